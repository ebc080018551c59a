"""Rules of the board and its signals: its components can be bought, and its signals sampled."""

from __future__ import annotations

import math

from fingertip.design.formulas import filter as formulas
from fingertip.design.formulas.amplifiers import BAND_CUTOFFS
from fingertip.design.geometry import DesignTables
from fingertip.design.rules.ruleset import Interval, Limit, Ruleset, Violation, at_least, at_most

CHANNEL_RULES = Ruleset()
RULES = Ruleset(when=lambda design: design.board.has_filter)

PREFERRED_SHARE = 0.1
"""Share of a limit that the rules keep free: preferred values differ from the ideal ones."""


@CHANNEL_RULES.rule("board.channels")
def several_channels_have_a_board(design: DesignTables) -> Violation | None:
    board = design.board
    if board.channels == 1 or board.variant == "precision":
        return None

    return Violation(
        f"{board.channels} fingers are more than one, which is what a board of variant "
        f"{board.variant} reads",
        at_most(1),
        alternatives={"board.variant": "precision"},
    )


@RULES.rule("board.capacitor_uf", when=lambda design: design.board.capacitor_series == "given")
def filter_capacitor_fits_its_footprint(design: DesignTables) -> Violation | None:
    return _check_footprint("capacitor_uf", "C1 to C3", design)


@RULES.rule(
    "board.envelope_capacitor_uf", when=lambda design: design.board.capacitor_series == "given"
)
def envelope_capacitor_fits_its_footprint(design: DesignTables) -> Violation | None:
    return _check_footprint("envelope_capacitor_uf", "C4", design)


@RULES.rule("board.capacitor_uf", when=lambda design: design.board.capacitor_series == "given")
def filter_resistors_in_range(design: DesignTables) -> Violation | None:
    c_f = formulas.to_farads(design.board.capacitor_uf)
    f_c = design.board.cutoff_hz
    # R2 is the smallest of the three and R3 the largest.
    smallest = formulas.r2_ohm(f_c, c_f)
    largest = formulas.r3_ohm(f_c, c_f)

    return _check_resistors(
        "capacitor_uf",
        cutoff="cutoff_hz",
        smallest=("R2", smallest),
        largest=("R3", largest),
        design=design,
    )


@RULES.rule(
    "board.envelope_capacitor_uf", when=lambda design: design.board.capacitor_series == "given"
)
def envelope_resistor_in_range(design: DesignTables) -> Violation | None:
    c_f = formulas.to_farads(design.board.envelope_capacitor_uf)
    f_lp = design.board.envelope_cutoff_hz
    r_lp = ("R_LP", formulas.r_lp_ohm(f_lp, c_f))
    return _check_resistors(
        "envelope_capacitor_uf",
        cutoff="envelope_cutoff_hz",
        smallest=r_lp,
        largest=r_lp,
        design=design,
    )


@RULES.at_least(
    "board.cutoff_hz", slack=0.0, when=lambda design: design.board.capacitor_series != "given"
)
def selected_capacitor_exists(design: DesignTables) -> Limit:
    # R3 = 2 / (C omega) is the largest of the three.
    return _limit_selected_capacitor("R3", 2.0)


@RULES.at_least(
    "board.envelope_cutoff_hz",
    slack=0.0,
    when=lambda design: design.board.capacitor_series != "given",
)
def selected_envelope_capacitor_exists(design: DesignTables) -> Limit:
    return _limit_selected_capacitor("R_LP", 1.0)


@RULES.rule("board.passband_gain")
def gain_resistor_in_range(design: DesignTables) -> Violation | None:
    G = design.board.passband_gain
    R5 = design.board.r5_ohm
    R4 = formulas.r4_ohm(G, R5)
    if formulas.MIN_OHM <= R4 <= formulas.MAX_OHM:
        return None

    # R4 = R5 / (G - 1) at its bound.
    passing = (
        at_most(1 + R5 / formulas.MIN_OHM)
        if R4 < formulas.MIN_OHM
        else at_least(1 + R5 / formulas.MAX_OHM)
    )
    return Violation(
        f"{G:.10g} with R5 of {R5:g} ohm requires R4 of {R4:.4g} ohm, {_out_of_range(R4)}",
        passing,
        "with this r5_ohm",
    )


