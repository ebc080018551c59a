"""Simulation of a fingertip up to the sampled voltage: scenes, contact, sensor and board.

Scenes of one finger and manipulations with a whole hand are described by files (`SceneFile`, `ManipulationFile`).
`load_simulation` reads them together with a design, as ``fingertip simulate`` does. `run_scene` and `run_manipulation`
run them, and `fingertip.sim.report` summarises their results. `simulate` runs one sliding-finger trial of the article.
"""

from fingertip.foundation.jit import compiled
from fingertip.sim.contact.materials import SURFACES
from fingertip.sim.runs.files import ManipulationFile, SceneFile
from fingertip.sim.runs.manipulation import ManipulationResult, run_manipulation
from fingertip.sim.runs.motion import Controller, FixedGrip, Observation
from fingertip.sim.runs.scene import SceneRecord, SceneResult, run_scene, stream_scene
from fingertip.sim.signal.finger import FingerSignals
from fingertip.sim.signal.grid import Grid
from fingertip.sim.simulation import Simulation, Trial, article_manipulations, article_trials, load_simulation, simulate
from fingertip.sim.trace_file import encode_trace

__all__ = [
    "SURFACES",
    "Controller",
    "FingerSignals",
    "FixedGrip",
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
    "article_trials",
    "compiled",
    "encode_trace",
    "load_simulation",
    "run_manipulation",
    "run_scene",
    "simulate",
    "stream_scene",
]
