"""What happens to a finger, up to the voltage that is sampled: scenes, contact, sensor, board."""

from fingertip.sim.campaign import manipulations, trials
from fingertip.sim.controller import Controller, FixedGrip, Seen
from fingertip.sim.jit import compiled
from fingertip.sim.manipulated import Manipulated
from fingertip.sim.manipulation import run_manipulation
from fingertip.sim.manipulation_file import ManipulationFile
from fingertip.sim.result import Simulated, run_scene
from fingertip.sim.scene_file import SceneFile
from fingertip.sim.surfaces import SURFACES
from fingertip.sim.trial import Trial, simulate

__all__ = [
    "SURFACES",
    "Controller",
    "FixedGrip",
    "Manipulated",
    "ManipulationFile",
    "SceneFile",
    "Seen",
    "Simulated",
    "Trial",
    "compiled",
    "manipulations",
    "run_manipulation",
    "run_scene",
    "simulate",
    "trials",
]
