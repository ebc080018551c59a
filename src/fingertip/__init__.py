"""A bioinspired prosthetic fingertip from one file of parameters.

The names below read as the command line does::

    from fingertip import Design, build, write_board, simulate, detect

    design = Design.load("params/fsr400.toml", changes=["mold.draft_deg=2"])
    build(design, formats=["stl"])  # -> out/fsr400
    write_board(design, "pcb")
    detect(simulate(design), design).intervals

Importing this package loads nothing; each name loads what it needs when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fingertip._version import __version__

if TYPE_CHECKING:
    from fingertip.board import BoardValues, board_values, write_board
    from fingertip.cad.files.interop import part_mesh, part_solid, part_trimesh
    from fingertip.design import Design
    from fingertip.errors import FingertipError
    from fingertip.kit import Build, build
    from fingertip.sim import ManipulationFile, SceneFile, Trial, run_manipulation, run_scene, simulate
    from fingertip.slip import Detection, SlipChain, Trace, detect, read_trace

_HOME = {
    "BoardValues": "fingertip.board",
    "Build": "fingertip.kit",
    "Design": "fingertip.design",
    "Detection": "fingertip.slip",
    "FingertipError": "fingertip.errors",
    "ManipulationFile": "fingertip.sim",
    "SceneFile": "fingertip.sim",
    "SlipChain": "fingertip.slip",
    "Trace": "fingertip.slip",
    "Trial": "fingertip.sim",
    "board_values": "fingertip.board",
    "build": "fingertip.kit",
    "detect": "fingertip.slip",
    "part_mesh": "fingertip.cad.files.interop",
    "part_solid": "fingertip.cad.files.interop",
    "part_trimesh": "fingertip.cad.files.interop",
    "read_trace": "fingertip.slip",
    "run_manipulation": "fingertip.sim",
    "run_scene": "fingertip.sim",
    "simulate": "fingertip.sim",
    "write_board": "fingertip.board",
}

__all__ = [
    "BoardValues",
    "Build",
    "Design",
    "Detection",
    "FingertipError",
    "ManipulationFile",
    "SceneFile",
    "SlipChain",
    "Trace",
    "Trial",
    "__version__",
    "board_values",
    "build",
    "detect",
    "part_mesh",
    "part_solid",
    "part_trimesh",
    "read_trace",
    "run_manipulation",
    "run_scene",
    "simulate",
    "write_board",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'fingertip' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return __all__
