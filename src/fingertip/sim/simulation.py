"""Simulations: from files, as ``fingertip simulate`` does before it prints and writes, and the
article's (III.C).

from fingertip.sim.simulation import load_simulation

simulation = load_simulation("hard_tap", "fsr400", changes=["tap.count=1"])
result = simulation.run()

The article's experiments are the sliding-finger trial, its series of 120 trials, and its 12
manipulations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from fingertip.board.analysis.tactile_response import find_tactile_range_v
from fingertip.catalogues.file_kinds import (
    DESIGN,
    MANIPULATION,
    SCENE,
    find_file,
    identify_kind,
    split_changes,
)
from fingertip.design import Design
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import (
    FingertipError,
    Issue,
    TraceError,
    checked,
    gather,
    raise_issues,
)
from fingertip.sim.contact.surface_files import (
    ARTICLE_SURFACES,
    SURFACES,
    SurfaceFile,
    find_profile_warnings,
)
from fingertip.sim.runs.scene import (
    SceneRecord,
    SceneResult,
    run_scene,
    select_columns,
    stream_scene,
)
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.runs.timeline import SLIDE_M
from fingertip.sim.signal.simulated_finger import FingerSignals
from fingertip.sim.trace_file import open_trace, write_columns

if TYPE_CHECKING:
    from fingertip.sim.runs.manipulation import ManipulationResult
    from fingertip.sim.runs.manipulation_plan import Controller
from fingertip.slip.traces.trace import Trace


@dataclass(frozen=True)
class Simulation:
    """Design, scene and seed of one simulation, ready to run."""

    design: Design
    scene: SceneFile | ManipulationFile
    seed: int = 0
    name: str = "trace"
    """Name of the scene's file without suffix; "trace" for a trial of the article."""

    def find_warnings(self) -> Iterator[str]:
        """Yield what limits the recorded voltage: an ADC range that the board exceeds, a profile of
        too few points.
        """
        if "voltage_v" in self.scene.outputs:
            range_v = find_tactile_range_v(self.design)
            if self.scene.converter.bits:
                yield from self.scene.converter.find_warnings(*range_v)
            elif max(range_v) > self.design.detector.adc_range_v:
                from fingertip.board.analysis.board_values import find_range_warnings  # noqa: PLC0415

                yield from find_range_warnings(self.design)

        if (
            isinstance(self.scene, SceneFile)
            and self.scene.slide.distance_m
            and self.scene.surface.profile_um
        ):
            yield from find_profile_warnings(
                self.scene.surface.profile_step_um,
                self.scene.slide.speed_m_s,
                self.design.board.cutoff_hz,
            )

    def run(
        self, controller: Controller | None = None, progress: Callable[[str], None] | None = None
    ) -> SceneResult | ManipulationResult:
        """Run the simulation. Raises TraceError."""
        if isinstance(self.scene, ManipulationFile):
            from fingertip.sim.runs.manipulation import run_manipulation  # noqa: PLC0415

            return run_manipulation(self.design, self.scene, controller, self.seed, progress)

        return run_scene(self.design, self.scene, self.seed, progress)

    def write(
        self, file: BinaryIO, path: Path, progress: Callable[[str], None] | None = None
    ) -> SceneRecord | ManipulationResult:
        """Run the simulation and write its trace to an open file, a scene chunk by chunk.

        Raises TraceError.
        """
        if isinstance(self.scene, ManipulationFile):
            from fingertip.sim.runs.manipulation import run_manipulation  # noqa: PLC0415

            result = run_manipulation(self.design, self.scene, None, self.seed, progress)
            write_columns(file, path, result.time_s, result.columns)
            return result

        scene = self.scene
        writer = open_trace(file, path, scene.outputs)

        def take(chunk: FingerSignals) -> None:
            writer.write(chunk.time_s, select_columns(chunk, scene))

        record = stream_scene(
            self.design,
            scene=scene,
            take=take,
            seed=self.seed,
            progress=progress,
        )
        writer.close()
        return record


