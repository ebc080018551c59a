"""Detection on a whole trace, scored where the trace contains the true slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fingertip.design import Design
from fingertip.foundation.display import html_table, to_dataframe
from fingertip.foundation.errors import Issue, TraceError, raise_issues
from fingertip.foundation.numerics import Array
from fingertip.foundation.validation import find_not_positive
from fingertip.slip.detectors import registry
from fingertip.slip.detectors.analog_and_digital import SlipChain, noise_level
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.fast import FastDetector, FastOutput, Floors
from fingertip.slip.detectors.fast_record import Trust, load_record
from fingertip.slip.detectors.noise_and_threshold import NoiseLevel
from fingertip.slip.force import MEAN_S, Force, ForceScale
from fingertip.slip.traces.trace import RawTrace, Trace
from fingertip.slip.traces.truth import Interval, Score, intervals, score

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class UsedThreshold:
    """Threshold that a detector used on a trace: of what quantity, and how far it moved."""

    quantity: str
    first_on_v: float | None
    """Threshold where the detector turns ON first [V]; None if it stays OFF."""
    last_v: float
    """Threshold at the end [V]."""
    lowest_v: float
    highest_v: float
    unit: str = "mV"
    """A thousandth of the signal's unit, which may be a force."""

    @classmethod
    def of(cls, detector: str, output: DetectorOutput) -> UsedThreshold:
        threshold_v = output.threshold_v
        on = np.flatnonzero(output.on)
        first_v = float(threshold_v[on[0]]) if len(on) else None
        quantity = registry.find_detector_type(detector).quantity

        return cls(
            quantity=quantity,
            first_on_v=first_v,
            last_v=float(threshold_v[-1]),
            lowest_v=float(np.nanmin(threshold_v)),
            highest_v=float(np.nanmax(threshold_v)),
        )

    def describe(self) -> str:
        """Describe it for people: ``threshold 0.186 to 0.374 mV, 0.186 at the first ON``."""
        if self.highest_v - self.lowest_v <= 1e-9 * self.highest_v:  # it does not follow the noise
            return f"threshold {1000 * self.highest_v:.3g} {self.unit}"

        first = "" if self.first_on_v is None else f", {1000 * self.first_on_v:.3g} at the first ON"
        return (
            f"threshold {1000 * self.lowest_v:.3g} to {1000 * self.highest_v:.3g} "
            f"{self.unit}{first}"
        )


