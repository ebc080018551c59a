"""Simulation of a fingertip up to the sampled voltage: scenes, contact, sensor and board.

A design with a scene of one finger (`SceneFile`) or of a hand (`ManipulationFile`) and a seed come
in; signals, true slips and a trace for a detector go out. `load_simulation` reads them as
``fingertip simulate`` does.

>>> from fingertip.sim import Grid
>>> Grid(refinement=2).rate_hz
20000.0
"""

from fingertip.sim.runs.manipulation import ManipulationResult, run_manipulation
from fingertip.sim.runs.manipulation_plan import Controller, Observation
from fingertip.sim.runs.scene import SceneRecord, SceneResult, run_scene
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.signal.grid import Grid
from fingertip.sim.simulation import (
    Simulation,
    Trial,
    article_manipulations,
    load_simulation,
    simulate,
)

__all__ = [
    "Controller",
    "Grid",
    "ManipulationFile",
    "ManipulationResult",
    "Observation",
    "SceneFile",
    "SceneRecord",
    "SceneResult",
    "Simulation",
    "Trial",
    "article_manipulations",
    "load_simulation",
    "run_manipulation",
    "run_scene",
    "simulate",
]
