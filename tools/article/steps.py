"""Sensitivity of signals and delays to the time step, and of the delay to the sampling rate.

The same trials run on the shipped grid and on a much finer one, which stands for the limit of
vanishing steps. Noise is drawn on the base grid and stays the same, so every difference is an error
of the step.

The ADC's noise is the same at every conversion (`detector.noise_v`), so ten times the sampling rate
leaves a tenth of its power in the band of slip. The article's ADC (NI 6002) makes 50 000
conversions a second in total; the article used 2 000. `fast` derives its thresholds from the noise,
so it needs no other threshold.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from fingertip.design import Design
from fingertip.detection.adaptation import adapt_rate
from fingertip.foundation.errors import DesignError
from fingertip.foundation.workers import call_each
from fingertip.lab.campaign.campaign import (
    HELD_OUT_FROM,
    REPORTED_SEPARATELY,
    CampaignPlan,
    Case,
    generate_cases,
)
from fingertip.lab.campaign.run import evaluate, quantile_s, run_cases, select_board_outputs
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.signal.grid import Grid
from fingertip.slip.detectors.registry import DETECTORS


def generate_limited_cases(plan: CampaignPlan) -> Iterator[Case]:
    """Generate those of all cases whose alarms a requirement limits."""
    return (case for case in generate_cases(plan) if case.cause not in REPORTED_SEPARATELY)


def generate_trials(trials: int, first_seed: int = HELD_OUT_FROM) -> Iterator[Case]:
    return (
        case
        for case in generate_cases(CampaignPlan(trials, 0.5), first_seed)
        if case.cause == "slip"
    )


STEPS_COMPARED = 16
"""Number of steps of the finer grid per step of the shipped one."""
COMPARED = ("force_n", "voltage_v", "envelope_v")


def compare_grids(
    design: Design,
    case: Case,
    detectors: Sequence[str] = tuple(DETECTORS),
    refinement: int = STEPS_COMPARED,
) -> tuple[dict[str, float], dict[str, float]]:
    """Run one trial on the shipped grid and on a finer one, with the same noise.

    Returns by signal the largest difference, in the signal's unit, and by detector the shift of the
    delay [samples]: infinite if slips are found on one grid only, NaN if on neither.
    """
    sampled = select_board_outputs(design, detectors)
    signals = COMPARED if design.board.has_filter else COMPARED[:2]
    scene = case.scene.model_copy(update={"outputs": ["slip", *signals, *sampled]})
    pair = [run_scene(design, scene, case.seed, grid=Grid(parts)) for parts in (1, refinement)]
    errors = {
        name: float(np.max(np.abs(pair[0].columns[name] - pair[1].columns[name])))
        for name in signals
    }
    rate = design.detector.sample_rate_hz
    delays = {
        name: [
            evaluate(
                case,
                trace=one.trace,
                detector=name,
                design=design,
                scales=[1.0],
            )[0].delays_s
            for one in pair
        ]
        for name in detectors
    }

    return errors, {name: rate * _find_shift_s(*both) for name, both in delays.items()}


def _find_shift_s(coarse_s: Sequence[float], fine_s: Sequence[float]) -> float:
    """Largest shift of a delay [s]; infinite if the numbers of
    slips found differ, NaN if there are none.
    """
    if len(coarse_s) != len(fine_s):
        return math.inf

    return max((abs(a - b) for a, b in zip(coarse_s, fine_s, strict=True)), default=math.nan)


MAX_SHIFT_SAMPLES = 1.0
"""Shift of a delay that the goal permits [samples]: a sample is the resolution of every
detector.
"""
GOAL_SHARE = 0.95
"""Fraction of the trials whose delay must not shift by more than that. Goal of this project."""
_ROUNDING = 1e-6


@dataclass(frozen=True)
class DelayShift:
    detector: str
    trials: int
    """Number of trials in which slip was found on either grid."""
    beyond_sample: int
    """Number of them with a shift beyond one sample."""
    one_grid_only: int
    """Number of them in which slip was found on one grid only; they count as beyond one sample."""
    median_s: float
    p90_s: float
    worst_s: float

    @property
    def meets_goal(self) -> bool:
        """True if few enough trials shift by more than one sample."""
        return self.beyond_sample <= (1 - GOAL_SHARE) * self.trials + _ROUNDING


@dataclass(frozen=True)
class SignalError:
    """Largest error of a signal in a trial, over all trials, in the signal's unit."""

    signal: str
    median: float
    p90: float
    worst: float


@dataclass(frozen=True)
class StepSensitivity:
    """Effect of the time step on trials with slip."""

    trials: int
    refinement: int
    shifts: tuple[DelayShift, ...]
    errors: tuple[SignalError, ...]


def study_steps(design: Design, trials: int) -> StepSensitivity:
    """Compare both grids on the article's trials."""
    differences = list(
        call_each(partial(compare_grids, design, case) for case in generate_trials(trials))
    )
    rate = design.detector.sample_rate_hz
    shifts = tuple(
        _pool_shifts(name, [samples[name] for _, samples in differences], rate)
        for name in DETECTORS
    )
    errors = []

    for name in COMPARED:
        values = [largest[name] for largest, _ in differences]
        median, p90 = (float(np.quantile(values, q, method="higher")) for q in (0.5, 0.9))
        errors.append(SignalError(name, median, p90, max(values)))

    return StepSensitivity(len(differences), STEPS_COMPARED, shifts, tuple(errors))


def _pool_shifts(detector: str, shifts_samples: Sequence[float], rate_hz: float) -> DelayShift:
    found = [shift for shift in shifts_samples if not math.isnan(shift)]
    beyond = sum(shift > MAX_SHIFT_SAMPLES + _ROUNDING for shift in found)
    median_s, p90_s = (
        quantile_s(found, len(found), q) / rate_hz if found else 0.0 for q in (0.5, 0.9)
    )
    worst_s = max(found, default=0.0) / rate_hz

    return DelayShift(
        detector=detector,
        trials=len(found),
        beyond_sample=beyond,
        one_grid_only=sum(map(math.isinf, found)),
        median_s=median_s,
        p90_s=p90_s,
        worst_s=worst_s,
    )


RATES_HZ = (2000.0, 5000.0, 10_000.0, 20_000.0)
DETECTOR = "fast"


@dataclass(frozen=True)
class SamplingRateResult:
    sample_rate_hz: float
    found_share: float
    median_s: float
    """Infinite if fewer than half of the slips were found."""
    p90_s: float
    alarms_per_minute: float


def study_sampling_rates(
    design: Design,
    trials: int = 24,
    negative_minutes: float = 4.0,
    rates_hz: Sequence[float] = RATES_HZ,
) -> list[SamplingRateResult]:
    """Run the same cases at each rate that the design can have, and at its own."""
    plan = CampaignPlan(trials, negative_minutes)
    results = []

    for rate in sorted({*rates_hz, design.detector.sample_rate_hz}):
        try:
            adapted = adapt_rate(design, rate)
        except DesignError:
            continue

        (pooled,) = run_cases(adapted, list(generate_limited_cases(plan)), {DETECTOR: (1.0,)})[
            DETECTOR
        ]
        found = (
            pooled.found_share,
            pooled.delay_s(0.5),
            pooled.delay_s(0.9),
            pooled.alarms_per_minute,
        )
        results.append(SamplingRateResult(rate, *found))

    return results
