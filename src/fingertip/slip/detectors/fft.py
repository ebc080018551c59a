"""Detector `fft`: energy in one band of a short spectrum, the article's baseline (section IV.B).

The article states 128 samples (64 ms) and a threshold, and no other detail. This implementation
makes the baseline as good as it can be. The windows overlap: one every 2 ms. A Hann window keeps
the leakage of contacts out of the band, which a rectangular window does not. The band extends from
the board's cutoff to three times that frequency. The threshold follows from the noise by the same
rule as those of the other detectors.

The plain form takes the article's words as they stand: windows side by side, without a taper, ON if
any bin exceeds the threshold. It serves to compare with the article's figure
(`tools/article/previous_works.py`).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import as_samples
from fingertip.foundation.numerics import Array, bisect
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.noise_and_threshold import input_noise_v

# Thresholds for an energy detector in Gaussian noise, from a permitted false alarm rate.
#
# The energy in noise is a weighted sum of squares of independent Gaussian variables.

ALARMS_PER_HOUR = 1.0
"""False alarms from noise alone that a threshold permits: a sixth of all that a detector
may have.
"""


def tail_probability(weights: Array, threshold: float) -> float:
    """Compute the probability that ``sum w_i x_i^2`` exceeds a threshold, for independent x_i of
    unit variance.

    Saddle point approximation of R. Lugannani and S. Rice (Adv. Appl. Prob. 12(2), 1980,
    doi:10.2307/1426607) as applied to quadratic forms by D. Kuonen (Biometrika 86(4), 1999,
    doi:10.1093/biomet/86.4.929). Its relative error is at most 10 %, however small the probability.
    The approximation holds for thresholds above the mean; for others the result is 1.
    """
    w = weights / float(weights.max())
    x = threshold / float(weights.max())
    if x <= float(w.sum()):
        return 1.0

    # The derivative of the cumulant generating function grows from the mean to infinity between
    # these bounds.
    low, high = bisect(lambda z: float(np.sum(w / (1 - 2 * z * w))) < x, 0.0, 0.5, halvings=200)
    z = 0.5 * (low + high)
    K = -0.5 * float(np.sum(np.log1p(-2 * z * w)))
    second = 2 * float(np.sum((w / (1 - 2 * z * w)) ** 2))
    r = math.sqrt(max(2 * (z * x - K), 1e-300))
    v = z * math.sqrt(second)

    return 0.5 * math.erfc((r + math.log(v / r) / r) / math.sqrt(2))


@functools.lru_cache(maxsize=64)
def solve_threshold(
    energy_weights: tuple[float, ...], excursion_s: float, alarms_per_hour: float
) -> float:
    """Find the RMS threshold that noise of unit variance crosses at a given rate."""
    weights = np.array(energy_weights)
    probability = alarms_per_hour * excursion_s / 3600
    mean = float(weights.sum())
    most = mean + 200 * float(weights.max())
    _, energy = bisect(
        lambda energy: tail_probability(weights, energy) > probability, mean, most, halvings=80
    )

    return math.sqrt(energy)


WINDOW_S = 0.064
"""Window length [s]: 128 samples at 2 kHz (article, section IV.B)."""
HOP_S = 0.002
"""Time between the starts of two windows [s]."""
_BATCH = 256
"""Number of spectra that are computed at a time."""
EXCURSION_S = WINDOW_S / 8
"""Assumed mean duration of an excursion above the threshold [s]; a test counts the alarms
in noise.
"""


class FftDetector(Detector):
    """FFT detector with its state.

    It starts as if the input had always had the value of the first sample.
    """

    def __init__(
        self,
        design: Design,
        noise_v: float | None = None,
        threshold_scale: float = 1.0,
        is_plain: bool = False,
    ) -> None:
        rate = design.detector.sample_rate_hz
        cutoff = design.board.cutoff_hz
        self.noise_v = input_noise_v(design) if noise_v is None else noise_v
        self.window_samples = n = round(WINDOW_S * rate)
        self.memory_s = n / rate
        self._is_plain = is_plain
        self._hop_samples = n if is_plain else max(1, round(HOP_S * rate))
        low_hz, high_hz = (rate / n, (rate - rate / n) / 2) if is_plain else (cutoff, 3 * cutoff)
        taper = 0.0 if is_plain else 0.5
        self._window = np.array(
            [1.0 - taper - taper * math.cos(2 * math.pi * i / n) for i in range(n)]
        )
        # With this scale the statistic of a tone in the band is its RMS value, and that of white
        # noise the RMS value of its part in the band.
        self._window *= math.sqrt(2 / n / float(self._window @ self._window))
        in_band = [k for k in range(n // 2 + 1) if low_hz <= k * rate / n <= high_hz]
        # A band narrower than a bin takes the nearest bin.
        in_band = in_band or [max(1, round(low_hz * n / rate))]
        self._first_bin = in_band[0]
        self._end_bin = in_band[-1] + 1
        weights = tuple(self.noise_weights().tolist())

        if is_plain:  # each bin alone has two squares, and all bins share the alarms
            unit_threshold = solve_threshold(
                weights[:2], self.memory_s, ALARMS_PER_HOUR / len(in_band)
            )
        else:
            unit_threshold = solve_threshold(weights, EXCURSION_S, ALARMS_PER_HOUR)

        self._threshold_v = unit_threshold * self.noise_v * threshold_scale
        self._past = np.zeros(0)
        self._until_next = 0
        self._rms_v = 0.0

    @classmethod
    def for_design(
        cls, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0
    ) -> FftDetector:
        return cls(design, noise_v, threshold_scale)

    @classmethod
    def equivalent_noise_v(cls, design: Design, quiet_v: Array) -> float:
        """Compute the white noise of the same mean energy in the band [V]."""
        fft = cls(design, 1.0)
        rms_v = fft.process(quiet_v).statistic_v[fft.window_samples :]
        # In white noise of unit variance the mean square of the statistic is the sum of the
        # weights.
        return math.sqrt(float(np.mean(rms_v**2))) / math.sqrt(float(fft.noise_weights().sum()))

    def process(self, voltage_v: Iterable[float]) -> DetectorOutput:
        new = np.asarray(as_samples(voltage_v), dtype=np.float64)
        n = self.window_samples
        statistic = np.empty(len(new))
        if not len(self._past) and len(new):
            self._past = np.full(n - 1, new[0])

        samples = np.concatenate((self._past, new))
        hop = self._hop_samples
        first = self._until_next
        statistic[:first] = self._rms_v

        # numpy computes real transforms row by row: those of a batch have the bits of single ones.
        for start in range(first, len(new), _BATCH * hop):
            end = min(start + _BATCH * hop, len(new))
            shape = (-(-(end - start) // hop), n)
            item = samples.itemsize
            rms_v = self._band_rms(
                np.ndarray(shape, np.float64, samples, start * item, (hop * item, item))
            )
            statistic[start:end] = np.repeat(rms_v, hop)[: end - start]
            self._rms_v = float(rms_v[-1])
            self._until_next = start + hop * len(rms_v)

        self._until_next -= len(new)
        self._past = samples[len(new) :]
        return DetectorOutput(
            statistic, np.full(len(new), self._threshold_v), statistic > self._threshold_v
        )

    def _band_rms(self, windows: Array) -> Array:
        band = np.fft.rfft((windows - windows[:, :1]) * self._window)[
            :, self._first_bin : self._end_bin
        ]
        energies = band.real**2 + band.imag**2
        return np.asarray(np.sqrt(energies.max(axis=1) if self._is_plain else energies.sum(axis=1)))

    def noise_weights(self) -> Array:
        """Weights of the energy as a sum of squares
        (`tail_probability`), in noise of unit variance.
        """
        spectra = np.fft.rfft(np.diag(self._window))[:, self._first_bin : self._end_bin]
        rows = np.concatenate((spectra.real, spectra.imag), axis=1)
        weights = np.linalg.eigvalsh(rows.T @ rows)

        return np.asarray(weights[weights > 1e-9 * weights.max()])
