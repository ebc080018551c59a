"""A trace: sampled tactile voltage over time, with the true force and slip where they are known; and what
is wrong with one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.design.sections import Detector
from fingertip.errors import Issue
from fingertip.slip.traces.rounded import Rounded, rounded

RATE_TOLERANCE = 0.005
"""Most by which a trace's mean rate may differ from the detector's: as much as it moves the cutoff
frequency."""
STEP_TOLERANCE = 0.5
"""Most by which one time step may differ from the mean, as a share of it: more is a gap or a wrong stamp."""


@dataclass(frozen=True, eq=False)
class Trace:
    """Columns of equal length."""

    time_s: NDArray[np.float64]
    voltage_v: NDArray[np.float64]
    """Raw tactile voltage [V]: bridge and instrumentation amplifier, before the filter board."""
    force_n: NDArray[np.float64] | None = None
    """True normal force [N]."""
    slip: NDArray[np.bool_] | None = None
    """True gross slip."""
    envelope_v: NDArray[np.float64] | None = None
    """Output of the filter board [V], which the detector `analog` takes."""


def issues(trace: Trace, detector: Detector, in_volts: bool = True) -> list[Issue]:
    """Everything that keeps a trace from being detected on, one sentence each; samples are counted from 0.

    Parameters
    ----------
    trace
        The trace.
    detector
        Gives the rate [Hz], the least length: one window, and the converter's range [V].
    in_volts
        Whether the signal is a voltage, so that the range means something.
    """
    found = [*length_issues(trace, detector, "trace"), *column_issues(trace, "trace", None)]
    if in_volts:
        found.extend(range_issues(trace, detector, "trace", None))
    if np.isfinite(trace.time_s).all() and trace.time_s.ndim == 1 and len(trace.time_s) > 1:
        found.extend(time_issues(trace.time_s, detector, "trace", None))
    return found


def length_issues(trace: Trace, detector: Detector, name: str) -> Iterator[Issue]:
    """A trace too short for one window."""
    count, minimum = len(trace.time_s), max(2, detector.window_samples)
    if count < minimum:
        yield Issue(
            name,
            f"holds {count} sample{'s' * (count != 1)}; at least one window of {minimum}, record for longer.",
        )


def column_issues(trace: Trace, name: str, first_line: int | None) -> Iterator[Issue]:
    """Columns of unequal length, values that are not finite.

    Parameters
    ----------
    trace
        The trace.
    name
        What the sentences call the trace, such as its file.
    first_line
        Line of the file that holds the first sample; without it the sentences count samples from 0.
    """
    for column in ("time_s", "voltage_v", "force_n", "slip", "envelope_v"):
        values = getattr(trace, column)
        if values is None:
            continue
        field = f"{name}, {column}"
        if values.shape != trace.time_s.shape or values.ndim != 1:
            shapes = f"has shape {values.shape}, time_s {trace.time_s.shape}"
            yield Issue(field, f"{shapes}; give one value per sample.")
        elif (bad := np.flatnonzero(~np.isfinite(values))).size:
            first = int(bad[0])
            more = f", and {bad.size - 1} more after it," if bad.size > 1 else ""
            yield Issue(
                field,
                f"{values[first]} {_where(first, first_line)}{more} is not a finite number; "
                "record again or cut it out.",
            )


def range_issues(trace: Trace, detector: Detector, name: str, first_line: int | None) -> Iterator[Issue]:
    """Voltages that the converter cannot have given; whole numbers among them are its counts."""
    volts, maximum = trace.voltage_v, detector.adc_range_v
    beyond = np.flatnonzero(np.isfinite(volts) & (np.abs(volts) > maximum)) if volts.ndim == 1 else np.zeros(0)
    if not beyond.size:
        return
    first = int(beyond[0])
    whole = bool(np.all(volts[np.isfinite(volts)] % 1 == 0))
    yield Issue(f"{name}, voltage_v", beyond_sentence(f"{volts[first]:g} {_where(first, first_line)}", whole, detector))


def beyond_sentence(value: str, whole: bool, detector: Detector) -> str:
    """Of a voltage that the converter cannot have given, and its place; `whole`: all of them are whole numbers."""
    maximum = detector.adc_range_v
    if whole:
        step = 2 * maximum / 2**detector.adc_bits
        remedy = f"whole numbers throughout look like its counts: --scale {step:.8g} makes volts of them"
    else:
        remedy = "give --scale if the column is not in volts, or --set detector.adc_range_v"
    return f"{value} is beyond the converter's {maximum:g} V; {remedy}."


def remarks(trace: Trace, detector: Detector) -> Iterator[str]:
    """What makes an answer doubtful without making it wrong: a voltage that never changes, or stands at an end."""
    volts, maximum = trace.voltage_v, detector.adc_range_v
    step = 2 * maximum / 2**detector.adc_bits
    ends = int(np.sum((volts >= maximum - 1.5 * step) | (volts <= step / 2 - maximum)))
    if ends:
        many = f"all {ends}" if ends == len(volts) else f"{ends} of {len(volts)}"
        yield (
            f"{many} samples stand at an end of the converter's range, plus and minus {maximum:g} V: slip does not show "
            "there. Divide the signal ahead of the converter, or record with a wider range (detector.adc_range_v)."
        )
    elif np.ptp(volts) == 0.0:
        yield f"the voltage is {volts[0]:g} V throughout: is a sensor connected?"


def time_issues(time_s: NDArray[np.float64], detector: Detector, name: str, first_line: int | None) -> Iterator[Issue]:
    """Finite times that go backwards, repeat, leave gaps, or come at another rate than the detector's."""
    field = f"{name}, time_s"
    if coarse := rounded(time_s):
        yield Issue(field, _rounded_sentence(time_s, coarse, detector, first_line))
        return
    steps = np.diff(time_s)
    # The median is the recording's own step, whatever single gaps do to the mean.
    usual = float(np.median(steps))
    if usual <= 0.0:
        yield Issue(field, "does not advance in most of its steps; write the time of each sample in seconds.")
        return
    even = True
    for bad, what in (
        (steps < 0.0, "goes backwards"),
        (steps == 0.0, "repeats the time before it"),
        (steps > usual * (1 + STEP_TOLERANCE), "comes after a gap"),
        ((steps > 0.0) & (steps < usual * (1 - STEP_TOLERANCE)), "comes too early"),
    ):
        places = np.flatnonzero(bad)
        if places.size:
            even = False
            i = int(places[0]) + 1
            more = f", and {places.size - 1} more like it" if places.size > 1 else ""
            yield Issue(
                field,
                f"{time_s[i]:.9g} s {_where(i, first_line)} {what} (before it {time_s[i - 1]:.9g} s, "
                f"usual step {usual:.4g} s){more}; detection needs evenly spaced samples.",
            )
    rate = float(len(steps) / (time_s[-1] - time_s[0])) if even else 1 / usual
    if abs(rate / detector.sample_rate_hz - 1) > RATE_TOLERANCE:
        yield Issue(field, rate_sentence(rate, detector))


