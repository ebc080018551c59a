"""The slip-filter board: from a design to component values, a circuit and a netlist for KiCad."""

from fingertip.board.output import board_circuit, board_files, write_board
from fingertip.board.values import BoardValues, board_values

__all__ = ["BoardValues", "board_circuit", "board_files", "board_values", "write_board"]
