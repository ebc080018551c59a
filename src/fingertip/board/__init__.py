"""Slip-filter board: component values, circuit, analysis, bring-up and KiCad files of a design."""

from fingertip.board.analysis.board_values import BoardValues, board_values
from fingertip.board.circuits.board_circuit import board_circuit

__all__ = ["BoardValues", "board_circuit", "board_values"]
