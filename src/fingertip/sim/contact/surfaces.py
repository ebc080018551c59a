"""Surfaces: LuGre friction under a varying normal force, the definition of gross slip, and rough profiles.

    z     = c s,   c = 1 / sqrt(N + N0)                                 mean bristle deflection
    L     = v - alpha(v, z) sigma0 |v| z / g(v)                         rate at which motion bends bristles
    ds/dt = N c L - r(N, z) s
    mu    = sigma0 z + sigma1 c ds/dt + sigma2 v,   friction force N mu

At constant load this is the model of C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, IEEE Trans. Automatic
Control 40(3), 1995, doi:10.1109/9.376053, with alpha = 1. The Stribeck curve g has the rational form of D. P. Hess and
A. Soom (Trans. ASME J. Tribology 112(1), 1990), which needs no exponential. Elasto-plastic bristles (alpha): P. Dupont,
V. Hayward, B. Armstrong, F. Altpeter, IEEE Trans. Automatic Control 47(5), 2002, doi:10.1109/TAC.2002.1000274.

The state is s, because the bristles store the energy ``sigma0 s^2 / 2``. A change of the load at rest leaves s and this
energy as they are. With z as state, as usual, the stored energy ``sigma0 N z^2 / 2`` would grow with the load, and
nobody would have done that work. Friction is therefore passive under any load, with the bound of `Friction.is_passive`.

Bristles relax at the rate ``r = R ((1 - N / N0)+ + (sigma0 |z| / mu_s - 1)+)``, which only takes energy: where the load
is nearly gone, and where a falling load has left them more friction than breakaway. At constant load they never are.
(Relaxation is part of the damping sigma1 too, which is harmless while sigma1^2 R is far below 4 sigma0 sigma2.)
"""

from __future__ import annotations

import math
import random
from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.jit import CompiledLoop
from fingertip.foundation.numerics import Array

ELASTO_PLASTIC = 0.7
"""Usual value of `Friction.elastic`: bristles yield from 0.7 of their deflection in fast sliding. Assumption."""

ROS2_GAMMA = 1 - 1 / math.sqrt(2)
"""Parameter of ROS2 that makes it L-stable (Verwer et al. 1999), the method of both loops with fixed steps."""
LOAD_SCALE_N = 1e-3
"""N0, a load far below all that matter [N]. It keeps the model smooth where contact begins and ends."""
RELAXATION_S = 1e-3
"""Time in which bristles without contact straighten up [s]. Assumption.

The loops take it as an argument: numba's cache would not notice a change of a constant in another file."""
RELAX_PER_S = 1 / RELAXATION_S
"""Rate R of this relaxation [1/s]."""
STICK_SLIP_STRIBECK_M_S = 0.06
"""Stribeck velocity of `Friction.with_stick_slip` [m/s]: friction still falls at the article's speeds. Assumption."""
GROSS_SLIP_M_S = 1e-3
"""Sliding speed above which slip is gross [m/s]; slip onset is the time at which it is first exceeded.

Assumption: 1/40 of the article's slowest slide."""


