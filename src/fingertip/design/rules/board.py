"""Rules between the board's parameters: components that can be bought, and an amplifier that can drive them."""

from __future__ import annotations

import math
from collections.abc import Callable

from fingertip.amplifiers import Amplifier, list_dual_amplifiers
from fingertip.design import filter_components
from fingertip.design.amplifier_choice import choose_amplifier, total_supply_v, works_on_supply
from fingertip.design.amplifier_stages import (
    BAND_CUTOFFS,
    compute_envelope_current_a,
    compute_filter_current_a,
    compute_peaking_db,
    compute_phase_margin_deg,
    first_stage_feedback,
    input_swing_v,
)
from fingertip.design.comparator_data import (
    MAX_AVERAGING_F,
    MAX_BIAS_A,
    MAX_COMPARATOR_V,
    MIN_COMPARATOR_V,
    max_window_s,
)
from fingertip.design.filter_components import MAX_1206_F, MAX_OHM, MIN_CUTOFF_RATIO, MIN_OHM, to_farads
from fingertip.design.parameters import Board, DesignTables
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.preferred_series import CAPACITOR_SERIES, find_preferred_neighbours
from fingertip.design.rules.ruleset import Interval, Ruleset, Violation, at_least, at_most
from fingertip.design.signal_ground import upper_headroom_v
from fingertip.numerics import bisect

RULES = Ruleset()

MIN_R5_OHM = find_bounds(Board.model_fields["r5_ohm"]).minimum or 0.0
"""Minimum of the parameter r5_ohm [ohm]."""

BANDWIDTH_MARGIN = 10.0
"""Minimum closed-loop bandwidth GBW / G, in cutoffs: the amplifier then costs 0.5 % of the gain at the cutoff."""
MAX_OFFSET_RATIO = 0.5
"""Maximum ratio of the first stage's offset to its swing: the signal keeps half of it."""
MIN_PHASE_MARGIN_DEG = 30.0
"""Minimum phase margin of the first stage [degree]. Below it a few picofarad more make an oscillator."""
MAX_PEAKING_DB = 1.0
"""Maximum gain beyond the band over that of the passband [dB]."""
PREFERRED_SHARE = 0.1
"""Share of a limit that the rules keep free, because preferred values differ from the ideal ones."""
CURRENT_MARGIN = 0.8
"""Maximum ratio of a filter amplifier's current to what its data sheet gives. Preferred values add some percent."""
ENVELOPE_CURRENT_MARGIN = 0.95
"""Maximum ratio of the current that charges variant article's envelope, at its peak, to what the data sheet gives."""

SUPPLY_RANGES_V = {"split": (5.0, 6.0), "single": (5.0, 6.0), "single_3v3": (3.1, 3.6)}
"""Range of the voltage of each supply [V].

The bridge of the first two is sized for the article's 4.3 V. The AD623 needs 3 V (its data sheet), and the last supply
ends where the inputs of a controller do.
"""
MAX_SPLIT_V = 5.5
"""Maximum of each half of a split supply [V]. The AD623's supply range ends at 12 V (its data sheet; unverified)."""


@RULES.rule("board.capacitor_uf")
def filter_capacitor_fits_its_footprint(design: DesignTables) -> Violation | None:
    """The given filter capacitor can be bought in the size of its footprint."""
    return _check_footprint("capacitor_uf", "C1 to C3", design)


@RULES.rule("board.envelope_capacitor_uf")
def envelope_capacitor_fits_its_footprint(design: DesignTables) -> Violation | None:
    """The given envelope capacitor can be bought in the size of its footprint."""
    return _check_footprint("envelope_capacitor_uf", "C4", design)


