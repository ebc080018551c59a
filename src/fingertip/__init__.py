"""Parametric design of a sensorised prosthetic fingertip: printable parts, filter board, simulation, slip detection.

The public names follow the commands of the command line::

    from fingertip import Design, build, write_board, simulate, detect

    design = Design.load("fsr400", changes=["mold.draft_deg=2"])
    build(design, formats=["stl"])  # -> out/fsr400
    write_board(design)  # -> out/fsr400/board
    detect(simulate(design), design).intervals

Importing this package loads none of its modules. Each name is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fingertip.foundation.version import __version__

if TYPE_CHECKING:
    from fingertip.board import BoardValues, board_values
    from fingertip.cad.convert import assembly, frames, part_mesh, part_solid, part_trimesh, part_workplane
    from fingertip.cad.report import Build
    from fingertip.cad.verification.verify import check
    from fingertip.design import Design
    from fingertip.detection.arrays import detect
    from fingertip.detection.files import FileDetection, StreamDetection, detect_file, detect_stream
    from fingertip.foundation.display import Picture
    from fingertip.foundation.errors import FingertipError
    from fingertip.pictures.picture import picture
    from fingertip.sim import ManipulationFile, SceneFile, Trial, run_manipulation, run_scene, simulate
    from fingertip.sim.signal.readout import Readout
    from fingertip.slip import Detection, SlipChain, Trace, read_trace
    from fingertip.sweep.table import run_sweep
    from fingertip.tasks.board import write_board
    from fingertip.tasks.build import build
    from fingertip.tasks.coupon import write_coupon
    from fingertip.tasks.firmware import write_firmware
    from fingertip.tasks.make import Made, make
    from fingertip.tasks.robot import write_robot

_MODULES = {
    "BoardValues": "fingertip.board",
    "Build": "fingertip.cad.report",
    "Design": "fingertip.design",
    "Detection": "fingertip.slip",
    "FileDetection": "fingertip.detection.files",
    "FingertipError": "fingertip.foundation.errors",
    "Made": "fingertip.tasks.make",
    "ManipulationFile": "fingertip.sim",
    "Picture": "fingertip.foundation.display",
    "Readout": "fingertip.sim.signal.readout",
    "SceneFile": "fingertip.sim",
    "SlipChain": "fingertip.slip",
    "StreamDetection": "fingertip.detection.files",
    "Trace": "fingertip.slip",
    "Trial": "fingertip.sim",
    "assembly": "fingertip.cad.convert",
    "board_values": "fingertip.board",
    "build": "fingertip.tasks.build",
    "check": "fingertip.cad.verification.verify",
    "detect": "fingertip.detection.arrays",
    "detect_file": "fingertip.detection.files",
    "detect_stream": "fingertip.detection.files",
    "frames": "fingertip.cad.convert",
    "make": "fingertip.tasks.make",
    "part_mesh": "fingertip.cad.convert",
    "part_solid": "fingertip.cad.convert",
    "part_trimesh": "fingertip.cad.convert",
    "part_workplane": "fingertip.cad.convert",
    "picture": "fingertip.pictures.picture",
    "read_trace": "fingertip.slip",
    "run_manipulation": "fingertip.sim",
    "run_scene": "fingertip.sim",
    "run_sweep": "fingertip.sweep.table",
    "simulate": "fingertip.sim",
    "write_board": "fingertip.tasks.board",
    "write_coupon": "fingertip.tasks.coupon",
    "write_firmware": "fingertip.tasks.firmware",
    "write_robot": "fingertip.tasks.robot",
}
"""Public name -> module that defines it."""

__all__ = [
    "BoardValues",
    "Build",
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
    "build",
    "check",
    "detect",
    "detect_file",
    "detect_stream",
    "frames",
    "make",
    "part_mesh",
    "part_solid",
    "part_trimesh",
    "part_workplane",
    "picture",
    "read_trace",
    "run_manipulation",
    "run_scene",
    "run_sweep",
    "simulate",
    "write_board",
    "write_coupon",
    "write_firmware",
    "write_robot",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'fingertip' has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)


def __dir__() -> list[str]:
    return __all__
