"""Normal vibration: the surface's profile passes under the pad and shakes it through its resonance.

A wavelength lambda passing at v excites v/lambda. Its height times the contact's normal stiffness is the
force that drives the resonance, so vibration grows with roughness and, by the stiffness, with load. The pad
is taken to follow the profile at its summits, without averaging over the patch: an upper bound (assumption).
"""

from __future__ import annotations

import math
import random
from collections.abc import MutableSequence, Sequence

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.jit import CompiledLoop

HURST = 0.8
"""Exponent of the self-affine profile (B. N. J. Persson et al., J. Phys.: Condens. Matter 17, 2005, R1)."""
_ROUGH_OCTAVES = 5
"""Octaves of roughness below the cutoff wavelength: up to 0.5 kHz and more at 4 cm/s, far above the resonance."""
_WAVY_OCTAVES = 2
"""Octaves of waviness above it, where the self-affine spectrum is taken to go on. Assumption."""
_PER_OCTAVE = 6
_SPACING_M = 5e-6


def profile(rng: random.Random, roughness_um: float, cutoff_m: float, length_m: float) -> Array:
    """Heights [m] of one line across a surface, every `_SPACING_M`.

    Waves of random phase, amplitudes as lambda^H, scaled so that those up to the cutoff wavelength [m] have
    the roughness: a Gaussian profile's rms is ``Ra sqrt(pi / 2)``.
    """
    count = math.ceil(length_m / _SPACING_M) + 2
    waves, square = [], 0.0
    for i in range(-_WAVY_OCTAVES * _PER_OCTAVE, _ROUGH_OCTAVES * _PER_OCTAVE):
        octave = (i + rng.random()) / _PER_OCTAVE  # not on a lattice: no beats of a common period
        amplitude = 2.0 ** (-HURST * octave)
        square += amplitude * amplitude / 2 if octave >= 0.0 else 0.0
        waves.append((amplitude, 2 * math.pi * 2.0**octave / cutoff_m, 2 * math.pi * rng.random()))
    scale = roughness_um * 1e-6 * math.sqrt(math.pi / 2) / math.sqrt(square)
    # The rotation by one spacing needs no cosine per point, and no vector cosine, whose last bit varies.
    turns = [complex(math.cos(k * _SPACING_M), math.sin(k * _SPACING_M)) for _, k, _ in waves]
    starts = [scale * amplitude * complex(math.cos(phase), math.sin(phase)) for amplitude, _, phase in waves]
    heights = np.zeros(count)
    _rotate(np.array(starts), np.array(turns), heights)
    return heights


def _rotate_loop(starts: Sequence[complex], turns: Sequence[complex], heights: MutableSequence[float]) -> None:
    for wave in range(len(starts)):
        pointer, turn = starts[wave], turns[wave]
        for i in range(len(heights)):
            heights[i] += pointer.real
            pointer *= turn


def height_m(heights: Array, position_m: Array) -> Array:
    """The profile's height [m] under the pad, linear between its points, held beyond its ends."""
    return np.interp(position_m, np.arange(len(heights)) * _SPACING_M, heights)


def left_by_hand(height_m: Array, step_s: float, follow_hz: float, state: Array | None = None) -> Array:
    """What a compliant hand leaves of a height for the pad to take up [m].

    Below the frequency [Hz] at which the finger's mass swings on the hand, the hand rides up and down with the
    surface; above it the mass stays and the pad yields. A first-order follower stands for that swing (assumption: the
    hand is well damped). `state` of shape (1,), at first the first height, carries the hand's from chunk to chunk.
    """
    share = 1 - math.exp(-2 * math.pi * follow_hz * step_s)
    out = np.zeros(len(height_m))
    _follow(share, height_m, height_m[:1].copy() if state is None else state, out)
    return out


def _follow_loop(
    share: float, heights: Sequence[float], state: MutableSequence[float], out: MutableSequence[float]
) -> None:
    hand = state[0]
    for i in range(len(heights)):
        out[i] = heights[i] - hand
        hand += share * (heights[i] - hand)
    state[0] = hand


def resonate(
    drive_n: Array,
    touching: NDArray[np.bool_],
    step_s: float,
    frequency_hz: float,
    damping_ratio: float,
    state: Array | None = None,
) -> Array:
    """Contact force [N] from the force that drives the pad: a second-order low-pass of unit gain at rest.

    Exact for a drive that is linear between grid points. Where the finger does not touch, the force is
    exactly 0 and the resonance starts anew; where the surface would have to pull, it is 0. `state` of shape (3,), at
    first 0, carries force, rate and drive from chunk to chunk.
    """
    w, zeta, h = 2 * math.pi * frequency_hz, damping_ratio, step_s
    wd = w * math.sqrt(1 - zeta * zeta)
    decay = math.exp(-zeta * w * h)
    C, S = decay * math.cos(wd * h), decay * math.sin(wd * h) / wd
    # e = y - (particular solution of the ramp), which swings freely: e'' + 2 zeta w e' + w^2 e = 0.
    a11, a12, a21, a22 = C + zeta * w * S, S, -w * w * S, C - zeta * w * S
    lag = 2 * zeta / w
    out = np.zeros(len(drive_n))
    _swing((a11, a12, a21, a22), lag, h, drive_n, touching, np.zeros(3) if state is None else state, out)
    return out


def _swing_loop(
    free: tuple[float, float, float, float],
    lag: float,
    h: float,
    drive: Sequence[float],
    touching: Sequence[bool],
    state: MutableSequence[float],
    out: MutableSequence[float],
) -> None:
    a11, a12, a21, a22 = free
    y, rate, before = state[0], state[1], state[2]
    for i in range(len(drive)):
        now = drive[i]
        if touching[i]:
            ramp = (now - before) / h
            e, de = y - (before - lag * ramp), rate - ramp
            y = a11 * e + a12 * de + now - lag * ramp
            rate = a21 * e + a22 * de + ramp
        else:
            y = rate = 0.0
        before = now
        out[i] = y if y > 0.0 else 0.0
    state[0], state[1], state[2] = y, rate, before


_rotate = CompiledLoop(_rotate_loop, outputs=1, samples="heights", plain_us=8.0)
_follow = CompiledLoop(_follow_loop, outputs=2, samples="heights", plain_us=0.3)
_swing = CompiledLoop(_swing_loop, outputs=2, samples="drive", plain_us=0.4)
