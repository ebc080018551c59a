"""Rules between the board's parameters: resistors that can be bought, an amplifier fast enough."""

from __future__ import annotations

import math

from fingertip.design import filter_components
from fingertip.design.comparator_parts import (
    MAX_BIAS_A,
    MAX_COMPARATOR_V,
    MAX_MEAN_F,
    MIN_COMPARATOR_V,
    longest_window_s,
)
from fingertip.design.filter_components import MAX_FOOTPRINT_F, MAX_OHM, MIN_OHM, SERIES_DECADE, farad
from fingertip.design.parameters import Board, DesignTables
from fingertip.design.rules.ruleset import Ruleset, rounded_down, rounded_up

RULES = Ruleset()

BANDWIDTH_MARGIN = 10.0
"""Least closed-loop bandwidth GBW / G in cutoffs: the amplifier then costs 0.5% of the gain at the cutoff."""


BAND_CUTOFFS = 3.0
"""The band that is kept, in cutoffs: the embedded finger's slip ends at 1.5, the bare sensor's goes to about 3."""


@RULES.rule("board.capacitor_uf", "board.capacitor_series", "board.cutoff_hz")
def _filter_capacitor_fits_its_place(d: DesignTables) -> str | None:
    return _fits("capacitor_uf", "C1 to C3", d)


@RULES.rule("board.envelope_capacitor_uf", "board.capacitor_series", "board.envelope_cutoff_hz")
def _envelope_capacitor_fits_its_place(d: DesignTables) -> str | None:
    return _fits("envelope_capacitor_uf", "C4", d)


@RULES.rule("board.capacitor_uf", "board.cutoff_hz", "board.capacitor_series")
def _filter_resistors_in_range(d: DesignTables) -> str | None:
    if d.board.capacitor_series != "given":
        return None
    c_f, f_c = farad(d.board.capacitor_uf), d.board.cutoff_hz
    # R2 is the smallest of the three and R3 the largest.
    smallest, largest = filter_components.r2_ohm(f_c, c_f), filter_components.r3_ohm(f_c, c_f)
    return _capacitor_in_range("capacitor_uf", "cutoff_hz", ("R2", smallest), ("R3", largest), d)


@RULES.rule("board.envelope_capacitor_uf", "board.envelope_cutoff_hz", "board.capacitor_series")
def _envelope_resistor_in_range(d: DesignTables) -> str | None:
    if d.board.capacitor_series != "given":
        return None
    c_f, f_lp = farad(d.board.envelope_capacitor_uf), d.board.envelope_cutoff_hz
    r_lp = ("R_LP", filter_components.r_lp_ohm(f_lp, c_f))
    return _capacitor_in_range("envelope_capacitor_uf", "envelope_cutoff_hz", r_lp, r_lp, d)


@RULES.rule("board.cutoff_hz", "board.capacitor_series")
def _chosen_capacitor_exists(d: DesignTables) -> str | None:
    # R3 = 2 / (C omega) is the largest of the three.
    return _chosen("R3", 2.0, d.board.cutoff_hz, d)


@RULES.rule("board.envelope_cutoff_hz", "board.capacitor_series")
def _chosen_envelope_capacitor_exists(d: DesignTables) -> str | None:
    return _chosen("R_LP", 1.0, d.board.envelope_cutoff_hz, d)


@RULES.rule("board.passband_gain", "board.r5_ohm")
def _gain_resistor_in_range(d: DesignTables) -> str | None:
    R5 = d.board.r5_ohm
    R4 = filter_components.r4_ohm(d.board.passband_gain, R5)
    if MIN_OHM <= R4 <= MAX_OHM:
        return None
    # R4 = R5 / (G - 1) at its bound.
    if R4 < MIN_OHM:
        remedy = f"at most {rounded_down(1 + R5 / MIN_OHM)} with this r5_ohm"
    else:
        remedy = f"at least {rounded_up(1 + R5 / MAX_OHM)} with this r5_ohm"
    asked = f"{d.board.passband_gain:.10g} with R5 of {R5:g} ohm asks for R4 of {R4:.4g} ohm"
    return f"{asked}, {_outside(R4)}; {remedy}."


