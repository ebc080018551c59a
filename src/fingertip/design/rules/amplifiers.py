"""Rules between supply, amplifiers and comparator: what each withstands and drives."""

from __future__ import annotations

import math
from collections.abc import Callable

from fingertip.catalogues.electronics import Amplifier, list_dual_amplifiers
from fingertip.design.formulas import amplifiers as formulas
from fingertip.design.formulas import filter as filter_components
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters.board_and_detector import Board
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.rules.board import PREFERRED_SHARE, at_most_preferred
from fingertip.design.rules.ruleset import Interval, Limit, Ruleset, Violation, at_most
from fingertip.foundation.numerics import bisect

SUPPLY_RULES = Ruleset()
RULES = Ruleset(when=lambda design: design.board.has_filter)

MIN_R5_OHM = find_bounds(Board.model_fields["r5_ohm"]).minimum or 0.0

BANDWIDTH_MARGIN = 10.0
"""Minimum closed-loop bandwidth GBW / G, in cutoffs: the gain at the cutoff then falls by 0.5 %."""
MAX_OFFSET_RATIO = 0.5
"""Maximum ratio of the first stage's offset to its swing: the signal keeps half of it."""
MIN_PHASE_MARGIN_DEG = 30.0
"""Minimum phase margin of the first stage [degree].
Below it a few picofarad more make an oscillator.
"""
MAX_PEAKING_DB = 1.0
"""Maximum gain beyond the band over that of the passband [dB]."""
CURRENT_MARGIN = 0.8
"""Maximum ratio of a filter amplifier's current to what its data sheet gives.
Preferred values add some percent.
"""
ENVELOPE_CURRENT_MARGIN = 0.95
"""Maximum ratio of the peak current that charges variant article's envelope to the data sheet's."""
SPLIT_RANGE_V = (5.0, 5.5)
"""Range of each half of variant article's supply [V]; its bridge is sized for 4.3 V."""
CONTROLLER_RANGE_V = (3.1, 3.6)
"""Range of the supply of a board for a controller [V]: half of it must leave the amplifiers room to
swing, and the inputs of the controller bear 3.6 V.
"""
DIVIDER_RANGE_V = (3.1, 5.5)
"""Range of the supply of a divider [V], which is its controller's."""


@SUPPLY_RULES.rule("board.supply_v")
def voltage_fits_the_supply(design: DesignTables) -> Violation | None:
    board = design.board
    ranges_v = {"article": SPLIT_RANGE_V, "divider": DIVIDER_RANGE_V}
    low, high = ranges_v.get(board.variant, CONTROLLER_RANGE_V)
    if low <= board.supply_v <= high:
        return None

    hint = ""
    if (
        board.variant == "article"
        and CONTROLLER_RANGE_V[0] <= board.supply_v <= CONTROLLER_RANGE_V[1]
    ):
        hint = ", in that of precision and comparator"

    return Violation(
        f"{board.supply_v:g} V lies outside the range of variant {board.variant}{hint}",
        ((low, high),),
    )


@RULES.rule("board.amplifier", voltage_fits_the_supply)
def amplifier_withstands_the_supply(design: DesignTables) -> Violation | None:
    amplifier = formulas.choose_amplifier(design.board)
    supply_v = formulas.total_supply_v(design.board)
    if formulas.works_on_supply(amplifier, design.board):
        return None

    return Violation(
        f"{amplifier.name} works on {amplifier.min_supply_v:g} to {amplifier.max_supply_v:g} V, "
        "and this supply puts "
        f"{supply_v:g} V across it"
    )