@RULES.rule("board.capacitor_uf", when=lambda design: design.board.capacitor_series == "given")
def filter_capacitor_is_preferred(design: DesignTables) -> Violation | None:
    return _check_preferred("capacitor_uf", "C1 to C3", design)


@RULES.rule(
    "board.envelope_capacitor_uf", when=lambda design: design.board.capacitor_series == "given"
)
def envelope_capacitor_is_preferred(design: DesignTables) -> Violation | None:
    return _check_preferred("envelope_capacitor_uf", "C4", design)


@RULES.rule("board.r5_ohm", when=lambda design: design.board.variant != "article")
def series_capacitor_exists(design: DesignTables) -> Violation | None:
    R5 = design.board.r5_ohm
    G = design.board.passband_gain
    f_c = design.board.cutoff_hz
    R4 = formulas.r4_ohm(G, R5)
    max_uf = formulas.SERIES_CAPACITORS_UF[-1]
    # A product of C and f that underflows requires an infinite resistor.
    conductance = math.tau * formulas.to_farads(max_uf) * f_c
    min_r4 = formulas.MIN_CUTOFF_RATIO / conductance if conductance else math.inf
    if min_r4 <= R4:
        return None

    return Violation(
        f"{R5:g} ohm at a gain of {G:.6g} requires R4 of {R4:.4g} ohm, whose series capacitor "
        "would be above "
        f"{max_uf:g} uF",
        at_least(min_r4 * (G - 1.0)),
    )


@RULES.at_least(
    "board.band_limit_hz", slack=0.0, when=lambda design: design.board.variant != "article"
)
def band_limit_above_the_band(design: DesignTables) -> Limit:
    f_c = design.board.cutoff_hz
    problem = f"cuts into the vibrations, which reach {BAND_CUTOFFS:g} cutoffs of {f_c:g} Hz"
    return Limit(BAND_CUTOFFS * f_c, problem)


@RULES.rule("board.band_limit_hz", when=lambda design: design.board.variant != "article")
def band_limit_capacitor_exists(design: DesignTables) -> Violation | None:
    R5 = design.board.r5_ohm
    f = design.board.band_limit_hz
    c_f = formulas.compute_limiting_capacitor_f(R5, f)
    minimum = formulas.MIN_LIMITING_CAPACITOR_F
    maximum = formulas.MAX_LIMITING_CAPACITOR_F
    if minimum <= c_f <= maximum:
        return None

    if c_f < minimum:
        limit = f"below {minimum * 1e12:g} pF"
        passing = at_most(f * c_f / minimum)
    else:
        limit = f"above {maximum * 1e12:g} pF"
        passing = at_least(f * c_f / maximum)

    return Violation(
        f"{f:g} Hz with R5 of {R5:g} ohm requires {c_f * 1e12:.4g} pF across it, {limit}",
        passing,
        "with this r5_ohm",
    )


def _limit_selected_capacitor(name: str, factor: float) -> Limit:
    """Return the least cutoff for which a capacitor can be selected; R = factor / (C omega)."""
    return Limit(
        factor / math.tau / formulas.MAX_SELECTABLE_F / formulas.MAX_OHM,
        f"requires {name} above {formulas.MAX_OHM / 1e6:g} Mohm with the largest capacitor that "
        "is selected, "
        f"{formulas.MAX_SELECTABLE_F * 1e6:g} uF",
        alternatives={"board.capacitor_series": "given"},
    )


def _check_footprint(capacitor: str, names: str, design: DesignTables) -> Violation | None:
    value = getattr(design.board, capacitor)
    max_uf = 1e6 * formulas.MAX_1206_F
    if value <= max_uf:
        return None

    return Violation(
        f"{value:g} uF is more than the footprint of {names} holds (1206, X7R for 16 V)",
        at_most_preferred(max_uf),
        alternatives={"board.capacitor_series": "E6"},
    )