@RULES.rule("board.capacitor_uf")
def filter_resistors_in_range(design: DesignTables) -> Violation | None:
    """The given filter capacitor and cutoff require resistors R1 to R3 within their range."""
    if design.board.capacitor_series != "given":
        return None
    c_f, f_c = to_farads(design.board.capacitor_uf), design.board.cutoff_hz
    # R2 is the smallest of the three and R3 the largest.
    smallest, largest = filter_components.r2_ohm(f_c, c_f), filter_components.r3_ohm(f_c, c_f)
    return _check_resistors("capacitor_uf", "cutoff_hz", ("R2", smallest), ("R3", largest), design)


@RULES.rule("board.envelope_capacitor_uf")
def envelope_resistor_in_range(design: DesignTables) -> Violation | None:
    """The given envelope capacitor and cutoff require a resistor R_LP within its range."""
    if design.board.capacitor_series != "given":
        return None
    c_f, f_lp = to_farads(design.board.envelope_capacitor_uf), design.board.envelope_cutoff_hz
    r_lp = ("R_LP", filter_components.r_lp_ohm(f_lp, c_f))
    return _check_resistors("envelope_capacitor_uf", "envelope_cutoff_hz", r_lp, r_lp, design)


@RULES.rule("board.cutoff_hz")
def selected_capacitor_exists(design: DesignTables) -> Violation | None:
    """A filter capacitor can be selected for the cutoff."""
    # R3 = 2 / (C omega) is the largest of the three.
    return _check_selected_capacitor("R3", 2.0, "cutoff_hz", design)


@RULES.rule("board.envelope_cutoff_hz")
def selected_envelope_capacitor_exists(design: DesignTables) -> Violation | None:
    """An envelope capacitor can be selected for the cutoff."""
    return _check_selected_capacitor("R_LP", 1.0, "envelope_cutoff_hz", design)


@RULES.rule("board.passband_gain")
def gain_resistor_in_range(design: DesignTables) -> Violation | None:
    """The gain requires a resistor R4 within its range."""
    G, R5 = design.board.passband_gain, design.board.r5_ohm
    R4 = filter_components.r4_ohm(G, R5)
    if MIN_OHM <= R4 <= MAX_OHM:
        return None
    # R4 = R5 / (G - 1) at its bound.
    passing = at_most(1 + R5 / MIN_OHM) if R4 < MIN_OHM else at_least(1 + R5 / MAX_OHM)
    return Violation(
        f"{G:.10g} with R5 of {R5:g} ohm requires R4 of {R4:.4g} ohm, {_out_of_range(R4)}", passing, "with this r5_ohm"
    )


@RULES.rule("board.capacitor_uf")
def filter_capacitor_is_preferred(design: DesignTables) -> Violation | None:
    """The given filter capacitor is a preferred value."""
    return _check_preferred("capacitor_uf", "C1 to C3", design)


@RULES.rule("board.envelope_capacitor_uf")
def envelope_capacitor_is_preferred(design: DesignTables) -> Violation | None:
    """The given envelope capacitor is a preferred value."""
    return _check_preferred("envelope_capacitor_uf", "C4", design)


@RULES.rule("board.supply_v")
def voltage_fits_the_supply(design: DesignTables) -> Violation | None:
    """The voltage lies within the range of the supply."""
    supply, supply_v = design.board.supply, design.board.supply_v
    minimum, maximum = SUPPLY_RANGES_V[supply]
    if minimum <= supply_v <= maximum:
        return None
    others = [name for name, (low, high) in SUPPLY_RANGES_V.items() if low <= supply_v <= high]
    return Violation(
        f"{supply_v:g} V lies outside the range of board.supply={supply}",
        ((minimum, maximum),),
        alternatives={"board.supply": others[0]} if others else {},
    )


@RULES.rule("board.amplifier", voltage_fits_the_supply)
def amplifier_withstands_the_supply(design: DesignTables) -> Violation | None:
    """The supply lies within the range of the amplifier."""
    amplifier, supply_v = choose_amplifier(design.board), total_supply_v(design.board)
    if works_on_supply(amplifier, design.board):
        return None
    return Violation(
        f"{amplifier.name} works on {amplifier.min_supply_v:g} to {amplifier.max_supply_v:g} V, and this supply puts "
        f"{supply_v:g} V across it",
    )


