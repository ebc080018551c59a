"""Detection on a whole trace, scored where the trace contains the true slip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.slip.detectors.detector import DetectorOutput
from fingertip.slip.detectors.fast import FastDetector, FastOutput
from fingertip.slip.detectors.noise import NoiseLevel, noise_level
from fingertip.slip.detectors.registry import make_detector, select_inputs
from fingertip.slip.intervals import Interval, Score, intervals, score
from fingertip.slip.traces.trace import Trace, find_issues


@dataclass(frozen=True, eq=False)
class Detection:
    """Result of detection on one trace, with the settings used."""

    detector: str
    threshold_v: float
    """Threshold in noise alone [V]."""
    memory_s: float
    """Longest time that ON outlasts slip [s]."""
    noise: NoiseLevel | None
    """Noise level of the article's chain at this input noise; None for other detectors than `digital`."""
    output: DetectorOutput
    intervals: tuple[Interval, ...]
    score: Score | None
    """Score against the true slips; None if the trace does not contain them."""
    confidences: tuple[float, ...]
    """Greatest ratio of statistic to threshold in each interval: by how much a controller may trust it."""
    incipient: tuple[Interval, ...] | None
    """Intervals in which slip may begin, at more false alarms than slip; None for other detectors than `fast`."""
    learned_noise_v: float | None
    """White RMS noise that the detector has learned at the end [V]; None for detectors that learn none."""


def detect(trace: Trace, design: Design, detector: str = "digital", noise_v: float | None = None) -> Detection:
    """Detect slip in a trace.

    Parameters
    ----------
    trace
        The trace. Its voltage may be any signal that follows the force if `noise_v` is given in the same unit.
    design
        Source of sampling rate, filters, window and threshold.
    detector
        Name of a detector; by default the article's chain in digital filters. The detector `analog` takes the trace's
        `envelope_v`. For a trace without one, `fingertip.detect_trace.detect_file` simulates the board.
    noise_v
        White RMS noise of the signal; by default the design's [V].

    Raises
    ------
    TraceError
        With all issues of the trace. They include another sampling rate than the design's, and a missing envelope for
        a detector that takes it.
    """
    issues = find_issues(trace, design.detector, in_volts=noise_v is None)
    inputs = select_inputs(trace, detector)
    if not inputs:
        remedy = "record it, or use --detector digital, which works without a board"
        message = f"is missing: the detector {detector} works on the board's output; {remedy}."
        issues.append(Issue("trace, envelope_v", message))
    if issues:
        raise TraceError(issues)
    instance = make_detector(detector, design, noise_v)
    threshold_v = instance.threshold_v  # before the noise floor adapts
    output = instance.process(*inputs)
    detected = intervals(trace.time_s, output.on)
    scored = None
    if trace.slip is not None:
        scored = score(detected, intervals(trace.time_s, trace.slip), instance.memory_s)
    level = noise_level(design, noise_v) if detector == "digital" else None
    incipient = intervals(trace.time_s, output.incipient) if isinstance(output, FastOutput) else None
    learned_v = instance.noise_v if isinstance(instance, FastDetector) else None
    confidences = _confidences(output, trace, detected)
    return Detection(
        detector, threshold_v, instance.memory_s, level, output, detected, scored, confidences, incipient, learned_v
    )


def _confidences(output: DetectorOutput, trace: Trace, detected: tuple[Interval, ...]) -> tuple[float, ...]:
    ratio = np.divide(
        output.statistic_v, output.threshold_v, where=output.threshold_v > 0.0, out=np.zeros(len(output.on))
    )
    first = np.searchsorted(trace.time_s, [i.onset_s for i in detected])
    last = np.searchsorted(trace.time_s, [i.end_s for i in detected])
    return tuple(float(ratio[a : max(b, a + 1)].max()) for a, b in zip(first.tolist(), last.tolist(), strict=True))
