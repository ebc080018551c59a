"""Slip-filter board: component values, circuit, and KiCad schematic and layout of a design."""

from fingertip.board.output import (
    board_circuit,
    board_differences,
    board_files,
    fabrication_differences,
    write_board,
    write_fabrication,
)
from fingertip.board.values.board_values import BoardValues, board_values

__all__ = [
    "BoardValues",
    "board_circuit",
    "board_differences",
    "board_files",
    "board_values",
    "fabrication_differences",
    "write_board",
    "write_fabrication",
]
