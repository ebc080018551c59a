"""Rules between sampling, filters and detector: signals that cannot be sampled, averaged or reached are refused."""

from __future__ import annotations

import math

from fingertip.design.parameters import DesignTables
from fingertip.design.rules.board import reach_v
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
def rate_above_cutoffs(d: DesignTables) -> Violation | None:
    """The sampling rate resolves the cutoffs of filter and envelope."""
    name, cutoff = max(
        ("board.cutoff_hz", d.board.cutoff_hz),
        ("board.envelope_cutoff_hz", d.board.envelope_cutoff_hz),
        key=lambda pair: pair[1],
    )
    minimum = SAMPLES_PER_CYCLE * cutoff
    if d.detector.sample_rate_hz >= minimum:
        return None
    return Violation(f"{d.detector.sample_rate_hz:g} Hz is too slow for {name} of {cutoff:g} Hz", at_least(minimum))


@RULES.rule("detector.window_samples")
def window_not_too_long(d: DesignTables) -> Violation | None:
    """The averaging window is not longer than a slide."""
    maximum = math.floor(MAX_WINDOW_S * d.detector.sample_rate_hz)
    if d.detector.window_samples <= maximum:
        return None
    return Violation(
        f"{d.detector.window_samples} samples at {d.detector.sample_rate_hz:g} Hz last longer than {MAX_WINDOW_S:g} s",
        at_most(maximum),
    )


@RULES.rule("detector.threshold_v")
def threshold_within_supply(d: DesignTables) -> Violation | None:
    """The signal can reach the threshold."""
    reach = reach_v(d.board)
    if d.detector.threshold_v < reach:
        return None
    signals = "" if reach == d.board.supply_v else f", whose signals have a quiescent level of {reach:g} V"
    return Violation(
        f"{d.detector.threshold_v:g} V is never reached by a board supplied with {d.board.supply_v:g} V{signals}",
        at_most(_MAX_THRESHOLD_SHARE * reach),
    )
