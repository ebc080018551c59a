"""What the article's window length does (its figure 5): a short one takes contacts for slip, a long one is late."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fingertip.campaign.judge import Verdict, judge
from fingertip.campaign.plan import HELD_OUT_FROM, Amount, cases
from fingertip.campaign.record import record
from fingertip.campaign.study import Total
from fingertip.design import Design
from fingertip.sim.jit import compiled
from fingertip.slip.detectors.noise import noise_level

WINDOWS_S = (0.005, 0.01, 0.02, 0.03, 0.05, 0.1)
"""The article shows 10 ms and more, takes 30 ms, and calls 20 to 100 ms acceptable."""
DETECTOR = "digital"
"""The article's figure shows its board's output; a board with a bare diode, as ours has it, lets no contact through."""
CONTACTS = ("contact", "release", "load change")


@dataclass(frozen=True)
class Row:
    """The article's chain with one window."""

    window_s: float
    threshold_v: float
    """By the design's rule: noise level and six deviations, which a longer window makes smaller [V]."""
    found_share: float
    median_s: float
    """Over all slips [s]; infinite if fewer than half were found."""
    p90_s: float
    contact_alarms_per_minute: float
    """In contacts, releases and changes of grip, the trials' own among them."""


def table(
    design: Design,
    trials: int = 24,
    quiet_minutes: float = 4.0,
    first_seed: int = HELD_OUT_FROM,
    windows_s: Sequence[float] = WINDOWS_S,
) -> list[Row]:
    """Delay and alarms of the detector `digital` by its window, on the same traces."""
    designs = [with_window(design, window_s) for window_s in windows_s]
    verdicts: list[list[Verdict]] = [[] for _ in designs]
    with compiled():
        for case in cases(Amount(trials, quiet_minutes), first_seed):
            if case.cause not in ("slip", *CONTACTS):
                continue
            trace, force_n = record(design, case, board=False)
            for kept, other in zip(verdicts, designs, strict=True):
                kept += judge(case, trace, force_n, DETECTOR, other, [1.0])
    totals = [Total(1.0, tuple(kept)) for kept in verdicts]
    return [
        Row(window_s, d.detector.threshold_v, t.found_share, t.delay_s(0.5), t.delay_s(0.9), t.alarms_per_minute)
        for window_s, d, t in zip(windows_s, designs, totals, strict=True)
    ]


def with_window(design: Design, window_s: float) -> Design:
    """The design with another window [s], its threshold where the rule puts it."""
    tables = design.model_dump()
    tables["detector"]["window_samples"] = max(1, round(window_s * design.detector.sample_rate_hz))
    rule = noise_level(Design(**tables)).threshold_v
    if rule > 0.0:
        tables["detector"]["threshold_v"] = rule
    return Design(**tables)
