"""Choice of the board's dual amplifier, and what the choice must withstand."""

from __future__ import annotations

from fingertip.amplifiers import (
    ARTICLE_AMPLIFIER,
    AUTO,
    CATALOGUE,
    LOW_OFFSET_AMPLIFIER,
    LOW_VOLTAGE_AMPLIFIER,
    RAIL_TO_RAIL_AMPLIFIER,
    Amplifier,
)
from fingertip.design.parameters import Board


def total_supply_v(board: Board) -> float:
    """Voltage between both rails of the amplifiers [V]."""
    return 2.0 * board.supply_v if board.supply == "split" else board.supply_v


def works_on_supply(amplifier: Amplifier, board: Board) -> bool:
    """Return whether a board's supply lies within the range of an amplifier."""
    return amplifier.min_supply_v <= total_supply_v(board) <= amplifier.max_supply_v


def choose_amplifier(board: Board) -> Amplifier:
    """Return the dual amplifier of a board: the one it names, or for "auto" the one that fits variant and supply.

    The article's own board has the article's amplifier. Variant comparator has a threshold of some millivolts in
    hardware, and five offsets add up in its envelope, so it has an amplifier of low offset.
    """
    return CATALOGUE[choose_automatically(board) if board.amplifier == AUTO else board.amplifier]


def choose_automatically(board: Board) -> str:
    """Return the name of the amplifier that "auto" stands for."""
    if (board.variant, board.supply) == ("article", "split"):
        return ARTICLE_AMPLIFIER
    if board.variant == "comparator":
        return choose_low_offset_amplifier(board).name
    return RAIL_TO_RAIL_AMPLIFIER


def choose_low_offset_amplifier(board: Board) -> Amplifier:
    """Return the amplifier of low offset that works on a board's supply."""
    preferred = CATALOGUE[LOW_OFFSET_AMPLIFIER]
    return preferred if works_on_supply(preferred, board) else CATALOGUE[LOW_VOLTAGE_AMPLIFIER]


def find_gain_bandwidth_hz(board: Board) -> float:
    """Return the gain-bandwidth product of the board's dual amplifier [Hz]."""
    return choose_amplifier(board).bandwidth_hz
