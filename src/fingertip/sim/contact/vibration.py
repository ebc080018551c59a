"""Normal vibration: the surface profile passes under the pad and excites its resonance.

A wavelength lambda that passes at speed v excites the frequency v/lambda. Its height times the normal stiffness of the
contact is the force that drives the resonance. So vibration grows with the roughness and, through the stiffness, with
the load. The pad is assumed to follow the summits of the profile without averaging over the contact patch, which gives
an upper bound.
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
"""Hurst exponent of the self-affine profile (B. N. J. Persson et al., J. Phys.: Condens. Matter 17, 2005, R1)."""
_ROUGH_OCTAVES = 5
"""Octaves of roughness below the cutoff wavelength: to at least 0.5 kHz at 4 cm/s, far above the resonance."""
_WAVY_OCTAVES = 2
"""Octaves of waviness above the cutoff wavelength, where the self-affine spectrum is assumed to continue."""
_PER_OCTAVE = 6
"""Waves per octave."""
_SPACING_M = 5e-6
"""Spacing of the profile's points [m]."""
_FORCE, _RATE, _DRIVE = range(3)
"""Indices of the state of the resonance: force [N], its rate [N/s], and the previous drive [N]."""


def generate_profile(rng: random.Random, roughness_um: float, cutoff_m: float, length_m: float) -> Array:
    """Generate the heights [m] of one line across a surface, every `_SPACING_M`.

    The profile is a sum of waves with random phases and amplitudes proportional to lambda^H. Its scale makes the waves
    up to the cutoff wavelength have the given roughness: the RMS height of a Gaussian profile is ``Ra sqrt(pi / 2)``.

    Parameters
    ----------
    rng
        Source of phases and wavelengths.
    roughness_um
        Arithmetic mean deviation Ra [um].
    cutoff_m
        Cutoff wavelength between roughness and waviness [m].
    length_m
        Length of the line [m].
    """
    count = math.ceil(length_m / _SPACING_M) + 2
    waves, square = [], 0.0
    for i in range(-_WAVY_OCTAVES * _PER_OCTAVE, _ROUGH_OCTAVES * _PER_OCTAVE):
        octave = (i + rng.random()) / _PER_OCTAVE  # random wavelengths share no common period, so they do not beat
        amplitude = 2.0 ** (-HURST * octave)
        square += amplitude * amplitude / 2 if octave >= 0.0 else 0.0
        waves.append((amplitude, 2 * math.pi * 2.0**octave / cutoff_m, 2 * math.pi * rng.random()))
    scale = roughness_um * 1e-6 * math.sqrt(math.pi / 2) / math.sqrt(square)
    # Each wave is a phasor that turns by a fixed angle per point. This needs no cosine per point, and no vectorised
    # cosine, whose last bit varies between processors.
    turns = [complex(math.cos(k * _SPACING_M), math.sin(k * _SPACING_M)) for _, k, _ in waves]
    starts = [scale * amplitude * complex(math.cos(phase), math.sin(phase)) for amplitude, _, phase in waves]
    heights = np.zeros(count)
    _sum_waves(np.array(starts), np.array(turns), heights)
    return heights


def _sum_waves_loop(starts: Sequence[complex], turns: Sequence[complex], heights: MutableSequence[float]) -> None:
    """Add the real part of each rotating phasor to the heights."""
    for wave in range(len(starts)):
        pointer, turn = starts[wave], turns[wave]
        for i in range(len(heights)):
            heights[i] += pointer.real
            pointer *= turn


def interpolate_height_m(heights: Array, position_m: Array) -> Array:
    """Height of the profile under the pad [m]: linear between its points, constant beyond its ends."""
    return np.interp(position_m, np.arange(len(heights)) * _SPACING_M, heights)


