"""Campaign of simulated trials: the recording of each case, what a
detector makes of it, and the pooled results.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation.numerics import Array, binomial_interval, poisson_interval, quantile_ranks
from fingertip.foundation.workers import call_each
from fingertip.lab.campaign.campaign import (
    HELD_OUT_FROM,
    REPORTED_SEPARATELY,
    CampaignPlan,
    Case,
    generate_cases,
)
from fingertip.sim import run_scene
from fingertip.sim.runs.scene import SceneRun
from fingertip.sim.signal.grid import Grid
from fingertip.slip.detectors import registry
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.fast import FastDetector, FastOutput
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import INCIPIENT_S, Interval, intervals, score

SAME_EVENT_S = 0.1
"""Alarms closer together than this count as one: a hand would react to one event once.
Assumption.
"""
VIBRATION_HZ = 30.0
"""Frequency from which changes of the force count as vibration
[Hz]: contacts lie below it (article, III.A).
"""
SCALES = (0.7, 0.8, 0.9, 1.0, 1.15, 1.35, 1.5, 1.6, 1.8, 2.0, 2.3, 2.6, 3.0, 4.0, 6.0, 10.0)
"""Factors of each detector's threshold, from sensitive to insensitive."""
LOW_SCALES = (0.02, 0.05, 0.1, 0.2, 0.4)
"""Further factors for the board's envelope: a diode without bias passes very little noise."""


@dataclass(frozen=True)
class TrialResult:
    case: Case
    duration_s: float
    slips: int
    delays_s: tuple[float, ...]
    """Delays of the slips that were found [s]; 0 in incipient slip. A detector that was ON before a
    slip did not find it: that is a false alarm.
    """
    on_share: float
    """Fraction of the time from the first detection to the slip's
    end that is ON; 0 if there is no detection.
    """
    alarms: tuple[str, ...]
    """Causes of the false alarms, one for each."""
    creep_s: float = 0.0
    """Time from the start of the robot's motion to the onset of the first slip [s]: the article
    counts delays from a robot's motion, which its encoders show late
    (`fingertip.slip.traces.truth`).
    """
    motion_s: float | None = None
    """Start of the robot's motion in the recording [s]; None if it does not move."""
    clip_share: float | None = None
    """Share of the slip in which the board clips; None without
    slip, or where no detector reads the board.
    """

    @property
    def motion_delays_s(self) -> tuple[float, ...]:
        """Delays of the slips that were found, since the robot moved [s]."""
        return tuple(delay + self.creep_s for delay in self.delays_s)


def simulate_trace(
    design: Design, case: Case, detectors: Sequence[str], grid: Grid | None = None
) -> Trace:
    """Simulate the recording of a case, through the ADC."""
    outputs = ["voltage_v", "force_n", "slip", *select_board_outputs(design, detectors)]
    return run_scene(
        design, case.scene.model_copy(update={"outputs": outputs}), case.seed, grid=grid
    ).trace


def select_board_outputs(design: Design, detectors: Sequence[str]) -> list[str]:
    """Select the sampled outputs of the board that detectors read, beside the tactile voltage."""
    columns = {registry.find_detector_type(name).input_column for name in detectors}
    columns |= {registry.find_second_column(design, name) or "voltage_v" for name in detectors}
    return [f"sampled_{name}" for name in sorted(columns - {"voltage_v"})]


def evaluate(
    case: Case,
    trace: Trace,
    detector: str,
    design: Design,
    scales: Sequence[float],
    fast_runs: dict[float, FastOutput] | None = None,
) -> list[TrialResult]:
    """Run a detector on a trace, for each factor of its threshold; a constant one needs a single
    run.

    `fast_runs` keeps by factor what `fast` gave on this trace: `incipient` is another operating
    point of the same run.
    """
    runs = {} if fast_runs is None else fast_runs
    nominal = registry.make_detector(detector, design)
    inputs = registry.select_inputs(trace, detector)
    output = _process(nominal, inputs, 1.0, runs)
    constant = float(np.ptp(output.threshold_v)) == 0.0
    found: dict[float, TrialResult] = {}
    is_off = False  # at a factor, and then at all greater ones

    for scale in sorted(scales):
        if not is_off:
            if constant or scale == 1.0:
                on = output.on if scale == 1.0 else output.statistic_v > scale * output.threshold_v
                is_off = constant and not on.any()
            else:
                scaled = registry.make_detector(detector, design, threshold_scale=scale)
                on = _process(scaled, inputs, scale, runs).on
                is_off = isinstance(scaled, FastDetector) and scaled.is_off_beyond(runs[scale])

            result = score_trial(case, trace, on, nominal.memory_s)

        found[scale] = result

    return [found[scale] for scale in scales]


def _process(
    detector: Detector,
    inputs: tuple[Array, ...],
    scale: float,
    runs: dict[float, FastOutput],
) -> DetectorOutput:
    if not isinstance(detector, FastDetector):
        return detector.process(*inputs)
    if scale not in runs:
        runs[scale] = FastDetector.process(detector, *inputs)

    return detector.select(runs[scale])