@dataclass(frozen=True)
class Friction:
    """LuGre friction of one surface, per newton of normal force. Raises TraceError."""

    mu_s: float
    """Static (breakaway) coefficient of friction."""
    mu_c: float
    """Kinetic coefficient of friction, at high speed."""
    stribeck_m_s: float = 0.005
    """Stribeck velocity, at which half of the drop from `mu_s` to `mu_c` has happened [m/s]. Assumption."""
    sigma0: float = 25e3
    """Bristle stiffness [1/m]. Assumption: breakaway after some 20 um."""
    sigma1: float = 2.0
    """Bristle damping [s/m]. Assumption within the passivity bound."""
    sigma2: float = 0.6
    """Viscous friction [s/m]. Assumption: at 8 cm/s it adds 0.05 to the coefficient."""
    elastic: float = 0.0
    """Fraction of the deflection ``mu_c / sigma0`` up to which bristles bend elastically.

    0 is plain LuGre friction, where bristles always creep."""

    def __post_init__(self) -> None:
        issues = [
            Issue(f"friction.{name}", f"{value:g} is refused; it must be a finite number above 0.")
            for name, value in vars(self).items()
            if name != "elastic" and not (math.isfinite(value) and value > 0.0)
        ]
        if not 0.0 <= self.elastic <= 0.99:
            issues.append(Issue("friction.elastic", f"{self.elastic:g} is refused; choose 0 (plain) to 0.99."))
        if not issues and self.mu_s < self.mu_c:
            issues.append(Issue("friction.mu_s", f"{self.mu_s:g} is below mu_c; at least {self.mu_c:g}."))
        if not issues and not self.is_passive:
            maximum = self.sigma2 * self.mu_c / (self.mu_s - self.mu_c)
            issues.append(
                Issue("friction.sigma1", f"{self.sigma1:g} s/m lets bristles deliver energy; below {maximum:g}.")
            )
        if issues:
            raise TraceError(issues)

    def with_stick_slip(self) -> Friction:
        """Friction that falls with speed so far and so widely that a pad swings on its mount. Assumption.

        Near 0.04 m/s and above some 1 N the pad also sticks at moments. Slower slides stay smooth, because the curve is
        flat there, and at light loads the damping of the mount is stronger.
        """
        return Friction(1.6 * self.mu_c, self.mu_c, STICK_SLIP_STRIBECK_M_S, self.sigma0, 0.2, 0.15)

    @property
    def is_passive(self) -> bool:
        """True if friction only ever takes energy: ``sigma2 > sigma1 (mu_s - mu_c) / mu_c``.

        The bound holds for plain LuGre friction (N. Barabanov, R. Ortega, IEEE Trans. Automatic Control 45(4), 2000,
        doi:10.1109/9.847131). Elasto-plastic bristles yield less, so the same bound serves for them. The tests
        ``test_friction_is_passive`` look for a counterexample with both kinds of bristles.
        """
        return self.sigma2 * self.mu_c > self.sigma1 * (self.mu_s - self.mu_c)

    def is_gross_slip(self, velocity_m_s: Array, bristle_m: Array, load_n: Array) -> NDArray[np.bool_]:
        """Return where the contact slides faster than `GROSS_SLIP_M_S`; without load nothing slides."""
        return (self.sliding_speed_m_s(velocity_m_s, bristle_m) > GROSS_SLIP_M_S) & (load_n > 0.0)

    def sliding_speed_m_s(self, velocity_m_s: Array, bristle_m: Array) -> Array:
        """Speed at which the contact slides [m/s]: the part of the velocity that does not bend bristles, ``v - dz/dt``.

        A pad that is pulled creeps as long as it sticks. Its bent bristles spring back when it is released, so bending
        is no slip. The remaining motion does not spring back: it is the plastic displacement of Dupont et al.
        """
        v, z = np.abs(velocity_m_s), np.abs(bristle_m)
        ratio = v / self.stribeck_m_s
        g = self.mu_c + (self.mu_s - self.mu_c) / (1 + ratio * ratio)
        speed = self.sigma0 * v * z / g
        if self.elastic:
            # alpha(v, z) of Dupont et al.: 0 below the elastic limit and for bristles that straighten up, 1 in sliding.
            minimum = self.elastic * self.mu_c
            fraction = np.clip((self.sigma0 * z - minimum) / (g - minimum), 0.0, 1.0)
            speed = np.where(velocity_m_s * bristle_m > 0.0, fraction * fraction * (3 - 2 * fraction) * speed, 0.0)
        return np.asarray(speed, dtype=np.float64)


# Heights of a rough surface along the line on which a pad slides.
#
# The profile is a sum of waves with random phases and amplitudes proportional to lambda^H. Its scale makes the waves up
# to the cutoff wavelength have the given roughness: the RMS height of a Gaussian profile is ``Ra sqrt(pi / 2)``.

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
    """Generate a profile."""
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
    """One test surface."""

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
