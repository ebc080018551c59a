"""Normal vibration of a soft pad: the surface profile that passes under it, the resonance of the
finger on it.
"""

from __future__ import annotations

import math

import numpy as np

from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.foundation.numerics import Array
from fingertip.pad.response import Pad
from fingertip.sim.contact.friction import LOAD_SCALE_N
from fingertip.sim.contact.surfaces import SurfaceProfile


def cube_root(values: Array) -> Array:
    """Cube root of values from 1e-12 to 1e4, or of 0, by Newton's method, which every processor
    rounds alike.
    """
    x = np.where(values > 1e-12, values, 1.0)
    y = np.sqrt(np.sqrt(x))
    for _ in range(9):
        y = (2 * y + x / (y * y)) / 3

    return np.where(values > 1e-12, y, 0.0)


def smoothstep(x: Array) -> Array:
    """Smooth step from 0 at 0 to 1 at 1, with zero slope at both ends: ``x^2 (3 - 2 x)``."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3 - 2 * x)


# Normal vibration: the surface profile passes under the pad and excites its resonance.
#
# A wavelength lambda that passes at speed v excites the frequency v/lambda. Its height times the
# normal stiffness of the contact is the force that drives the resonance. So vibration grows with
# the roughness and, through the stiffness, with the load, by the law of the surface
# (`SurfaceTable.load_law`). Unless a scene asks for the average over the contact patch, the pad
# follows the summits of one line, which gives an upper bound.
#
# Both filters are exact for ramps. Ramps cut a curve u(t) short by h^2 u'' / 12 on average, so
# their ends are moved by as much, which gives order 4. u'' is that of the cubic through the last
# four points of the grid.

_HAND, _HEIGHT, _HEIGHT_1, _HEIGHT_2, _HEIGHT_3 = range(5)
"""Indices of the state of the hand that follows a surface: its height, the end of the previous ramp
of the surface, and the last three heights of the surface [m].
"""
_FORCE, _RATE, _DRIVE, _ONE, _TWO, _THREE = range(6)
"""Indices of the state of the resonance: force [N], its rate [N/s], the end of the previous ramp of
the drive, and the last three drives [N].
"""


def end_ramp(u: float, u1: float, u2: float, u3: float) -> float:
    """End of the ramp that stands for a curve, from its last four points."""
    return (10.0 * u + 5.0 * u1 - 4.0 * u2 + u3) * (1 / 12)


def transmit(load_n: Array) -> Array:
    """Fraction of a shaking force that reaches the contact: all of it under load, and none without
    contact.

    It begins in proportion to the load. A force that began all at once, between two points of the
    grid, would have no order 2.
    """
    return np.asarray(load_n / (load_n + LOAD_SCALE_N))


class ProfileForce:
    """Force with which a surface profile shakes a pad, chunk by chunk.

    Below the resonance of the finger's mass on the hand, the hand moves up and down with the
    surface, as far as its stiffness allows (`Pad.follow_share`). Above it the mass stays where it
    is and the pad deforms. A first-order low-pass filter of the hand's motion models this
    (assumption: the hand is well damped).
    """

    def __init__(
        self,
        pad: Pad,
        profile: SurfaceProfile,
        is_proportional: bool,
        step_s: float,
    ) -> None:
        self._is_proportional = is_proportional
        self._stiffness_at_1n = pad.normal_stiffness_n_per_m(1.0)
        self._profile = profile
        self._step_s = step_s
        self._hand_hz = pad.backing.resonance_hz
        self._follow_share = pad.follow_share
        self._state: Array | None = None
        self._origin_m = 0.0

    def process(self, load_n: Array, path_m: Array) -> Array:
        """Return the force [N] under a load [N] at positions along the profile [m]."""
        height = self._profile.height_m(path_m)
        if self._state is None:
            # the hand has followed the surface so far
            self._state = np.zeros(5)
            self._origin_m = height[0]

        deflection = high_pass(
            height - self._origin_m, self._step_s, self._hand_hz, self._state, self._follow_share
        )
        # The load N presses the pad into the profile: stiffness at the present force, and none
        # without contact. As a ball's it grows with N^(1/3), but begins in proportion to N: a
        # vertical slope would cost the order 2.
        grown_n = (
            load_n if self._is_proportional else load_n / cube_root(load_n + LOAD_SCALE_N) ** 2
        )
        return self._stiffness_at_1n * grown_n * deflection


class ContactResonance:
    """Contact force from the force that drives the pad, chunk by chunk: a second-order low-pass
    with unit gain at 0 Hz.

    Where the finger does not touch, the force is exactly 0 and the resonance restarts from zero.
    Where the surface would have to pull, the force is 0.
    """

    def __init__(self, step_s: float, frequency_hz: float, damping_ratio: float) -> None:
        w = 2 * math.pi * frequency_hz
        zeta = damping_ratio
        h = step_s
        wd = w * math.sqrt(1 - zeta * zeta)
        decay = math.exp(-zeta * w * h)
        C = decay * math.cos(wd * h)
        S = decay * math.sin(wd * h) / wd
        # For a drive that is a ramp, y = particular solution + e, where e decays freely: e'' + 2
        # zeta w e' + w^2 e = 0. One step multiplies (e, e') by this matrix.
        self._free = (C + zeta * w * S, S, -w * w * S, C - zeta * w * S)
        self._lag = 2 * zeta / w
        self._step_s = h
        self._state = np.zeros(6)

    def process(self, drive_n: Array, load_n: Array, jump_n: Array | None = None) -> Array:
        """Return the contact force [N].

        A drive may jump by `jump_n` [N] right after the previous point.
        """
        out = np.zeros(len(drive_n))
        jumps = np.zeros(len(drive_n)) if jump_n is None else jump_n
        _resonate(self._free, self._lag, self._step_s, drive_n, jumps, load_n, self._state, out)

        return out


def high_pass(
    height_m: Array,
    step_s: float,
    follow_hz: float,
    state: Array,
    follow_share: float = 1.0,
) -> Array:
    """Deflection of a pad over heights [m] that the hand follows by a share below `follow_hz`.

    Units: `state` [m].
    """
    w = 2 * math.pi * follow_hz
    deflection = np.zeros(len(height_m))
    _high_pass(math.exp(-w * step_s), 1 / w, step_s, follow_share, height_m, state, deflection)

    return deflection


def _high_pass_loop(
    decay: float,
    lag: float,
    h: float,
    share: float,
    heights: Floats,
    state: MutableFloats,
    out: MutableFloats,
) -> None:
    """Subtract a share of the hand's height, a first-order low-pass of the heights."""
    hand = state[_HAND]
    before = state[_HEIGHT]
    u1 = state[_HEIGHT_1]
    u2 = state[_HEIGHT_2]
    u3 = state[_HEIGHT_3]

    for i in range(len(heights)):
        now = end_ramp(heights[i], u1, u2, u3)
        u3 = u2
        u2 = u1
        u1 = heights[i]
        # On a ramp the hand stays `lag` seconds behind; what differs from that decays.
        behind = lag * ((now - before) / h)
        hand = (hand - before + behind) * decay + now - behind
        before = now
        out[i] = u1 - share * hand

    state[_HAND] = hand
    state[_HEIGHT] = before
    state[_HEIGHT_1] = u1
    state[_HEIGHT_2] = u2
    state[_HEIGHT_3] = u3