@RULES.rule("board.passband_gain", amplifier_withstands_the_supply)
def amplifier_fast_enough(design: DesignTables) -> Violation | None:
    amplifier = formulas.choose_amplifier(design.board)
    G = design.board.passband_gain
    f_c = design.board.cutoff_hz
    GBW = amplifier.bandwidth_hz
    if BANDWIDTH_MARGIN * G * f_c <= GBW:
        return None

    return Violation(
        f"the {GBW:g} Hz of a {amplifier.name} leave {GBW / G:.4g} Hz at a gain of {G:.6g}, less "
        "than "
        f"{BANDWIDTH_MARGIN:g} cutoffs of {f_c:g} Hz",
        at_most(GBW / BANDWIDTH_MARGIN / f_c),
        alternatives=_other_amplifier(
            design, lambda faster: faster.bandwidth_hz >= BANDWIDTH_MARGIN * G * f_c
        ),
    )


@RULES.rule("board.passband_gain", amplifier_withstands_the_supply)
def offset_leaves_room(design: DesignTables) -> Violation | None:
    """The amplified offset of the first stage leaves room for the signal.

    Other variants do not amplify it.
    """
    if design.board.variant != "article":
        return None

    amplifier = formulas.choose_amplifier(design.board)
    G = design.board.passband_gain
    ratio = MAX_OFFSET_RATIO * (1.0 - PREFERRED_SHARE)
    maximum_v = ratio * formulas.input_swing_v(design.board, amplifier)
    if G * amplifier.max_offset_v <= maximum_v:
        return None

    return Violation(
        f"{G:.6g} times the {1e3 * amplifier.max_offset_v:g} mV of offset that a "
        f"{amplifier.order_name} may have are "
        f"{G * amplifier.max_offset_v:.3g} V, more than {ratio:g} of the swing of "
        f"{formulas.input_swing_v(design.board, amplifier):.3g} V",
        at_most(maximum_v / amplifier.max_offset_v),
    )


@RULES.rule("board.r5_ohm", amplifier_withstands_the_supply)
def first_stage_is_stable(design: DesignTables) -> Violation | None:
    """The input's capacitance leaves the first stage stable, and the filter without resonance."""
    board = design.board
    amplifier = formulas.choose_amplifier(board)
    gain = board.passband_gain
    min_margin_deg = MIN_PHASE_MARGIN_DEG * (1.0 + PREFERRED_SHARE)
    max_peaking_db = MAX_PEAKING_DB * (1.0 - PREFERRED_SHARE)

    def problem(r5_ohm: float) -> str:
        feedback = formulas.first_stage_feedback(board, amplifier, r5_ohm)
        margin_deg = formulas.compute_phase_margin_deg(amplifier, feedback)
        if margin_deg < min_margin_deg:
            return f"leaves {margin_deg:.0f} degrees of phase margin, less than {min_margin_deg:g}"

        peaking_db = formulas.compute_peaking_db(amplifier, feedback, gain)
        if peaking_db > max_peaking_db:
            return (
                f"makes the filter's gain peak {peaking_db:.1f} dB beyond its band, more than "
                f"{max_peaking_db:g} dB"
            )

        return ""

    present_problem = problem(board.r5_ohm)
    if not present_problem:
        return None

    passing: tuple[Interval, ...] = ()
    if not problem(MIN_R5_OHM):
        stable_ohm, _ = bisect(
            lambda r5_ohm: not problem(r5_ohm), MIN_R5_OHM, board.r5_ohm, halvings=30
        )
        passing = at_most(stable_ohm)

    return Violation(
        f"{board.r5_ohm:g} ohm with the {1e12 * amplifier.input_f:g} pF of a {amplifier.name}'s "
        f"input {present_problem}",
        passing,
        "at this gain",
    )


