"""Slip detection in arrays of a program, whose sampling rate a design is adapted to."""

from __future__ import annotations

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
        Sampling rate of the voltages [Hz].

    Raises
    ------
    TraceError
        With all issues of the recording.
    DesignError
        If its rate is out of bounds, or too low for the design's filters.
    """
    design = design or Design()
    trace = recording if isinstance(recording, Trace) else _read_array(recording, rate_hz)
    if len(trace.time_s) > 1 and "sample_rate_hz" not in design.detector.model_fields_set:
        found_hz = (len(trace.time_s) - 1) / float(trace.time_s[-1] - trace.time_s[0])
        stated_hz = rate_hz or float(f"{found_hz:.6g}")
        design = adapt_rate(design, stated_hz, "threshold_v" in design.detector.model_fields_set)
    return detect_in_trace(trace, design, detector, noise_v)


def _read_array(recording: Any, rate_hz: float | None) -> Trace:
    array = np.asarray(recording, dtype=float)
    if array.ndim == 2 and array.shape[1] == 2 and rate_hz is None:
        return Trace(array[:, 0].copy(), array[:, 1].copy())
    if array.ndim != 1 or rate_hz is None:
        shape = f"has shape {array.shape} and {'no rate' if rate_hz is None else f'rate_hz={rate_hz:g}'}"
        raise TraceError(Issue("recording", f"{shape}; give voltages (n,) with rate_hz, or time and voltage (n, 2)."))
    if not 0.0 < rate_hz < float("inf"):
        raise TraceError(Issue("rate_hz", f"{rate_hz:g} is no sampling rate; give the recording's, such as 2000."))
    return Trace(np.arange(len(array)) / rate_hz, array)