def _resonance_loop(
    free: tuple[float, float, float, float],
    lag: float,
    h: float,
    drive: Floats,
    jump: Floats,
    load: Floats,
    state: MutableFloats,
    out: MutableFloats,
) -> None:
    a11, a12, a21, a22 = free
    y = state[_FORCE]
    rate = state[_RATE]
    before = state[_DRIVE]
    u1 = state[_ONE]
    u2 = state[_TWO]
    u3 = state[_THREE]

    for i in range(len(drive)):
        before = before + jump[i]
        u1 = u1 + jump[i]
        u2 = u2 + jump[i]
        u3 = u3 + jump[i]
        now = end_ramp(drive[i], u1, u2, u3)
        u3 = u2
        u2 = u1
        u1 = drive[i]

        if load[i] > 0.0:
            # Subtract the particular solution (drive - lag * ramp), advance the free part, add the
            # solution again.
            ramp = (now - before) / h
            e = y - (before - lag * ramp)
            de = rate - ramp
            y = a11 * e + a12 * de + now - lag * ramp
            rate = a21 * e + a22 * de + ramp
        else:
            y = rate = 0.0

        before = now
        out[i] = y if y > 0.0 else 0.0

    state[_FORCE] = y
    state[_RATE] = rate
    state[_DRIVE] = before
    state[_ONE] = u1
    state[_TWO] = u2
    state[_THREE] = u3


_high_pass = CompiledLoop(_high_pass_loop, end_ramp, samples="heights", plain_us=0.3)
_resonate = CompiledLoop(_resonance_loop, end_ramp, samples="drive", plain_us=0.35)