def load_simulation(
    file: str | Path | None = None,
    design_file: str | Path | None = None,
    *,
    changes: Iterable[str] = (),
    surface: str | None = None,
    speed_m_s: float | None = None,
    force_n: float | None = None,
    seed: int = 0,
) -> Simulation:
    """Load design and scene from files, apply changes, and report all issues at once.

    Raises FingertipError.
    """
    named_file = file
    file, design_file = _find_files(file, design_file)
    kind = identify_kind(file) if file else None
    is_scene = kind in (SCENE, MANIPULATION)
    scene_changes, design_changes = split_changes(changes, [kind] if kind and is_scene else [])
    options: dict[str, Any] = {"surface": surface, "speed_m_s": speed_m_s, "force_n": force_n}
    issues: list[Issue] = []
    own: SurfaceFile | None = None

    if (
        surface is not None
        and surface not in SURFACES
        and Path(surface).suffix in (".toml", ".csv")
    ):
        options["surface"] = None
        with gather(issues):
            own = SurfaceFile.load(Path(surface))

    options = {option: value for option, value in options.items() if value is not None}
    if not is_scene:
        if design_file:
            beside = named_file or "no file"
            message = f"stands beside {beside}, which is not a scene; leave --design out."
            issues.append(Issue("--design", message))

        if scene_changes:
            message = "changes a scene; give a scene, such as sliding_finger."
            issues.append(Issue(f"--set {scene_changes[0]}", message))
    elif seed < 0:  # a trial checks its seed itself
        issues.append(Issue("--seed", f"{seed} is negative; choose a whole number of at least 0."))

    design: Design | None = None
    scene: SceneFile | ManipulationFile | None = None
    path = design_file if is_scene else file  # a file of any other kind is refused as a design
    with gather(issues):
        design = Design.load(*([path] if path else []), changes=design_changes)

    with gather(issues):
        if file is None or not is_scene:
            scene = Trial(**options, seed=seed).scene
        else:
            model = ManipulationFile if kind is MANIPULATION else SceneFile
            fields: dict[str, str] = {}
            for option in options:
                fields |= dict.fromkeys(model.options[option], option)

            scene_changes += [f"{field}={options[option]!r}" for field, option in fields.items()]

            try:
                scene = model.load(file, changes=scene_changes)
            except TraceError as error:
                typed = {field: f"--{option.replace('_', '-')}" for field, option in fields.items()}
                issues += dict.fromkeys(
                    replace(issue, field=typed.get(issue.field, issue.field))
                    for issue in error.issues
                )

    if own is not None and scene is not None:
        with gather(issues):
            scene = type(scene)(**scene.model_dump() | {"surface": own.surface.model_dump()})

    if speed_m_s is not None and isinstance(scene, SceneFile) and not scene.slide.distance_m:
        remedy = "leave it out, or let the finger slide with --set slide.distance_m=0.04"
        issues.append(
            Issue(
                "--speed-m-s",
                f"{speed_m_s:g} m/s has no effect, because nothing slides here; {remedy}.",
            )
        )

    if issues or design is None or scene is None:
        raise FingertipError(issues)

    return Simulation(design, scene, seed, file.stem if file and is_scene else "trace")


def _find_files(
    file: str | Path | None, design_file: str | Path | None
) -> tuple[Path | None, Path | None]:
    paths: list[Path | None] = []
    issues: list[Issue] = []
    for source, kinds in ((file, (DESIGN, SCENE, MANIPULATION)), (design_file, (DESIGN,))):
        with gather(issues):
            paths.append(find_file(source, *kinds) if source else None)

    raise_issues(FingertipError, issues)
    return paths[0], paths[1]


FORCE_RANGE_N = (0.2, 2.0)
"""Range of the article's random holding force [N]."""
MAX_FORCE_N = 4.0
"""Maximum holding force [N].
At a larger one the hand travels so far that the lift of 5 cm does not end the contact.
"""
SPEED_RANGE_M_S = (0.005, 0.2)
"""Range of the sliding speed [m/s]: slower takes minutes to compute, faster is not reached within 4
cm.
"""
SPEEDS_M_S = (0.04, 0.06, 0.08)
REPEATS_PER_TRIAL = 5
GRASPED_SURFACES = ("smooth", "plastic")
"""Surfaces of the article's two grasped objects.
Assumption: both were quite smooth, of unknown roughness.
"""
TRIGGER_V = 0.01
"""Drop of the tactile voltage at which the robot's wait begins [V].
Assumption: 20 times the noise of a sample.
"""
MANIPULATED_OBJECTS: dict[str, tuple[dict[str, Any], str]] = {
    "bottle": ({"mass_kg": 0.5, "surface": "plastic", "stiffness_n_per_m": 3000.0}, "power"),
    "parallelepiped": ({"mass_kg": 0.255, "surface": "wood"}, "power"),
    "small_parallelepiped": ({"mass_kg": 0.06, "surface": "wood"}, "pinch"),
    "cylinder": ({"mass_kg": 0.02, "surface": "wood"}, "pinch"),
}
"""Object and grasp of each of the article's manipulations. Assumptions: the bottle's surface is the
smartphone's, and its wall, 0.3 mm of polyester on a radius of 33 mm, yields by 1 mm under 3 N; no
measured stiffness was found.
"""
REPEATS_PER_MANIPULATION = 3


