"""Run of a campaign: the recording of each case, what a detector finds in it, and the results."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain

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
from fingertip.sim.runs.scene import SceneRun, run_scene
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
"""Least frequency of vibration [Hz]; the force of contacts changes more slowly (article, III.A)."""
SCALES = (0.7, 0.8, 0.9, 1.0, 1.15, 1.35, 1.5, 1.6, 1.8, 2.0, 2.3, 2.6, 3.0, 4.0, 6.0, 10.0)
"""Factors of each detector's threshold, from sensitive to insensitive."""
LOW_SCALES = (0.02, 0.05, 0.1, 0.2, 0.4)
"""Further factors for the board's envelope: a diode without bias passes very little noise."""


@dataclass(frozen=True)
class TrialResult:
    """Result of one detector in the recording of one case."""

    case: Case
    duration_s: float
    slips: int
    delays_s: tuple[float, ...]
    """Delays of the slips that were found [s].
    0 in incipient slip. A detector that was ON before a slip did not find it: that is a false
    alarm.
    """
    on_share: float
    """Share of the time from the first detection to the slip's end that is ON; 0 without one."""
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
    """Share of the slip in which the board clips; None without slip, or if no detector reads it."""

    @property
    def motion_delays_s(self) -> tuple[float, ...]:
        """Delays of the slips that were found, since the robot moved [s]."""
        return tuple(delay + self.creep_s for delay in self.delays_s)


def simulate_trace(
    design: Design, case: Case, detectors: Sequence[str], grid: Grid | None = None
) -> Trace:
    """Simulate the recording of a case, through the ADC."""
    outputs = ["voltage_v", "force_n", "slip", *select_board_outputs(design, detectors)]
    scene = case.scene.model_copy(update={"outputs": outputs})
    return run_scene(design, scene, case.seed, grid=grid).trace


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
    """Run a detector on a trace for each factor of its threshold, in the order of `scales`.

    A constant threshold needs a single run. `fast_runs` stores the runs of `fast` on this trace by
    factor: `incipient` is another flag of the same run.
    """
    runs = {} if fast_runs is None else fast_runs
    nominal = registry.make_detector(detector, design)
    inputs = registry.select_inputs(trace, detector)
    output = _process(nominal, inputs, 1.0, runs)
    is_constant = float(np.ptp(output.threshold_v)) == 0.0
    results_by_scale: dict[float, TrialResult] = {}
    is_off = False  # at a factor, and then at all greater ones

    for scale in sorted(scales):
        if not is_off:
            if scale == 1.0:
                on = output.on
                is_off = is_constant and not on.any()
            elif is_constant:
                on = output.statistic_v > scale * output.threshold_v
                is_off = not on.any()
            else:
                scaled = registry.make_detector(detector, design, threshold_scale=scale)
                on = _process(scaled, inputs, scale, runs).on
                is_off = isinstance(scaled, FastDetector) and scaled.is_off_beyond(runs[scale])

            result = score_trial(case, trace, on, nominal.memory_s)

        results_by_scale[scale] = result

    return [results_by_scale[scale] for scale in scales]


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
    """Score the flags of a detector, whose ON may outlast a slip by its memory [s]."""
    assert trace.slip is not None
    scored = score(intervals(trace.time_s, on), intervals(trace.time_s, trace.slip), memory_s)
    # A detector that responds to incipient slip gains no negative delay by that: its delay is 0.
    delays = [0.0 if d is not None and -INCIPIENT_S <= d < 0.0 else d for d in scored.delays_s]
    found_after_s = tuple(d for d in delays if d is not None and d >= 0.0)

    first_onset_s = scored.slips[0].onset_s if scored.slips else -math.inf
    alarms = _name_alarms(case, separate_events(scored.false_intervals), first_onset_s)
    alarms += ["before slip" for d in delays if d is not None and d < 0.0]

    motion_s = trace.origin.motion_s
    creep_s = 0.0
    if scored.slips and motion_s is not None:
        creep_s = max(0.0, first_onset_s - motion_s)

    return TrialResult(
        case=case,
        duration_s=float(trace.time_s[-1] - trace.time_s[0]),
        slips=len(scored.slips),
        delays_s=found_after_s,
        on_share=_measure_on_share(trace, on, scored.slips, delays),
        alarms=tuple(alarms),
        creep_s=creep_s,
        motion_s=motion_s,
        clip_share=trace.origin.clip_share,
    )


def _measure_on_share(
    trace: Trace,
    on: NDArray[np.bool_],
    slips: Sequence[Interval],
    delays_s: Sequence[float | None],
) -> float:
    """Measure the share that is ON of the first slip found, from its detection to its end.

    Returns 0 if no slip was found.
    """
    for slip, delay_s in zip(slips, delays_s, strict=True):
        if delay_s is not None and delay_s >= 0.0:
            is_after = trace.time_s >= slip.onset_s + delay_s
            is_slipping = is_after & (trace.time_s < slip.end_s)
            return float(np.mean(on[is_slipping])) if is_slipping.any() else 0.0

    return 0.0


