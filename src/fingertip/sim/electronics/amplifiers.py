"""How real a board's amplifiers are taken."""

from __future__ import annotations

from fingertip.board.supplies import SUPPLIES
from fingertip.design import Design
from fingertip.sim.electronics.circuit import Analog


def amplified(design: Design, amplifiers: str) -> Analog:
    """The board of a design with ideal amplifiers, with outputs that stop at their rails, or with the design's
    gain-bandwidth product ("ideal", "rails", "gain_bandwidth")."""
    board = Analog.of(design)
    if amplifiers == "rails":
        supply = SUPPLIES[design.board.supply]
        return board.changed(rail_v=supply.swing_v(design.board.supply_v))
    if amplifiers == "gain_bandwidth":
        return board.changed(gain_bandwidth_hz=design.board.gain_bandwidth_hz)
    return board
