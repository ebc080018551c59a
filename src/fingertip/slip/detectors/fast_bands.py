"""The two bands of the detector `fast`: their filters, and what white noise leaves in each."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.slip.detectors.chain import ChainSettings, high_pass
from fingertip.slip.detectors.quadratic import ALARMS_PER_HOUR, bar_for

Section = tuple[float, float, float, float, float]
"""``b0, b1, b2, a1, a2``."""


@dataclass(frozen=True)
class Filters:
    """One after the other: to the low-pass' output it is the wide band, to the last the upper one."""

    first: tuple[float, float, float]
    """``b0, b1, a1`` of the third-order high-pass, as the article's."""
    second: Section
    low: Section
    upper: Section

    @classmethod
    def of(cls, sample_rate_hz: float, low_hz: float, upper_hz: float, high_hz: float) -> Filters:
        """Butterworth filters: third order above `low_hz`, second below `high_hz`, second above `upper_hz`."""
        first, second = high_pass(ChainSettings(sample_rate_hz, low_hz, 1.0, low_hz, 1, 1.0))
        return cls(
            first, second, _second_order(sample_rate_hz, high_hz, 1), _second_order(sample_rate_hz, upper_hz, -1)
        )

    @property
    def coefficients(self) -> tuple[float, ...]:
        """For the loop, which knows the numerators of the last two from b0: ``b1`` is 2 b0 or -2 b0, b2 is b0."""
        return (*self.first, *self.second, self.low[0], *self.low[3:], self.upper[0], *self.upper[3:])

    def impulses(self, count: int) -> tuple[Array, Array]:
        """Impulse responses of both bands."""
        b0, b1, a1 = self.first
        wide = np.zeros(count)
        wide[0] = 1.0
        for section in ((b0, b1, 0.0, a1, 0.0), self.second, self.low):
            wide = _filtered(section, wide)
        return wide, _filtered(self.upper, wide)


def _second_order(rate: float, cutoff: float, sign: int) -> Section:
    """Butterworth's by the bilinear transform: a low-pass for sign 1, a high-pass for -1."""
    K = math.tan(math.pi * cutoff / rate)
    norm = 1 / (1 + math.sqrt(2) * K + K * K)
    b = norm * (K * K if sign > 0 else 1.0)
    return b, 2 * sign * b, b, 2 * (K * K - 1) * norm, (1 - math.sqrt(2) * K + K * K) * norm


def _filtered(section: Section, samples: Sequence[float] | Array) -> Array:
    b0, b1, b2, a1, a2 = section
    out, s1, s2 = np.zeros(len(samples)), 0.0, 0.0
    for i in range(len(samples)):
        x = float(samples[i])
        y = b0 * x + s1
        s1, s2 = b1 * x - a1 * y + s2, b2 * x - a2 * y
        out[i] = y
    return out


@dataclass(frozen=True, eq=False)
class BandNoise:
    """What white noise of unit variance gives in a band."""

    weights: Array
    """Of the energy, as a sum of squares (`quadratic.tail`)."""
    excursion_s: float
    """How long the energy stays above a high bar [s]."""
    energy: float
    """Its mean."""
    bar: float
    """Energy of the bar."""


@dataclass(frozen=True, eq=False)
class Noise:
    """What white noise of unit variance gives."""

    wide: BandNoise
    upper: BandNoise
    slope_ratio: float
    """Slope [1/s] that noise alone keeps up, over the square root of the wide band's mean energy."""


@functools.lru_cache(maxsize=64)
def noise_of(filters: Filters, rate: float, low_hz: float, high_hz: float, energy_s: float, slope_s: float) -> Noise:
    """Of both bands, each with a bar for half the alarms of `quadratic.ALARMS_PER_HOUR`."""
    every = max(1, int(rate / (8 * high_hz)))  # steps that still resolve the bands
    wide, upper = (_band(h, rate, energy_s, every) for h in filters.impulses(math.ceil(8 * rate / low_hz)))
    share = 1 / (1 + rate * slope_s)
    k = np.arange(math.ceil(12 * rate * slope_s))
    smooth = share * share * (k + 1) * (1 - share) ** k
    slope = np.diff(smooth, prepend=0.0) * rate
    return Noise(wide, upper, 4.0 * math.sqrt(float(slope @ slope) / wide.energy))


def _band(h: Array, rate: float, energy_s: float, every: int) -> BandNoise:
    steps = np.arange(0, math.ceil(6 * energy_s * rate), every)
    alike = np.array([float(h[: len(h) - lag] @ h[lag:]) if lag < len(h) else 0.0 for lag in steps.tolist()])
    weight = (1 - 1 / (1 + rate * energy_s)) ** steps
    weight /= weight.sum()
    root = np.sqrt(weight)
    apart = np.arange(len(steps))
    spread = alike[np.abs(apart[:, None] - apart[None, :])] * root[:, None] * root[None, :]
    weights = np.linalg.eigvalsh(spread)
    mean = float(weights.sum())
    # A stay above the bar ends when the energy, which decays with energy_s, has lost its excess: about the share
    # 2 w_max / bar of it. A third of the time constant stands for that (a test counts alarms in noise).
    weights, excursion_s = weights[weights > 1e-9 * weights.max()], energy_s / 3
    return BandNoise(weights, excursion_s, mean, bar_for(weights, excursion_s, ALARMS_PER_HOUR / 2))
