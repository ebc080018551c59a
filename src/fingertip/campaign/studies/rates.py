"""The delay of `fast` by how often the converter is read: its noise is spread over half the sampling rate.

The converter's noise is the same at every reading (`detector.noise_v`), so ten times the readings leave a tenth of its
power in the band of slip. The article's converter (NI 6002) gives 50 000 readings a second in all; the article took
2 000. `fast` takes its bars from the noise, so it needs no other threshold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fingertip.campaign.judge import Verdict, judge
from fingertip.campaign.plan import APART, HELD_OUT_FROM, Amount, cases
from fingertip.campaign.record import record
from fingertip.campaign.studies.limit import limits_s, quantile_s
from fingertip.campaign.study import Total
from fingertip.design import Design
from fingertip.errors import DesignError
from fingertip.sim.jit import compiled
from fingertip.slip.traces.rate import at_rate

RATES_HZ = (2000.0, 5000.0, 10_000.0, 20_000.0)
DETECTOR = "fast"


@dataclass(frozen=True)
class Rate:
    """One sampling rate."""

    sample_rate_hz: float
    limit_median_s: float
    """Lorden's bound (`fingertip.campaign.studies.limit`)."""
    limit_p90_s: float
    found_share: float
    median_s: float
    """Infinite if fewer than half were found."""
    p90_s: float
    alarms_per_minute: float


def rates(
    design: Design,
    trials: int = 24,
    quiet_minutes: float = 4.0,
    first_seed: int = HELD_OUT_FROM,
    rates_hz: Sequence[float] = RATES_HZ,
) -> list[Rate]:
    """The same trials and quiet scenes at each rate, and at the design's own if it is another; rates that the design
    cannot have are left out."""
    amount, found = Amount(trials, quiet_minutes), []
    for rate in sorted({*rates_hz, design.detector.sample_rate_hz}):
        try:
            sampled = at_rate(design, rate)
        except DesignError:
            continue
        verdicts: list[Verdict] = []
        with compiled():
            for case in cases(amount, first_seed):
                if case.cause not in APART:
                    trace, force_n = record(sampled, case, board=False)
                    verdicts += judge(case, trace, force_n, DETECTOR, sampled, [1.0])
        total, bounds = Total(1.0, tuple(verdicts)), limits_s(sampled, amount, first_seed)
        found.append(
            Rate(
                rate, quantile_s(bounds, len(bounds), 0.5), quantile_s(bounds, len(bounds), 0.9),
                total.found_share, total.delay_s(0.5), total.delay_s(0.9), total.alarms_per_minute,
            )
        )  # fmt: skip
    return found
