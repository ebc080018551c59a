"""Filters of the detector `fast`'s two bands, and the energy that white noise has in each."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.slip.detectors.digital import ChainSettings, FirstOrder, SecondOrder, high_pass
from fingertip.slip.detectors.false_alarms import ALARMS_PER_HOUR, solve_threshold


@dataclass(frozen=True)
class BandFilters:
    """Filter sections in series. The output of `low_pass` is the wide band, that of `upper` the upper band."""

    first: FirstOrder
    """First-order section of the article's third-order high-pass filter."""
    second: SecondOrder
    """Second-order section of the same filter."""
    low_pass: SecondOrder
    upper: SecondOrder

    @classmethod
    def butterworth(cls, sample_rate_hz: float, low_hz: float, upper_hz: float, high_hz: float) -> BandFilters:
        """Design Butterworth filters for a sampling rate.

        Parameters
        ----------
        sample_rate_hz
            Sampling rate [Hz].
        low_hz
            Cutoff of the third-order high-pass filter [Hz].
        upper_hz
            Cutoff of the second-order high-pass filter of the upper band [Hz].
        high_hz
            Cutoff of the second-order low-pass filter [Hz].
        """
        first, second = high_pass(ChainSettings(sample_rate_hz, low_hz, 1.0, low_hz, 1, 1.0))
        low_pass = _second_order(sample_rate_hz, high_hz, 1)
        return cls(first, second, low_pass, _second_order(sample_rate_hz, upper_hz, -1))

    def impulse_responses(self, count: int) -> tuple[Array, Array]:
        """Compute the impulse responses of the wide and the upper band, `count` samples each."""
        b0, b1, a1 = self.first
        wide = np.zeros(count)
        wide[0] = 1.0
        for section in (SecondOrder(b0, b1, 0.0, a1, 0.0), self.second, self.low_pass):
            wide = _filter(section, wide)
        return wide, _filter(self.upper, wide)


def _second_order(sample_rate_hz: float, cutoff_hz: float, sign: int) -> SecondOrder:
    """Design a second-order Butterworth filter by the bilinear transform: a low-pass for sign 1, a high-pass for -1."""
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


@dataclass(frozen=True, eq=False)
class BandNoise:
    """Energy of white noise of unit variance in one band."""

    weights: Array
    """Weights of the energy as a sum of squares (`false_alarms.tail_probability`)."""
    excursion_s: float
    """Mean duration of an excursion above a high threshold [s]."""
    energy: float
    """Mean energy."""
    threshold: float
    """Threshold of the energy."""


@dataclass(frozen=True, eq=False)
class DetectorNoise:
    """Response of the detector to white noise of unit variance."""

    wide: BandNoise
    upper: BandNoise
    slew_rate_ratio: float
    """Slew rate that noise alone sustains [1/s], divided by the square root of the wide band's mean energy."""


@functools.lru_cache(maxsize=64)
def compute_noise(
    filters: BandFilters, sample_rate_hz: float, low_hz: float, high_hz: float, energy_s: float, slew_rate_s: float
) -> DetectorNoise:
    """Compute the noise of both bands. Each band's threshold permits half of `false_alarms.ALARMS_PER_HOUR`.

    Parameters
    ----------
    filters
        The band filters.
    sample_rate_hz, low_hz, high_hz
        Sampling rate and edges of the wide band [Hz].
    energy_s
        Time constant of the energies [s].
    slew_rate_s
        Time constant of each of the two poles that smooth the slew rate [s].
    """
    stride = max(1, int(sample_rate_hz / (8 * high_hz)))  # still resolves the bands
    wide, upper = (
        _band_noise(h, sample_rate_hz, energy_s, stride)
        for h in filters.impulse_responses(math.ceil(8 * sample_rate_hz / low_hz))
    )
    smoothing = 1 / (1 + sample_rate_hz * slew_rate_s)
    k = np.arange(math.ceil(12 * sample_rate_hz * slew_rate_s))
    smoothed = smoothing * smoothing * (k + 1) * (1 - smoothing) ** k
    slew_rate = np.diff(smoothed, prepend=0.0) * sample_rate_hz
    return DetectorNoise(wide, upper, 4.0 * math.sqrt(float(slew_rate @ slew_rate) / wide.energy))


def _band_noise(impulse_response: Array, sample_rate_hz: float, energy_s: float, stride: int) -> BandNoise:
    h = impulse_response
    lags = np.arange(0, math.ceil(6 * energy_s * sample_rate_hz), stride)
    autocorrelation = np.array([float(h[: len(h) - lag] @ h[lag:]) if lag < len(h) else 0.0 for lag in lags.tolist()])
    # The energy is an exponentially weighted sum of squares of correlated samples. The eigenvalues of their weighted
    # covariance are the weights of the equivalent sum over independent samples.
    decay = (1 - 1 / (1 + sample_rate_hz * energy_s)) ** lags
    decay /= decay.sum()
    root = np.sqrt(decay)
    index = np.arange(len(lags))
    covariance = autocorrelation[np.abs(index[:, None] - index[None, :])] * root[:, None] * root[None, :]
    weights = np.linalg.eigvalsh(covariance)
    mean = float(weights.sum())
    # An excursion ends when the energy, which decays with energy_s, has lost its excess: a share of about
    # 2 w_max / threshold. A third of the time constant stands for that (a test counts alarms in noise).
    weights, excursion_s = weights[weights > 1e-9 * weights.max()], energy_s / 3
    return BandNoise(weights, excursion_s, mean, solve_threshold(weights, excursion_s, ALARMS_PER_HOUR / 2))
