"""Parametric design of a sensorised prosthetic fingertip: printable parts, filter board,
simulation, slip detection.

The public names follow the commands of the command line::

    from fingertip import Design, build, write_board, simulate, detect

    design = Design.load("fsr400", changes=["skin.width_mm=18"])
    build(design, formats=["stl"])  # -> out/fsr400
    write_board(design)  # -> out/fsr400/board
    detect(simulate(design), design).intervals

Importing this package loads none of its modules. Each name is imported when it is first used, a
function with a check of the types of its arguments.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from fingertip.board.analysis.board_values import BoardValues, board_values
    from fingertip.cad.build_result import Build
    from fingertip.cad.convert import (
        assembly,
        bone,
        frames,
        mesh_of,
        mold,
        part_mesh,
        part_solid,
        part_trimesh,
        part_workplane,
        skin,
    )
    from fingertip.cad.verification.verify import check
    from fingertip.calibration.printer import calibrate_printer
    from fingertip.calibration.sensor import calibrate_sensor, read_weighings
    from fingertip.design import Design
    from fingertip.detection.live import StreamDetection, detect_stream
    from fingertip.detection.recordings import FileDetection, detect, detect_channels, detect_file
    from fingertip.fitting.fitting import fit_design
    from fingertip.foundation.display import Picture
    from fingertip.foundation.errors import FingertipError
    from fingertip.lab.campaign.campaign import CampaignPlan
    from fingertip.lab.validation import validate
    from fingertip.pictures.design_picture import picture
    from fingertip.sim.runs.manipulation import run_manipulation
    from fingertip.sim.runs.scene import run_scene
    from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
    from fingertip.sim.signal.readout import Readout
    from fingertip.sim.simulation import Trial, simulate
    from fingertip.slip.detectors.analog_and_digital import SlipChain
    from fingertip.slip.plots import plot_detection, plot_trace
    from fingertip.slip.scored_detection import Detection
    from fingertip.slip.traces.read import read_trace
    from fingertip.slip.traces.trace import Trace
    from fingertip.sweep.run import run_sweep
    from fingertip.tasks.board_files import write_board
    from fingertip.tasks.build import build
    from fingertip.tasks.firmware_files import write_firmware
    from fingertip.tasks.make import Made, make
    from fingertip.tasks.robot_files import write_robot
    from fingertip.tasks.views import write_drawing

_NAMES = {
    "board.analysis.board_values": "BoardValues board_values",
    "cad.convert": "assembly bone frames mesh_of mold part_mesh part_solid part_trimesh "
    "part_workplane skin",
    "cad.build_result": "Build",
    "cad.verification.verify": "check",
    "calibration.printer": "calibrate_printer",
    "calibration.sensor": "calibrate_sensor read_weighings",
    "design": "Design",
    "detection.live": "StreamDetection detect_stream",
    "detection.recordings": "FileDetection detect detect_channels detect_file",
    "fitting.fitting": "fit_design",
    "foundation.display": "Picture",
    "foundation.errors": "FingertipError",
    "lab.campaign.campaign": "CampaignPlan",
    "lab.validation": "validate",
    "pictures.design_picture": "picture",
    "sim.runs.manipulation": "run_manipulation",
    "sim.runs.scene": "run_scene",
    "sim.runs.scene_and_manipulation_files": "ManipulationFile SceneFile",
    "sim.simulation": "Trial simulate",
    "sim.signal.readout": "Readout",
    "slip.plots": "plot_detection plot_trace",
    "slip.scored_detection": "Detection",
    "slip.detectors.analog_and_digital": "SlipChain",
    "slip.traces.read": "read_trace",
    "slip.traces.trace": "Trace",
    "sweep.run": "run_sweep",
    "tasks.board_files": "write_board",
    "tasks.build": "build",
    "tasks.views": "write_drawing",
    "tasks.firmware_files": "write_firmware",
    "tasks.make": "Made make",
    "tasks.robot_files": "write_robot",
}
"""Module of the package -> its public names."""
_MODULES = {
    name: f"fingertip.{module}" for module, names in _NAMES.items() for name in names.split()
}

__all__ = [
    "BoardValues",
    "Build",
    "CampaignPlan",
    "Design",
    "Detection",
    "FileDetection",
    "FingertipError",
    "Made",
    "ManipulationFile",
    "Picture",
    "Readout",
    "SceneFile",
    "SlipChain",
    "StreamDetection",
    "Trace",
    "Trial",
    "__version__",
    "assembly",
    "board_values",
    "bone",
    "build",
    "calibrate_printer",
    "calibrate_sensor",
    "check",
    "detect",
    "detect_channels",
    "detect_file",
    "detect_stream",
    "fit_design",
    "frames",
    "make",
    "mesh_of",
    "mold",
    "part_mesh",
    "part_solid",
    "part_trimesh",
    "part_workplane",
    "picture",
    "plot_detection",
    "plot_trace",
    "read_trace",
    "read_weighings",
    "run_manipulation",
    "run_scene",
    "run_sweep",
    "simulate",
    "skin",
    "validate",
    "write_board",
    "write_drawing",
    "write_firmware",
    "write_robot",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'fingertip' has no attribute {name!r}")

    value = getattr(import_module(_MODULES[name]), name)
    if callable(value) and not isinstance(value, type):
        from fingertip.foundation.errors import checked  # noqa: PLC0415

        value = checked(value)
        value.__module__ = __name__  # where pickle finds it

    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
