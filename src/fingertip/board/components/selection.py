"""Selection of preferred values (IEC 60063): near a computed one, in a range, for the filter.

Nearest means nearest by ratio. Capacitors come from a series, or are only values that are sold.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from fingertip.board.parts.select_part import list_capacitances
from fingertip.design.formulas import filter as formulas
from fingertip.design.formulas.amplifiers import choose_amplifier, select_rectifier_ohm
from fingertip.design.formulas.filter import (
    MANTISSAS,
    MAX_OHM,
    MIN_OHM,
    FilterComponents,
    find_preferred_neighbours,
    r_lp_ohm,
)
from fingertip.design.parameters.board_and_detector import Board
from fingertip.foundation.numerics import Array

SOLD = "preferred"
"""Name of the series of values that are sold."""
USUAL_SERIES = "E6"
"""Series of capacitors that every board selects itself."""
FILTER_PACKAGE = "1206"
SMALL_PACKAGE = "0603"
"""Sizes of the filter's capacitors and of all others of the signal path."""


def neighbouring_values(
    value: float, series: str, minimum: float = MIN_OHM, maximum: float = MAX_OHM
) -> tuple[float, ...]:
    """Find the preferred values next below and above one; itself if preferred, or an end."""
    low, high = find_preferred_neighbours(min(max(value, minimum), maximum), series)
    return (low,) if low == high else (low, high)


def nearest_value(
    value: float, series: str, minimum: float = MIN_OHM, maximum: float = MAX_OHM
) -> float:
    """Find the preferred value nearest to `value` by ratio; of two, the lower."""
    return min(
        neighbouring_values(value, series, minimum, maximum), key=lambda v: abs(math.log(v / value))
    )


def values_around(value: float, series: str) -> tuple[float, ...]:
    """List the preferred resistances from half of `value` to twice `value`."""
    return _list_values(max(value / 2, MIN_OHM), min(2 * value, MAX_OHM), series)


def values_in_range(low: float, high: float, series: str) -> tuple[float, ...]:
    """List the preferred values from `low` to `high`; if none, the one nearest to `low`."""
    return _list_values(low, high, series) or (nearest_value(low, series, 1e-12, 1e-3),)


def _list_values(low: float, high: float, series: str) -> tuple[float, ...]:
    exponents = range(math.floor(math.log10(low)) - 2, math.floor(math.log10(high)) + 1)
    # Read as a decimal number, a value has no rounding error.
    decades = itertools.product(exponents, MANTISSAS[series])
    return _within(low, high, (float(f"{mantissa}e{exponent}") for exponent, mantissa in decades))


def _within(low: float, high: float, values: Iterable[float]) -> tuple[float, ...]:
    # The ends are computed, so rounding must not exclude a value that lies exactly on one of them.
    return tuple(value for value in values if low * (1 - 1e-9) <= value <= high * (1 + 1e-9))


def nearest_capacitance(farad: float, series: str, package: str = SMALL_PACKAGE) -> float:
    """Find the capacitance [F] nearest by ratio, among those sold or in the usual series."""
    if series == SOLD:
        return min(list_capacitances(package), key=lambda c_f: abs(math.log(c_f / farad)))

    return nearest_value(farad, USUAL_SERIES, 1e-12, 1e-3)


def capacitances_in_range(
    low_f: float, high_f: float, series: str, package: str
) -> tuple[float, ...]:
    """List the capacitances [F] of a series in a range; if none, the one nearest to it."""
    if series != SOLD:
        return values_in_range(low_f, high_f, series)

    capacitances = _within(low_f, high_f, list_capacitances(package))
    return capacitances or (nearest_capacitance(math.sqrt(low_f * high_f), series, package),)


# Components of filter and envelope (article, eqs. 2, 8, 10; it writes omega where j omega is meant
# in eqs. 1, 3, 4, 9 and 11). With `board.resistor_choice` "joint", R1, R2 and R3 are chosen
# together, with "apart" each for itself.


