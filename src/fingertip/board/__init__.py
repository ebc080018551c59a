"""The slip-filter board: from a design to component values, a circuit, a schematic and a layout for KiCad."""

from fingertip.board.output import (
    board_circuit,
    board_files,
    differences,
    fabrication_differences,
    write_board,
    write_fabrication,
)
from fingertip.board.values.board_values import BoardValues, board_values

__all__ = [
    "BoardValues",
    "board_circuit",
    "board_files",
    "board_values",
    "differences",
    "fabrication_differences",
    "write_board",
    "write_fabrication",
]