@RULES.rule("board.capacitor_uf", amplifier_withstands_the_supply)
def amplifier_drives_the_filter(design: DesignTables) -> Violation | None:
    board = design.board
    if board.capacitor_series != "given":
        return None

    amplifier = formulas.choose_amplifier(board)
    current_a = formulas.compute_filter_current_a(board)
    limit_a = CURRENT_MARGIN * amplifier.output_current_a
    if current_a <= limit_a:
        return None

    return Violation(
        f"{board.capacitor_uf:g} uF at {board.cutoff_hz:g} Hz asks {1e3 * current_a:.3g} mA of a "
        f"{amplifier.name}, "
        f"more than {CURRENT_MARGIN:g} of its {1e3 * amplifier.output_current_a:g} mA",
        at_most_preferred(board.capacitor_uf * limit_a / current_a),
        "at this cutoff",
        alternatives=_other_amplifier(
            design, lambda stronger: CURRENT_MARGIN * stronger.output_current_a >= current_a
        ),
    )


@RULES.rule(
    "board.envelope_capacitor_uf", amplifier_withstands_the_supply, amplifier_drives_the_filter
)
def amplifier_charges_the_envelope(design: DesignTables) -> Violation | None:
    board = design.board
    if board.variant != "article" or board.capacitor_series != "given":
        return None

    amplifier = formulas.choose_amplifier(board)
    c_lp_f = filter_components.to_farads(board.envelope_capacitor_uf)
    charging_a = formulas.compute_envelope_current_a(board, c_lp_f)
    filter_a = formulas.compute_filter_current_a(board)
    limit_a = ENVELOPE_CURRENT_MARGIN * amplifier.output_current_a
    if charging_a + filter_a <= limit_a:
        return None

    return Violation(
        f"{board.envelope_capacitor_uf:g} uF asks peaks of {1e3 * (charging_a + filter_a):.3g} mA "
        "of a "
        f"{amplifier.name} at {formulas.BAND_CUTOFFS:g} cutoffs of {board.cutoff_hz:g} Hz, more "
        "than "
        f"{ENVELOPE_CURRENT_MARGIN:g} of its {1e3 * amplifier.output_current_a:g} mA",
        # R_LP is inverse to the capacitor, so that the current is proportional to it.
        at_most_preferred(board.envelope_capacitor_uf * (limit_a - filter_a) / charging_a),
        "at this cutoff",
    )


@RULES.rule("detector.threshold_v", when=lambda design: design.board.variant == "comparator")
def threshold_can_be_trimmed(design: DesignTables) -> Violation | None:
    maximum = filter_components.upper_headroom_v(design.board) / 4.0
    if filter_components.MIN_COMPARATOR_V <= design.detector.threshold_v <= maximum:
        return None

    return Violation(
        f"{design.detector.threshold_v:g} V lies outside the range of variant comparator's trimmer",
        ((filter_components.MIN_COMPARATOR_V, maximum),),
        "with this supply",
    )


@RULES.at_most("detector.window_samples", threshold_can_be_trimmed, slack=0.0)
def mean_tolerates_the_bias_current(design: DesignTables) -> Limit | None:
    """The comparator's bias current shifts the averaged signal by at most half of the threshold."""
    if design.board.variant != "comparator":
        return None

    n = design.detector.window_samples
    rate = design.detector.sample_rate_hz
    threshold = design.detector.threshold_v
    averaging_ohm = n / rate / 2.0 / filter_components.MAX_AVERAGING_F
    bias_a = filter_components.MAX_BIAS_A

    return Limit(
        math.floor(filter_components.max_window_s(threshold) * rate),
        f"at {rate:g} Hz require an averaging resistor of {averaging_ohm:.4g} ohm, in which the "
        "input "
        f"current of variant comparator's LMV331 (at most {1e9 * bias_a:g} nA) drops "
        f"{1e3 * averaging_ohm * bias_a:.3g} mV, more than half of the threshold of "
        f"{1e3 * threshold:g} mV",
    )


def _other_amplifier(design: DesignTables, passes: Callable[[Amplifier], bool]) -> dict[str, str]:
    """Return the first amplifier that works on the supply and passes, as an alternative."""
    for amplifier in list_dual_amplifiers():
        if formulas.works_on_supply(amplifier, design.board) and passes(amplifier):
            return {"board.amplifier": amplifier.name}

    return {}
