"""Filters of the detector `fast`, and the energy that white noise has behind them."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.slip.detectors.digital import FirstOrder, SecondOrder

LOW_HZ, UPPER_HZ, HIGH_HZ = 40.0, 90.0, 170.0
"""Lower edges of the wide and of the upper band, and the upper edge of both [Hz].

Contacts lie below 30 Hz, and the spectrum of slip in an embedded sensor rarely exceeds 100 Hz (article, section III.A
and figure 2), where noise is weakest compared with what a change of force leaves. The edges belong to pad and sensor,
not to the filter board, whose cutoff may differ."""
SLOW_HZ = 28.0
"""Cutoff behind which the voltage follows the slow force [Hz]: just below contacts' highest frequency."""

RESTORED_HZ = 15.0
"""Cutoff to which that of the board's high-pass filter is moved in software [Hz]: well below the bands. With a lower
one, offsets of the filtered signal and its recovery from a limit would count more."""

ThirdOrder = tuple[FirstOrder, SecondOrder]
"""Filter of third order: a section of first order, followed by one of second order."""


@dataclass(frozen=True)
class FastFilters:
    """Butterworth filters. The output of `restored` feeds `high_edge`, whose output feeds the two other high-passes."""

    restored: ThirdOrder
    """High-pass filter of the board's order, with its cutoff moved to `RESTORED_HZ`."""
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
        first, second = self.restored
        restored = _filter(second, _filter(SecondOrder(first.b0, first.b1, 0.0, first.a1, 0.0), impulse))
        edge = _filter(self.high_edge, restored)
        return _filter(self.wide, edge), _filter(self.upper, edge)

    def noise_energies(self, sample_rate_hz: float) -> tuple[float, float]:
        """Mean energies of white noise of unit variance in the wide and in the upper band."""
        wide, upper = self.impulse_responses(math.ceil(8 * sample_rate_hz / LOW_HZ))
        return float(wide @ wide), float(upper @ upper)


@functools.lru_cache(maxsize=16)
def design_filters(sample_rate_hz: float) -> FastFilters:
    """Design the filters for a sampling rate [Hz]."""
    return FastFilters(
        restored=_third_order(sample_rate_hz, RESTORED_HZ),
        high_edge=_butterworth(sample_rate_hz, HIGH_HZ, 1),
        upper=_butterworth(sample_rate_hz, UPPER_HZ, -1),
        wide=_butterworth(sample_rate_hz, LOW_HZ, -1),
        slow=_butterworth(sample_rate_hz, SLOW_HZ, 1),
    )


def design_board_filter(sample_rate_hz: float, cutoff_hz: float) -> tuple[ThirdOrder, ThirdOrder]:
    """Design the board's high-pass filter for a gain of 1, and the filter that restores what it takes away.

    The product of both is `FastFilters.restored`: their numerators and denominators cancel.

    Parameters
    ----------
    sample_rate_hz
        Sampling rate [Hz].
    cutoff_hz
        Cutoff of the board's filter [Hz].
    """
    first, second = board = _third_order(sample_rate_hz, cutoff_hz)
    low_first, low_second = _third_order(sample_rate_hz, RESTORED_HZ)
    gain_1, gain_2 = low_first.b0 / first.b0, low_second.b0 / second.b0
    restore = (
        FirstOrder(gain_1, gain_1 * first.a1, low_first.a1),
        SecondOrder(gain_2, gain_2 * second.a1, gain_2 * second.a2, low_second.a1, low_second.a2),
    )
    return board, restore


@functools.lru_cache(maxsize=16)
def noise_energies(sample_rate_hz: float) -> tuple[float, float]:
    """Energies of `FastFilters.noise_energies` for a sampling rate [Hz]."""
    return design_filters(sample_rate_hz).noise_energies(sample_rate_hz)


def _third_order(sample_rate_hz: float, cutoff_hz: float) -> ThirdOrder:
    """Design a Butterworth high-pass filter of third order by the bilinear transform."""
    K = math.tan(math.pi * cutoff_hz / sample_rate_hz)
    b, norm = 1 / (1 + K), 1 / (1 + K + K * K)
    return (
        FirstOrder(b, -b, (K - 1) * b),
        SecondOrder(norm, -2 * norm, norm, 2 * (K * K - 1) * norm, (1 - K + K * K) * norm),
    )


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