@dataclass(frozen=True, eq=False)
class Detection:
    """Result of detection on one trace, with the settings used."""

    detector: str
    signals: registry.UsedSignals
    """Columns of the trace that the detector took."""
    threshold: UsedThreshold
    memory_s: float
    """Longest time that ON outlasts slip [s]."""
    noise: NoiseLevel | None
    """Noise level of the article's chain at this input noise;
    None for other detectors than `digital`.
    """
    output: DetectorOutput
    intervals: tuple[Interval, ...]
    score: Score | None
    """Score against the true slips; None if the trace does not contain them."""
    strengths: tuple[float, ...]
    """Greatest ratio of statistic to threshold in the first 50 ms of each interval."""
    trusts: tuple[Trust, ...] | None
    """How often an ON of this strength was slip on real recordings; None for detectors but
    `fast`.
    """
    incipient: tuple[Interval, ...] | None
    """Slip from its first signs on, with more false alarms; None for detectors but `fast`."""
    learned_noise_v: float | None
    """Learned white RMS noise at the end [V]; None for detectors that learn none."""
    floors: Floors | None
    """Floors that `fast` has learned at the end; None for other detectors."""
    undecided: Interval | None
    """Time at the start in which `fast` cannot tell slip from noise, as nothing rested before."""
    trace: Trace
    scale: ForceScale | None = None
    """Force at each voltage; None if the sensor's curve or the unit of the signal is unknown."""

    @property
    def forces(self) -> tuple[Force, ...] | None:
        """Force at the beginning of each interval, of the mean voltage of 20 ms before it."""
        if self.scale is None:
            return None

        onsets_s = np.array([interval.onset_s for interval in self.intervals])
        begins = np.searchsorted(self.trace.time_s, onsets_s - MEAN_S, side="right")
        ends = np.searchsorted(self.trace.time_s, onsets_s, side="right")
        parts = map(slice, begins.tolist(), ends.tolist())
        return tuple(self.scale.read(float(self.trace.voltage_v[part].mean())) for part in parts)

    @property
    def threshold_v(self) -> float:
        """Threshold where the detector turned ON first, or at the end if it stayed OFF [V]."""
        first_v = self.threshold.first_on_v
        return self.threshold.last_v if first_v is None else first_v

    @property
    def motion_delays_s(self) -> tuple[float | None, ...] | None:
        """Delay of each slip since the robot moved [s], None if missed; None without a motion."""
        motion_s = self.trace.origin.motion_s
        if self.score is None or motion_s is None:
            return None

        pairs = zip(self.score.slips, self.score.delays_s, strict=True)
        return tuple(
            None if delay is None else slip.onset_s + delay - motion_s for slip, delay in pairs
        )

    def __repr__(self) -> str:
        count = f"{len(self.intervals)} interval{'' if len(self.intervals) == 1 else 's'} ON"
        if self.score is None:
            return f"Detection({self.detector}: {count})"

        delays_s = [delay_s for delay_s in self.score.delays_s if delay_s is not None]
        text = f"{len(delays_s)} of {len(self.score.delays_s)} slips found"
        if delays_s:
            text += f", delay {1000 * float(np.median(delays_s)):.1f} ms"

        false = f"{len(self.score.false_intervals)} false"
        return f"Detection({self.detector}: {count}, {text}, {false})"

    def _repr_html_(self) -> str:
        """Table of the intervals, for Jupyter."""
        rows = []
        for interval, strength in zip(self.intervals, self.strengths, strict=True):
            is_false = self.score is not None and interval in self.score.false_intervals
            if self.score is None:
                verdict = ""
            elif is_false:
                verdict = "false"
            else:
                verdict = "true"

            rows.append(
                (f"{interval.onset_s:.4f}", f"{interval.end_s:.4f}", f"{strength:.3g}", verdict)
            )

        return html_table(repr(self), ("ON from [s]", "to [s]", "strength", "slip"), rows)

    def to_dataframe(self) -> pandas.DataFrame:
        """Return the intervals; `is_true` is missing where true slip is not known.

        Raises MissingLibraryError.
        """
        columns: dict[str, list[object]] = {
            "onset_s": [interval.onset_s for interval in self.intervals],
            "end_s": [interval.end_s for interval in self.intervals],
            "strength": [*self.strengths],
        }
        if self.score is not None:
            columns["is_true"] = [
                interval not in self.score.false_intervals for interval in self.intervals
            ]

        return to_dataframe(columns, "Detection.to_dataframe")


