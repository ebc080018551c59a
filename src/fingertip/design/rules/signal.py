"""Rules between sampling, filters and detector: signals that cannot be sampled, averaged or reached are refused."""

from __future__ import annotations

import math

from fingertip.design.formulas.supply import upper_headroom_v
from fingertip.design.geometry.design_tables import DesignTables
from fingertip.design.rules.ruleset import Ruleset, Violation, at_least, at_most

RULES = Ruleset()

SAMPLES_PER_CYCLE = 4.0
"""Minimum samples per cycle of a cutoff: twice Nyquist's, which leaves an octave of passband above the cutoff."""
MAX_WINDOW_S = 1.0
"""Maximum length of the averaging window [s]: a whole slide of the article's. The article's own limit for a useful
reaction is 0.1 s."""
_MAX_THRESHOLD_SHARE = 0.99
"""Maximum threshold that is recommended, as a share of what the supply lets the signal reach."""


@RULES.rule("detector.sample_rate_hz")
def rate_above_cutoffs(design: DesignTables) -> Violation | None:
    """The sampling rate resolves the cutoffs of filter and envelope."""
    name, cutoff = max(
        ("board.cutoff_hz", design.board.cutoff_hz),
        ("board.envelope_cutoff_hz", design.board.envelope_cutoff_hz),
        key=lambda pair: pair[1],
    )
    minimum = SAMPLES_PER_CYCLE * cutoff
    if design.detector.sample_rate_hz >= minimum:
        return None
    return Violation(
        f"{design.detector.sample_rate_hz:g} Hz is too slow for {name} of {cutoff:g} Hz", at_least(minimum)
    )


@RULES.rule("detector.window_samples")
def window_not_too_long(design: DesignTables) -> Violation | None:
    """The averaging window is not longer than a slide."""
    maximum = math.floor(MAX_WINDOW_S * design.detector.sample_rate_hz)
    if design.detector.window_samples <= maximum:
        return None
    return Violation(
        f"{design.detector.window_samples} samples at {design.detector.sample_rate_hz:g} Hz last longer than "
        f"{MAX_WINDOW_S:g} s",
        at_most(maximum),
    )


@RULES.rule("detector.threshold_v")
def threshold_within_supply(design: DesignTables) -> Violation | None:
    """The signal can reach the threshold."""
    reach = upper_headroom_v(design.board)
    if design.detector.threshold_v < reach:
        return None
    signals = "" if reach == design.board.supply_v else f", whose signals have a quiescent level of {reach:g} V"
    return Violation(
        f"{design.detector.threshold_v:g} V is never reached by a board supplied with "
        f"{design.board.supply_v:g} V{signals}",
        at_most(_MAX_THRESHOLD_SHARE * reach),
    )
