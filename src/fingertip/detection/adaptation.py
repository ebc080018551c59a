"""Adaptation of a design's detector to a recording's sampling rate and noise.

Nothing happens in a quiet part, in the air or in a held grasp. Its noise, of any spectrum, is
expressed as the white noise for which a detector has the threshold it needs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.analog_and_digital import noise_level
from fingertip.slip.detectors.fast import FastDetector
from fingertip.slip.detectors.fast_settings import FastSettings
from fingertip.slip.detectors.registry import find_detector_type, make_detector
from fingertip.slip.scored_detection import Detection
from fingertip.slip.traces.sampling import (
    MAX_RATE_HZ,
    MIN_RATE_HZ,
    RATE_TOLERANCE,
    check_rate,
    rate_bounds_message,
)
from fingertip.slip.traces.trace import RawTrace, Trace
from fingertip.slip.traces.truth import intervals

_DISTURBANCE_RATIO = 6.0
"""Ratio of the energy statistic to its median at a disturbance; noise reaches half of it."""
_ENERGY_S = 0.015
"""Window of that energy [s]."""
MIN_S = 0.3
"""Minimum duration [s]; a shorter part does not give the deviation in 40 Hz to 10 %."""
_RAMP_MEAN_S = 0.05
"""Time over which the signal is averaged to see how the force moves [s]."""
_RAMP_V = 0.01
_RAMP_SHARE = 0.05
_RAMP_DEVIATIONS = 12.0
"""Change from one mean to the next that is motion: in volts, as a share of the recording's range,
and over the noise. Creep of a held grasp stays below.
"""
NOISELESS_REMEDY = "use a measured signal, or the voltage of a simulated trace instead of its force"
"""Remedy for a quiet part without noise, such as that of a simulated force before contact."""


@dataclass(frozen=True)
class QuietPart:
    """Quiet part of a recording, whose noise gives the thresholds."""

    samples: slice
    text: str
    """Ends of the span, such as 4:4.5 s."""

    @classmethod
    def select(
        cls,
        trace: Trace,
        between_s: tuple[float, float],
        in_volts: bool,
        name: str,
    ) -> QuietPart:
        """Select the part between two times after the first sample [s].

        Raises TraceError, also where the force moves.
        """
        part = cls(_select_samples(trace, between_s, name), f"{between_s[0]:g}:{between_s[1]:g} s")
        moved = _describe_ramp(trace, part.samples, in_volts)

        if moved:
            message = f"{moved}, within {part.text}; choose a part in which the force rests."
            raise TraceError(Issue("--calibrate", message))

        return part

    def describe(self) -> str:
        return f"the part {self.text} of --calibrate"

    def refuse_slip(self, detection: Detection) -> None:
        """Refuse a part in which the detector finds slip. Raises TraceError."""
        on = detection.output.on[self.samples]
        if on.any():
            first_s = detection.trace.time_s[self.samples][on][0]
            message = f"{detection.detector} finds slip at {first_s:.4f} s, within {self.text}"
            raise TraceError(
                Issue(
                    "--calibrate", f"{message}; choose a part in which nothing moves or vibrates."
                )
            )

    def describe_disturbance(self, design: Design, trace: Trace) -> str | None:
        """Describe a disturbance, from which the thresholds would follow; None if there is none."""
        sample = _find_disturbance(design, trace.voltage_v[self.samples])
        if sample is None:
            return None

        message = (
            f"the signal is disturbed at {trace.time_s[self.samples][sample]:.4f} s, within "
            f"{self.text} of --calibrate"
        )
        return f"{message}: thresholds may be too high; choose another part."


def _select_samples(trace: Trace, between_s: tuple[float, float], name: str) -> slice:
    """Select the samples of a trace's quiet part. Raises TraceError."""
    begin_s, end_s = between_s
    text = f"{begin_s:g}:{end_s:g} s"
    duration_s = trace.time_s[-1] - trace.time_s[0]
    lasts = f"{duration_s:.4g}"
    # Rounding of times must not move a sample across a limit.
    since_s = trace.time_s - trace.time_s[0]
    slack_s = 1e-9 * max(1.0, duration_s)
    part = slice(int((since_s < begin_s - slack_s).sum()), int((since_s < end_s - slack_s).sum()))

    if part.stop <= part.start:
        message = (
            f"covers no sample of {name}, which lasts {lasts} s; choose an end after the "
            "start, such as 0:0.5."
        )
    elif part.stop - part.start == len(trace.time_s):
        message = (
            f"covers all {lasts} s of {name}; choose a shorter part during which nothing happens."
        )
    elif end_s > duration_s + 1.5 * duration_s / max(1, len(trace.time_s) - 1) + slack_s:
        message = f"ends after {name}, which lasts {lasts} s; choose an end of at most {lasts}."
    elif trace.slip is not None and trace.slip[part].any():
        first_s = trace.time_s[part.start + np.argmax(trace.slip[part])]
        slip = next(
            interval
            for interval in intervals(trace.time_s, trace.slip)
            if interval.onset_s <= first_s <= interval.end_s
        )
        between = f"{slip.onset_s - trace.time_s[0]:.4g} to {slip.end_s - trace.time_s[0]:.4g} s"
        message = f"covers slip, which lasts from {between}; choose a part without it."
    else:
        return part

    raise TraceError(Issue("--calibrate", f"{text} {message}"))