def compute_pad_deflection_m(height_m: Array, step_s: float, follow_hz: float, state: Array | None = None) -> Array:
    """Deflection of the pad over a height profile, after the compliant hand has followed its slow part [m].

    Below the resonance of the finger's mass on the hand, the hand moves up and down with the surface. Above it the mass
    stays where it is and the pad deforms. A first-order high-pass filter models this (assumption: the hand is well
    damped).

    Parameters
    ----------
    height_m
        Height of the surface under the pad [m], per step.
    step_s
        Step [s].
    follow_hz
        Resonance of the finger's mass on the hand [Hz].
    state
        Height of the hand, shape (1,), carried from chunk to chunk. Starts at the first height.
    """
    coefficient = 1 - math.exp(-2 * math.pi * follow_hz * step_s)
    out = np.zeros(len(height_m))
    _high_pass(coefficient, height_m, height_m[:1].copy() if state is None else state, out)
    return out


def _high_pass_loop(
    coefficient: float, heights: Sequence[float], state: MutableSequence[float], out: MutableSequence[float]
) -> None:
    """Subtract the height of the hand, a first-order low-pass of the heights."""
    hand = state[0]
    for i in range(len(heights)):
        out[i] = heights[i] - hand
        hand += coefficient * (heights[i] - hand)
    state[0] = hand


def apply_resonance(
    drive_n: Array,
    touching: NDArray[np.bool_],
    step_s: float,
    frequency_hz: float,
    damping_ratio: float,
    state: Array | None = None,
) -> Array:
    """Contact force [N] from the driving force: a second-order low-pass filter with unit gain at 0 Hz.

    The solution is exact for a drive that is linear between grid points. Where the finger does not touch, the force is
    exactly 0 and the resonance restarts from zero. Where the surface would have to pull, the force is 0.

    Parameters
    ----------
    drive_n
        Force that drives the pad [N], per step.
    touching
        Whether the finger touches, per step.
    step_s
        Step [s].
    frequency_hz, damping_ratio
        Resonance of the contact [Hz] and its damping ratio.
    state
        Force, its rate and the drive, shape (3,), carried from chunk to chunk. Starts at 0.
    """
    w, zeta, h = 2 * math.pi * frequency_hz, damping_ratio, step_s
    wd = w * math.sqrt(1 - zeta * zeta)
    decay = math.exp(-zeta * w * h)
    C, S = decay * math.cos(wd * h), decay * math.sin(wd * h) / wd
    # For a drive that is a ramp, y = particular solution + e, where e decays freely: e'' + 2 zeta w e' + w^2 e = 0.
    # One step multiplies (e, e') by the matrix a.
    a11, a12, a21, a22 = C + zeta * w * S, S, -w * w * S, C - zeta * w * S
    lag = 2 * zeta / w
    out = np.zeros(len(drive_n))
    _resonate((a11, a12, a21, a22), lag, h, drive_n, touching, np.zeros(3) if state is None else state, out)
    return out


def _resonance_loop(
    free: tuple[float, float, float, float],
    lag: float,
    h: float,
    drive: Sequence[float],
    touching: Sequence[bool],
    state: MutableSequence[float],
    out: MutableSequence[float],
) -> None:
    """Advance the damped resonance exactly under a piecewise linear drive."""
    a11, a12, a21, a22 = free
    y, rate, before = state[_FORCE], state[_RATE], state[_DRIVE]
    for i in range(len(drive)):
        now = drive[i]
        if touching[i]:
            # Subtract the particular solution (drive - lag * ramp), advance the free part, add the solution again.
            ramp = (now - before) / h
            e, de = y - (before - lag * ramp), rate - ramp
            y = a11 * e + a12 * de + now - lag * ramp
            rate = a21 * e + a22 * de + ramp
        else:
            y = rate = 0.0
        before = now
        out[i] = y if y > 0.0 else 0.0
    state[_FORCE], state[_RATE], state[_DRIVE] = y, rate, before


_sum_waves = CompiledLoop(_sum_waves_loop, outputs=1, samples="heights", plain_us=4.0)
_high_pass = CompiledLoop(_high_pass_loop, outputs=2, samples="heights", plain_us=0.3)
_resonate = CompiledLoop(_resonance_loop, outputs=2, samples="drive", plain_us=0.3)
