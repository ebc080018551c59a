"""Selection of the filter's preferred resistors and, where the design asks for it, of its capacitors.

For R2 and R3 the values nearest to the ideal ones are also the best pair, see `section_error`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

from fingertip.board.values.ideal_response import pole_hz, section_frequency_hz, section_quality
from fingertip.board.values.preferred_values import nearest_value, neighbouring_values, values_in_range
from fingertip.design.filter_components import (
    B2,
    SELECTABLE_R1_OHM,
    SELECTABLE_R_LP_OHM,
    FilterComponents,
    r1_ohm,
    r_lp_ohm,
    selectable_range_f,
)
from fingertip.design.parameters import Board


def section_error(r2_ohm: float, r3_ohm: float, c_f: float, section_hz: float, quality: float) -> float:
    """Error of a Sallen-Key section's f0' and Q' against f0 and Q: hypot(ln(f0' / f0), ln(Q' / Q)).

    The two terms have equal weight because at f0 each shifts the section's magnitude by as much as itself, to first
    order. With x and y the logarithms of R2 and R3 over their ideal values, ln(f0' / f0) = -(x + y) / 2 and
    ln(Q' / Q) = (y - x) / 2. The squared error is therefore (x^2 + y^2) / 2, and each resistor can be selected alone.
    """
    return math.hypot(
        math.log(section_frequency_hz(r2_ohm, r3_ohm, c_f) / section_hz),
        math.log(section_quality(r2_ohm, r3_ohm) / quality),
    )


def select_section_resistors(section_hz: float, quality: float, c_f: float, series: str) -> tuple[float, float]:
    """Select the preferred R2 and R3 [ohm] with the smallest `section_error` of all pairs of the series.

    Four pairs are compared: the neighbours of the ideal R2 = 1 / (2 Q omega_0 C) and R3 = 2 Q / (omega_0 C). By the
    identity given at `section_error` no other pair can be better.
    """
    r2 = 1.0 / (2.0 * quality * math.tau * section_hz * c_f)
    r3 = 2.0 * quality / (math.tau * section_hz * c_f)
    pairs = itertools.product(neighbouring_values(r2, series), neighbouring_values(r3, series))
    return min(pairs, key=lambda pair: section_error(pair[0], pair[1], c_f, section_hz, quality))


def select_resistors(ideal: FilterComponents, series: str) -> FilterComponents:
    """Select preferred resistors for ideal ones; the capacitors keep the values that they have.

    R5 is selected first, then R4 by the ratio R5 / R4 that the gain requires. Raises as `neighbouring_values` does.
    """
    nearest: Callable[[float], float] = lambda ohm: nearest_value(ohm, series)  # noqa: E731
    r2_ohm, r3_ohm = select_section_resistors(
        section_frequency_hz(ideal.r2_ohm, ideal.r3_ohm, ideal.c_f),
        section_quality(ideal.r2_ohm, ideal.r3_ohm),
        ideal.c_f,
        series,
    )
    r5_ohm = nearest(ideal.r5_ohm)
    return replace(
        ideal,
        r1_ohm=nearest(ideal.r1_ohm),
        r2_ohm=r2_ohm,
        r3_ohm=r3_ohm,
        r4_ohm=nearest(ideal.r4_ohm * r5_ohm / ideal.r5_ohm),
        r5_ohm=r5_ohm,
        r_lp_ohm=nearest(ideal.r_lp_ohm),
    )


def select_capacitors(board: Board) -> Board:
    """Return the parameters with the fitted capacitors: as given, or selected from `board.capacitor_series`."""
    if board.capacitor_series == "given":
        return board
    c_f, c_lp_f = select_filter_capacitor(board), select_envelope_capacitor(board)
    return board.model_copy(update={"capacitor_uf": _microfarads(c_f), "envelope_capacitor_uf": _microfarads(c_lp_f)})


def filter_error(c_f: float, cutoff_hz: float, series: str) -> float:
    """Error of the filter with this C [F] and the best preferred resistors.

    It is the hypot of the logarithms of f0, Q and the first pole over their ideal values.
    """
    r2_ohm, r3_ohm = select_section_resistors(cutoff_hz, 1.0 / math.sqrt(B2), c_f, series)
    first_hz = pole_hz(nearest_value(r1_ohm(cutoff_hz, c_f), series), c_f)
    section = section_error(r2_ohm, r3_ohm, c_f, cutoff_hz, 1.0 / math.sqrt(B2))
    return math.hypot(section, math.log(first_hz / cutoff_hz))


def select_filter_capacitor(board: Board) -> float:
    """Select C1 = C2 = C3 [F] with the smallest `filter_error` among those that give R1 within `SELECTABLE_R1_OHM`.

    For each C the resistors are the best that exist (`select_section_resistors`, and the nearest R1). No combination of
    the two series within that range is therefore better. Of equal errors the smaller capacitor is selected.
    """
    return min(
        values_in_range(*selectable_range_f(board.cutoff_hz, SELECTABLE_R1_OHM), board.capacitor_series),
        key=lambda c_f: (round(filter_error(c_f, board.cutoff_hz, board.series), 12), c_f),
    )


def select_envelope_capacitor(board: Board) -> float:
    """Select C_LP [F] whose preferred R_LP gives the pole nearest to the envelope's, R_LP in `SELECTABLE_R_LP_OHM`."""
    target_hz = board.envelope_cutoff_hz

    def error(c_f: float) -> float:
        return abs(math.log(pole_hz(nearest_value(r_lp_ohm(target_hz, c_f), board.series), c_f) / target_hz))

    return min(
        values_in_range(*selectable_range_f(target_hz, SELECTABLE_R_LP_OHM), board.capacitor_series),
        key=lambda c_f: (round(error(c_f), 12), c_f),
    )


def _microfarads(farads: float) -> float:
    """Preferred capacitance [uF], without the rounding error of the multiplication."""
    return float(f"{farads * 1e6:.6g}")