def detect(
    trace: Trace,
    design: Design,
    detector: str = registry.DEFAULT,
    noise_v: float | None = None,
    floors: Floors | None = None,
    *,
    is_valid: bool = False,
) -> Detection:
    """Detect slip in a trace whose sampling rate is the design's.

    Raises TraceError with all issues of the trace.

    `noise_v` is the white RMS noise of the signal [V], by default the design's. Given in the unit
    of the signal, it may be any signal that follows the force. `fast` starts with `floors`, those
    of a rest, if given. A trace that `is_valid` was validated for the design already.
    """
    issues = list[Issue]()
    if not is_valid:
        raw = RawTrace("trace", trace, in_volts=noise_v is None, is_array=True)
        issues += raw.find_issues(design.detector)

    if noise_v is not None:
        issues += find_not_positive("noise_v", noise_v, "V", f"{design.detector.noise_v:g}")

    inputs = registry.select_inputs(trace, detector)
    if not inputs:
        remedy = f"record it, or use --detector {registry.DEFAULT}, which works without a board"
        message = f"is missing: the detector {detector} works on the board's output; {remedy}."
        issues.append(Issue("trace, envelope_v", message))

    raise_issues(TraceError, issues)
    instance = registry.make_detector(detector, design, noise_v)
    if isinstance(instance, FastDetector):
        instance.stored_floors = floors

    output = instance.process(*inputs)
    detected = intervals(trace.time_s, output.on)
    strengths = _find_strengths(output, trace.time_s, detected)
    truth = None if trace.slip is None else intervals(trace.time_s, trace.slip)
    return Detection(
        detector=detector,
        signals=registry.find_signals(design, detector, len(inputs) > 1),
        threshold=UsedThreshold.of(detector, output),
        memory_s=instance.memory_s,
        noise=noise_level(design, noise_v) if isinstance(instance, SlipChain) else None,
        output=output,
        intervals=detected,
        score=None if truth is None else score(detected, truth, instance.memory_s),
        strengths=strengths,
        trusts=tuple(map(load_record().find, strengths)) if detector == "fast" else None,
        incipient=intervals(trace.time_s, output.incipient)
        if isinstance(output, FastOutput)
        else None,
        learned_noise_v=instance.noise_v if isinstance(instance, FastDetector) else None,
        floors=instance.floors if isinstance(instance, FastDetector) else None,
        undecided=_find_undecided(instance, output, trace),
        trace=trace,
    )


BEGIN_S = 0.3
BEGIN_RATIO = 2.0
"""Time in which `fast` learns first floors [s], and fall of its threshold that shows a rest."""
MAX_NOISE_RATIO = 5.0
"""Largest ratio of noise to stated noise in the signals of the fit."""


def _find_undecided(detector: Detector, output: DetectorOutput, trace: Trace) -> Interval | None:
    """Find the time in which what `fast` took for its noise may have
    been slip: until it rests, or all of it.
    """
    times_s = trace.time_s
    volts = trace.voltage_v if trace.filtered_v is None else trace.filtered_v
    first = int(np.searchsorted(times_s, times_s[0] + BEGIN_S))
    is_flat = len(np.unique(volts[:first])) <= 2  # a step of the converter, to and fro

    if (
        not isinstance(detector, FastDetector)
        or detector.stored_floors
        or first >= len(times_s)
        or is_flat
    ):
        return None

    rested = np.flatnonzero(output.threshold_v[first:] * BEGIN_RATIO < output.threshold_v[first])
    if not len(rested) and (
        output.on.any() or detector.noise_v <= MAX_NOISE_RATIO * detector.settings.noise_v
    ):
        return None

    end = first + rested[0] if len(rested) else -1
    return Interval(float(times_s[0]), float(times_s[end]))


def find_ratio(output: DetectorOutput, part: slice = slice(None)) -> Array:
    """Find the statistic over the threshold at each sample; 0 where the threshold is 0."""
    threshold_v = output.threshold_v[part]
    zeros = np.zeros(len(threshold_v))
    return np.divide(output.statistic_v[part], threshold_v, where=threshold_v > 0.0, out=zeros)


def _find_strengths(
    output: DetectorOutput, time_s: Array, detected: tuple[Interval, ...]
) -> tuple[float, ...]:
    """Greatest ratio of statistic to threshold in the first 50 ms of each interval."""
    onsets_s = np.array([interval.onset_s for interval in detected])
    begins = np.searchsorted(time_s, onsets_s).tolist()
    ends = np.searchsorted(time_s, onsets_s + load_record().opening_s).tolist()
    parts = [slice(begin, max(end, begin + 1)) for begin, end in zip(begins, ends, strict=True)]
    return tuple(float(find_ratio(output, part).max()) for part in parts)
