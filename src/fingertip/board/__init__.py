"""Slip-filter board: component values, circuit, and KiCad schematic and layout of a design."""

from fingertip.board.board_values import BoardValues, board_values
from fingertip.board.circuits.signal_paths import board_circuit
from fingertip.board.output import (
    board_differences,
    board_files,
    fabrication_differences,
    write_board,
    write_fabrication,
)

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
