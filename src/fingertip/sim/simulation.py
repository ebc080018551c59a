"""Simulation from files: everything that ``fingertip simulate`` does before it prints and writes.

from fingertip.sim import load_simulation

simulation = load_simulation("hard_tap", "fsr400", changes=["tap.count=1"])
result = simulation.run()
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.limits import adc_range_warnings
from fingertip.catalogues.bundled import find_file
from fingertip.catalogues.file_kinds import DESIGN, MANIPULATION, SCENE, identify_kind, split_changes
from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, Issue
from fingertip.sim.article import Trial
from fingertip.sim.files.manipulation import ManipulationFile
from fingertip.sim.files.scene import SceneFile
from fingertip.sim.files.schema import find_converter_warnings
from fingertip.sim.hand.manipulation import ManipulationResult, run_manipulation
from fingertip.sim.hand.motion import Controller
from fingertip.sim.report import open_trace
from fingertip.sim.scene.run import SceneRecord, SceneResult, run_scene, select_columns, stream_scene


@dataclass(frozen=True)
class Simulation:
    """Design, scene and seed of one simulation, ready to run."""

    design: Design
    scene: SceneFile | ManipulationFile
    seed: int = 0
    name: str = "trace"
    """Name of the scene's file without suffix; "trace" for a trial of the article."""

    def find_warnings(self) -> Iterator[str]:
        """Yield what limits the recorded voltage, such as an ADC range that the board exceeds."""
        if "voltage_v" in self.scene.outputs:
            limits = board_values(self.design).voltage_limits
            if self.scene.converter.bits:
                yield from find_converter_warnings(self.scene.converter, limits.min_tactile_v, limits.max_tactile_v)
            else:
                yield from adc_range_warnings(limits)

    def run(
        self, controller: Controller | None = None, progress: Callable[[str], None] | None = None
    ) -> SceneResult | ManipulationResult:
        """Run the simulation. Raises TraceError."""
        if isinstance(self.scene, ManipulationFile):
            return run_manipulation(self.design, self.scene, controller, self.seed, progress)
        return run_scene(self.design, self.scene, self.seed, progress)

    def write(
        self, file: BinaryIO, path: Path, progress: Callable[[str], None] | None = None
    ) -> SceneRecord | ManipulationResult:
        """Run the simulation and write its trace to an open file, a scene chunk by chunk. Raises TraceError."""
        if isinstance(self.scene, ManipulationFile):
            result = run_manipulation(self.design, self.scene, None, self.seed, progress)
            writer = open_trace(file, path, result.column_names)
            writer.write(result.time_s, result.columns)
            writer.close()
            return result
        scene = self.scene
        writer = open_trace(file, path, scene.outputs)
        record = stream_scene(
            self.design,
            scene,
            lambda chunk: writer.write(chunk.time_s, select_columns(chunk, scene)),
            self.seed,
            progress,
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
    """Load design and scene from files, apply changes, and report all issues at once. Raises FingertipError."""
    given, (file, design_file) = file, _find_files(file, design_file)
    kind = identify_kind(file) if file else None
    is_scene = kind in (SCENE, MANIPULATION)
    scene_changes, design_changes = split_changes(changes, [kind] if kind and is_scene else [])
    options: dict[str, Any] = {"surface": surface, "speed_m_s": speed_m_s, "force_n": force_n}
    options = {option: value for option, value in options.items() if value is not None}
    issues: list[Issue] = []
    if not is_scene:
        if design_file:
            message = f"stands beside {given or 'no file'}, which is not a scene; leave --design out."
            issues.append(Issue("--design", message))
        if scene_changes:
            message = "changes a scene; give a scene, such as sliding_finger."
            issues.append(Issue(f"--set {scene_changes[0]}", message))
    elif seed < 0:  # a trial checks its seed itself
        issues.append(Issue("--seed", f"{seed} is negative; choose a whole number of at least 0."))

    design: Design | None = None
    scene: SceneFile | ManipulationFile | None = None
    path = design_file if is_scene else file  # a file of any other kind is refused as a design
    try:
        design = Design.load(*([path] if path else []), changes=design_changes)
    except FingertipError as error:
        issues.extend(error.issues)
    try:
        if file is None or not is_scene:
            scene = Trial(**options, seed=seed).scene
        else:
            model = ManipulationFile if kind is MANIPULATION else SceneFile
            for option, value in options.items():
                text = f'"{value}"' if isinstance(value, str) else repr(value)
                scene_changes += [f"{name}={text}" for name in model.options[option]]
            scene = model.load(file, changes=scene_changes)
    except FingertipError as error:
        issues.extend(error.issues)
    if speed_m_s is not None and isinstance(scene, SceneFile) and not scene.slide.distance_m:
        remedy = "leave it out, or let the finger slide with --set slide.distance_m=0.04"
        issues.append(Issue("--speed-m-s", f"{speed_m_s:g} m/s has no effect, because nothing slides here; {remedy}."))
    if issues or design is None or scene is None:
        raise FingertipError(issues)
    return Simulation(design, scene, seed, file.stem if file and is_scene else "trace")


def _find_files(file: str | Path | None, design_file: str | Path | None) -> tuple[Path | None, Path | None]:
    found: list[Path | None] = []
    issues: list[Issue] = []
    for given, kinds in ((file, (DESIGN, SCENE, MANIPULATION)), (design_file, (DESIGN,))):
        try:
            found.append(find_file(given, *kinds) if given else None)
        except FingertipError as error:
            issues.extend(error.issues)
    if issues:
        raise FingertipError(issues)
    return found[0], found[1]
