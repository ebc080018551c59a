"""Components of the filter: preferred resistors and, where the design asks for it, capacitors.

The formulas give what the selection needs of each section (article, eqs. 2, 8, 10). The article writes omega where
j omega is meant (eqs. 1, 3, 4, 9, 11). With `board.resistor_choice` "joint", R1, R2 and R3 are chosen together
(`fingertip.board.components.filter`); with "apart" each for itself. For R2 and R3 the values nearest to the ideal
ones are then also the best pair, see `section_error`.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from fingertip.board.components.preferred_values import mantissas, nearest_value, neighbouring_values, values_in_range
from fingertip.board.parts.select_part import list_capacitances
from fingertip.design.formulas.amplifiers import choose_amplifier, select_rectifier_ohm
from fingertip.design.formulas.filter import (
    MAX_OHM,
    MIN_OHM,
    SECTION_QUALITY,
    SELECTABLE_R1_OHM,
    SELECTABLE_R_LP_OHM,
    FilterComponents,
    compute_limiting_capacitor_f,
    ideal_components,
    r1_ohm,
    r_lp_ohm,
    select_series_capacitor_f,
    selectable_range_f,
)
from fingertip.design.parameters import Board

if TYPE_CHECKING:
    from fingertip.foundation.numerics import Array


# Capacitors to choose from: values of a preferred series, or only those that the parts table has.


SOLD = "preferred"
"""Name of the series of values that are sold."""
USUAL_SERIES = "E6"
"""Series of capacitors that every board selects itself."""
FILTER_PACKAGE, SMALL_PACKAGE = "1206", "0603"
"""Sizes of the filter's capacitors and of all others of the signal path."""


def nearest_capacitance(farad: float, series: str, package: str = SMALL_PACKAGE) -> float:
    """Find the capacitance [F] nearest by ratio: of those that are sold, or else of the usual series."""
    if series == SOLD:
        return min(list_capacitances(package), key=lambda f: abs(math.log(f / farad)))
    return nearest_value(farad, USUAL_SERIES, 1e-12, 1e-3)


def capacitances_in_range(low_f: float, high_f: float, series: str, package: str) -> tuple[float, ...]:
    """List the capacitances [F] of a series from `low_f` to `high_f`, or the one nearest to the range if none is."""
    if series != SOLD:
        return values_in_range(low_f, high_f, series)
    sold = list_capacitances(package)
    # The ends are computed, so rounding must not exclude a value that lies exactly on one of them.
    found = tuple(f for f in sold if low_f * (1 - 1e-9) <= f <= high_f * (1 + 1e-9))
    return found or (nearest_capacitance(math.sqrt(low_f * high_f), series, package),)


# Joint choice of R1, R2 and R3: the preferred values whose response together deviates least from a Butterworth one.
#
# With w = f / f_c and x = w^2 the ideal magnitude is x^3 / (1 + x^3), squared. The first stage with p = R1 C omega_c
# has p^2 x / (1 + p^2 x), and the Sallen-Key section with q = 2 R2 C omega_c and r = R2 R3 (C omega_c)^2 has r^2 x^2 /
# ((1 - r x)^2 + q^2 x). The deviation is the largest difference of the magnitudes [dB] at any frequency of
# `DEVIATION_BAND`. Errors of the three values that cancel in the product count little, which a choice of each value
# alone does not see.


DEVIATION_BAND = 0.5, 4.0
"""Band in which the deviation counts [cutoffs]: from 18 dB below the passband to beyond the vibrations."""
SEARCH_RATIOS = {"E12": 1.8, "E24": 1.5, "E96": 1.15}
"""Largest ratio of a candidate to its ideal value by series. A wider search finds nothing better; a test shows it."""
_DIGITS, _ROUNDING_DB = 9, 1e-8
"""Decimals of a deviation [dB]; differences below them are rounding."""
_COARSE, _FINE = 7, 6
"""Number of frequencies at which every combination is compared, and of intervals between two of them for those left."""


