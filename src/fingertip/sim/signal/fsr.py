"""Force-sensing resistor: from the force on the pad to the force that the sensor shows."""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence

import numpy as np

from fingertip.arrays import Array
from fingertip.jit import CompiledLoop

LOAD_SHIFT_PER_M = (1 - 0.035 / 0.32) / 6e-3
"""Fraction of the force that the sensor loses per metre by which the pad is sheared towards the base [1/m].

Source: a linear finite-element trial of such a finger, in which a pad load that moved by 6 mm towards the base left
0.035 of it on the active area instead of 0.32. That the article's slide shears the pad towards the base is an
assumption.
"""
HYSTERESIS = 0.10
"""Largest relative error by which the force reads high after a higher one (article, III.B: at most 10 %)."""
_PLAY_FRACTION = 0.2
"""Fraction of the force that goes through the play operator. Assumption.

A play operator alone would pass no vibration smaller than itself, and the article's vibrations do pass."""
CREEP_FROM_S = 1.0
"""Time under load from which creep is counted in decades [s]: data sheets read the sensor then. Assumption."""
_PLAY, _LOADED = range(2)
"""Indices of the sensor's state: play [N], and the number of points since it was loaded."""


class ForceSensor:
    """Sensor with shear, hysteresis and creep, chunk by chunk.

    Hysteresis: a growing force reads true, a falling one up to `HYSTERESIS` too high. A play operator acts on the
    force's ratio, p in [F, F (1 + H/s)], and is mixed in with the fraction s. Creep: the reading grows by a fixed
    fraction per decade of time under load.

    Parameters
    ----------
    step_s
        Step of the grid [s].
    share_per_decade
        Relative increase per decade of time under load.
    """

    def __init__(self, step_s: float, share_per_decade: float = 0.0) -> None:
        self._step_s, self._share, self._state = step_s, share_per_decade, np.zeros(2)

    def process(self, contact_n: Array, shear_m: Array | None = None) -> Array:
        """Return the force that the sensor shows [N], from the contact's force [N] and the shear of the pad [m]."""
        force = contact_n
        if shear_m is not None:
            force = contact_n * np.clip(1 - LOAD_SHIFT_PER_M * shear_m, 0.0, None)
        shown = np.zeros(len(force))
        _indicate(1 + HYSTERESIS / _PLAY_FRACTION, self._share, self._step_s / CREEP_FROM_S, force, self._state, shown)
        return shown


def _indicate_loop(
    play_ratio: float,
    creep: float,
    step: float,
    forces: Sequence[float],
    state: MutableSequence[float],
    shown: MutableSequence[float],
) -> None:
    """Apply the play operator, mixed in with its fraction, and creep."""
    p, loaded = state[_PLAY], state[_LOADED]
    for i in range(len(forces)):
        force = forces[i]
        p = min(max(p, force), force * play_ratio)
        value = force + _PLAY_FRACTION * (p - force)
        if creep > 0.0:
            loaded = loaded + 1.0 if value > 0.0 else 0.0
            value *= 1 + creep * math.log10(1 + loaded * step)
        shown[i] = value
    state[_PLAY], state[_LOADED] = p, loaded


_indicate = CompiledLoop(_indicate_loop, outputs=2, samples="forces", plain_us=0.4)