def _name_alarms(case: Case, alarms: Sequence[Interval], first_onset_s: float) -> list[str]:
    """Name the causes of false alarms; those of a trial come before its first slip, or after."""
    if case.cause != "slip":
        return [case.cause] * len(alarms)

    return ["contact" if alarm.onset_s < first_onset_s else "release" for alarm in alarms]


def separate_events(alarms: Iterable[Interval]) -> list[Interval]:
    """Return the first alarm of each event."""
    first_alarms: list[Interval] = []
    end = -np.inf

    for alarm in alarms:
        if alarm.onset_s - end > SAME_EVENT_S:
            first_alarms.append(alarm)

        end = alarm.end_s

    return first_alarms


def find_onset_s(design: Design, case: Case, trace: Trace) -> float:
    """Find the first true slip of a trial [s from the start of the slide]; NaN without one."""
    slide = SceneRun(design, case.scene, case.seed).timeline.slide
    if slide is None or trace.slip is None or not trace.slip.any():
        return math.nan

    return float(trace.time_s[np.argmax(trace.slip)]) - slide.start_s


def measure_vibration_n(trace: Trace) -> float:
    """Measure the RMS vibration of the normal force in slip [N]; NaN without slip.

    The mean over a period of `VIBRATION_HZ` is taken off.
    """
    if trace.force_n is None or trace.slip is None or not trace.slip.any():
        return math.nan

    slipping = np.flatnonzero(trace.slip)
    step_s = float(trace.time_s[1] - trace.time_s[0])
    width = min(max(1, round(1 / (VIBRATION_HZ * step_s))), len(trace.force_n))
    fast_n = trace.force_n - np.convolve(trace.force_n, np.full(width, 1 / width), "same")
    return float(np.sqrt(np.mean(fast_n[slipping[0] : slipping[-1] + 1] ** 2)))


def measure_out_of_contact_share(trace: Trace) -> float:
    """Measure the share of the slip in which the pad does not touch; NaN without slip."""
    if trace.force_n is None or trace.slip is None or not trace.slip.any():
        return math.nan

    return float(np.mean(trace.force_n[trace.slip] <= 0.0))


def median_of_known(values: Iterable[float]) -> float:
    """Return the median of the values that are finite; NaN if none is."""
    known = [value for value in values if math.isfinite(value)]
    return float(np.median(known)) if known else math.nan


def quantile_s(delays_s: Sequence[float], slips: int, fraction: float) -> float:
    """Return the least delay [s] within which more than a fraction of all slips is found.

    For a fraction of 1 all are found. The delay is infinite if fewer are found.
    """
    ranked = sorted(delays_s) + [math.inf] * (slips - len(delays_s))
    if not ranked:
        return math.inf

    return float(ranked[min(len(ranked) - 1, int(fraction * len(ranked)))])


