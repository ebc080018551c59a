"""Front end of any design, a board's or a divider: the tactile voltage over the sensor's conductance."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.limits import TactileResponse, adc_range_warnings
from fingertip.board.components.bridge import MAX_FORCE_N, sensor_conductance_s
from fingertip.design import Design


def find_tactile_response(design: Design) -> TactileResponse:
    board = design.board
    if board.has_filter:
        return board_values(design).tactile_response
    # The supply behind the resistor drives the sensor, whose current is read across that resistor.
    return TactileResponse(0.0, board.supply_v, board.divider_ohm, -board.divider_ohm)


def find_tactile_range_v(design: Design) -> tuple[float, float]:
    """Smallest and largest tactile voltage [V], from an open sensor to its maximum force."""
    response = find_tactile_response(design)
    ends_v = response.open_v, response.tactile_v(sensor_conductance_s(MAX_FORCE_N))
    return min(ends_v), max(ends_v)


def find_range_warnings(design: Design) -> Iterator[str]:
    """Find a converter that clips the tactile voltage."""
    board, converter = design.board, design.detector
    if board.has_filter:
        yield from adc_range_warnings(board_values(design).voltage_limits)
    elif board.supply_v > converter.adc_range_v:
        yield (
            f"the divider's voltage, up to {board.supply_v:g} V, exceeds the converter's {converter.adc_range_text}; "
            f"use --set board.supply_v={converter.adc_range_v:g}, from the pin of the converter's reference."
        )
