"""What happens to a finger, up to the voltage that is sampled: scenes, contact, sensor, board."""

from fingertip.jit import compiled
from fingertip.sim.campaign import manipulations, trials
from fingertip.sim.contact.surfaces import SURFACES
from fingertip.sim.hand.controller import Controller, FixedGrip, Seen
from fingertip.sim.hand.manipulated import Manipulated
from fingertip.sim.hand.manipulation import run_manipulation
from fingertip.sim.hand.manipulation_file import ManipulationFile
from fingertip.sim.scenes.scene_file import SceneFile
from fingertip.sim.stages.result import Simulated, run_scene
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
