"""Slip detection in arrays of a program, whose sampling rate a design is adapted to."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.detection.adaptation import adapt_detector
from fingertip.detection.files import adapt_to_rate, simulate_board
from fingertip.foundation.errors import Issue, TraceError
from fingertip.slip.detection import Detection
from fingertip.slip.detection import detect as detect_in_trace
from fingertip.slip.detectors.registry import DEFAULT, check_detector
from fingertip.slip.traces.sampling import check_rate
from fingertip.slip.traces.trace import ColumnMap, RawTrace, Trace, as_numbers


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
        A trace, or what numpy makes an array of: voltages, which take `rate_hz`, or rows of time and voltage. Without
        `envelope_v`, the detector `analog` takes the output of the design's board, simulated for the voltage.
    design
        Source of filters, window, threshold and board; by default the default design. It is adapted to the rate of the
        recording if it does not state one itself.
    detector
        Name of a detector: `digital`, `analog`, `fft` or `fast`.
    noise_v
        White RMS noise of the signal; by default the design's [V].
    rate_hz
        Sampling rate to which any design is adapted [Hz]. Times of the recording must agree with it.

    Raises
    ------
    TraceError
        With all issues of the recording, or if its rate is out of bounds.
    DesignError
        If `rate_hz` is too low for the design's filters.
    """
    design = design or Design()
    kind = check_detector(design, detector)
    adapt = partial(adapt_detector, detector, None, False, noise_v is not None, lambda message: None)
    trace = _read_array(recording, rate_hz)
    raw = RawTrace("trace", trace, in_volts=noise_v is None, is_array=True)
    if rate_hz is not None:
        design = adapt(design, rate_hz)
    elif "sample_rate_hz" not in design.detector.model_fields_set:
        design = adapt_to_rate(design, raw, adapt)
    if kind.takes_envelope and trace.envelope_v is None:
        trace = simulate_board(raw.validate(design.detector), design, ColumnMap(), "trace", lambda message: None)
    return detect_in_trace(trace, design, detector, noise_v)


def _read_array(recording: Any, rate_hz: float | None) -> Trace:
    if isinstance(recording, Trace):
        return recording
    array = as_numbers("recording", recording)
    if array.ndim == 2 and array.shape[1] == 2:
        return Trace(array[:, 0].copy(), array[:, 1].copy())
    if array.ndim != 1 or rate_hz is None:
        shape = f"has shape {array.shape} and {'no rate' if rate_hz is None else f'rate_hz={rate_hz:g}'}"
        raise TraceError(Issue("recording", f"{shape}; give voltages (n,) with rate_hz, or time and voltage (n, 2)."))
    check_rate(rate_hz)
    return Trace(np.arange(len(array)) / rate_hz, array)
