"""Files of a bring-up, and the assessment of readings, for a design."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fingertip.board.board_values import BoardValues, board_values
from fingertip.board.bringup.plan import BringUp, plan_bring_up
from fingertip.board.bringup.prediction import Board
from fingertip.board.bringup.readings import read_readings, readings_template
from fingertip.board.bringup.report import assess_readings
from fingertip.board.bringup.sheet import render_sheet
from fingertip.board.bringup.wiring import wiring_diagram
from fingertip.board.circuits.signal_paths import board_circuit
from fingertip.board.output import BRING_UP, BRING_UP_READINGS, WIRING
from fingertip.design import Design


def bring_up_files(design: Design) -> dict[str, bytes]:
    """Content of the bring-up sheet, of its wiring diagram and of the file of readings, by name."""
    values = board_values(design)
    plan = _plan(design, values)
    return {
        BRING_UP: render_sheet(plan, values, design, WIRING).encode(),
        WIRING: wiring_diagram(plan.board.circuit, design.board.supply_v, design.name),
        BRING_UP_READINGS: readings_template(plan, design.name).encode(),
    }


def assess_board(design: Design, path: Path) -> dict[str, Any]:
    """Assess the readings in a file, as plain data.

    Raises
    ------
    TomlFileError, BoardError
        If the file cannot be read, or holds what are no readings of this design's board.
    """
    values = board_values(design)
    readings = read_readings(path, _plan(design, values))
    is_in_software = values.comparator_levels is None and values.output_offset is not None
    threshold_v = design.detector.threshold_v if is_in_software else None
    return assess_readings(_plan(design, values, readings.tone_v), readings, threshold_v)


def _plan(design: Design, values: BoardValues, *tone_v: float) -> BringUp:
    return plan_bring_up(Board.of_design(design, board_circuit(values)), values, *tone_v)