@dataclass(frozen=True)
class FirstStageCapacitors:
    """Capacitors that variants other than `article` add to the first stage [F]."""

    series_capacitor_f: float
    """C14 in series with R4: the stage does not amplify the amplifier's offset."""
    limiting_capacitor_f: float
    """C20 across R5: the stage does not amplify frequencies above the vibrations."""
    limit_hz: float
    """Frequency at which C20 has reduced the gain by 3 dB: 1 / (2 pi R5 C20)."""


@dataclass(frozen=True)
class FilterSelection:
    """Components of filter and envelope: by the formulas, and as fitted."""

    ideal: FilterComponents
    preferred: FilterComponents
    capacitors: FirstStageCapacitors | None
    """None in variant article."""
    rectifier_ohm: float | None
    """Both resistors of the precision rectifier, gain -1; None on boards without one."""

    def by_reference(self) -> dict[str, float]:
        """Value of each fitted component [ohm, F] by its reference designator."""
        c = self.preferred
        values = {
            "R1": c.r1_ohm,
            "R2": c.r2_ohm,
            "R3": c.r3_ohm,
            "R4": c.r4_ohm,
            "R5": c.r5_ohm,
            "R6": c.r_lp_ohm,
            "C1": c.c_f,
            "C2": c.c_f,
            "C3": c.c_f,
            "C4": c.c_lp_f,
        }

        if self.capacitors is not None:
            values |= {
                "C14": self.capacitors.series_capacitor_f,
                "C20": self.capacitors.limiting_capacitor_f,
            }
        if self.rectifier_ohm is not None:
            values |= {"R15": self.rectifier_ohm, "R16": self.rectifier_ohm, "R17": c.r_lp_ohm}

        return values


def select_filter(board: Board) -> FilterSelection:
    ideal = formulas.ideal_components(select_capacitors(board))
    preferred = select_resistors(ideal, board.series, jointly=board.resistor_choice == "joint")
    if board.variant == "article":
        return FilterSelection(ideal, preferred, None, None)

    c20_f = nearest_capacitance(
        pole_hz(preferred.r5_ohm, board.band_limit_hz), board.capacitor_series
    )
    # C14 in series with R4 is the smallest whose corner frequency is at least a decade below the
    # cutoff. For the article's 1.5k and 67 Hz this is 16 uF, and 22 uF is the available value. If
    # none is large enough, it is the largest.
    cutoff_hz = pole_hz(preferred.r1_ohm, preferred.c_f)
    min_uf = 1e6 * formulas.MIN_CUTOFF_RATIO / (math.tau * preferred.r4_ohm * cutoff_hz)
    c14_uf = next(
        (c for c in formulas.SERIES_CAPACITORS_UF if c >= min_uf), formulas.SERIES_CAPACITORS_UF[-1]
    )
    capacitors = FirstStageCapacitors(
        formulas.to_farads(c14_uf), c20_f, pole_hz(preferred.r5_ohm, c20_f)
    )
    rectifier_ohm = select_rectifier_ohm(choose_amplifier(board)) if board.has_envelope else None

    return FilterSelection(ideal, preferred, capacitors, rectifier_ohm)


def pole_hz(r_ohm: float, c_f: float) -> float:
    """Return 1 / (2 pi R C): a pole [Hz] for R [ohm] and C [F]; C for R and a frequency [Hz]."""
    return 1.0 / (math.tau * r_ohm * c_f)


def select_resistors(ideal: FilterComponents, series: str, *, jointly: bool) -> FilterComponents:
    """Select preferred resistors for ideal ones; the capacitors keep the values that they have."""
    ohm = ideal.r1_ohm, ideal.r2_ohm, ideal.r3_ohm
    r1_ohm, r2_ohm, r3_ohm = (
        choose_jointly(ohm, series)[0] if jointly else (nearest_value(r, series) for r in ohm)
    )
    r5_ohm = nearest_value(ideal.r5_ohm, series)

    return replace(
        ideal,
        r1_ohm=r1_ohm,
        r2_ohm=r2_ohm,
        r3_ohm=r3_ohm,
        # R5 comes first, then R4 by the ratio R5 / R4 that the gain requires.
        r4_ohm=nearest_value(ideal.r4_ohm * r5_ohm / ideal.r5_ohm, series),
        r5_ohm=r5_ohm,
        r_lp_ohm=nearest_value(ideal.r_lp_ohm, series),
    )


