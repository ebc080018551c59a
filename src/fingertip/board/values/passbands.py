"""The passband of many boards at once, as built: `passband` for arrays, with capacitors that differ. Needs numpy."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fingertip.arrays import Array
from fingertip.board.values.built import OPEN_LOOP_GAIN

_PER_DECADE = 6
_BELOW = 4.0
"""Where the search begins, below f0."""
_SHRINKINGS = 24
"""Golden sections around the peak: its frequency is then within 1e-5, its gain within 1e-10."""
_HALVINGS = 36
"""Of the step in which the lower end lies: it is then within 1e-11."""
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


def power_gain(f_hz: Array, parts: Array, gain_bandwidth_hz: float) -> Array:
    """Square of the gain from the tactile voltage to the rectifier, as `built.network` has it.

    Parameters
    ----------
    f_hz
        A frequency for each board.
    parts
        R1 to R5 and C1 to C3, one row each; then C14 and C20, where the board has them.
    gain_bandwidth_hz
        Of the amplifier.
    """
    R1, R2, R3, R4, R5, C1, C2, C3 = parts[:8]
    s = 2j * np.pi * f_hz
    inverse = 1.0 / OPEN_LOOP_GAIN + 1j * f_hz / gain_bandwidth_hz
    if len(parts) > 8:
        C14, C20 = parts[8:]
        G = 1.0 + R5 / ((1.0 + s * (R5 * C20)) * (R4 + 1.0 / (s * C14)))
    else:
        G = 1.0 + R5 / R4
    pole, square = s * (R1 * C1), s * s * (R2 * R3 * C2 * C3)
    # The buffer's gain is K = A / (1 + A), and 1 - K lets a little of R3 into the section's damping.
    K = 1.0 / (1.0 + inverse)
    section = K * square / (square + s * (R2 * (C2 + C3) + (1.0 - K) * R3 * C3) + 1.0)
    whole = pole / (1.0 + pole) / (1.0 / G + inverse) * section
    result: Array = whole.real**2 + whole.imag**2
    return result


def passbands(values: Array, gain_bandwidth_hz: float) -> tuple[Array, Array]:
    """The largest gain, and the lower frequency [Hz] where 3.0103 dB of it are lost, of values in rows."""
    parts = np.ascontiguousarray(np.moveaxis(values, -1, 0).reshape(values.shape[-1], -1))
    _, R2, R3, R4, R5, _, C2, C3 = parts[:8]
    f0 = 1.0 / (2.0 * np.pi * np.sqrt(R2 * R3 * C2 * C3))

    def power(x: Array) -> Array:
        return power_gain(f0 * np.exp(x), parts, gain_bandwidth_hz)

    last = math.log(10.0 * max(1.0, float(np.max(gain_bandwidth_hz / (1.0 + R5 / R4) / f0))))
    first = -math.log(_BELOW)
    count = math.ceil((last - first) / math.log(10.0) * _PER_DECADE)
    step = (last - first) / count
    grid = np.array([power(np.full_like(f0, first + i * step)) for i in range(count + 1)])
    at = np.clip(grid.argmax(axis=0), 1, count - 1)
    maximum = np.maximum(_largest(power, first + (at - 1) * step, first + (at + 1) * step), grid.max(axis=0))

    index = np.arange(count + 1)[:, None]
    low = first + step * np.where((grid < 0.5 * maximum) & (index < at), index, 0).max(axis=0)
    high = low + step
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        below = power(middle) < 0.5 * maximum
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    shape = values.shape[:-1]
    return np.sqrt(maximum).reshape(shape), (f0 * np.exp(high)).reshape(shape)


def _largest(power: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """The largest value between these ends, by golden sections."""
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_left, at_right = power(left), power(right)
    for _ in range(_SHRINKINGS):
        rises = at_left < at_right
        low, high = np.where(rises, left, low), np.where(rises, high, right)
        new = np.where(rises, low + _GOLDEN * (high - low), high - _GOLDEN * (high - low))
        at_new = power(new)
        left, right = np.where(rises, right, new), np.where(rises, new, left)
        at_left, at_right = np.where(rises, at_right, at_new), np.where(rises, at_new, at_left)
    return np.maximum(at_left, at_right)
