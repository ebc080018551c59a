"""Slip detection in arrays of a program, whose sampling rate a design is adapted to."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.detection.adaptation import adapt_rate
from fingertip.foundation.errors import Issue, TraceError
from fingertip.slip.detection import Detection
from fingertip.slip.detection import detect as detect_in_trace
from fingertip.slip.detectors.registry import DEFAULT
from fingertip.slip.traces.trace import Trace


def detect(
    recording: Trace | Any,
    design: Design | None = None,
    detector: str = DEFAULT,
    noise_v: float | None = None,
    *,
    rate_hz: float | None = None,
) -> Detection:
    """Detect slip in a trace, or in an array of voltages.

    Parameters
    ----------
    recording
        A trace, or what numpy makes an array of: voltages, which take `rate_hz`, or rows of time and voltage.
    design
        Source of filters, window, threshold and board; by default the default design. It is adapted to the rate of the
        recording if it does not state one itself.
    detector
        Name of a detector: `digital`, `analog`, `fft` or `fast`.
    noise_v
        White RMS noise of the signal; by default the design's [V].
    rate_hz
        Sampling rate of voltages without times [Hz].

    Raises
    ------
    TraceError
        With all issues of the recording.
    DesignError
        If its rate is out of bounds, or too low for the design's filters.
    """
    design = design or Design()
    trace = _read_array(recording, rate_hz)
    lasts_s = float(trace.time_s[-1] - trace.time_s[0]) if len(trace.time_s) > 1 else 0.0
    stated = design.detector.model_fields_set
    # What has no rate is refused below with all else that is wrong with it.
    if 0.0 < lasts_s < math.inf and "sample_rate_hz" not in stated:
        found_hz = rate_hz or float(f"{(len(trace.time_s) - 1) / lasts_s:.6g}")
        design = adapt_rate(design, found_hz, "threshold_v" in stated)
    return detect_in_trace(trace, design, detector, noise_v)


def _read_array(recording: Any, rate_hz: float | None) -> Trace:
    if isinstance(recording, Trace) and rate_hz is None:
        return recording
    if isinstance(recording, Trace):
        raise TraceError(Issue("rate_hz", f"{rate_hz:g} Hz is given, and a trace has its own times; leave it out."))
    try:
        array = np.asarray(recording, dtype=float)
    except (TypeError, ValueError) as error:
        raise TraceError(Issue("recording", f"is no array of numbers ({error}); give voltages.")) from None
    if array.ndim == 2 and array.shape[1] == 2 and rate_hz is None:
        return Trace(array[:, 0].copy(), array[:, 1].copy())
    if array.ndim != 1 or rate_hz is None:
        shape = f"has shape {array.shape} and {'no rate' if rate_hz is None else f'rate_hz={rate_hz:g}'}"
        raise TraceError(Issue("recording", f"{shape}; give voltages (n,) with rate_hz, or time and voltage (n, 2)."))
    if not 0.0 < rate_hz < float("inf"):
        raise TraceError(Issue("rate_hz", f"{rate_hz:g} is no sampling rate; give the recording's, such as 2000."))
    return Trace(np.arange(len(array)) / rate_hz, array)
