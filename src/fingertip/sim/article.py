"""Experiments of the article (III.C): the sliding-finger trial, its series of 120 trials, and its 12 manipulations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.design import Design
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import Issue, TraceError
from fingertip.sim.contact.surfaces import SURFACES
from fingertip.sim.files.manipulation import ManipulationFile
from fingertip.sim.files.scene import SceneFile
from fingertip.sim.scene.run import run_scene
from fingertip.sim.scene.timeline import SLIDE_M
from fingertip.slip.traces.trace import Trace

FORCE_RANGE_N = (0.2, 2.0)
"""Range of the article's random holding force [N]."""
MAX_FORCE_N = 4.0
"""Maximum holding force [N]. At a larger one the hand travels so far that the lift of 5 cm does not end the contact."""
SPEED_RANGE_M_S = (0.005, 0.2)
"""Range of the sliding speed [m/s]. A slower slide takes minutes to compute; a faster one is not reached within 4
cm."""
SPEEDS_M_S = (0.04, 0.06, 0.08)
"""Sliding speeds of the article [m/s]."""
REPEATS_PER_TRIAL = 5
GRASPED_SURFACES = ("smooth", "plastic")
"""Surfaces of the article's two grasped objects. Assumption: both were quite smooth, of unknown roughness."""
MANIPULATED_OBJECTS = {
    "bottle": (0.5, "plastic", "power"),
    "parallelepiped": (0.255, "wood", "power"),
    "small_parallelepiped": (0.06, "wood", "pinch"),
    "cylinder": (0.02, "wood", "pinch"),
}
"""Mass [kg], surface and grasp of the article's four objects. The bottle is assumed to have the surface of the
smartphone cover."""
REPEATS_PER_MANIPULATION = 3


@dataclass(frozen=True)
class Trial:
    """One sliding-finger trial: surface, sliding speed, holding force, and the seed of everything random.

    Raises
    ------
    TraceError
        With one issue for each value that is not valid.
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
            issues.append(Issue("--seed", f"{self.seed} is negative; choose a whole number of at least 0."))
        if issues:
            raise TraceError(issues)

    @property
    def scene(self) -> SceneFile:
        """The trial as a scene."""
        low, high = FORCE_RANGE_N if self.force_n is None else (self.force_n, self.force_n)
        return SceneFile(
            scene="sliding_finger",
            contact={"surface": self.surface},
            hold={"min_force_n": low, "max_force_n": high},
            slide={"distance_m": SLIDE_M, "speed_m_s": self.speed_m_s},
        )


def simulate(design: Design, trial: Trial | None = None) -> Trace:
    """Simulate one sliding-finger trial of the article.

    The pad is dragged under the quasi-static normal force. Vibration is computed along the resulting path and does not
    act back on friction, because plain LuGre friction creeps under vibration below breakaway (P. Dupont et al., IEEE
    Trans. Automatic Control 47(5), 2002, doi:10.1109/TAC.2002.1000274). The vibration is a few percent of the force.

    Parameters
    ----------
    design
        Gives the shape of the pad, the sampling rate, the ADC and its noise.
    trial
        Trial to simulate. The default is the article's slowest slide on its medium surface.

    Returns
    -------
    Trace
        Voltage, true normal force and true gross slip. The same design and trial give the same trace.
    """
    trial = trial or Trial()
    return run_scene(design, trial.scene, trial.seed).trace


def article_trials() -> Iterator[tuple[SceneFile, int]]:
    """Yield scene and own seed of the 120 trials: 6 surfaces and 2 grasped objects, 3 speeds, 5 repeats."""
    seed = 0
    for configuration, surfaces in (("sliding_finger", tuple(SURFACES)), ("sliding_surface", GRASPED_SURFACES)):
        for surface in surfaces:
            for speed in SPEEDS_M_S:
                scene = SceneFile(
                    scene=configuration,
                    contact={"surface": surface},
                    hold={"mode": "grasp", "min_force_n": 0.5, "max_force_n": 3.5, "release": False}
                    if configuration == "sliding_surface"
                    else {},
                    slide={"distance_m": 0.04, "speed_m_s": speed},
                )
                for _ in range(REPEATS_PER_TRIAL):
                    yield scene, seed
                    seed += 1


def article_manipulations(first_seed: int = 0) -> Iterator[tuple[ManipulationFile, int]]:
    """Yield scene, named after its object, and seed of each of the 12 manipulations: 4 objects, 3 repeats."""
    seed = first_seed
    for name, (mass, surface, kind) in MANIPULATED_OBJECTS.items():
        # The recording of a power grasp lasts 1 s longer (article, III.C).
        grasp = {"kind": kind, "after_s": 2.0 if kind == "power" else 1.0}
        scene = ManipulationFile(scene=name, object={"mass_kg": mass, "surface": surface}, grasp=grasp)
        for _ in range(REPEATS_PER_MANIPULATION):
            yield scene, seed
            seed += 1