@functools.lru_cache(maxsize=256)
def choose_jointly(ideal_ohm: tuple[float, float, float], series: str) -> tuple[tuple[float, float, float], float]:
    """Choose R1, R2 and R3 [ohm] from a series, and return them with their deviation [dB].

    Of equal deviations the smaller resistors are chosen. Every combination is compared at a few frequencies of the
    band. What is worse there than a known combination is in the whole band cannot be the best, and is left out.
    """
    import numpy as np

    candidates = [_list_candidates(ohm, series) for ohm in ideal_ohm]
    first, second, third = (np.array(values) / ohm for values, ohm in zip(candidates, ideal_ohm, strict=True))
    x = _squared_frequencies()
    coarse = x[::_FINE]
    stage, section = _stage_db(first, coarse), _section_db(second[:, None], third[None, :], coarse)
    lower_bound = np.abs(stage[:, None, None, :] + section).max(axis=-1)

    likely = np.unravel_index(lower_bound.argmin(), lower_bound.shape)
    known_db = _deviations_db(*(values[[i]] for values, i in zip((first, second, third), likely, strict=True)))
    i, j, k = np.nonzero(lower_bound <= known_db + _ROUNDING_DB)
    deviations = np.round(_deviations_db(first[i], second[j], third[k]), _DIGITS)
    best = int(deviations.argmin())  # the first of equal ones has the smallest resistors
    return (candidates[0][i[best]], candidates[1][j[best]], candidates[2][k[best]]), float(deviations[best])


def compute_deviation_db(ohm: tuple[float, float, float], ideal_ohm: tuple[float, float, float]) -> float:
    """Compute the largest deviation of R1, R2 and R3 [ohm] from the Butterworth response of the ideal ones [dB]."""
    import numpy as np

    ratios = (np.array([value / ideal]) for value, ideal in zip(ohm, ideal_ohm, strict=True))
    return float(_deviations_db(*ratios)[0])


def _deviations_db(first: Array, second: Array, third: Array) -> Array:
    """Deviations [dB] of combinations of R1, R2 and R3 over their ideal values."""
    import numpy as np

    x = _squared_frequencies()
    return np.asarray(np.abs(_stage_db(first, x) + _section_db(second, third, x)).max(axis=-1))


def _list_candidates(ideal_ohm: float, series: str) -> list[float]:
    """List the preferred values around an ideal one within the search ratio, or the nearest if there is none."""
    decade, ratio = mantissas(series), SEARCH_RATIOS[series]
    low, high = max(ideal_ohm / ratio, MIN_OHM), min(ideal_ohm * ratio, MAX_OHM)
    digits = len(str(decade[0])) - 1
    exponents = range(math.floor(math.log10(low)) - digits, math.floor(math.log10(high)) - digits + 1)
    # Division by a power of ten rounds correctly; multiplication by a negative one would not.
    values = (m * 10.0**e if e >= 0 else m / 10.0**-e for e in exponents for m in decade)
    found = [value for value in values if low * (1 - 1e-9) <= value <= high * (1 + 1e-9)]
    return found or [nearest_value(ideal_ohm, series)]


@functools.cache
def _squared_frequencies() -> Array:
    """Frequencies of the band over the cutoff, squared, evenly spaced by ratio."""
    import numpy as np

    low, high = DEVIATION_BAND
    return np.asarray(np.geomspace(low * low, high * high, (_COARSE - 1) * _FINE + 1))


def _stage_db(first: Array, x: Array) -> Array:
    """Magnitude of the first stage over that of the ideal filter [dB], for R1 over its ideal value."""
    import numpy as np

    p2x = first[..., None] ** 2 * x
    return np.asarray(10.0 * np.log10(p2x / (1.0 + p2x) * (1.0 + x**3) / x**3))


