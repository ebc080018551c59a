"""Sampling rate of a stream: measured from its first times, and checked at each sample."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence

import numpy as np

from fingertip.design.parameters.board_and_detector import Detector as DetectorParameters
from fingertip.detection.stream_lines import (
    NumberedLine,
    find_time_columns,
    line_error,
    read_time,
    split_line,
)
from fingertip.foundation.errors import TraceError
from fingertip.foundation.numerics import Array
from fingertip.slip.traces import sampling
from fingertip.slip.traces.csv_header import Header
from fingertip.slip.traces.trace import ColumnMap

FIRST_LINES = 200
"""Number of lines from whose times the rate of a stream is measured."""
_MEAN_WINDOWS = 100
"""Number of windows over which the mean rate is measured before the measurement restarts."""


def measure_rate(
    header: Header,
    first_lines: Sequence[NumberedLine],
    columns: ColumnMap,
    known_hz: float,
) -> float | None:
    """Measure the sampling rate by the times in the first and the last of some lines [Hz].

    Returns None if the rate is the known one or out of bounds, and if there are no times. A line
    that is wrong also gives None: its error is raised once its sample is read.
    """
    time_columns = find_time_columns(header, columns)
    if not time_columns or len(first_lines) < 2:
        return None

    try:
        start_s = read_time(split_line(header, first_lines[0]), time_columns)
        end_s = read_time(split_line(header, first_lines[-1]), time_columns)
    except (IndexError, TraceError):
        return None

    duration_s = end_s - start_s
    if not duration_s > 0.0:
        return None

    rate_hz = (len(first_lines) - 1) / duration_s
    uncertainty = sampling.STEP_TOLERANCE / len(first_lines)
    is_known = abs(rate_hz / known_hz - 1) <= sampling.RATE_TOLERANCE + uncertainty

    if is_known or sampling.rate_bounds_message(rate_hz):
        return None

    return sampling.round_rate(rate_hz, uncertainty)


class SampleClock:
    """Check of the times of samples against the sampling rate: each step, and the mean."""

    def __init__(self, parameters: DetectorParameters) -> None:
        self._parameters = parameters
        self._steps = 0
        """Number of steps since `_start_s`."""
        self._start_s = math.nan
        self._previous_s = math.nan

    def check(self, time_s: float, line_number: int) -> None:
        """Check the time of the next sample [s].

        Raises TraceError if its step, or the mean rate, is not that of the detector.
        """
        step_s = time_s - self._previous_s
        self._previous_s = time_s

        if math.isnan(step_s):
            self._start_s = time_s
            return

        if abs(step_s * self._parameters.sample_rate_hz - 1) > sampling.STEP_TOLERANCE:
            raise line_error(line_number, self._describe_step(time_s, step_s))

        self._steps += 1
        if self._steps % self._parameters.window_samples == 0:
            self._check_mean(time_s, line_number)

    def accept(self, times_s: Array) -> bool:
        """Check the times of the next samples [s]; False, and no change, if any is wrong."""
        after = copy.copy(self)
        try:
            after._check_all(times_s)
        except TraceError:
            return False

        vars(self).update(vars(after))
        return True

    def _check_all(self, times_s: Array) -> None:
        steps_s = np.diff(times_s, prepend=self._previous_s)  # the first of all is NaN
        wrong = np.abs(steps_s * self._parameters.sample_rate_hz - 1) > sampling.STEP_TOLERANCE
        if wrong.any():
            raise line_error(0, "has a wrong step.")

        done = 0
        if math.isnan(self._previous_s):
            self._start_s = float(times_s[0])
            done = 1

        window = self._parameters.window_samples
        while (missing := window - self._steps % window) <= len(times_s) - done:
            done += missing
            self._steps += missing
            self._check_mean(float(times_s[done - 1]), 0)

        self._steps += len(times_s) - done
        self._previous_s = float(times_s[-1])

    def _check_mean(self, time_s: float, line_number: int) -> None:
        """Check the mean rate at the end of a window. Raises TraceError."""
        mean_hz = self._steps / (time_s - self._start_s)
        deviation = abs(mean_hz / self._parameters.sample_rate_hz - 1)

        # A single time stamp may be off by STEP_TOLERANCE: the mean of few steps moves most.
        if deviation > sampling.RATE_TOLERANCE + sampling.STEP_TOLERANCE / self._steps:
            raise line_error(line_number, sampling.rate_message(mean_hz, self._parameters))

        if self._steps >= _MEAN_WINDOWS * self._parameters.window_samples:
            self._start_s = time_s
            self._steps = 0

    def _describe_step(self, time_s: float, step_s: float) -> str:
        """Describe a wrong step from one sample to the next, with the remedy."""
        rate_hz = self._parameters.sample_rate_hz
        is_first = self._steps == 0

        if is_first and step_s > 0.0 and sampling.guess_time_unit(1 / step_s):
            return sampling.rate_bounds_message(1 / step_s) or ""

        without_times = f"--rate-hz {rate_hz:g} --column time_s=none"
        if step_s == 0.0:
            remedy = f"ignore rounded times with {without_times}"
        elif is_first:
            remedy = "use --rate-hz, or record without gaps"
        else:
            remedy = f"if few samples are missing, ignore the times with {without_times}"

        return (
            f"{time_s:.9g} s is {step_s:.4g} s after the previous sample, but the detector "
            f"requires steps of {1 / rate_hz:.4g} s ({rate_hz:g} Hz); {remedy}."
        )