def score_trial(case: Case, trace: Trace, on: NDArray[np.bool_], memory_s: float) -> TrialResult:
    """Score the flags of a detector, whose ON may outlast a slip
    by its memory [s], against the true slip.
    """
    assert trace.slip is not None
    scored = score(intervals(trace.time_s, on), intervals(trace.time_s, trace.slip), memory_s)
    # A detector that responds to incipient slip gains no negative delay by that: its delay is 0.
    counted = [0.0 if d is not None and -INCIPIENT_S <= d < 0.0 else d for d in scored.delays_s]
    delays = tuple(d for d in counted if d is not None and d >= 0.0)
    on_share = 0.0

    if delays:
        slip, delay = next(
            (s, d) for s, d in zip(scored.slips, counted, strict=True) if d in delays
        )
        since = (trace.time_s >= slip.onset_s + (delay or 0.0)) & (trace.time_s < slip.end_s)
        on_share = float(np.mean(on[since])) if since.any() else 0.0

    alarms = [case.cause] * len(false := separate_events(scored.false_intervals))
    if case.cause == "slip":  # contact or grasp before the slip, and release after it
        first_s = scored.slips[0].onset_s if scored.slips else -math.inf
        alarms = ["contact" if alarm.onset_s < first_s else "release" for alarm in false]

    alarms += ["before slip" for d in counted if d is not None and d < 0.0]
    duration = float(trace.time_s[-1] - trace.time_s[0])
    motion_s = trace.origin.motion_s
    creep = (
        max(0.0, scored.slips[0].onset_s - motion_s)
        if scored.slips and motion_s is not None
        else 0.0
    )

    return TrialResult(
        case=case,
        duration_s=duration,
        slips=len(scored.slips),
        delays_s=delays,
        on_share=on_share,
        alarms=tuple(alarms),
        creep_s=creep,
        motion_s=motion_s,
        clip_share=trace.origin.clip_share,
    )


def separate_events(alarms: Iterable[Interval]) -> list[Interval]:
    """Keep the first alarm of each event."""
    kept: list[Interval] = []
    end = -np.inf

    for alarm in alarms:
        if alarm.onset_s - end > SAME_EVENT_S:
            kept.append(alarm)

        end = alarm.end_s

    return kept


def find_onset_s(design: Design, case: Case, trace: Trace) -> float:
    """Find the first true slip of a trial [s], counted from the
    start of the slide; NaN without slip or slide.
    """
    slide = SceneRun(design, case.scene, case.seed).timeline.slide
    if slide is None or trace.slip is None or not trace.slip.any():
        return math.nan

    return float(trace.time_s[np.argmax(trace.slip)]) - slide.start_s


def measure_vibration_n(trace: Trace) -> float:
    """Measure the RMS vibration of the normal force, beyond a
    period's mean, in slip [N]; NaN without slip.
    """
    if trace.force_n is None or trace.slip is None or not trace.slip.any():
        return math.nan

    slipping = np.flatnonzero(trace.slip)
    width = min(
        max(1, round(1 / (VIBRATION_HZ * float(trace.time_s[1] - trace.time_s[0])))),
        len(trace.force_n),
    )
    fast_n = trace.force_n - np.convolve(trace.force_n, np.full(width, 1 / width), "same")
    return float(np.sqrt(np.mean(fast_n[slipping[0] : slipping[-1] + 1] ** 2)))


def measure_out_of_contact_share(trace: Trace) -> float:
    """Measure the share of the slip in which the pad does not touch; NaN without slip."""
    if trace.force_n is None or trace.slip is None or not trace.slip.any():
        return math.nan

    return float(np.mean(trace.force_n[trace.slip] <= 0.0))


def median_of_known(values: Iterable[float]) -> float:
    """Median of those values that are finite; NaN if none is."""
    known = [value for value in values if math.isfinite(value)]
    return float(np.median(known)) if known else math.nan


def quantile_s(delays_s: Sequence[float], slips: int, fraction: float) -> float:
    """Upper quantile: smallest delay within which more than a fraction of all slips is found [s],
    or all for 1.

    Infinite if fewer are found.
    """
    ranked = sorted(delays_s) + [math.inf] * (slips - len(delays_s))
    return float(ranked[min(len(ranked) - 1, int(fraction * len(ranked)))]) if ranked else math.inf


def quantile_interval_s(
    delays_s: Sequence[float], slips: int, fraction: float
) -> tuple[float, float]:
    """Interval that holds a quantile with 95 %, from order statistics [s]."""
    low, high = quantile_ranks(slips, fraction)
    ranked = [0.0, *sorted(delays_s), *[math.inf] * (slips + 1 - len(delays_s))]
    return ranked[low + 1], ranked[high + 1]


