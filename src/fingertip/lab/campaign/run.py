"""Run a campaign and pool its results: detection rate, delays and false alarms by cause, at every threshold."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import poisson_interval
from fingertip.lab.campaign.evaluate import TrialResult, evaluate, needs_board, simulate_trace
from fingertip.lab.campaign.plan import HELD_OUT_FROM, REPORTED_SEPARATELY, CampaignPlan, generate_cases
from fingertip.sim import SceneFile
from fingertip.slip import DETECTORS

SCALES = (0.7, 0.8, 0.9, 1.0, 1.15, 1.35, 1.5, 1.6, 1.8, 2.0, 2.3, 2.6, 3.0, 4.0, 6.0, 10.0)
"""Factors of each detector's threshold, from sensitive to insensitive."""
LOW_SCALES = (0.02, 0.05, 0.1, 0.2, 0.4)
"""Additional factors for detectors that read the board's envelope: a diode without bias passes so little noise that the
threshold may be far below the design's."""


def quantile_s(delays_s: Sequence[float], slips: int, fraction: float) -> float:
    """Delay by which a fraction of all slips is found [s]; infinite if fewer are found."""
    ranked = sorted(delays_s) + [math.inf] * (slips - len(delays_s))
    return float(ranked[min(len(ranked) - 1, int(fraction * len(ranked)))]) if ranked else math.inf


@dataclass(frozen=True)
class DetectorResult:
    """Pooled results of one detector at one threshold."""

    scale: float
    """Factor of the detector's threshold."""
    trials: tuple[TrialResult, ...]

    @property
    def slips(self) -> int:
        """Number of true slips."""
        return sum(t.slips for t in self.trials)

    @property
    def delays_s(self) -> list[float]:
        """Delays of all slips that were found [s]."""
        return [d for t in self.trials for d in t.delays_s]

    @property
    def found_share(self) -> float:
        """Fraction of the slips that were found."""
        return len(self.delays_s) / self.slips if self.slips else 0.0

    @property
    def share_within_30_ms(self) -> float:
        """Fraction of the slips that were found within 30 ms."""
        return sum(d < 0.03 for d in self.delays_s) / max(1, self.slips)

    def delay_s(self, fraction: float) -> float:
        """Delay by which a fraction of all slips was found [s]; infinite if fewer were found."""
        return quantile_s(self.delays_s, self.slips, fraction)

    def motion_delay_s(self, fraction: float) -> float:
        """The same delay since the robot moved [s]."""
        return quantile_s([d for t in self.trials for d in t.motion_delays_s], self.slips, fraction)

    @property
    def worst_s(self) -> float:
        """Longest delay of a slip that was found [s]; infinite if none was."""
        return max(self.delays_s, default=math.inf)

    @property
    def on_share(self) -> float:
        """Mean fraction of the slip that is ON after its detection."""
        shares = [t.on_share for t in self.trials if t.delays_s]
        return float(np.mean(shares)) if shares else 0.0

    def alarms(self) -> dict[str, int]:
        """Number of false alarms by cause."""
        causes = [cause for t in self.trials for cause in t.alarms]
        return {cause: causes.count(cause) for cause in dict.fromkeys([t.case.cause for t in self.trials] + causes)}

    def minutes(self) -> dict[str, float]:
        """Duration of the scenes by cause [min]; the trials are under ``slip``."""
        total: dict[str, float] = {}
        for t in self.trials:
            total[t.case.cause] = total.get(t.case.cause, 0.0) + t.duration_s / 60
        return total

    @property
    def limited_minutes(self) -> float:
        """Duration of all scenes but those that are reported separately [min]."""
        return sum(m for cause, m in self.minutes().items() if cause not in REPORTED_SEPARATELY)

    @property
    def limited_alarms(self) -> int:
        """Number of false alarms in them."""
        return sum(n for cause, n in self.alarms().items() if cause not in REPORTED_SEPARATELY)

    @property
    def alarms_per_minute(self) -> float:
        """False alarms per minute, in all scenes but those that are reported separately."""
        return self.limited_alarms / self.limited_minutes if self.limited_minutes else 0.0

    @property
    def alarm_interval(self) -> tuple[float, float]:
        """Interval that contains the rate of false alarms with 95 % probability [1/min]."""
        low, high = poisson_interval(self.limited_alarms)
        minutes = self.limited_minutes
        return (low / minutes, high / minutes) if minutes else (0.0, math.inf)

    def group_delays(self, key: Callable[[TrialResult], object]) -> dict[object, tuple[float, float, int]]:
        """Mean and standard deviation of the delay [s], and number of slips found, by group of trials."""
        groups: dict[object, list[float]] = {}
        for t in self.trials:
            if t.slips:
                groups.setdefault(key(t), []).extend(t.delays_s)
        return {k: (float(np.mean(d)), float(np.std(d)), len(d)) if d else (np.inf, 0.0, 0) for k, d in groups.items()}


def scene_surface(scene: SceneFile) -> str:
    """Surface of a scene, or the object that is pulled through the grasp."""
    name = scene.contact.surface
    return name if scene.name == "sliding_finger" else f"object, {name}"


def surface(trial: TrialResult) -> str:
    """Surface of a trial, a key for `DetectorResult.group_delays`."""
    return scene_surface(trial.case.scene)


def speed_m_s(trial: TrialResult) -> float:
    """Sliding speed of a trial [m/s], a key for `DetectorResult.group_delays`."""
    return trial.case.scene.slide.speed_m_s


@dataclass(frozen=True)
class CampaignResult:
    """Results of a campaign."""

    plan: CampaignPlan
    first_seed: int
    detectors: dict[str, tuple[DetectorResult, ...]]
    """Detector -> results by factor of the threshold, in ascending order."""

    def at_nominal_threshold(self, detector: str) -> DetectorResult:
        """Result of a detector at its nominal threshold, with the factor 1."""
        return next(result for result in self.detectors[detector] if result.scale == 1.0)

    def at_alarm_rate(self, detector: str, max_alarms_per_minute: float) -> DetectorResult | None:
        """Result of a detector at the lowest threshold that keeps a rate of false alarms; None if none keeps it."""
        quiet = (r for r in self.detectors[detector] if r.alarms_per_minute <= max_alarms_per_minute)
        return next(quiet, None)


def run_campaign(
    design: Design,
    plan: CampaignPlan,
    detectors: Sequence[str] = tuple(DETECTORS),
    scales: Sequence[float] = SCALES,
    progress: Callable[[str], None] = lambda _: None,
    first_seed: int = HELD_OUT_FROM,
    advance: Callable[[float], None] = lambda _: None,
) -> CampaignResult:
    """Simulate every case once and evaluate every detector on it."""
    scales = sorted({1.0, *scales})
    factors = {name: sorted({*(LOW_SCALES if needs_board(name) else ()), *scales}) for name in detectors}
    trials: dict[str, list[list[TrialResult]]] = {name: [[] for _ in factors[name]] for name in detectors}
    with compiled(progress):
        cases = list(generate_cases(plan, first_seed))
        for i, case in enumerate(cases):
            advance(i / len(cases))
            trace, force_n = simulate_trace(design, case, detectors)
            for name in detectors:
                results = evaluate(case, trace, force_n, name, design, factors[name])
                for collected, result in zip(trials[name], results, strict=True):
                    collected.append(result)
    pooled = {
        name: tuple(
            DetectorResult(scale, tuple(collected))
            for scale, collected in zip(factors[name], trials[name], strict=True)
        )
        for name in detectors
    }
    return CampaignResult(plan, first_seed, pooled)