def select_capacitors(board: Board) -> Board:
    """Return the parameters with fitted capacitors: given, or of `board.capacitor_series`."""
    if board.capacitor_series == "given":
        return board

    c_f = select_filter_capacitor(board)
    c_lp_f = _select_envelope_capacitor(board)
    return board.model_copy(
        update={"capacitor_uf": _microfarads(c_f), "envelope_capacitor_uf": _microfarads(c_lp_f)}
    )


def _selectable_range_f(cutoff_hz: float, range_ohm: tuple[float, float]) -> tuple[float, float]:
    """Return the range of C [F] with 1 / (C omega) in a range [ohm] at a cutoff [Hz]."""
    values = (1.0 / (math.tau * cutoff_hz * ohm) for ohm in reversed(range_ohm))
    low_f, high_f = (
        min(max(c_f, formulas.MIN_SELECTABLE_F), formulas.MAX_SELECTABLE_F) for c_f in values
    )
    return low_f, high_f


def select_filter_capacitor(board: Board) -> float:
    """Select C1 = C2 = C3 [F] with the smallest error and R1 in `SELECTABLE_R1_OHM`.

    For each C the resistors are the best that exist. No combination of the two series within that
    range is therefore better. Of equal errors the smaller capacitor is selected.
    """
    range_f = _selectable_range_f(board.cutoff_hz, formulas.SELECTABLE_R1_OHM)
    capacitors = capacitances_in_range(*range_f, board.capacitor_series, FILTER_PACKAGE)
    return min(capacitors, key=lambda c_f: (round(filter_error(c_f, board), 9), c_f))


def filter_error(c_f: float, board: Board) -> float:
    """Return the error of the filter with this C [F] and the best preferred resistors.

    It is the deviation from a Butterworth response where the resistors are chosen together, else
    the hypot of the logarithms of f0, Q and the first pole over their ideal values. With x and y
    the logarithms of R2 and R3 over their ideal values, ln(f0' / f0) = -(x + y) / 2 and ln(Q' / Q)
    = (y - x) / 2. The sum of their squares is (x^2 + y^2) / 2, so each resistor can be selected
    alone.
    """
    ideal = formulas.ideal_components(board.model_copy(update={"capacitor_uf": 1e6 * c_f}))
    ohm = ideal.r1_ohm, ideal.r2_ohm, ideal.r3_ohm
    if board.resistor_choice == "joint":
        return choose_jointly(ohm, board.series)[1]

    first, x, y = (math.log(nearest_value(r, board.series) / r) for r in ohm)
    return math.hypot(first, math.hypot(x, y) / math.sqrt(2.0))


def _select_envelope_capacitor(board: Board) -> float:
    """Select C_LP [F] whose preferred R_LP gives the pole nearest to the envelope's."""
    target_hz = board.envelope_cutoff_hz

    def error(c_f: float) -> float:
        ohm = nearest_value(r_lp_ohm(target_hz, c_f), board.series)
        return abs(math.log(pole_hz(ohm, c_f) / target_hz))

    range_f = _selectable_range_f(target_hz, formulas.SELECTABLE_R_LP_OHM)
    return min(
        capacitances_in_range(*range_f, board.capacitor_series, FILTER_PACKAGE),
        key=lambda c_f: (round(error(c_f), 12), c_f),
    )


def _microfarads(farads: float) -> float:
    """Return a capacitance [uF] without the rounding error of the multiplication."""
    return float(f"{farads * 1e6:.6g}")


