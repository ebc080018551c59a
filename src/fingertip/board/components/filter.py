"""Components of the filter: preferred resistors and, where the design asks for it, capacitors.

The formulas give what the selection needs of each section (article, eqs. 2, 8, 10). The article writes omega where
j omega is meant (eqs. 1, 3, 4, 9, 11). With `board.resistor_choice` "joint", R1, R2 and R3 are chosen together
(`fingertip.board.components.joint_choice`); with "apart" each for itself. For R2 and R3 the values nearest to the ideal
ones are then also the best pair, see `section_error`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from fingertip.board.components.capacitor_choice import FILTER_PACKAGE, capacitances_in_range, nearest_capacitance
from fingertip.board.components.joint_choice import choose_jointly
from fingertip.board.components.preferred_values import nearest_value, neighbouring_values
from fingertip.design.amplifier_choice import choose_amplifier
from fingertip.design.amplifier_stages import select_rectifier_ohm
from fingertip.design.filter_components import (
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