def _section_db(second: Array, third: Array, x: Array) -> Array:
    """Magnitude of the Sallen-Key section [dB], for R2 and R3 over their ideal values."""
    import numpy as np

    q2x, rx = second[..., None] ** 2 * x, (second * third)[..., None] * x
    return np.asarray(10.0 * np.log10(rx**2 / ((1.0 - rx) ** 2 + q2x)))


def pole_hz(r_ohm: float, c_f: float) -> float:
    """1 / (2 pi R C) [Hz] for R [ohm] and C [F]: pole of the first stage, and of the envelope (below eq. 11)."""
    return 1.0 / (math.tau * r_ohm * c_f)


def section_frequency_hz(r2_ohm: float, r3_ohm: float, c_f: float) -> float:
    """f0 = 1 / (2 pi C sqrt(R2 R3)) [Hz] of the Sallen-Key section.

    Eq. (10) prints 1 / sqrt(R2 R3 C), with C inside the root, which is not a frequency.
    """
    return 1.0 / (math.tau * c_f * math.sqrt(r2_ohm) * math.sqrt(r3_ohm))


def section_quality(r2_ohm: float, r3_ohm: float) -> float:
    """Q = sqrt(R3 / (4 R2)) of the Sallen-Key section with equal capacitors, eq. (8)."""
    return math.sqrt(r3_ohm / (4.0 * r2_ohm))


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


def select_filter_resistors(ideal: FilterComponents, series: str, *, jointly: bool) -> tuple[float, float, float]:
    """Select preferred R1, R2 and R3 [ohm] for ideal ones, together or apart. Raises as `neighbouring_values` does."""
    ohm = (ideal.r1_ohm, ideal.r2_ohm, ideal.r3_ohm)
    if jointly:
        return choose_jointly(ohm, series)[0]
    r2_ohm, r3_ohm = select_section_resistors(
        section_frequency_hz(ideal.r2_ohm, ideal.r3_ohm, ideal.c_f),
        section_quality(ideal.r2_ohm, ideal.r3_ohm),
        ideal.c_f,
        series,
    )
    return nearest_value(ideal.r1_ohm, series), r2_ohm, r3_ohm


