"""Rules between sampling, filters and detector: what cannot be sampled, averaged or reached is refused."""

from __future__ import annotations

import math

from fingertip.design.parameters import DesignTables
from fingertip.design.rules.board import reach_v
from fingertip.design.rules.ruleset import Ruleset, rounded_down, rounded_up

RULES = Ruleset()

SAMPLES_PER_CYCLE = 4.0
"""Least samples per cycle of a cutoff: twice Nyquist's, so that an octave of passband is left above the
cutoff."""
LONGEST_WINDOW_S = 1.0
"""A window as long as a whole slide of the article's. Its own bound for a useful reaction is 0.1 s."""


@RULES.rule("detector.sample_rate_hz", "board.cutoff_hz", "board.envelope_cutoff_hz")
def _rate_above_cutoffs(d: DesignTables) -> str | None:
    name, cutoff = max(
        ("board.cutoff_hz", d.board.cutoff_hz),
        ("board.envelope_cutoff_hz", d.board.envelope_cutoff_hz),
        key=lambda pair: pair[1],
    )
    minimum = SAMPLES_PER_CYCLE * cutoff
    if d.detector.sample_rate_hz >= minimum:
        return None
    return (
        f"{d.detector.sample_rate_hz:g} Hz is too slow for {name} of {cutoff:g} Hz; "
        f"at least {rounded_up(minimum)} Hz, or lower {name}."
    )


@RULES.rule("detector.window_samples", "detector.sample_rate_hz")
def _window_not_too_long(d: DesignTables) -> str | None:
    maximum = math.floor(LONGEST_WINDOW_S * d.detector.sample_rate_hz)
    if d.detector.window_samples <= maximum:
        return None
    return (
        f"{d.detector.window_samples} samples at {d.detector.sample_rate_hz:g} Hz last longer than "
        f"{LONGEST_WINDOW_S:g} s; at most {maximum} samples."
    )


@RULES.rule("detector.threshold_v", "board.supply_v", "board.supply")
def _threshold_within_supply(d: DesignTables) -> str | None:
    reach = reach_v(d.board)
    if d.detector.threshold_v < reach:
        return None
    signals = "" if reach == d.board.supply_v else f", whose signals rest at {reach:g} V"
    return (
        f"{d.detector.threshold_v:g} V is never reached by a board supplied with {d.board.supply_v:g} V{signals}; "
        f"at most {rounded_down(0.99 * reach)} V."
    )
