"""Requirements on a design's detector, and whether a campaign met them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.lab.campaign.grip import ClosedLoopSummary
from fingertip.lab.campaign.plan import REPORTED_SEPARATELY
from fingertip.lab.campaign.run import CampaignResult, surface


@dataclass(frozen=True)
class RequirementLimits:
    """Limits for one detector. Those with a reference are the article's for its trials, others this project's."""

    min_found: float = 0.995
    """Smallest fraction of slips found (article, IV.A: all of 120)."""
    max_mean_s: float = 0.060
    """Largest mean delay on every surface [s] (article, IV.A)."""
    max_p90_s: float = 0.100
    """Largest 90th percentile of the delay [s] (article, III.A: a signal is useful below 100 ms)."""
    max_alarms_per_minute: float = 0.1
    """Largest rate of false alarms from contacts, releases, load changes and drift [1/min]."""
    min_held: float = 11 / 12
    """Smallest fraction of manipulations in which the object is held (article, IV.A: 10 of 12; one more here)."""
    max_reaction_s: float = 0.2
    """Upper bound of the time from slip until a finger moves, in all manipulations [s] (article, IV.A)."""
    max_false_grips: int = 0
    """Largest number of grip increases without slip, in all manipulations."""


@dataclass(frozen=True)
class Requirement:
    """One requirement and the measured value."""

    name: str
    value: float
    limit: float
    passed: bool
    message: str


def check_detection(result: CampaignResult, detector: str, limits: RequirementLimits) -> Iterator[Requirement]:
    """Check the requirements on detection: slips found, delays and false alarms."""
    nominal = result.at_nominal_threshold(detector)
    yield Requirement(
        "found",
        nominal.found_share,
        limits.min_found,
        nominal.found_share >= limits.min_found,
        f"{100 * nominal.found_share:.1f} % of {nominal.slips} slips found; at least {100 * limits.min_found:g} %",
    )
    means = {name: mean for name, (mean, _, _) in nominal.group_delays(surface).items()}
    worst = max(means, key=lambda name: means[name])
    yield Requirement(
        "mean delay",
        means[worst],
        limits.max_mean_s,
        means[worst] <= limits.max_mean_s,
        f"mean delay on the worst surface ({worst}) is {_ms(means[worst])}; at most {1000 * limits.max_mean_s:g} ms",
    )
    p90 = nominal.delay_s(0.9)
    yield Requirement(
        "p90 delay",
        p90,
        limits.max_p90_s,
        p90 <= limits.max_p90_s,
        f"90th percentile of the delay is {_ms(p90)}; at most {1000 * limits.max_p90_s:g} ms",
    )
    rate = nominal.alarms_per_minute
    yield Requirement(
        "alarms",
        rate,
        limits.max_alarms_per_minute,
        rate <= limits.max_alarms_per_minute,
        f"{rate:.2f} false alarms per minute, without {', '.join(REPORTED_SEPARATELY)}; at most "
        f"{limits.max_alarms_per_minute:g}",
    )


def check_closed_loop(summary: ClosedLoopSummary, limits: RequirementLimits) -> Iterator[Requirement]:
    """Check the requirements on the closed loop: objects held, reaction time and false grips."""
    held_fraction = summary.held / summary.count
    yield Requirement(
        "held",
        held_fraction,
        limits.min_held,
        held_fraction >= limits.min_held - 1e-9,
        f"{summary.held} of {summary.count} objects held; at least {100 * limits.min_held:.3g} %",
    )
    slowest = math.inf if summary.unanswered else max(summary.reactions_s, default=0.0)
    yield Requirement(
        "reaction",
        slowest,
        limits.max_reaction_s,
        slowest < limits.max_reaction_s,
        f"slowest reaction of the hand is {_ms(slowest)}; less than {1000 * limits.max_reaction_s:g} ms",
    )
    yield Requirement(
        "false grips",
        summary.false_grips,
        limits.max_false_grips,
        summary.false_grips <= limits.max_false_grips,
        f"{summary.false_grips} grip increases without slip; at most {limits.max_false_grips}",
    )


def _ms(seconds: float) -> str:
    return f"{1000 * seconds:.1f} ms" if math.isfinite(seconds) else "infinite"