@RULES.rule("board.passband_gain", amplifier_withstands_the_supply)
def amplifier_fast_enough(design: DesignTables) -> Violation | None:
    """The amplifier has enough bandwidth for the gain at the cutoff."""
    amplifier, G, f_c = choose_amplifier(design.board), design.board.passband_gain, design.board.cutoff_hz
    GBW = amplifier.bandwidth_hz
    if BANDWIDTH_MARGIN * G * f_c <= GBW:
        return None
    return Violation(
        f"the {GBW:g} Hz of a {amplifier.name} leave {GBW / G:.4g} Hz at a gain of {G:.6g}, less than "
        f"{BANDWIDTH_MARGIN:g} cutoffs of {f_c:g} Hz",
        at_most(GBW / BANDWIDTH_MARGIN / f_c),
        alternatives=_other_amplifier(design, lambda other: other.bandwidth_hz >= BANDWIDTH_MARGIN * G * f_c),
    )


@RULES.rule("board.passband_gain", amplifier_withstands_the_supply)
def offset_leaves_room(design: DesignTables) -> Violation | None:
    """The amplified offset of the first stage leaves room for the signal. Other variants do not amplify it."""
    if design.board.variant != "article":
        return None
    amplifier, G = choose_amplifier(design.board), design.board.passband_gain
    ratio = MAX_OFFSET_RATIO * (1.0 - PREFERRED_SHARE)
    maximum_v = ratio * input_swing_v(design.board, amplifier)
    if G * amplifier.max_offset_v <= maximum_v:
        return None
    return Violation(
        f"{G:.6g} times the {1e3 * amplifier.max_offset_v:g} mV of offset that a {amplifier.order_name} may have are "
        f"{G * amplifier.max_offset_v:.3g} V, more than {ratio:g} of the swing of "
        f"{input_swing_v(design.board, amplifier):.3g} V",
        at_most(maximum_v / amplifier.max_offset_v),
        alternatives={"board.variant": "precision"},
    )


@RULES.rule("board.r5_ohm", amplifier_withstands_the_supply)
def first_stage_is_stable(design: DesignTables) -> Violation | None:
    """The input's capacitance with R4 and R5 leaves the first stage stable, and the filter without a resonance."""
    board, amplifier = design.board, choose_amplifier(design.board)
    gain, min_margin_deg = board.passband_gain, MIN_PHASE_MARGIN_DEG * (1.0 + PREFERRED_SHARE)
    max_peaking_db = MAX_PEAKING_DB * (1.0 - PREFERRED_SHARE)

    def problem(r5_ohm: float) -> str:
        feedback = first_stage_feedback(board, amplifier, r5_ohm)
        margin_deg = compute_phase_margin_deg(amplifier, feedback)
        if margin_deg < min_margin_deg:
            return f"leaves {margin_deg:.0f} degrees of phase margin, less than {min_margin_deg:g}"
        peaking_db = compute_peaking_db(amplifier, feedback, gain)
        if peaking_db > max_peaking_db:
            return f"makes the filter's gain peak {peaking_db:.1f} dB beyond its band, more than {max_peaking_db:g} dB"
        return ""

    found = problem(board.r5_ohm)
    if not found:
        return None
    passing: tuple[Interval, ...] = ()
    if not problem(MIN_R5_OHM):
        stable_ohm, _ = bisect(lambda r5_ohm: not problem(r5_ohm), MIN_R5_OHM, board.r5_ohm, halvings=30)
        passing = at_most(stable_ohm)
    return Violation(
        f"{board.r5_ohm:g} ohm with the {1e12 * amplifier.input_f:g} pF of a {amplifier.name}'s input {found}",
        passing,
        "at this gain",
        alternatives={"board.variant": "precision"} if board.variant == "article" else {},
    )


