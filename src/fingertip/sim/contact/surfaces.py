"""Surfaces of the article, and the heights of a rough surface along the line on which a pad slides.

The profile is a sum of waves with random phases and amplitudes proportional to lambda^H. Its scale makes the waves up
to the cutoff wavelength have the given roughness: the RMS height of a Gaussian profile is ``Ra sqrt(pi / 2)``.
"""

from __future__ import annotations

import math
import random
from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.foundation.jit import CompiledLoop
from fingertip.foundation.numerics import Array
from fingertip.sim.contact.friction import Friction

HURST = 0.8
"""Hurst exponent of the self-affine profile (B. N. J. Persson et al., J. Phys.: Condens. Matter 17, 2005, R1)."""
_ROUGH_OCTAVES = 5
"""Octaves of roughness below the cutoff wavelength: to at least 0.5 kHz at 4 cm/s, far above the resonance."""
_WAVY_OCTAVES = 2
"""Octaves of waviness above the cutoff wavelength, where the self-affine spectrum is assumed to continue."""
_PER_OCTAVE = 6
_SPACING_M = 5e-6


@dataclass(frozen=True, eq=False)
class SurfaceProfile:
    """Heights [m] and slopes at equal distances along one line across a surface."""

    start_m: float
    heights_m: Array
    slopes: Array
    spacing_m: float = _SPACING_M

    def height_m(self, position_m: Array) -> Array:
        """Height under a pad [m]: the cubic through heights and slopes, constant beyond the ends."""
        out = np.zeros(len(position_m))
        _interpolate(self.spacing_m, self.start_m, self.heights_m, self.slopes, position_m, out)
        return out


def generate_profile(
    rng: random.Random,
    roughness_um: float,
    cutoff_m: float,
    start_m: float,
    length_m: float,
    patch_radius_m: float = 0.0,
) -> SurfaceProfile:
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
    starts = [
        scale * amplitude * average_over_patch(k * patch_radius_m) * complex(math.cos(phase), math.sin(phase))
        for amplitude, k, phase in waves
    ]
    numbers = np.array([k for _, k, _ in waves])
    heights, slopes = np.zeros(count), np.zeros(count)
    _sum_waves(np.array(starts), np.array(turns), numbers, heights, slopes)
    return SurfaceProfile(start_m, heights, slopes)


def average_over_patch(angle: float) -> float:
    """Fraction of a wave's amplitude that is left after averaging over a round contact patch.

    Heights are weighted by the pressure, ``sqrt(1 - r^2 / a^2)`` of a Hertzian contact, and the surface is the same
    across the line. A wave of wave number k then keeps ``3 (sin u - u cos u) / u^3`` with u = k a.
    """
    if angle < 1e-2:
        return 1 - angle * angle / 10
    return 3 * (math.sin(angle) - angle * math.cos(angle)) / angle**3


def _sum_waves_loop(
    starts: Sequence[complex],
    turns: Sequence[complex],
    numbers: Sequence[float],
    heights: MutableSequence[float],
    slopes: MutableSequence[float],
) -> None:
    """Add each rotating phasor: its real part is a height, its negative imaginary part times k a slope."""
    for wave in range(len(starts)):
        pointer, turn, k = starts[wave], turns[wave], numbers[wave]
        for i in range(len(heights)):
            heights[i] += pointer.real
            slopes[i] -= k * pointer.imag
            pointer *= turn


def _interpolate_loop(
    spacing: float,
    start: float,
    heights: Sequence[float],
    slopes: Sequence[float],
    position: Sequence[float],
    out: MutableSequence[float],
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
            before, after = spacing * slopes[j], spacing * slopes[j + 1]
            out[i] = heights[j] + t * (before + t * (3 * rise - 2 * before - after + t * (before + after - 2 * rise)))


_sum_waves = CompiledLoop(_sum_waves_loop, outputs=2, samples="heights", plain_us=6.0)
_interpolate = CompiledLoop(_interpolate_loop, outputs=1, samples="position", plain_us=0.5)


# The article's six flat surfaces: friction per newton of normal force, and roughness.
#
# The roughness of the three metals is the article's (section III.C). The cutoff wavelength for a roughness is that of
# ISO 4288, table 1 (Ra above 0.1 to 2 um: 0.8 mm; above 2 to 10 um: 2.5 mm). All other values are assumptions: the
# article gives no friction coefficient and calls the roughness of the other surfaces unknown. Their order follows the
# article (section IV): wood is rougher than paper and plastic, and smoother surfaces have less friction.


@dataclass(frozen=True)
class Surface:
    label: str
    roughness_um: float
    """Arithmetic mean deviation Ra of the profile [um]."""
    friction: Friction

    @property
    def cutoff_wavelength_m(self) -> float:
        """Longest wavelength that counts as roughness [m] (ISO 4288, table 1). Longer ones count as waviness."""
        return 0.8e-3 if self.roughness_um <= 2.0 else 2.5e-3


SURFACES: dict[str, Surface] = {
    "smooth": Surface("metal, Ra 0.2 um", 0.2, Friction(0.50, 0.40)),
    "medium": Surface("metal, Ra 0.8 um", 0.8, Friction(0.60, 0.48)),
    # "gross" is the article's word for its coarse metal; it has nothing to do with gross slip.
    "gross": Surface("metal, Ra 3.2 um", 3.2, Friction(0.75, 0.60)),
    "wood": Surface("wood", 5.0, Friction(0.70, 0.56)),
    "paper": Surface("book cover", 1.6, Friction(0.60, 0.48)),
    "plastic": Surface("smartphone cover, in the article also called rubber", 1.2, Friction(0.55, 0.44)),
}
