"""Capacitors the board chooses itself: those of a series with which preferred resistors come nearest to the filter."""

from __future__ import annotations

import math

from fingertip.board.values.filters import pole_hz
from fingertip.board.values.preferred import choose_section, nearest, section_error, within
from fingertip.design.filter_components import (
    B2,
    CHOSEN_ENVELOPE_OHM,
    CHOSEN_OHM,
    chosen_range_f,
    r1_ohm,
    r_lp_ohm,
)
from fingertip.design.sections import Board


def fitted(board: Board) -> Board:
    """The board's parameters with the capacitors that are fitted: as given, or chosen from `board.capacitor_series`."""
    if board.capacitor_series == "given":
        return board
    c_f, c_lp_f = choose_capacitor(board), choose_envelope_capacitor(board)
    return board.model_copy(update={"capacitor_uf": _micro(c_f), "envelope_capacitor_uf": _micro(c_lp_f)})


def filter_error(c_f: float, cutoff_hz: float, series: str) -> float:
    """How far the filter misses with this C [F] and the best preferred resistors.

    hypot of the logarithms of f0, Q and the first pole over their ideal values.
    """
    r2_ohm, r3_ohm = choose_section(cutoff_hz, 1.0 / math.sqrt(B2), c_f, series)
    first_hz = pole_hz(nearest(r1_ohm(cutoff_hz, c_f), series), c_f)
    section = section_error(r2_ohm, r3_ohm, c_f, cutoff_hz, 1.0 / math.sqrt(B2))
    return math.hypot(section, math.log(first_hz / cutoff_hz))


def choose_capacitor(board: Board) -> float:
    """C1 = C2 = C3 [F] with the least `filter_error` among those that give R1 within `CHOSEN_OHM`.

    For each C the resistors are the best there are (`choose_section`, and R1 for itself), so no combination of the two
    series within that range comes nearer. Of equals the smaller.
    """
    return min(
        within(*chosen_range_f(board.cutoff_hz, CHOSEN_OHM), board.capacitor_series),
        key=lambda c_f: (round(filter_error(c_f, board.cutoff_hz, board.series), 12), c_f),
    )


def choose_envelope_capacitor(board: Board) -> float:
    """C_LP [F] whose preferred R_LP comes nearest to the envelope's pole, R_LP within `CHOSEN_ENVELOPE_OHM`."""
    wanted_hz = board.envelope_cutoff_hz

    def error(c_f: float) -> float:
        return abs(math.log(pole_hz(nearest(r_lp_ohm(wanted_hz, c_f), board.series), c_f) / wanted_hz))

    return min(
        within(*chosen_range_f(wanted_hz, CHOSEN_ENVELOPE_OHM), board.capacitor_series),
        key=lambda c_f: (round(error(c_f), 12), c_f),
    )


def _micro(farad: float) -> float:
    """[uF] of a preferred value, without the multiplication's last bits."""
    return float(f"{farad * 1e6:.6g}")