@RULES.rule("board.capacitor_uf", amplifier_withstands_the_supply)
def amplifier_drives_the_filter(design: DesignTables) -> Violation | None:
    """The amplifier can drive the filter's capacitors and resistors."""
    board = design.board
    if board.capacitor_series != "given":
        return None
    amplifier, current_a = choose_amplifier(board), compute_filter_current_a(board)
    limit_a = CURRENT_MARGIN * amplifier.output_current_a
    if current_a <= limit_a:
        return None
    return Violation(
        f"{board.capacitor_uf:g} uF at {board.cutoff_hz:g} Hz asks {1e3 * current_a:.3g} mA of a {amplifier.name}, "
        f"more than {CURRENT_MARGIN:g} of its {1e3 * amplifier.output_current_a:g} mA",
        _at_most_preferred(board.capacitor_uf * limit_a / current_a),
        "at this cutoff",
        alternatives=_other_amplifier(design, lambda other: CURRENT_MARGIN * other.output_current_a >= current_a),
    )


@RULES.rule("board.envelope_capacitor_uf", amplifier_withstands_the_supply, amplifier_drives_the_filter)
def amplifier_charges_the_envelope(design: DesignTables) -> Violation | None:
    """The amplifier can charge the envelope's capacitor through variant article's diode."""
    board = design.board
    if board.variant != "article" or board.capacitor_series != "given":
        return None
    amplifier, c_lp_f = choose_amplifier(board), to_farads(board.envelope_capacitor_uf)
    charging_a, filter_a = compute_envelope_current_a(board, c_lp_f), compute_filter_current_a(board)
    limit_a = ENVELOPE_CURRENT_MARGIN * amplifier.output_current_a
    if charging_a + filter_a <= limit_a:
        return None
    return Violation(
        f"{board.envelope_capacitor_uf:g} uF asks peaks of {1e3 * (charging_a + filter_a):.3g} mA of a "
        f"{amplifier.name} at {BAND_CUTOFFS:g} cutoffs of {board.cutoff_hz:g} Hz, more than "
        f"{ENVELOPE_CURRENT_MARGIN:g} of its {1e3 * amplifier.output_current_a:g} mA",
        # R_LP is inverse to the capacitor, so that the current is proportional to it.
        _at_most_preferred(board.envelope_capacitor_uf * (limit_a - filter_a) / charging_a),
        "at this cutoff",
        alternatives={"board.variant": "precision"},
    )


@RULES.rule("board.r5_ohm")
def series_capacitor_exists(design: DesignTables) -> Violation | None:
    """The capacitor in series with R4 can be bought."""
    if design.board.variant == "article":
        return None
    R5, G, f_c = design.board.r5_ohm, design.board.passband_gain, design.board.cutoff_hz
    R4 = filter_components.r4_ohm(G, R5)
    max_uf = filter_components.SERIES_CAPACITORS_UF[-1]
    # A product of C and f that underflows requires an infinite resistor.
    conductance = math.tau * to_farads(max_uf) * f_c
    min_r4 = MIN_CUTOFF_RATIO / conductance if conductance else math.inf
    if min_r4 <= R4:
        return None
    return Violation(
        f"{R5:g} ohm at a gain of {G:.6g} requires R4 of {R4:.4g} ohm, whose series capacitor would be above "
        f"{max_uf:g} uF",
        at_least(min_r4 * (G - 1.0)),
        alternatives={"board.variant": "article"},
    )


@RULES.rule("board.band_limit_hz")
def band_limit_above_the_band(design: DesignTables) -> Violation | None:
    """The band limit of the first stage leaves the vibrations of slip untouched."""
    if design.board.variant == "article":
        return None
    minimum = BAND_CUTOFFS * design.board.cutoff_hz
    if design.board.band_limit_hz >= minimum:
        return None
    return Violation(
        f"{design.board.band_limit_hz:g} Hz cuts into the vibrations, which reach {BAND_CUTOFFS:g} cutoffs of "
        f"{design.board.cutoff_hz:g} Hz",
        at_least(minimum),
        alternatives={"board.variant": "article"},
    )