def select_resistors(ideal: FilterComponents, series: str, *, jointly: bool) -> FilterComponents:
    """Select preferred resistors for ideal ones; the capacitors keep the values that they have.

    R5 is selected first, then R4 by the ratio R5 / R4 that the gain requires. Raises as `neighbouring_values` does.
    """
    nearest: Callable[[float], float] = lambda ohm: nearest_value(ohm, series)  # noqa: E731
    r1_ohm, r2_ohm, r3_ohm = select_filter_resistors(ideal, series, jointly=jointly)
    r5_ohm = nearest(ideal.r5_ohm)
    return replace(
        ideal,
        r1_ohm=r1_ohm,
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
    r2_ohm, r3_ohm = select_section_resistors(cutoff_hz, SECTION_QUALITY, c_f, series)
    first_hz = pole_hz(nearest_value(r1_ohm(cutoff_hz, c_f), series), c_f)
    section = section_error(r2_ohm, r3_ohm, c_f, cutoff_hz, SECTION_QUALITY)
    return math.hypot(section, math.log(first_hz / cutoff_hz))


def select_filter_capacitor(board: Board) -> float:
    """Select C1 = C2 = C3 [F] with the smallest error among those that give R1 within `SELECTABLE_R1_OHM`.

    The error is the deviation from a Butterworth response where the resistors are chosen together, else
    `filter_error`. For each C the resistors are the best that exist. No combination of the two series within that range
    is therefore better. Of equal errors the smaller capacitor is selected.
    """

    def error(c_f: float) -> float:
        if board.resistor_choice == "apart":
            return filter_error(c_f, board.cutoff_hz, board.series)
        ideal = ideal_components(board.model_copy(update={"capacitor_uf": 1e6 * c_f}))
        return choose_jointly((ideal.r1_ohm, ideal.r2_ohm, ideal.r3_ohm), board.series)[1]

    range_f = selectable_range_f(board.cutoff_hz, SELECTABLE_R1_OHM)
    capacitors = capacitances_in_range(*range_f, board.capacitor_series, FILTER_PACKAGE)
    return min(capacitors, key=lambda c_f: (round(error(c_f), 9), c_f))


def select_envelope_capacitor(board: Board) -> float:
    """Select C_LP [F] whose preferred R_LP gives the pole nearest to the envelope's, R_LP in `SELECTABLE_R_LP_OHM`."""
    target_hz = board.envelope_cutoff_hz

    def error(c_f: float) -> float:
        return abs(math.log(pole_hz(nearest_value(r_lp_ohm(target_hz, c_f), board.series), c_f) / target_hz))

    range_f = selectable_range_f(target_hz, SELECTABLE_R_LP_OHM)
    return min(
        capacitances_in_range(*range_f, board.capacitor_series, FILTER_PACKAGE),
        key=lambda c_f: (round(error(c_f), 12), c_f),
    )


def _microfarads(farads: float) -> float:
    """Preferred capacitance [uF], without the rounding error of the multiplication."""
    return float(f"{farads * 1e6:.6g}")


@dataclass(frozen=True)
class FirstStageCapacitors:
    """Capacitors that variants other than `article` add to the first stage [F]."""

    series_capacitor_f: float
    """C14 in series with R4: the stage does not amplify the amplifier's offset."""
    limiting_capacitor_f: float
    """C20 across R5: the stage does not amplify frequencies above the vibrations."""
    limit_hz: float
    """Frequency at which C20 has reduced the gain by 3 dB: 1 / (2 pi R5 C20)."""


def select_first_stage_capacitors(
    components: FilterComponents, band_limit_hz: float, capacitor_series: str = "given"
) -> FirstStageCapacitors:
    """Select preferred capacitors of the first stage for preferred resistors and a band limit [Hz]."""
    c20_f = nearest_capacitance(compute_limiting_capacitor_f(components.r5_ohm, band_limit_hz), capacitor_series)
    c14_f = select_series_capacitor_f(components.r4_ohm, pole_hz(components.r1_ohm, components.c_f))
    return FirstStageCapacitors(c14_f, c20_f, pole_hz(components.r5_ohm, c20_f))


@dataclass(frozen=True)
class FilterSelection:
    """Components of filter and envelope: by the formulas, and as fitted."""

    ideal: FilterComponents
    preferred: FilterComponents
    capacitors: FirstStageCapacitors | None
    """None in variant article."""
    rectifier_ohm: float | None
    """Both resistors of the precision rectifier, gain -1; None in variant article."""

    def by_reference(self) -> dict[str, float]:
        """Value of each fitted component [ohm, F] by its reference designator."""
        c = self.preferred
        values = {
            "R1": c.r1_ohm, "R2": c.r2_ohm, "R3": c.r3_ohm, "R4": c.r4_ohm, "R5": c.r5_ohm, "R6": c.r_lp_ohm,
            "C1": c.c_f, "C2": c.c_f, "C3": c.c_f, "C4": c.c_lp_f,
        }  # fmt: skip
        if self.capacitors is not None and self.rectifier_ohm is not None:
            values |= {"C14": self.capacitors.series_capacitor_f, "C20": self.capacitors.limiting_capacitor_f}
            values |= {"R15": self.rectifier_ohm, "R16": self.rectifier_ohm, "R17": c.r_lp_ohm}
        return values


def select_filter(board: Board) -> FilterSelection:
    """Select the components of filter and envelope. Raises as `neighbouring_values` does."""
    ideal = ideal_components(select_capacitors(board))
    preferred = select_resistors(ideal, board.series, jointly=board.resistor_choice == "joint")
    if board.variant == "article":
        return FilterSelection(ideal, preferred, None, None)
    capacitors = select_first_stage_capacitors(preferred, board.band_limit_hz, board.capacitor_series)
    return FilterSelection(ideal, preferred, capacitors, select_rectifier_ohm(choose_amplifier(board)))