@checked
@dataclass(frozen=True)
class Trial:
    """One sliding-finger trial; its seed draws everything random.

    Raises TraceError with all invalid values.
    """

    surface: str = "medium"
    speed_m_s: float = 0.04
    force_n: float | None = None
    """Holding force [N]. None lets the seed draw one between 0.2 and 2 N."""
    seed: int = 0

    def __post_init__(self) -> None:
        issues = []
        if self.surface not in SURFACES:
            remedy = suggest_name(self.surface, list(SURFACES))
            issues.append(Issue("--surface", f"{self.surface!r} is not known; {remedy}"))

        minimum, maximum = SPEED_RANGE_M_S
        if not minimum <= self.speed_m_s <= maximum:
            remedy = f"choose {minimum:g} to {maximum:g} m/s (article: 0.04)"
            issues.append(Issue("--speed-m-s", f"{self.speed_m_s:g} m/s is refused; {remedy}."))

        if self.force_n is not None and not 0.0 < self.force_n <= MAX_FORCE_N:
            remedy = f"choose above 0 and at most {MAX_FORCE_N:g} N, or leave it out"
            issues.append(Issue("--force-n", f"{self.force_n:g} N is refused; {remedy}."))

        if self.seed < 0:
            issues.append(
                Issue("--seed", f"{self.seed} is negative; choose a whole number of at least 0.")
            )

        raise_issues(TraceError, issues)

    @property
    def scene(self) -> SceneFile:
        low, high = FORCE_RANGE_N if self.force_n is None else (self.force_n, self.force_n)
        return SceneFile(
            scene="sliding_finger",
            contact={"surface": self.surface},
            hold={"min_force_n": low, "max_force_n": high},
            slide={"distance_m": SLIDE_M, "speed_m_s": self.speed_m_s},
        )


def simulate(design: Design, trial: Trial | None = None) -> Trace:
    """Simulate one sliding-finger trial of the article.

    The pad is dragged under the quasi-static normal force. Vibration is computed along the
    resulting path and does not act back on friction, because plain LuGre friction creeps under
    vibration below breakaway (P. Dupont et al., IEEE Trans. Automatic Control 47(5), 2002,
    doi:10.1109/TAC.2002.1000274). The vibration is 1 % (`smooth`) to 17 % (`wood`) of the force.

    The design gives the shape of the pad, the sampling rate, the ADC and its noise. The default
    trial is the article's slowest slide on its medium surface. The trace has voltage, true normal
    force and true gross slip; the same design and trial give the same trace.
    """
    trial = trial or Trial()
    return run_scene(design, trial.scene, trial.seed).trace


def article_trials() -> Iterator[tuple[SceneFile, int]]:
    """Yield scene and own seed of the 120 trials: 6 surfaces and 2 grasped objects, 3 speeds, 5
    repeats.
    """
    seed = 0
    # The thumb of a tri-digital grasp, which presses with the force of both fingers;
    # `tri_digital.toml` has all three.
    grasp = {
        "mode": "grasp",
        "min_force_n": 0.5,
        "max_force_n": 3.5,
        "release": False,
        "trigger_v": TRIGGER_V,
    }

    for configuration, surfaces, hold in (
        ("sliding_finger", ARTICLE_SURFACES, dict[str, Any]()),
        ("sliding_surface", GRASPED_SURFACES, grasp),
    ):
        for surface in surfaces:
            for speed in SPEEDS_M_S:
                slide = {"distance_m": 0.04, "speed_m_s": speed}
                scene = SceneFile(
                    scene=configuration,
                    contact={"surface": surface},
                    hold=hold,
                    slide=slide,
                )
                for _ in range(REPEATS_PER_TRIAL):
                    yield scene, seed
                    seed += 1


def article_manipulations(first_seed: int = 0) -> Iterator[tuple[ManipulationFile, int]]:
    """Yield scene, named after its object, and seed of each of the 12 manipulations: 4 objects, 3
    repeats.
    """
    seed = first_seed
    for name, (target, kind) in MANIPULATED_OBJECTS.items():
        # The recording of a power grasp lasts 1 s longer (article, III.C).
        grasp = {"kind": kind, "after_s": 2.0 if kind == "power" else 1.0}
        scene = ManipulationFile(scene=name, object=target, grasp=grasp)
        for _ in range(REPEATS_PER_MANIPULATION):
            yield scene, seed
            seed += 1