@RULES.rule("board.band_limit_hz")
def band_limit_capacitor_exists(design: DesignTables) -> Violation | None:
    """The capacitor across R5 that sets the band limit can be bought."""
    if design.board.variant == "article":
        return None
    R5, f = design.board.r5_ohm, design.board.band_limit_hz
    c_f = filter_components.compute_limiting_capacitor_f(R5, f)
    minimum, maximum = filter_components.MIN_LIMITING_CAPACITOR_F, filter_components.MAX_LIMITING_CAPACITOR_F
    if minimum <= c_f <= maximum:
        return None
    if c_f < minimum:
        limit, passing = f"below {minimum * 1e12:g} pF", at_most(f * c_f / minimum)
    else:
        limit, passing = f"above {maximum * 1e12:g} pF", at_least(f * c_f / maximum)
    return Violation(
        f"{f:g} Hz with R5 of {R5:g} ohm requires {c_f * 1e12:.4g} pF across it, {limit}", passing, "with this r5_ohm"
    )


@RULES.rule("board.supply_v")
def bridge_amplifier_withstands_the_split_supply(design: DesignTables) -> Violation | None:
    """Both halves of a split supply together stay below the bridge amplifier's maximum, with a margin."""
    supply_v = design.board.supply_v
    if design.board.supply != "split" or supply_v <= MAX_SPLIT_V:
        return None
    return Violation(
        f"plus and minus {supply_v:g} V put {2 * supply_v:g} V across the bridge's AD623, too close to the end of its "
        "supply range",
        at_most(MAX_SPLIT_V),
        alternatives={"board.supply": "single"},
    )


@RULES.rule("board.supply_v")
def comparator_withstands_the_supply(design: DesignTables) -> Violation | None:
    """The supply does not exceed the comparator's maximum."""
    if design.board.variant != "comparator" or design.board.supply_v <= MAX_COMPARATOR_V:
        return None
    return Violation(
        f"{design.board.supply_v:g} V is too much for variant comparator's LMV331", at_most(MAX_COMPARATOR_V)
    )


@RULES.rule("detector.threshold_v")
def threshold_can_be_trimmed(design: DesignTables) -> Violation | None:
    """The threshold lies within the range of the comparator's trimmer."""
    if design.board.variant != "comparator":
        return None
    maximum = upper_headroom_v(design.board) / 4.0
    if MIN_COMPARATOR_V <= design.detector.threshold_v <= maximum:
        return None
    return Violation(
        f"{design.detector.threshold_v:g} V lies outside the range of variant comparator's trimmer",
        ((MIN_COMPARATOR_V, maximum),),
        "with this supply",
    )


@RULES.rule("detector.window_samples")
def mean_tolerates_the_bias_current(design: DesignTables) -> Violation | None:
    """The comparator's bias current shifts the averaged signal by at most half of the threshold."""
    if design.board.variant != "comparator" or design.detector.threshold_v < MIN_COMPARATOR_V:
        return None
    n, rate, threshold = design.detector.window_samples, design.detector.sample_rate_hz, design.detector.threshold_v
    maximum = math.floor(max_window_s(threshold) * rate)
    if n <= maximum:
        return None
    averaging_ohm = n / rate / 2.0 / MAX_AVERAGING_F
    return Violation(
        f"{n} samples at {rate:g} Hz require an averaging resistor of {averaging_ohm:.4g} ohm, in which the input "
        f"current of variant comparator's LMV331 (at most {1e9 * MAX_BIAS_A:g} nA) drops "
        f"{1e3 * averaging_ohm * MAX_BIAS_A:.3g} mV, more than half of the threshold of {1e3 * threshold:g} mV",
        at_most(maximum),
    )


