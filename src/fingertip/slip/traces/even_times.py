"""Times in single precision: restored to the even spacing from which they were rounded.

A float32 has 24 bits. After an hour its steps are 0.24 ms wide, half of a sample at 2 kHz, and the times look as if
they jumped. Where all of them lie as near to evenly spaced times as a float32 can, the even ones are taken instead.
"""

from __future__ import annotations

import numpy as np

from fingertip.arrays import Array
from fingertip.slip.traces.sampling import RATE_TOLERANCE, STEP_TOLERANCE, round_rate

_MAX_SHARE = 4.0
"""Largest spacing of the float32 numbers at the last time, over the step between samples; beyond, times say little."""
_MAX_DEVIATION = 0.12
"""Largest distance of a time from the nearest float32, over their spacing: decimals that were printed cause some."""


def restore_even_times(times: Array) -> Array | None:
    """Return evenly spaced times for times in float32 whose steps need it; None for any others.

    Parameters
    ----------
    times
        Times, in the unit in which they were rounded.
    """
    if times.ndim != 1 or len(times) < 3 or not np.isfinite(times).all():
        return None
    steps = np.diff(times)
    duration = float(times[-1] - times[0])
    mean = duration / len(steps)
    if mean <= 0.0 or (steps < 0.0).any():
        return None
    is_rate_clear = abs(float(np.median(steps)) - mean) <= RATE_TOLERANCE / 2 * mean
    if is_rate_clear and bool((np.abs(steps - mean) <= STEP_TOLERANCE * mean).all()):
        return None
    rounded = times.astype(np.float32)
    spacing = float(np.spacing(np.abs(rounded).max()))
    if spacing > _MAX_SHARE * mean or (np.abs(times - rounded) > _MAX_DEVIATION * np.spacing(np.abs(rounded))).any():
        return None
    rate = round_rate(1 / mean, spacing / duration)
    if rate is None:
        return None
    counted = np.arange(len(times))
    for even in (times[0] + counted / rate, times[0] + counted * mean):
        # The first time is rounded too, by up to half a spacing, and both may be rounded to decimals after that.
        if np.abs(times - even).max() <= (1 + 2 * _MAX_DEVIATION) * spacing:
            return np.asarray(even, dtype=np.float64)
    return None
