"""Checks of a trace's samples: number, range, rate, gaps, and rounded times."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design.parameters.board_and_detector import Detector as DetectorParameters
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array

RATE_TOLERANCE = 0.005
"""Maximum relative deviation of the mean sampling rate, and so of the cutoff."""
STEP_TOLERANCE = 0.5
"""Maximum relative deviation of a time step; more is a gap or a wrong time stamp."""
MIN_RATE_HZ = 1000.0
MAX_RATE_HZ = 20000.0
"""Bounds of ``detector.sample_rate_hz`` [Hz]."""
TIME_UNITS_S = {
    "s": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    "ns": 1e-9,
}
_UNIT_NAMES = {"ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds"}
_MIN_REPEATS = 0.05
"""Minimum share of repeated times in a rounded trace; fewer repetitions are reported one by one."""
_MAX_DEVIATION_STEPS = 1.5
"""Maximum deviation of a rounded time from even spacing [rounding steps]."""
_MIN_RISES = 20
_MIN_EVEN = 0.98
"""Rises above which a column may hold times, and least share of even steps."""
_MAX_RATE_UNCERTAINTY = 0.005
"""Relative uncertainty above which the rate of rounded times is not reported."""


@dataclass(frozen=True)
class RoundedTimes:
    """Evenly spaced times that were rounded, so that several samples share one time."""

    repeats: int
    """Number of samples whose time equals that of the sample before."""
    first: int
    """Index of the first of those samples, from 0."""
    step_s: float
    """Rounding step [s]."""
    rate_hz: float | None
    """Mean rate with the digits that are certain [Hz]; None if none is."""


def find_rounding(time_s: Array) -> RoundedTimes | None:
    """Detect evenly spaced times that were rounded; None for any others."""
    steps = np.diff(time_s)
    places = np.flatnonzero(steps == 0.0)
    if len(places) < max(1.0, _MIN_REPEATS * len(steps)) or (steps < 0.0).any() or not steps.any():
        return None

    step_s = float(steps[steps > 0.0].min())
    duration_s = float(time_s[-1] - time_s[0])
    even = time_s[0] + duration_s * np.arange(len(time_s)) / len(steps)
    if np.abs(time_s - even).max() > _MAX_DEVIATION_STEPS * step_s:
        return None

    rate_hz = round_rate(len(steps) / duration_s, step_s / duration_s)
    return RoundedTimes(len(places), int(places[0]) + 1, step_s, rate_hz)


def round_rate(rate_hz: float, uncertainty: float) -> float | None:
    """Round a rate [Hz] to the fewest digits within its relative uncertainty."""
    if uncertainty > _MAX_RATE_UNCERTAINTY:
        return None

    candidates = (float(f"{rate_hz:.{digits}g}") for digits in range(1, 6))
    return next((rate for rate in candidates if abs(rate / rate_hz - 1) <= uncertainty), rate_hz)


def rises_evenly(values: Array) -> bool:
    """Return whether finite values rise by about the same at each step, but for a few."""
    return _are_even(np.diff(values))


def _are_even(steps: Array) -> bool:
    """Return whether nearly all steps are about the same, and rise."""
    if not len(steps) or float((steps > 0.0).mean()) <= _MIN_EVEN:
        return False

    usual = float(np.median(steps))
    return float((np.abs(steps - usual) <= STEP_TOLERANCE * usual).mean()) > _MIN_EVEN


@np.errstate(over="ignore", invalid="ignore")
def rises_as_time(values: Array) -> bool:
    """Return whether values rise as times and counters do: evenly, rounded, or without a fall."""
    steps = np.diff(values)
    is_rising = np.count_nonzero(steps > 0.0) > _MIN_RISES and not (steps < 0.0).any()
    is_steady = is_rising and (
        float((steps > 0.0).mean()) > 0.5 or find_rounding(values) is not None
    )

    return is_steady or _are_even(steps)


def length_message(count: int, minimum: int) -> str:
    """Describe a trace of fewer samples than one window, with the remedy."""
    samples = f"{count} sample{'s' * (count != 1)}"
    return f"has {samples}; at least one window of {minimum} is required; record for longer."


def range_message(
    volts: float,
    where: str,
    whole: bool,
    detector: DetectorParameters,
    is_array: bool = False,
) -> str:
    """Describe a voltage outside the ADC range [V], with the remedy."""
    scale = "--scale"
    remedy = "use --scale if the column is not in volts, or set"

    if is_array:
        scale = "a factor of"
        remedy = "multiply the voltages if they are not in volts, or give a Design with"
    elif 10 * detector.adc_range_v < volts <= 1000 * detector.adc_range_v:
        remedy = (
            "if the column is in millivolts, use --scale 0.001; otherwise give another "
            "--scale, or set"
        )

    remedy += " a wider detector.adc_range_v"
    if whole:
        scale = (
            f"{scale} {detector.adc_step_v:.8g} converts counts of {detector.adc_bits} bits "
            "to volts; of other bits"
        )
        remedy = (
            f"the values are whole numbers, as ADC counts are: {scale}, give the step of "
            "that converter"
        )

    return f"{volts:g}{where} exceeds the ADC range of {detector.adc_range_text}; {remedy}."


def time_issues(
    time_s: Array,
    usual: float,
    detector: DetectorParameters,
    name: str,
    lines: Sequence[int] | None,
    is_array: bool,
) -> Iterator[Issue]:
    """Yield issues of times that decrease, repeat, leave gaps, or have another rate.

    `usual` is the median step [s], whatever single gaps do to the mean.
    """
    field = f"{name}, time_s"
    rounding = find_rounding(time_s)

    if rounding:
        yield Issue(
            field,
            _rounding_message(
                time_s,
                rounding=rounding,
                detector=detector,
                lines=lines,
                is_array=is_array,
            ),
        )
        return

    steps = np.diff(time_s)
    remedy = "detection requires evenly spaced samples"

    if usual <= 0.0:
        yield Issue(
            field,
            "does not increase in most of its steps; give the time of each sample in seconds.",
        )
        return

    if not rate_bounds_message(1 / usual):
        agrees = abs(1 / usual / detector.sample_rate_hz - 1) <= RATE_TOLERANCE
        rate_hz = detector.sample_rate_hz if agrees else 1 / usual
        remedy += f"; if few are missing, {_without_times('the times', f'{rate_hz:.6g}', is_array)}"

    is_even = True
    faults = (
        (steps < 0.0, "goes backwards"),
        (steps == 0.0, "repeats the time before it"),
        (steps > usual * (1 + STEP_TOLERANCE), "comes after a gap"),
        ((steps > 0.0) & (steps < usual * (1 - STEP_TOLERANCE)), "comes too early"),
    )
    for is_wrong, what in faults:
        places = np.flatnonzero(is_wrong)
        if places.size:
            is_even = False
            i = int(places[0]) + 1
            context = (
                f"(previous time {time_s[i - 1]:.9g} s, median step {usual:.4g} "
                f"s){count_others(places.size)}"
            )
            yield Issue(
                field, f"{time_s[i]:.9g} s {sample_location(i, lines)} {what} {context}; {remedy}."
            )

    rate = float(len(steps) / (time_s[-1] - time_s[0])) if is_even else 1 / usual
    if abs(rate / detector.sample_rate_hz - 1) > RATE_TOLERANCE:
        yield Issue(field, rate_message(rate, detector, is_array))


def _rounding_message(
    time_s: Array,
    rounding: RoundedTimes,
    detector: DetectorParameters,
    lines: Sequence[int] | None,
    is_array: bool,
) -> str:
    """Describe rounded times, and how to read the recording without them."""
    at = rounding.first
    rate = f"HZ, the rate of the recording{'' if is_array else ', and'}"
    mean = ""
    condition = ""

    if rounding.rate_hz:
        mean = f", at a mean rate of {rounding.rate_hz:.6g} Hz"
        rate_hz = rounding.rate_hz
        unit = guess_time_unit(rate_hz)

        if unit:
            rate_hz = rate_hz / TIME_UNITS_S[unit]
            condition = f"if they are in {_UNIT_NAMES[unit]}, "

        agrees = abs(rate_hz / detector.sample_rate_hz - 1) <= RATE_TOLERANCE
        rate = f"{detector.sample_rate_hz if agrees else rate_hz:.9g}"

    return (
        f"{time_s[at]:.9g} s {sample_location(at, lines)} repeats the time before it"
        f"{count_others(rounding.repeats)}: the times are rounded to {rounding.step_s:.4g} "
        f"s{mean}; "
        f"{condition}{_without_times('them', rate, is_array)}."
    )


def _without_times(times: str, rate: str, is_array: bool) -> str:
    if is_array:
        return f"pass the voltages alone, with rate_hz={rate}"

    return f"ignore {times} with --rate-hz {rate} --column time_s=none"


def rate_message(rate_hz: float, detector: DetectorParameters, is_array: bool = False) -> str:
    """Describe a sampling rate [Hz] that differs from the detector's, with the remedy."""
    message = rate_bounds_message(rate_hz, is_array)
    if message:
        return message

    return (
        f"is sampled at {rate_hz:.6g} Hz, but the detector is designed for "
        f"{detector.sample_rate_hz:g} Hz "
        f"(tolerance {100 * RATE_TOLERANCE:g} %); use --rate-hz {rate_hz:.6g} to adapt its "
        "filters, or resample the "
        "trace."
    )