def equivalent_noise_v(detector: str, design: Design, quiet_v: Array, name: str) -> float:
    """Compute the white RMS noise for which a detector's threshold exceeds this signal.

    The detector's own output for the signal decides. The white noise of the signal's second
    differences is the lower bound; drift and a constant load do not contribute to it. Raises
    TraceError.
    """
    minimum = math.ceil(MIN_S * design.detector.sample_rate_hz)
    if len(quiet_v) < minimum:
        samples = f"{len(quiet_v)} sample{'s' * (len(quiet_v) != 1)}"
        raise TraceError(
            Issue("--calibrate", f"covers {samples} of {name}; choose at least {MIN_S:g} s.")
        )

    white_v = math.sqrt(float(np.mean(np.diff(quiet_v, 2) ** 2)) / 6)
    if not white_v > 0.0:
        message = f"covers a constant part of {name}: a signal without noise gives no threshold"
        raise TraceError(Issue("--calibrate", f"{message}; {NOISELESS_REMEDY}."))

    implementation = find_detector_type(detector).implementation
    return max(white_v, implementation.equivalent_noise_v(design, quiet_v))


def _find_disturbance(design: Design, quiet_v: Array) -> int | None:
    """Return the first sample with far more energy than the median; None if there is none."""
    settling = round(0.1 * design.detector.sample_rate_hz)
    filtered = FastDetector(FastSettings.from_design(design, 1.0)).process(quiet_v).filtered_v
    window = max(1, round(_ENERGY_S * design.detector.sample_rate_hz))
    # RMS value over the window that ends with each sample.
    total = np.concatenate((np.zeros(window), np.cumsum(filtered * filtered)))
    statistic = np.sqrt(np.maximum(total[window:] - total[:-window], 0.0) / window)[settling:]
    if not len(statistic):
        return None

    loud = np.flatnonzero(statistic > _DISTURBANCE_RATIO * float(np.median(statistic)))
    return settling + int(loud[0]) if len(loud) else None


