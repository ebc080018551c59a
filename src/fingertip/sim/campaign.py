"""The article's 120 trials (III.C): six surfaces and two grasped objects, three velocities, five trials each."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.sim.scene_file import SceneFile
from fingertip.sim.surfaces import SURFACES

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
                    hold={"mode": "grasp", "force_least_n": 0.5, "force_most_n": 3.5, "release": False}
                    if configuration == "sliding_surface"
                    else {},
                    slide={"distance_m": 0.04, "speed_m_s": speed},
                )
                for _ in range(TRIALS):
                    yield scene, seed
                    seed += 1