def _check_selected_capacitor(name: str, factor: float, cutoff: str, design: DesignTables) -> Violation | None:
    """Refuse a cutoff for which no capacitor can be selected, its resistor being factor / (C omega)."""
    if design.board.capacitor_series == "given":
        return None
    cutoff_hz = getattr(design.board, cutoff)
    min_hz = factor / math.tau / filter_components.MAX_SELECTABLE_F / MAX_OHM
    if cutoff_hz >= min_hz:
        return None
    return Violation(
        f"{cutoff_hz:g} Hz requires {name} above {MAX_OHM / 1e6:g} Mohm with the largest capacitor that is selected, "
        f"{filter_components.MAX_SELECTABLE_F * 1e6:g} uF",
        at_least(min_hz),
        alternatives={"board.capacitor_series": "given"},
    )


def _check_footprint(capacitor: str, names: str, design: DesignTables) -> Violation | None:
    """Refuse a capacitor that cannot be bought in the size of its footprint."""
    if design.board.capacitor_series != "given":
        return None
    value, max_uf = getattr(design.board, capacitor), 1e6 * MAX_1206_F
    if value <= max_uf:
        return None
    return Violation(
        f"{value:g} uF is more than the footprint of {names} holds (1206, X7R for 16 V)",
        _at_most_preferred(max_uf),
        alternatives={"board.capacitor_series": "E6"},
    )


def _check_resistors(
    capacitor: str, cutoff: str, smallest: tuple[str, float], largest: tuple[str, float], design: DesignTables
) -> Violation | None:
    """Refuse a capacitor whose resistors, proportional to 1 / (C f), leave their range."""
    too_small = smallest[1] < MIN_OHM
    name, ohm = smallest if too_small else largest
    if MIN_OHM <= ohm <= MAX_OHM:
        return None
    value, f = getattr(design.board, capacitor), getattr(design.board, cutoff)
    passing: tuple[Interval, ...] = ()
    if math.isfinite(ohm):
        # R C f is the same for every C and f, so each bound on R is a bound on C at this f.
        rcf = ohm * value * f
        passing = _at_most_preferred(rcf / f / MIN_OHM) if too_small else _at_least_preferred(rcf / f / MAX_OHM)
    return Violation(
        f"{value:g} uF at {f:g} Hz requires {name} of {ohm:.4g} ohm, {_out_of_range(ohm)}", passing, "at this cutoff"
    )


def _check_preferred(capacitor: str, names: str, design: DesignTables) -> Violation | None:
    """Refuse a capacitor that nobody makes, and name its neighbours."""
    if design.board.capacitor_series != "given":
        return None
    value = getattr(design.board, capacitor)
    below, above = find_preferred_neighbours(value)
    if below == above:
        return None
    return Violation(
        f"{value:.10g} uF for {names} is no value of series {CAPACITOR_SERIES}, in which capacitors are made",
        ((below, below), (above, above)),
        alternatives={"board.capacitor_series": "E6"},
    )


def _at_most_preferred(maximum_uf: float) -> tuple[Interval, ...]:
    """Return the capacitances up to the largest preferred one that does not exceed a maximum [uF]."""
    return at_most(find_preferred_neighbours(maximum_uf)[0]) if maximum_uf > 0.0 else ()


def _at_least_preferred(minimum_uf: float) -> tuple[Interval, ...]:
    """Return the capacitances from the smallest preferred one on that is not below a minimum [uF]."""
    return at_least(find_preferred_neighbours(minimum_uf)[1]) if minimum_uf > 0.0 else ()


def _other_amplifier(design: DesignTables, passes: Callable[[Amplifier], bool]) -> dict[str, str]:
    """Return the first amplifier of the catalogue that passes a condition and the supply, as an alternative."""
    names = (a.name for a in list_dual_amplifiers() if works_on_supply(a, design.board) and passes(a))
    name = next(names, None)
    return {"board.amplifier": name} if name else {}


def _out_of_range(ohm: float) -> str:
    return f"below {MIN_OHM:g} ohm" if ohm < MIN_OHM else f"above {MAX_OHM / 1e6:g} Mohm"
