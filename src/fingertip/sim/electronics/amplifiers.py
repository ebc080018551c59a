"""How real a board's amplifiers are taken."""

from __future__ import annotations

from fingertip.board import board_values
from fingertip.design import Design
from fingertip.sim.electronics.circuit import Analog


def amplified(design: Design, amplifiers: str) -> Analog:
    """The board of a design with ideal amplifiers, with outputs that stop at their rails, or with the design's
    gain-bandwidth product ("ideal", "rails", "gain_bandwidth").

    Rails are taken as far below the signals' rest as above it. A TL082's inputs end sooner there and its output then
    jumps up, which is not simulated: `Limits.filter_trough_v` says how far down variant article's board may be taken.
    """
    board = Analog.of(design)
    if amplifiers == "rails":
        return board.changed(rail_v=board_values(design).limits.filter_peak_v)
    if amplifiers == "gain_bandwidth":
        return board.changed(gain_bandwidth_hz=design.board.gain_bandwidth_hz)
    return board
