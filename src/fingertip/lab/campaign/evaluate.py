"""One case of a campaign: its simulated recording, and the result of a detector on it at several thresholds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.lab.campaign.plan import Case
from fingertip.sim import run_scene
from fingertip.sim.scene.run import SceneRun
from fingertip.slip import DETECTORS, Trace, make_detector
from fingertip.slip.detectors.registry import find_second_column, select_inputs
from fingertip.slip.traces.intervals import INCIPIENT_S, Interval, intervals, score

SAME_EVENT_S = 0.1
"""Alarms closer together than this count as one: a hand would react to one event once. Assumption."""


@dataclass(frozen=True)
class TrialResult:
    """Result of a detector on one case."""

    case: Case
    duration_s: float
    force_n: float
    """Holding force [N]."""
    slips: int
    """Number of true slips."""
    delays_s: tuple[float, ...]
    """Delays of the slips that were found [s]; 0 in incipient slip. A detector that was ON before a slip did not find
    it: that is a false alarm."""
    on_share: float
    """Fraction of the time from the first detection to the slip's end that is ON; 0 if there is no detection."""
    alarms: tuple[str, ...]
    """Causes of the false alarms, one for each."""
    creep_s: float = 0.0
    """Time from the start of the robot's motion to the onset of the first slip [s]: the article counts delays from a
    robot's motion, which its encoders show late (`fingertip.slip.traces.origin`)."""
    motion_s: float | None = None
    """Start of the robot's motion in the recording [s]; None if it does not move."""

    @property
    def motion_delays_s(self) -> tuple[float, ...]:
        """Delays of the slips that were found, since the robot moved [s]."""
        return tuple(delay + self.creep_s for delay in self.delays_s)


def simulate_trace(design: Design, case: Case, detectors: Sequence[str]) -> tuple[Trace, float]:
    """Simulate the recording of a case, through the ADC. Returns holding force [N]."""
    outputs = ["voltage_v", "force_n", "slip", *select_board_outputs(design, detectors)]
    result = run_scene(design, case.scene.model_copy(update={"outputs": outputs}), case.seed)
    return result.trace, result.force_n


def select_board_outputs(design: Design, detectors: Sequence[str]) -> list[str]:
    """Select the sampled outputs of the board that detectors read, beside the tactile voltage."""
    columns = {DETECTORS[name].input_column for name in detectors}
    columns |= {find_second_column(design, name) or "voltage_v" for name in detectors}
    return [f"sampled_{name}" for name in sorted(columns - {"voltage_v"})]


def needs_board(*detectors: str) -> bool:
    """Return whether any of the detectors reads the board's envelope."""
    return any(DETECTORS[name].input_column == "envelope_v" for name in detectors)


def evaluate(
    case: Case, trace: Trace, force_n: float, detector: str, design: Design, scales: Sequence[float]
) -> list[TrialResult]:
    """Run a detector on a trace and return one result for each factor of its threshold.

    Where the threshold is constant, the test statistic is the same for every factor and is computed once.
    """
    nominal, inputs = make_detector(detector, design), select_inputs(trace, detector)
    output = nominal.process(*inputs)
    constant = float(np.ptp(output.threshold_v)) == 0.0
    results = []
    for scale in scales:
        if scale == 1.0:
            on = output.on
        elif constant:
            on = output.statistic_v > scale * output.threshold_v
        else:
            on = make_detector(detector, design, threshold_scale=scale).process(*inputs).on
        results.append(_score_trial(case, trace, force_n, on, nominal.memory_s))
    return results


def _score_trial(case: Case, trace: Trace, force_n: float, on: NDArray[np.bool_], memory_s: float) -> TrialResult:
    assert trace.slip is not None
    scored = score(intervals(trace.time_s, on), intervals(trace.time_s, trace.slip), memory_s)
    # A detector that responds to incipient slip gains no negative delay by that: its delay is 0.
    counted = [0.0 if d is not None and -INCIPIENT_S <= d < 0.0 else d for d in scored.delays_s]
    delays = tuple(d for d in counted if d is not None and d >= 0.0)
    early = [d for d in counted if d is not None and d < 0.0]
    on_share = 0.0
    if delays:
        slip, delay = next((s, d) for s, d in zip(scored.slips, counted, strict=True) if d in delays)
        since = (trace.time_s >= slip.onset_s + (delay or 0.0)) & (trace.time_s < slip.end_s)
        on_share = float(np.mean(on[since])) if since.any() else 0.0
    alarms = [_find_cause(case, alarm, scored.slips) for alarm in separate_events(scored.false_intervals)]
    alarms += ["before slip"] * len(early)
    duration = float(trace.time_s[-1] - trace.time_s[0])
    motion_s = trace.origin.motion_s
    creep = max(0.0, scored.slips[0].onset_s - motion_s) if scored.slips and motion_s is not None else 0.0
    return TrialResult(case, duration, force_n, len(scored.slips), delays, on_share, tuple(alarms), creep, motion_s)


def separate_events(alarms: Iterable[Interval]) -> list[Interval]:
    """Keep the first alarm of each event."""
    kept: list[Interval] = []
    end = -np.inf
    for alarm in alarms:
        if alarm.onset_s - end > SAME_EVENT_S:
            kept.append(alarm)
        end = alarm.end_s
    return kept


def _find_cause(case: Case, alarm: Interval, slips: Sequence[Interval]) -> str:
    """Cause of an alarm; in a trial, contact or grasp before the slip, and release after it."""
    if case.cause != "slip":
        return case.cause
    return "contact" if slips and alarm.onset_s < slips[0].onset_s else "release"


# True slip in a simulated recording: its onset, and the vibration of the pad in it.


VIBRATION_HZ = 30.0
"""Frequency from which changes of the force count as vibration [Hz]: contacts lie below it (article, III.A)."""


def find_onset_s(design: Design, case: Case, trace: Trace) -> float:
    """Find the first true slip of a trial [s], counted from the start of the slide; NaN without slip or slide."""
    slide = SceneRun(design, case.scene, case.seed).timeline.slide
    if slide is None or trace.slip is None or not trace.slip.any():
        return math.nan
    return float(trace.time_s[np.argmax(trace.slip)]) - slide.start_s


def measure_vibration_n(trace: Trace) -> float:
    """Measure the RMS vibration of the true normal force from the first to the last slip [N]; NaN without slip.

    What a mean over one period of `VIBRATION_HZ` follows is no vibration.
    """
    if trace.force_n is None or trace.slip is None or not trace.slip.any():
        return math.nan
    slipping = np.flatnonzero(trace.slip)
    width = min(max(1, round(1 / (VIBRATION_HZ * float(trace.time_s[1] - trace.time_s[0])))), len(trace.force_n))
    fast_n = trace.force_n - np.convolve(trace.force_n, np.full(width, 1 / width), "same")
    return float(np.sqrt(np.mean(fast_n[slipping[0] : slipping[-1] + 1] ** 2)))


def median_of_known(values: Iterable[float]) -> float:
    """Median of those values that are finite; NaN if none is."""
    known = [value for value in values if math.isfinite(value)]
    return float(np.median(known)) if known else math.nan