def _rounded_sentence(time_s: NDArray[np.float64], coarse: Rounded, detector: Detector, first_line: int | None) -> str:
    """With what sets the times aside: at their mean rate, or at the detector's if that agrees with it."""
    at, more = coarse.first, f", and {coarse.repeats - 1} more like it" if coarse.repeats > 1 else ""
    found, rate, mean = coarse.rate_hz, "HZ, as it was recorded, and", ""
    if found:
        agrees = abs(found / detector.sample_rate_hz - 1) <= RATE_TOLERANCE
        rate = f"{detector.sample_rate_hz if agrees else found:.9g}"
        mean = f", at a mean rate of {found:.6g} Hz"
    return (
        f"{time_s[at]:.9g} s {_where(at, first_line)} repeats the time before it{more}: the times are rounded to "
        f"{coarse.step_s:.4g} s{mean}; set them aside with --rate-hz {rate} --column time_s=none."
    )


def rate_sentence(rate_hz: float, detector: Detector) -> str:
    """Of samples that come at another rate [Hz] than the detector's."""
    return (
        f"is sampled at {rate_hz:.6g} Hz, the detector is designed for {detector.sample_rate_hz:g} Hz "
        f"(within {100 * RATE_TOLERANCE:g} %); use --rate-hz {rate_hz:.6g} to make its filters "
        "for that, or sample the trace anew."
    )


def _where(sample: int, first_line: int | None) -> str:
    return f"at sample {sample}" if first_line is None else f"in line {first_line + sample}"