# Joint choice of R1, R2 and R3: the preferred values whose response together deviates least from a
# Butterworth one.
#
# With w = f / f_c and x = w^2 the ideal magnitude is x^3 / (1 + x^3), squared. The first stage with
# p = R1 C omega_c has p^2 x / (1 + p^2 x), and the Sallen-Key section with q = 2 R2 C omega_c and r
# = R2 R3 (C omega_c)^2 has r^2 x^2 / ((1 - r x)^2 + q^2 x). The deviation is the largest difference
# of the magnitudes [dB] at any frequency of `DEVIATION_BAND`. Errors of the three values that
# cancel in the product count little, which a choice of each value alone does not see.

DEVIATION_BAND = 0.5, 4.0
"""Band in which the deviation counts [cutoffs]: from -18 dB to beyond the vibrations."""
SEARCH_RATIOS = {"E12": 1.8, "E24": 1.5, "E96": 1.15}
"""Largest ratio of a candidate to its ideal value; a test shows that more finds nothing better."""
_DIGITS = 9
_ROUNDING_DB = 1e-8
"""Decimals of a deviation [dB]; differences below them are rounding."""
_COARSE = 7
_FINE = 6
"""Frequencies of the first comparison, and intervals between two of them in the second."""


@functools.lru_cache(maxsize=256)
def choose_jointly(
    ideal_ohm: tuple[float, float, float], series: str
) -> tuple[tuple[float, float, float], float]:
    """Choose R1, R2 and R3 [ohm] from a series, and return them with their deviation [dB].

    Of equal deviations the smaller resistors are chosen. Every combination is compared at a few
    frequencies of the band. What is worse there than a known combination is in the whole band
    cannot be the best, and is left out.
    """
    ratio = SEARCH_RATIOS[series]
    candidates = [
        _list_values(max(ohm / ratio, MIN_OHM), min(ohm * ratio, MAX_OHM), series)
        or (nearest_value(ohm, series),)
        for ohm in ideal_ohm
    ]
    first, second, third = (
        np.array(values) / ohm for values, ohm in zip(candidates, ideal_ohm, strict=True)
    )
    x = _squared_frequencies()
    coarse = x[::_FINE]
    stage = _stage_db(first, coarse)
    section = _section_db(second[:, None], third[None, :], coarse)
    lower_bound = np.abs(stage[:, None, None, :] + section).max(axis=-1)

    likely = np.unravel_index(lower_bound.argmin(), lower_bound.shape)
    known_db = _deviations_db(
        *(values[[i]] for values, i in zip((first, second, third), likely, strict=True))
    )
    i, j, k = np.nonzero(lower_bound <= known_db + _ROUNDING_DB)
    deviations = np.round(_deviations_db(first[i], second[j], third[k]), _DIGITS)
    best = int(deviations.argmin())  # the first of equal ones has the smallest resistors

    return (candidates[0][i[best]], candidates[1][j[best]], candidates[2][k[best]]), float(
        deviations[best]
    )


def _deviations_db(first: Array, second: Array, third: Array) -> Array:
    """Return the deviations [dB] of combinations of R1, R2 and R3 over their ideal values."""
    x = _squared_frequencies()
    return np.asarray(np.abs(_stage_db(first, x) + _section_db(second, third, x)).max(axis=-1))


@functools.cache
def _squared_frequencies() -> Array:
    """Return the frequencies of the band over the cutoff, squared, evenly spaced by ratio."""
    low, high = DEVIATION_BAND
    return np.asarray(np.geomspace(low * low, high * high, (_COARSE - 1) * _FINE + 1))


def _stage_db(first: Array, x: Array) -> Array:
    """Return the first stage's magnitude over the ideal filter's [dB], for R1 over its ideal."""
    p2x = first[..., None] ** 2 * x
    return np.asarray(10.0 * np.log10(p2x / (1.0 + p2x) * (1.0 + x**3) / x**3))


def _section_db(second: Array, third: Array, x: Array) -> Array:
    """Return the Sallen-Key section's magnitude [dB], for R2 and R3 over their ideal values."""
    q2x = second[..., None] ** 2 * x
    rx = (second * third)[..., None] * x
    return np.asarray(10.0 * np.log10(rx**2 / ((1.0 - rx) ** 2 + q2x)))