def quantile_interval_s(
    delays_s: Sequence[float], slips: int, fraction: float
) -> tuple[float, float]:
    """Return the interval that holds a quantile with 95 %, from order statistics [s]."""
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
        return sum(trial.slips for trial in self.trials)

    @property
    def delays_s(self) -> list[float]:
        """Delays of all slips that were found [s]."""
        return list(chain.from_iterable(trial.delays_s for trial in self.trials))

    @property
    def motion_delays_s(self) -> list[float]:
        """Delays of all slips that were found, since the robot moved [s]."""
        return list(chain.from_iterable(trial.motion_delays_s for trial in self.trials))

    @property
    def found_share(self) -> float:
        return len(self.delays_s) / self.slips if self.slips else 0.0

    @property
    def found_interval(self) -> tuple[float, float]:
        """Interval that contains the share of slips found with 95 % probability."""
        return binomial_interval(len(self.delays_s), self.slips)

    def delay_interval(self, fraction: float) -> tuple[float, float]:
        """Interval that contains a quantile of the delay with 95 % probability [s].

        Its upper end is infinite if too few slips were found.
        """
        return quantile_interval_s(self.delays_s, self.slips, fraction)

    def motion_delay_interval(self, fraction: float) -> tuple[float, float]:
        """Interval that contains a quantile of the delay since motion, as `delay_interval`."""
        return quantile_interval_s(self.motion_delays_s, self.slips, fraction)

    @property
    def clip_share(self) -> float:
        """Mean share of the slides in which the board clips; NaN if it is not known."""
        known = [trial.clip_share for trial in self.trials if trial.clip_share is not None]
        return float(np.mean(known)) if known else math.nan

    @property
    def share_within_30_ms(self) -> float:
        return sum(d < 0.03 for d in self.delays_s) / max(1, self.slips)

    def delay_s(self, fraction: float) -> float:
        return quantile_s(self.delays_s, self.slips, fraction)

    def motion_delay_s(self, fraction: float) -> float:
        return quantile_s(self.motion_delays_s, self.slips, fraction)

    @property
    def worst_s(self) -> float:
        """Longest delay of a slip that was found [s]; infinite if none was."""
        return max(self.delays_s, default=math.inf)

    @property
    def on_share(self) -> float:
        """Mean fraction of the slip that is ON after its detection."""
        shares = [trial.on_share for trial in self.trials if trial.delays_s]
        return float(np.mean(shares)) if shares else 0.0

    def alarms(self) -> dict[str, int]:
        """Number of false alarms by cause; 0 for the causes of all scenes that gave none."""
        causes = list(chain.from_iterable(trial.alarms for trial in self.trials))
        scenes = [trial.case.cause for trial in self.trials]
        return {cause: causes.count(cause) for cause in dict.fromkeys(scenes + causes)}

    def minutes(self) -> dict[str, float]:
        """Duration of the scenes by cause [min]; the trials are under ``slip``."""
        minutes: dict[str, float] = {}
        for trial in self.trials:
            cause = trial.case.cause
            minutes[cause] = minutes.get(cause, 0.0) + trial.duration_s / 60

        return minutes

    @property
    def limited_minutes(self) -> float:
        """Duration of all scenes but those that are reported separately [min]."""
        minutes = self.minutes()
        return sum(minutes[cause] for cause in minutes if cause not in REPORTED_SEPARATELY)

    @property
    def limited_alarms(self) -> int:
        """Number of false alarms in these scenes."""
        alarms = self.alarms()
        return sum(alarms[cause] for cause in alarms if cause not in REPORTED_SEPARATELY)

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
        """Mean and standard deviation of the delay [s], and number of slips found, by group."""
        groups: dict[object, list[float]] = {}
        for trial in self.trials:
            if trial.slips:
                groups.setdefault(key(trial), []).extend(trial.delays_s)

        return {
            group: (float(np.mean(delays)), float(np.std(delays)), len(delays))
            if delays
            else (np.inf, 0.0, 0)
            for group, delays in groups.items()
        }


def surface(trial: TrialResult) -> str:
    """Surface of a trial, or of the object that is pulled through the grasp.

    It is a key for `DetectorResult.group_delays`.
    """
    scene = trial.case.scene
    name = scene.contact.surface
    return name if scene.name == "sliding_finger" else f"object, {name}"


def speed_m_s(trial: TrialResult) -> float:
    """Sliding speed of a trial [m/s], a key for `DetectorResult.group_delays`."""
    return trial.case.scene.slide.speed_m_s


@dataclass(frozen=True)
class CampaignResult:
    """Results of all detectors in one campaign."""

    plan: CampaignPlan
    first_seed: int
    detectors: dict[str, tuple[DetectorResult, ...]]
    """Detector -> results by factor of the threshold, in ascending order."""

    def at_nominal_threshold(self, detector: str) -> DetectorResult:
        return next(result for result in self.detectors[detector] if result.scale == 1.0)

    def at_alarm_rate(self, detector: str, max_alarms_per_minute: float) -> DetectorResult | None:
        """Result at the lowest threshold with at most this rate of false alarms, or None."""
        for result in self.detectors[detector]:
            if result.alarms_per_minute <= max_alarms_per_minute:
                return result

        return None


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
    factors = {}
    for name in detectors:
        takes_envelope = registry.find_detector_type(name).takes_envelope
        factors[name] = sorted({*LOW_SCALES, *scales}) if takes_envelope else scales
    results = run_cases(design, list(generate_cases(plan, first_seed)), factors, advance)

    return CampaignResult(plan, first_seed, results)


def run_cases(
    design: Design,
    cases: Sequence[Case],
    factors: Mapping[str, Sequence[float]],
    advance: Callable[[float], None] = lambda _: None,
) -> dict[str, tuple[DetectorResult, ...]]:
    """Simulate cases and evaluate each detector on them at some factors of its threshold."""
    runs = call_each(partial(_run_case, design, case, factors) for case in cases)
    trials_by_case = []
    for number, trials in enumerate(runs, 1):
        trials_by_case.append(trials)
        advance(number / len(cases))

    results = {}
    for name, scales in factors.items():
        trials_by_scale = zip(*(trials[name] for trials in trials_by_case), strict=True)
        results[name] = tuple(map(DetectorResult, scales, trials_by_scale))

    return results


def _run_case(
    design: Design, case: Case, factors: Mapping[str, Sequence[float]]
) -> dict[str, list[TrialResult]]:
    """Simulate a case, and evaluate each detector on it at each factor of its threshold."""
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
