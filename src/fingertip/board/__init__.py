"""Slip-filter board: component values, circuit, analysis, bring-up and KiCad files of a design."""

from fingertip.board.analysis.board_values import BoardValues, board_values
from fingertip.board.circuits.signal_paths import board_circuit

__all__ = ["BoardValues", "board_circuit", "board_values"]

NETLIST = "slip_filter.net"
VALUES = "values.json"
DECK = "slip_filter.cir"
BOM = "bom.csv"
SCHEMATIC = "slip_filter.kicad_sch"
LAYOUT = "slip_filter.kicad_pcb"
PROJECT = "slip_filter.kicad_pro"
README = "README.md"
BRING_UP, BRING_UP_READINGS, WIRING = "bringup.md", "bringup_readings.toml", "wiring.svg"
