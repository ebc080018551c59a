"""Heights of a surface along the line on which a pad slides: rough, ridged or measured.

A rough profile is a sum of waves with random phases and amplitudes proportional to lambda^H, the
self-affine spectrum of B. N. J. Persson et al. (J. Phys.: Condens. Matter 17, 2005, R1). Its scale
makes the waves up to the cutoff wavelength have the given roughness: the RMS height of a Gaussian
profile is ``Ra sqrt(pi / 2)``. Ridges are one more wave. A measured profile begins at a random
place, if it is longer than the slide.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.foundation.numerics import Array
from fingertip.sim.contact.surface_files import SurfaceTable

_ROUGH_OCTAVES = 5
"""Octaves of roughness below the cutoff wavelength: to at least 0.5 kHz at 4 cm/s, far above the
resonance.
"""
_WAVY_OCTAVES = 2
"""Octaves of waviness above the cutoff wavelength, where the self-affine spectrum is assumed to
continue.
"""
_PER_OCTAVE = 6
_SPACING_M = 5e-6
_AT_ONCE = 3
"""Number of waves that one pass adds: a rough profile has 42 of them."""


@dataclass(frozen=True, eq=False)
class SurfaceProfile:
    """Heights [m] and slopes at equal distances along one line across a surface."""

    start_m: float
    heights_m: Array
    slopes: Array
    spacing_m: float = _SPACING_M

    def height_m(self, position_m: Array) -> Array:
        """Height under a pad [m]: a cubic through heights and slopes, constant beyond the ends."""
        out = np.zeros(len(position_m))
        _interpolate(self.spacing_m, self.start_m, self.heights_m, self.slopes, position_m, out)
        return out


def generate_profile(
    rng: random.Random,
    surface: SurfaceTable,
    start_m: float,
    length_m: float,
    patch_radius_m: float = 0.0,
) -> SurfaceProfile:
    """Generate the heights of a surface, whose table is complete, or cut them out of a measured
    profile.
    """
    if surface.profile_um:
        return _cut_profile(rng, surface, start_m, length_m, patch_radius_m)

    count = math.ceil(length_m / _SPACING_M) + 2
    cutoff_m = 1e-3 * surface.longest_wave_mm
    waves = []
    square = 0.0

    for i in range(-_WAVY_OCTAVES * _PER_OCTAVE, _ROUGH_OCTAVES * _PER_OCTAVE):
        octave = (
            i + rng.random()
        ) / _PER_OCTAVE  # random wavelengths share no common period, so they do not beat
        amplitude = 2.0 ** (-surface.hurst * octave)
        square += amplitude * amplitude / 2 if octave >= 0.0 else 0.0
        waves.append((amplitude, 2 * math.pi * 2.0**octave / cutoff_m, 2 * math.pi * rng.random()))

    felt_um = surface.felt_um * surface.roughness_um**surface.felt_exponent
    scale = felt_um * 1e-6 * math.sqrt(math.pi / 2) / math.sqrt(square)
    waves = [(scale * amplitude, k, phase) for amplitude, k, phase in waves]

    if surface.ridge_depth_um:
        number = 2 * math.pi / (1e-3 * surface.ridge_pitch_mm)
        waves.append((1e-6 * surface.ridge_depth_um / 2, number, 2 * math.pi * rng.random()))

    averaged = [
        (amplitude * average_over_patch(k * patch_radius_m), k, phase)
        for amplitude, k, phase in waves
    ]
    return SurfaceProfile(start_m, *sum_waves(averaged, _SPACING_M, count))


def sum_waves(
    waves: Sequence[tuple[float, float, float]], spacing: float, count: int
) -> tuple[Array, Array]:
    """Sum waves of amplitude, wave number and phase at equal distances.

    Return their sum and its slope.

    Each wave is a phasor that turns by a fixed angle per point. This needs no cosine per point, and
    no vectorised cosine, whose last bit varies between processors.
    """
    turns = [complex(math.cos(k * spacing), math.sin(k * spacing)) for _, k, _ in waves]
    starts = [
        amplitude * complex(math.cos(phase), math.sin(phase)) for amplitude, _, phase in waves
    ]
    numbers = [k for _, k, _ in waves]
    spare = -len(waves) % _AT_ONCE
    heights = np.zeros(count)
    slopes = np.zeros(count)
    _sum_waves(
        np.array(starts + [0j] * spare),
        np.array(turns + [1 + 0j] * spare),
        np.array(numbers + [0.0] * spare),
        heights,
        slopes,
    )

    return heights, slopes


def _cut_profile(
    rng: random.Random,
    surface: SurfaceTable,
    start_m: float,
    length_m: float,
    patch_radius_m: float,
) -> SurfaceProfile:
    heights = 1e-6 * np.array(surface.profile_um)
    step_m = 1e-6 * surface.profile_step_um
    reach = int(patch_radius_m / step_m)

    if reach > 0:
        # `average_over_patch` in space: pressure over a round patch, summed across the line, is a
        # parabola along it.
        x = np.arange(-reach, reach + 1) * step_m / patch_radius_m
        weights = 1.0 - x * x
        heights = np.convolve(
            np.pad(heights, reach, mode="edge"), weights / weights.sum(), mode="valid"
        )

    spare_m = max(0.0, (len(heights) - 1) * step_m - length_m)
    first = int(rng.random() * spare_m / step_m)
    heights = heights[first:]
    return SurfaceProfile(start_m, heights, np.gradient(heights, step_m), step_m)


def average_over_patch(angle: float) -> float:
    """Fraction of a wave's amplitude that is left after averaging over a round contact patch.

    Heights are weighted by the pressure, ``sqrt(1 - r^2 / a^2)`` of a Hertzian contact, and the
    surface is the same across the line. A wave of wave number k then keeps ``3 (sin u - u cos u) /
    u^3`` with u = k a.
    """
    if angle < 1e-2:
        return 1 - angle * angle / 10

    return 3 * (math.sin(angle) - angle * math.cos(angle)) / angle**3


def _sum_waves_loop(
    starts: Sequence[complex],
    turns: Sequence[complex],
    numbers: Floats,
    heights: MutableFloats,
    slopes: MutableFloats,
) -> None:
    """Add rotating phasors, three at a time, which do not wait for each other.

    The real part of each is a height, its negative imaginary part times k a slope.
    """
    for wave in range(0, len(starts), _AT_ONCE):
        p0 = starts[wave]
        p1 = starts[wave + 1]
        p2 = starts[wave + 2]
        t0 = turns[wave]
        t1 = turns[wave + 1]
        t2 = turns[wave + 2]
        k0 = numbers[wave]
        k1 = numbers[wave + 1]
        k2 = numbers[wave + 2]

        for i in range(len(heights)):
            heights[i] = heights[i] + p0.real + p1.real + p2.real
            slopes[i] = slopes[i] - k0 * p0.imag - k1 * p1.imag - k2 * p2.imag
            p0 *= t0
            p1 *= t1
            p2 *= t2


def _interpolate_loop(
    spacing: float,
    start: float,
    heights: Floats,
    slopes: Floats,
    position: Floats,
    out: MutableFloats,
) -> None:
    last = len(heights) - 1
    for i in range(len(position)):
        at = (position[i] - start) / spacing
        if at <= 0.0:
            out[i] = heights[0]
        elif at >= last:
            out[i] = heights[last]
        else:
            j = int(at)
            t = at - j
            rise = heights[j + 1] - heights[j]
            before = spacing * slopes[j]
            after = spacing * slopes[j + 1]
            out[i] = heights[j] + t * (
                before + t * (3 * rise - 2 * before - after + t * (before + after - 2 * rise))
            )


_sum_waves = CompiledLoop(_sum_waves_loop, samples="heights", plain_us=6.0)
_interpolate = CompiledLoop(_interpolate_loop, samples="position", plain_us=0.5)