def rate_bounds_message(rate_hz: float, is_array: bool = False) -> str | None:
    """Describe a sampling rate [Hz] that no detector has; None for any other rate."""
    if MIN_RATE_HZ <= float(f"{rate_hz:.6g}") <= MAX_RATE_HZ:  # times are rounded
        return None

    message = f"is sampled at {rate_hz:.6g} Hz"
    unit = guess_time_unit(rate_hz)
    if unit:
        remedy = "convert them to seconds" if is_array else f"add --time-scale {unit}"
        return (
            f"{message} if its times are in seconds; if they are in {_UNIT_NAMES[unit]}, {remedy}."
        )

    if rate_hz < MIN_RATE_HZ:
        return f"{message}, too low for a detector; record at {MIN_RATE_HZ:g} Hz or more."

    return f"{message}, too high for a detector; resample it to {MAX_RATE_HZ:g} Hz or less."


def check_rate(rate_hz: float) -> None:
    """Refuse a stated sampling rate [Hz] that no detector has. Raises TraceError."""
    if not MIN_RATE_HZ <= rate_hz <= MAX_RATE_HZ:
        message = (
            f"{rate_hz:g} Hz is out of range; record at, or resample to, {MIN_RATE_HZ:g} to "
            f"{MAX_RATE_HZ:g} Hz."
        )
        raise TraceError(Issue("--rate-hz", message))