def _describe_ramp(trace: Trace, part: slice, in_volts: bool) -> str | None:
    """Describe a change of the force that is no drift; None if there is none."""
    volts = trace.voltage_v[part]
    duration_s = trace.time_s[-1] - trace.time_s[0]
    width = max(1, round(_RAMP_MEAN_S * (len(trace.time_s) - 1) / duration_s))
    means = volts[: len(volts) // width * width].reshape(-1, width).mean(axis=1)
    if len(means) < 2:
        return None

    changes = means[1:] - means[:-1]
    noise = math.sqrt(float(np.mean(np.diff(volts, 2) ** 2)) / 6 / width)
    largest = int(np.argmax(np.abs(changes)))
    unit = _RAMP_V if in_volts else _RAMP_SHARE * float(np.ptp(trace.voltage_v))
    if abs(changes[largest]) <= max(unit, _RAMP_DEVIATIONS * noise):
        return None

    moved = f"{1000 * abs(changes[largest]):.3g} mV" if in_volts else f"{abs(changes[largest]):.3g}"
    return f"the signal moves by {moved} at {trace.time_s[part][(largest + 1) * width]:.4f} s"


def adapt_rate(design: Design, rate_hz: float, keep_threshold: bool = False) -> Design:
    """Adapt a design's filters, window and threshold to another sampling rate.

    The window keeps its duration, or its samples where the design states these and no rate. The
    threshold keeps its ratio to the noise-derived one: of white noise less passes at a higher
    sampling rate. Raises DesignError.
    """
    old = design.detector
    if rate_hz == old.sample_rate_hz:
        return design

    tables = design.model_dump()
    # A rate out of bounds is refused below, as it is; its window might not even be a number.
    within_hz = min(max(rate_hz, MIN_RATE_HZ), MAX_RATE_HZ)
    if "window_samples" in old.model_fields_set and "sample_rate_hz" not in old.model_fields_set:
        window = old.window_samples
        # Compare the noise in windows of the same duration. This design only serves the comparison,
        # so its window is not checked against the bounds.
        same_duration = max(1, round(window * old.sample_rate_hz / within_hz))
        design = design.model_copy(
            update={"detector": old.model_copy(update={"window_samples": same_duration})}
        )
    else:
        window = max(1, round(old.window_samples * within_hz / old.sample_rate_hz))

    tables["detector"] |= {"sample_rate_hz": rate_hz, "window_samples": window}
    adapted = Design(**tables)
    if keep_threshold:
        return adapted

    before = noise_level(design).threshold_v
    after = noise_level(adapted).threshold_v
    if before > 0.0 and after > 0.0:
        tables["detector"]["threshold_v"] = old.threshold_v * after / before
        adapted = Design(**tables)

    return adapted


@dataclass(frozen=True)
class Adaptation:
    """Adaptation of a design to the sampling rate of a recording, for one detector."""

    detector: str
    noise_is_measured: bool = False
    """True if the threshold follows from the noise of the recording."""
    report: Callable[[str], None] = lambda message: None

    def to_recording(self, design: Design, raw: RawTrace) -> Design:
        """Adapt a design to a recording's rate, if the rates differ and a detector has it."""
        # A rate out of bounds is refused as the recording is validated, with all else that is
        # wrong.
        rate_hz = raw.rate_hz
        if not rate_hz or rate_bounds_message(rate_hz):
            return design
        if abs(rate_hz / design.detector.sample_rate_hz - 1) <= RATE_TOLERANCE:
            return design

        try:
            return self.to_rate(design, rate_hz, f"{raw.name} is sampled at {rate_hz:g} Hz: ")
        except FingertipError as error:
            reasons = " ".join(issue.message for issue in error.issues)
            message = (
                f"is sampled at {rate_hz:g} Hz, for which no detector can be designed: {reasons}"
            )
            raise TraceError([*raw.issues, Issue(f"{raw.name}, time_s", message)]) from None

    def to_rate(self, design: Design, rate_hz: float, prefix: str = "") -> Design:
        """Adapt a design to a rate, and report it after a prefix.

        Raises TraceError or DesignError.
        """
        keep_threshold = "threshold_v" in design.detector.model_fields_set
        check_rate(rate_hz)
        kind = find_detector_type(self.detector)
        adapted = adapt_rate(design, rate_hz, keep_threshold or kind.takes_envelope)
        samples = adapted.detector.window_samples
        values = f"the window is {samples} samples, {1000 * samples / rate_hz:.4g} ms"
        if not self.noise_is_measured and kind.has_design_threshold:
            threshold_v = make_detector(self.detector, adapted).threshold_v
            values += f"; the threshold is {threshold_v:.3g} V"

        self.report(f"{prefix}filters adapted to {rate_hz:g} Hz; {values}")
        return adapted
