"""Signal ground of a board on a single supply: the divider that sets it, and the headroom on both sides.

The filter's signals swing around the signal ground, and the bridge stands on it. On 5 V it lies in the middle. On 3.3 V
it lies somewhat lower: the inputs of the bridge's amplifier (AD623), a few tenths of a volt above it, must stay 1.5 V
below the supply (its data sheet, input voltage range; recalled, unverified).
"""

from __future__ import annotations

from fingertip.design.parameters import Board

DIVIDERS_OHM = {"split": None, "single": (10e3, 10e3), "single_3v3": (54.9e3, 44.2e3)}
"""Upper and lower resistor of the divider [ohm], by the supply's name.

With its capacitor the divider filters the supply's ripple above 3 Hz, or above 0.7 Hz as that of the bridge's supply
does: both then follow the supply alike, and their ratio stays.
"""

CONTROLLER_SUPPLIES = frozenset({"single_3v3"})
"""Supplies of boards for a controller, which give it their filtered signal beside the tactile voltage."""


def signal_ground_ratio(supply: str) -> float:
    """Voltage of the signal ground above ground as a ratio of the supply voltage: 0 on a split supply."""
    divider = DIVIDERS_OHM[supply]
    return divider[1] / (divider[0] + divider[1]) if divider else 0.0


def upper_headroom_v(board: Board) -> float:
    """Voltage from the signal ground to the upper rail [V]."""
    return board.supply_v * (1.0 - signal_ground_ratio(board.supply))


def smaller_headroom_v(board: Board) -> float:
    """Voltage from the signal ground to the nearer rail [V]."""
    ratio = signal_ground_ratio(board.supply)
    return board.supply_v * min(ratio, 1.0 - ratio) if ratio else board.supply_v


def filtered_range_v(board: Board, adc_range_v: float) -> float | None:
    """Largest deviation of the filtered signal from its rest that board and converter pass [V].

    Parameters
    ----------
    board
        Parameters of the board.
    adc_range_v
        Upper end of the converter's input range [V].

    Returns
    -------
    float | None
        None if the board does not give the filtered signal to a controller.
    """
    if board.supply not in CONTROLLER_SUPPLIES:
        return None
    rest_v = signal_ground_ratio(board.supply) * board.supply_v
    return min(rest_v, min(board.supply_v, adc_range_v) - rest_v)