@RULES.rule("board.gain_bandwidth_hz", "board.passband_gain", "board.cutoff_hz")
def _amplifier_fast_enough(d: DesignTables) -> str | None:
    GBW, G, f_c = d.board.gain_bandwidth_hz, d.board.passband_gain, d.board.cutoff_hz
    minimum = BANDWIDTH_MARGIN * G * f_c
    if minimum <= GBW:
        return None
    return (
        f"{GBW:g} Hz leaves {GBW / G:.4g} Hz at a gain of {G:.6g}, less than {BANDWIDTH_MARGIN:g} cutoffs of "
        f"{f_c:g} Hz; at least {rounded_up(minimum)} Hz, or lower board.passband_gain."
    )


@RULES.rule("board.r5_ohm", "board.variant", "board.passband_gain", "board.cutoff_hz")
def _series_capacitor_exists(d: DesignTables) -> str | None:
    if d.board.variant == "article":
        return None
    R4, f_c = filter_components.r4_ohm(d.board.passband_gain, d.board.r5_ohm), d.board.cutoff_hz
    max_uf = filter_components.SERIES_CAPACITORS_UF[-1]
    min_r4 = SERIES_DECADE / (math.tau * farad(max_uf) * f_c)
    if min_r4 <= R4:
        return None
    minimum = min_r4 * (d.board.passband_gain - 1.0)
    return (
        f"{d.board.r5_ohm:g} ohm at a gain of {d.board.passband_gain:.6g} asks for R4 of {R4:.4g} ohm, whose series "
        f"capacitor would be above {max_uf:g} uF; at least {rounded_up(minimum)} ohm, or board.variant=article."
    )


@RULES.rule("board.band_limit_hz", "board.variant", "board.cutoff_hz")
def _band_limit_above_the_band(d: DesignTables) -> str | None:
    minimum = BAND_CUTOFFS * d.board.cutoff_hz
    if d.board.variant == "article" or d.board.band_limit_hz >= minimum:
        return None
    return (
        f"{d.board.band_limit_hz:g} Hz would cut into the vibrations, {BAND_CUTOFFS:g} cutoffs of "
        f"{d.board.cutoff_hz:g} Hz; at least {rounded_up(minimum)} Hz, or board.variant=article, which has none."
    )


@RULES.rule("board.band_limit_hz", "board.variant", "board.r5_ohm")
def _band_limits_capacitor_exists(d: DesignTables) -> str | None:
    R5, f = d.board.r5_ohm, d.board.band_limit_hz
    c_f = filter_components.limit_capacitor_f(R5, f)
    minimum, maximum = filter_components.MIN_LIMIT_F, filter_components.MAX_LIMIT_F
    if d.board.variant == "article" or minimum <= c_f <= maximum:
        return None
    asked = f"{f:g} Hz with R5 of {R5:g} ohm asks for {c_f * 1e12:.4g} pF across it"
    if c_f < minimum:
        return f"{asked}, below {minimum * 1e12:g} pF; at most {rounded_down(f * c_f / minimum)} Hz with this r5_ohm."
    return f"{asked}, above {maximum * 1e12:g} pF; at least {rounded_up(f * c_f / maximum)} Hz with this r5_ohm."


@RULES.rule("board.supply_v", "board.variant")
def _comparator_stands_the_supply(d: DesignTables) -> str | None:
    if d.board.variant != "comparator" or d.board.supply_v <= MAX_COMPARATOR_V:
        return None
    return f"{d.board.supply_v:g} V is too much for variant comparator's LMV331; at most {MAX_COMPARATOR_V:g} V."


@RULES.rule("detector.threshold_v", "board.variant", "board.supply_v", "board.supply")
def _threshold_can_be_trimmed(d: DesignTables) -> str | None:
    maximum = reach_v(d.board) / 4.0
    if d.board.variant != "comparator" or MIN_COMPARATOR_V <= d.detector.threshold_v <= maximum:
        return None
    return (
        f"{d.detector.threshold_v:g} V lies outside what variant comparator's trimmer is made for; "
        f"{MIN_COMPARATOR_V:g} to {rounded_down(maximum)} V with this supply."
    )