@dataclass(frozen=True)
class DetectorResult:
    """Pooled results of one detector at one threshold."""

    scale: float
    trials: tuple[TrialResult, ...]

    @property
    def slips(self) -> int:
        return sum(t.slips for t in self.trials)

    @property
    def delays_s(self) -> list[float]:
        return [d for t in self.trials for d in t.delays_s]

    @property
    def found_share(self) -> float:
        return len(self.delays_s) / self.slips if self.slips else 0.0

    @property
    def found_interval(self) -> tuple[float, float]:
        """Interval that contains the share of slips found with 95 % probability."""
        return binomial_interval(len(self.delays_s), self.slips)

    def delay_interval(self, fraction: float) -> tuple[float, float]:
        """Interval that contains a quantile of the delay with 95 %
        probability [s]; infinite: too few were found.
        """
        return quantile_interval_s(self.delays_s, self.slips, fraction)

    def motion_delay_interval(self, fraction: float) -> tuple[float, float]:
        return quantile_interval_s(
            [d for t in self.trials for d in t.motion_delays_s], self.slips, fraction
        )

    @property
    def clip_share(self) -> float:
        """Mean share of the slides in which the board clips; NaN if it is not known."""
        known = [t.clip_share for t in self.trials if t.clip_share is not None]
        return float(np.mean(known)) if known else math.nan

    @property
    def share_within_30_ms(self) -> float:
        return sum(d < 0.03 for d in self.delays_s) / max(1, self.slips)

    def delay_s(self, fraction: float) -> float:
        return quantile_s(self.delays_s, self.slips, fraction)

    def motion_delay_s(self, fraction: float) -> float:
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
        causes = [cause for t in self.trials for cause in t.alarms]
        return {
            cause: causes.count(cause)
            for cause in dict.fromkeys([t.case.cause for t in self.trials] + causes)
        }

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

    def group_delays(
        self, key: Callable[[TrialResult], object]
    ) -> dict[object, tuple[float, float, int]]:
        """Mean and standard deviation of the delay [s], and
        number of slips found, by group of trials.
        """
        groups: dict[object, list[float]] = {}
        for t in self.trials:
            if t.slips:
                groups.setdefault(key(t), []).extend(t.delays_s)

        return {
            k: (float(np.mean(d)), float(np.std(d)), len(d)) if d else (np.inf, 0.0, 0)
            for k, d in groups.items()
        }


def surface(trial: TrialResult) -> str:
    """Surface of a trial, or the object that is pulled through the grasp; a key for
    `DetectorResult.group_delays`.
    """
    scene = trial.case.scene
    return (
        scene.contact.surface
        if scene.name == "sliding_finger"
        else f"object, {scene.contact.surface}"
    )


def speed_m_s(trial: TrialResult) -> float:
    """Sliding speed of a trial [m/s], a key for `DetectorResult.group_delays`."""
    return trial.case.scene.slide.speed_m_s


@dataclass(frozen=True)
class CampaignResult:
    plan: CampaignPlan
    first_seed: int
    detectors: dict[str, tuple[DetectorResult, ...]]
    """Detector -> results by factor of the threshold, in ascending order."""

    def at_nominal_threshold(self, detector: str) -> DetectorResult:
        return next(result for result in self.detectors[detector] if result.scale == 1.0)

    def at_alarm_rate(self, detector: str, max_alarms_per_minute: float) -> DetectorResult | None:
        """Result of a detector at the lowest threshold that keeps a
        rate of false alarms; None if none keeps it.
        """
        return next(
            (r for r in self.detectors[detector] if r.alarms_per_minute <= max_alarms_per_minute),
            None,
        )


def run_campaign(
    design: Design,
    plan: CampaignPlan,
    detectors: Sequence[str] = tuple(registry.DETECTORS),
    scales: Sequence[float] = SCALES,
    first_seed: int = HELD_OUT_FROM,
    advance: Callable[[float], None] = lambda _: None,
) -> CampaignResult:
    """Simulate every case once and evaluate every detector on it."""
    scales = sorted({1.0, *scales})
    low = {
        name: LOW_SCALES if registry.find_detector_type(name).takes_envelope else ()
        for name in detectors
    }
    factors = {name: sorted({*low[name], *scales}) for name in detectors}
    results = run_cases(design, list(generate_cases(plan, first_seed)), factors, advance)

    return CampaignResult(plan, first_seed, results)


def run_cases(
    design: Design,
    cases: Sequence[Case],
    factors: Mapping[str, Sequence[float]],
    advance: Callable[[float], None] = lambda _: None,
) -> dict[str, tuple[DetectorResult, ...]]:
    """Simulate cases and evaluate each detector on them at some factors of its threshold."""
    trials = []
    for i, found in enumerate(
        call_each(partial(_run_case, design, case, factors) for case in cases)
    ):
        trials.append(found)
        advance((i + 1) / len(cases))

    return {
        name: tuple(
            map(DetectorResult, scales, zip(*(found[name] for found in trials), strict=True))
        )
        for name, scales in factors.items()
    }


def _run_case(
    design: Design, case: Case, factors: Mapping[str, Sequence[float]]
) -> dict[str, list[TrialResult]]:
    trace = simulate_trace(design, case, tuple(factors))
    runs = dict[float, FastOutput]()
    return {
        name: evaluate(
            case,
            trace=trace,
            detector=name,
            design=design,
            scales=scales,
            fast_runs=runs,
        )
        for name, scales in factors.items()
    }
