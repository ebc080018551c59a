"""The article's trials (III.C): 120 with six surfaces and two grasped objects, three velocities, five trials each; and
12 manipulations, four objects three times."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.sim.contact.surfaces import SURFACES
from fingertip.sim.hand.manipulation_file import ManipulationFile
from fingertip.sim.scenes.scene_file import SceneFile

SPEEDS_M_S = (0.04, 0.06, 0.08)
TRIALS = 5
OBJECTS = ("smooth", "plastic")
"""What the two grasped objects are taken for: both were quite smooth, of unknown roughness. Assumption."""


def trials() -> Iterator[tuple[SceneFile, int]]:
    """Scene and seed of each trial; every trial has a seed of its own."""
    seed = 0
    for configuration, surfaces in (("sliding_finger", tuple(SURFACES)), ("sliding_surface", OBJECTS)):
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
                for _ in range(TRIALS):
                    yield scene, seed
                    seed += 1


MANIPULATED = {
    "bottle": (0.5, "plastic", "power"),
    "parallelepiped": (0.255, "wood", "power"),
    "small_parallelepiped": (0.06, "wood", "pinch"),
    "cylinder": (0.02, "wood", "pinch"),
}
"""The article's four objects: mass [kg], surface, grasp. The bottle's plastic is taken for the smartphone cover's
(assumption)."""
REPEATS = 3


def manipulations(first_seed: int = 0) -> Iterator[tuple[ManipulationFile, int]]:
    """Scene, named after its object, and seed of each manipulation."""
    seed = first_seed
    for name, (mass, surface, kind) in MANIPULATED.items():
        # Power grasps last 1 s longer (article, III.C).
        grasp = {"kind": kind, "after_s": 2.0 if kind == "power" else 1.0}
        scene = ManipulationFile(scene=name, object={"mass_kg": mass, "surface": surface}, grasp=grasp)
        for _ in range(REPEATS):
            yield scene, seed
            seed += 1