@RULES.rule("detector.window_samples", "board.variant", "detector.sample_rate_hz", "detector.threshold_v")
def _mean_bears_the_comparators_current(d: DesignTables) -> str | None:
    n, rate, threshold = d.detector.window_samples, d.detector.sample_rate_hz, d.detector.threshold_v
    if d.board.variant != "comparator" or threshold < MIN_COMPARATOR_V:
        return None
    maximum = math.floor(longest_window_s(threshold) * rate)
    if n <= maximum:
        return None
    mean_ohm = n / rate / 2.0 / MAX_MEAN_F
    return (
        f"{n} samples at {rate:g} Hz ask variant comparator for a mean of {mean_ohm:.4g} ohm, in which its LMV331's "
        f"{1e9 * MAX_BIAS_A:g} nA (at most) make {1e3 * mean_ohm * MAX_BIAS_A:.3g} mV, above half of the threshold "
        f"of {1e3 * threshold:g} mV; at most {maximum} samples, or a higher detector.threshold_v."
    )


def reach_v(board: Board) -> float:
    """How far above their rest the supply lets signals go [V]: all of it, or half where they rest at its middle."""
    return board.supply_v if board.supply == "split" else board.supply_v / 2.0


def _chosen(name: str, factor: float, cutoff_hz: float, d: DesignTables) -> str | None:
    """The issue of a cutoff for which no capacitor is chosen, its resistor being factor / (C omega)."""
    rcf = factor / math.tau
    min_hz = rcf / filter_components.MAX_CHOSEN_F / MAX_OHM
    if d.board.capacitor_series == "given" or cutoff_hz >= min_hz:
        return None
    return (
        f"{cutoff_hz:g} Hz asks for {name} above {MAX_OHM / 1e6:g} Mohm with the largest capacitor that is chosen, "
        f"{filter_components.MAX_CHOSEN_F * 1e6:g} uF; at least {rounded_up(min_hz)} Hz, "
        "or board.capacitor_series=given."
    )


def _fits(capacitor: str, names: str, d: DesignTables) -> str | None:
    """The issue of a capacitor that cannot be bought in the size of its place."""
    value, max_uf = getattr(d.board, capacitor), 1e6 * MAX_FOOTPRINT_F
    if d.board.capacitor_series != "given" or value <= max_uf:
        return None
    return (
        f"{value:g} uF is more than the place of {names} holds (1206, X7R for 16 V); at most {max_uf:g} uF, or "
        "board.capacitor_series=E6, which chooses one."
    )


def _capacitor_in_range(
    capacitor: str, cutoff: str, smallest: tuple[str, float], largest: tuple[str, float], d: DesignTables
) -> str | None:
    """The issue of a capacitor whose resistors, proportional to 1 / (C f), leave the range."""
    too_small = smallest[1] < MIN_OHM
    name, ohm = smallest if too_small else largest
    if MIN_OHM <= ohm <= MAX_OHM:
        return None
    value, f = getattr(d.board, capacitor), getattr(d.board, cutoff)
    # R C f is the same for every C and f, so each bound on R is a bound on C at this f.
    rcf = ohm * value * f if math.isfinite(ohm) else 0.0
    bound = rcf / f / (MIN_OHM if too_small else MAX_OHM)
    info = Board.model_fields[capacitor]
    minimum, maximum = (next(getattr(m, kind) for m in info.metadata if hasattr(m, kind)) for kind in ("ge", "le"))
    if minimum <= bound <= min(maximum, 1e6 * MAX_FOOTPRINT_F):
        limit = f"at most {rounded_down(bound)}" if too_small else f"at least {rounded_up(bound)}"
        remedy = f"{limit} uF at this cutoff"
    else:
        remedy = f"no capacitor passes there: {'lower' if too_small else 'raise'} board.{cutoff}"
    return f"{value:g} uF at {f:g} Hz asks for {name} of {ohm:.4g} ohm, {_outside(ohm)}; {remedy}."


def _outside(ohm: float) -> str:
    return f"below {MIN_OHM:g} ohm" if ohm < MIN_OHM else f"above {MAX_OHM / 1e6:g} Mohm"
