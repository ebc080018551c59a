"""Delay of `fast` by sampling rate: the ADC's noise is spread over half the sampling rate.

The ADC's noise is the same at every conversion (`detector.noise_v`), so ten times the sampling rate leaves a tenth of
its power in the band of slip. The article's ADC (NI 6002) makes 50 000 conversions a second in total; the article used
2 000. `fast` derives its thresholds from the noise, so it needs no other threshold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fingertip.campaign.evaluate import TrialResult, evaluate, simulate_trace
from fingertip.campaign.plan import HELD_OUT_FROM, REPORTED_SEPARATELY, CampaignPlan, generate_cases
from fingertip.campaign.run import DetectorResult, quantile_s
from fingertip.campaign.studies.detection_bound import compute_bounds_s
from fingertip.design import Design
from fingertip.errors import DesignError
from fingertip.jit import compiled
from fingertip.slip.rate_adaptation import adapt_rate

RATES_HZ = (2000.0, 5000.0, 10_000.0, 20_000.0)
DETECTOR = "fast"


@dataclass(frozen=True)
class SamplingRateResult:
    """Result at one sampling rate."""

    sample_rate_hz: float
    bound_median_s: float
    """Median of Lorden's bound (`fingertip.campaign.studies.detection_bound`) [s]."""
    bound_p90_s: float
    """90th percentile of Lorden's bound [s]."""
    found_share: float
    median_s: float
    """Median delay [s]; infinite if fewer than half of the slips were found."""
    p90_s: float
    alarms_per_minute: float


def study_sampling_rates(
    design: Design,
    trials: int = 24,
    negative_minutes: float = 4.0,
    first_seed: int = HELD_OUT_FROM,
    rates_hz: Sequence[float] = RATES_HZ,
) -> list[SamplingRateResult]:
    """Run the same cases at each rate, and at the design's own rate if it is another.

    Rates that the design cannot have are omitted.
    """
    plan, results = CampaignPlan(trials, negative_minutes), []
    for rate in sorted({*rates_hz, design.detector.sample_rate_hz}):
        try:
            adapted = adapt_rate(design, rate)
        except DesignError:
            continue
        collected: list[TrialResult] = []
        with compiled():
            for case in generate_cases(plan, first_seed):
                if case.cause not in REPORTED_SEPARATELY:
                    trace, force_n = simulate_trace(adapted, case, [DETECTOR])
                    collected += evaluate(case, trace, force_n, DETECTOR, adapted, [1.0])
        pooled, bounds = DetectorResult(1.0, tuple(collected)), compute_bounds_s(adapted, plan, first_seed)
        results.append(
            SamplingRateResult(
                rate, quantile_s(bounds, len(bounds), 0.5), quantile_s(bounds, len(bounds), 0.9),
                pooled.found_share, pooled.delay_s(0.5), pooled.delay_s(0.9), pooled.alarms_per_minute,
            )
        )  # fmt: skip
    return results
