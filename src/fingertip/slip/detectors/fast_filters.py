"""Filters of the detector `fast`, and the energy that white noise has behind them."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.slip.detectors.digital import SecondOrder

LOW_HZ, UPPER_HZ, HIGH_HZ = 40.0, 90.0, 170.0
"""Lower edges of the wide and of the upper band, and the upper edge of both [Hz].

Contacts lie below 30 Hz, and the spectrum of slip in an embedded sensor rarely exceeds 100 Hz (article, section III.A
and figure 2), where noise is weakest compared with what a change of force leaves. The edges belong to pad and sensor,
not to the filter board, whose cutoff may differ."""
SLOW_HZ = 28.0
"""Cutoff behind which the voltage follows the slow force [Hz]: just below contacts' highest frequency."""


@dataclass(frozen=True)
class FastFilters:
    """Second-order Butterworth sections. The output of `high_edge` feeds the two high-pass filters."""

    high_edge: SecondOrder
    """Low-pass filter at the upper edge of the bands."""
    upper: SecondOrder
    """High-pass filter at the lower edge of the upper band."""
    wide: SecondOrder
    """High-pass filter at the lower edge of the wide band."""
    slow: SecondOrder
    """Low-pass filter of the slow force, from the input."""

    def impulse_responses(self, count: int) -> tuple[Array, Array]:
        """Compute the impulse responses of the wide and the upper band, `count` samples each."""
        impulse = np.zeros(count)
        impulse[0] = 1.0
        edge = _filter(self.high_edge, impulse)
        return _filter(self.wide, edge), _filter(self.upper, edge)

    def noise_energies(self, sample_rate_hz: float) -> tuple[float, float]:
        """Mean energies of white noise of unit variance in the wide and in the upper band."""
        wide, upper = self.impulse_responses(math.ceil(8 * sample_rate_hz / LOW_HZ))
        return float(wide @ wide), float(upper @ upper)


@functools.lru_cache(maxsize=16)
def design_filters(sample_rate_hz: float) -> FastFilters:
    """Design the filters for a sampling rate [Hz]."""
    return FastFilters(
        high_edge=_butterworth(sample_rate_hz, HIGH_HZ, 1),
        upper=_butterworth(sample_rate_hz, UPPER_HZ, -1),
        wide=_butterworth(sample_rate_hz, LOW_HZ, -1),
        slow=_butterworth(sample_rate_hz, SLOW_HZ, 1),
    )


@functools.lru_cache(maxsize=16)
def noise_energies(sample_rate_hz: float) -> tuple[float, float]:
    """Energies of `FastFilters.noise_energies` for a sampling rate [Hz]."""
    return design_filters(sample_rate_hz).noise_energies(sample_rate_hz)


def _butterworth(sample_rate_hz: float, cutoff_hz: float, sign: int) -> SecondOrder:
    """Design a second-order section by the bilinear transform: a low-pass for sign 1, a high-pass for -1."""
    K = math.tan(math.pi * cutoff_hz / sample_rate_hz)
    norm = 1 / (1 + math.sqrt(2) * K + K * K)
    b = norm * (K * K if sign > 0 else 1.0)
    return SecondOrder(b, 2 * sign * b, b, 2 * (K * K - 1) * norm, (1 - math.sqrt(2) * K + K * K) * norm)


def _filter(section: SecondOrder, samples: Sequence[float] | Array) -> Array:
    b0, b1, b2, a1, a2 = section
    out, s1, s2 = np.zeros(len(samples)), 0.0, 0.0
    for i in range(len(samples)):
        x = float(samples[i])
        y = b0 * x + s1
        s1, s2 = b1 * x - a1 * y + s2, b2 * x - a2 * y
        out[i] = y
    return out