def _check_resistors(
    capacitor: str,
    cutoff: str,
    smallest: tuple[str, float],
    largest: tuple[str, float],
    design: DesignTables,
) -> Violation | None:
    too_small = smallest[1] < formulas.MIN_OHM
    name, ohm = smallest if too_small else largest
    if formulas.MIN_OHM <= ohm <= formulas.MAX_OHM:
        return None

    value = getattr(design.board, capacitor)
    f = getattr(design.board, cutoff)
    # R C f is the same for every C and f, so each bound on R is a bound on C at this f.
    rcf = ohm * value * f
    if too_small:
        passing = at_most_preferred(rcf / f / formulas.MIN_OHM)
    else:
        passing = at_least(formulas.find_preferred_neighbours(rcf / f / formulas.MAX_OHM)[1])

    return Violation(
        f"{value:g} uF at {f:g} Hz requires {name} of {ohm:.4g} ohm, {_out_of_range(ohm)}",
        passing,
        "at this cutoff",
    )


def _check_preferred(capacitor: str, names: str, design: DesignTables) -> Violation | None:
    """Refuse a capacitor that nobody makes, and name its neighbours."""
    value = getattr(design.board, capacitor)
    below, above = formulas.find_preferred_neighbours(value)
    if below == above:
        return None

    return Violation(
        f"{value:.10g} uF for {names} is no value of series {formulas.CAPACITOR_SERIES}, in which "
        "capacitors are made",
        ((below, below), (above, above)),
        alternatives={"board.capacitor_series": "E6"},
    )


def at_most_preferred(maximum_uf: float) -> tuple[Interval, ...]:
    """Return the capacitances up to the largest preferred one below a maximum [uF]."""
    return at_most(formulas.find_preferred_neighbours(maximum_uf)[0]) if maximum_uf > 0.0 else ()


def _out_of_range(ohm: float) -> str:
    if ohm < formulas.MIN_OHM:
        return f"below {formulas.MIN_OHM:g} ohm"

    return f"above {formulas.MAX_OHM / 1e6:g} Mohm"


SIGNAL_RULES = Ruleset()

SAMPLES_PER_CYCLE = 4.0
"""Minimum samples per cycle of a cutoff: twice Nyquist's, an octave of passband above
the cutoff.
"""
MAX_WINDOW_S = 1.0
"""Maximum length of the averaging window [s]: a whole slide of the article's.
The article's limit for a useful reaction is 0.1 s.
"""
_MAX_THRESHOLD_SHARE = 0.99
"""Maximum threshold that is recommended, as a share of what the supply lets the signal reach."""


@SIGNAL_RULES.at_least("detector.sample_rate_hz", slack=0.0)
def rate_above_cutoffs(design: DesignTables) -> Limit | None:
    name, cutoff = max(
        ("board.cutoff_hz", design.board.cutoff_hz),
        ("board.envelope_cutoff_hz", design.board.envelope_cutoff_hz),
        key=lambda pair: pair[1],
    )
    return Limit(SAMPLES_PER_CYCLE * cutoff, f"is too slow for {name} of {cutoff:g} Hz")


@SIGNAL_RULES.at_most("detector.window_samples", slack=0.0)
def window_not_too_long(design: DesignTables) -> Limit | None:
    rate = design.detector.sample_rate_hz
    return Limit(
        math.floor(MAX_WINDOW_S * rate), f"at {rate:g} Hz last longer than {MAX_WINDOW_S:g} s"
    )


@SIGNAL_RULES.rule("detector.threshold_v", when=lambda design: design.board.has_filter)
def threshold_within_supply(design: DesignTables) -> Violation | None:
    reach = formulas.upper_headroom_v(design.board)
    if design.detector.threshold_v < reach:
        return None

    signals = (
        ""
        if reach == design.board.supply_v
        else f", whose signals have a quiescent level of {reach:g} V"
    )
    return Violation(
        f"{design.detector.threshold_v:g} V is never reached by a board supplied with "
        f"{design.board.supply_v:g} V{signals}",
        at_most(_MAX_THRESHOLD_SHARE * reach),
    )