def guess_time_unit(rate_hz: float) -> str | None:
    """Guess the unit of times from their rate in seconds [Hz]; None if no unit fits."""
    return next(
        (
            unit
            for unit in _UNIT_NAMES
            if MIN_RATE_HZ <= rate_hz / TIME_UNITS_S[unit] <= MAX_RATE_HZ
        ),
        None,
    )


def count_others(count: int) -> str:
    return f" (and {count - 1} more)" if count > 1 else ""


def sample_location(sample: int, lines: Sequence[int] | None) -> str:
    """Return the place of a sample: its line in the file or, without lines, its index from 0."""
    return f"at sample {sample}" if lines is None else f"in line {lines[sample]}"


# Times in single precision: restored to the even spacing from which they were rounded.
#
# A float32 has 24 bits. After an hour its steps are 0.24 ms wide, half of a sample at 2 kHz, and
# the times look as if they jumped. Where all of them lie as near to evenly spaced times as a
# float32 can, the even ones are taken instead.

_MAX_SHARE = 4.0
"""Largest float32 spacing at the last time over the sampling step; more says too little."""
_MAX_DEVIATION = 0.12
"""Largest distance of a time from a float32, over their spacing; printing causes some."""


def restore_even_times(times: Array) -> Array | None:
    """Return evenly spaced times for times in float32 whose steps need it; None for any others."""
    if times.ndim != 1 or len(times) < 3 or not np.isfinite(times).all():
        return None

    steps = np.diff(times)
    duration = float(times[-1] - times[0])
    mean = duration / len(steps)
    spacing = float(np.spacing(np.float32(max(-times.min(), times.max()))))
    if not mean > 0.0 or steps.min() < 0.0 or spacing > _MAX_SHARE * mean:
        return None

    deviation = max(float(steps.max()) - mean, mean - float(steps.min()))
    if deviation <= STEP_TOLERANCE * mean:
        far = RATE_TOLERANCE / 2 * mean
        if deviation <= far or abs(float(np.median(steps)) - mean) <= far:
            return None

    rounded = times.astype(np.float32)
    rate = round_rate(1 / mean, spacing / duration)
    if (
        rate is None
        or (np.abs(times - rounded) > _MAX_DEVIATION * np.spacing(np.abs(rounded))).any()
    ):
        return None

    # The first time is rounded too, by up to half a spacing, and both may be rounded to decimals
    # after that.
    candidates = (times[0] + np.arange(len(times)) * step for step in (1 / rate, mean))
    return next(
        (
            even
            for even in candidates
            if np.abs(times - even).max() <= (1 + 2 * _MAX_DEVIATION) * spacing
        ),
        None,
    )
