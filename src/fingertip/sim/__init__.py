"""Simulation of a fingertip up to the sampled voltage: scenes, contact, sensor and board.

Scenes of one finger and manipulations with a whole hand are described by files (`SceneFile`, `ManipulationFile`).
`load_simulation` reads them together with a design, as ``fingertip simulate`` does. `run_scene` and `run_manipulation`
run them, and `fingertip.sim.report` summarises their results. `simulate` runs one sliding-finger trial of the article.
"""

from fingertip.sim.runs.files import ManipulationFile, SceneFile
from fingertip.sim.runs.manipulation import ManipulationResult, run_manipulation
from fingertip.sim.runs.motion import Controller, Observation
from fingertip.sim.runs.scene import SceneRecord, SceneResult, run_scene
from fingertip.sim.signal.grid import Grid
from fingertip.sim.simulation import Simulation, Trial, article_manipulations, load_simulation, simulate

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
