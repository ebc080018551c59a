"""Detector `fft`: energy in a band of a short spectrum, the article's baseline (IV.B) as well as it can be made.

The article takes 128 samples (64 ms) and a threshold, and says no more. Here the windows overlap, one every 2 ms; a
Hann window keeps the leakage of contacts out of the band, which a bare window would not; the band is the board's
cutoff to three times that; and the threshold follows from the noise by the same rule as the others'.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.slip.detectors.noise import input_noise_v
from fingertip.slip.detectors.quadratic import bar_for
from fingertip.slip.detectors.stream import Output

WINDOW_S = 0.064
"""128 samples at 2 kHz (article, IV.B)."""
HOP_S = 0.002
_EXCURSION_S = WINDOW_S / 8
# An eighth of the window stands for a stay above the bar (a test counts alarms in noise).


@dataclass(frozen=True)
class FftSettings:
    """What the detector needs to know."""

    sample_rate_hz: float
    window_samples: int
    hop_samples: int
    low_hz: float
    high_hz: float
    noise_v: float
    """Of the input, white, rms."""
    scale: float = 1.0
    """Of the threshold, to trade delay against false alarms."""

    @classmethod
    def of(cls, design: Design, noise_v: float | None = None) -> FftSettings:
        """The settings of a design: its rate and board's cutoff, its noise unless given [V]."""
        rate, cutoff = design.detector.sample_rate_hz, design.board.cutoff_hz
        noise = input_noise_v(design) if noise_v is None else noise_v
        return cls(rate, round(WINDOW_S * rate), max(1, round(HOP_S * rate)), cutoff, 3 * cutoff, noise)


@functools.lru_cache(maxsize=64)
def _bar(weights: tuple[float, ...]) -> float:
    return math.sqrt(bar_for(np.array(weights), _EXCURSION_S))


class Fft:
    """The detector with its state. It starts as if the first sample had always been there."""

    def __init__(self, settings: FftSettings) -> None:
        self.settings = settings
        n = settings.window_samples
        self._window = np.array([0.5 - 0.5 * math.cos(2 * math.pi * i / n) for i in range(n)])
        # So scaled, a tone of the band shows its rms, and white noise the rms of its part in the band.
        self._window *= math.sqrt(2 / n / float(self._window @ self._window))
        bins = range(n // 2 + 1)
        kept = [k for k in bins if settings.low_hz <= k * settings.sample_rate_hz / n <= settings.high_hz]
        kept = kept or [max(1, round(settings.low_hz * n / settings.sample_rate_hz))]  # a band narrower than a bin
        self._low, self._high = kept[0], kept[-1] + 1
        self._bar = _bar(tuple(self._noise_weights().tolist())) * settings.noise_v * settings.scale
        self._past = np.zeros(0)
        self._until_next = 0
        self._level = 0.0

    @property
    def threshold_v(self) -> float:
        """Rms in the band above which slip is ON [V]."""
        return self._bar

    @property
    def memory_s(self) -> float:
        """The window [s]."""
        return self.settings.window_samples / self.settings.sample_rate_hz

    def process(self, voltage_v: Iterable[float]) -> Output:
        """Take the next samples [V], any number of them, and return as many outputs."""
        new = np.asarray(voltage_v if isinstance(voltage_v, np.ndarray) else list(voltage_v), dtype=np.float64)
        n, level = self.settings.window_samples, np.empty(len(new))
        if not len(self._past) and len(new):
            self._past = np.full(n - 1, new[0])
        known = np.concatenate((self._past, new))
        start = 0
        # One spectrum at a time: the library may round a batch of them otherwise.
        for at in range(self._until_next, len(new), self.settings.hop_samples):
            level[start:at] = self._level
            self._level, start = self._rms(known[at : at + n]), at
            self._until_next = at + self.settings.hop_samples
        level[start:] = self._level
        self._until_next -= len(new)
        self._past = known[len(new) :]
        return Output(level, np.full(len(new), self._bar), level > self._bar)

    def step(self, voltage_v: float) -> bool:
        """Take one sample [V] and return whether slip is ON."""
        return bool(self.process([voltage_v]).on[0])

    def _rms(self, samples: Array) -> float:
        band = np.fft.rfft((samples - samples[0]) * self._window)[self._low : self._high]
        return math.sqrt(float(np.sum(band.real**2 + band.imag**2)))

    @property
    def white_level(self) -> float:
        """Root mean square of the level in white noise of unit variance."""
        return math.sqrt(float(self._noise_weights().sum()))

    def noise_bars(self) -> Iterator[tuple[Array, float, float]]:
        """What `quadratic.bar_for` made the bar of: weights [V^2], time above the bar [s]; and the bar [V]."""
        yield self._noise_weights() * self.settings.noise_v**2, _EXCURSION_S, self._bar

    def _noise_weights(self) -> Array:
        """Of the energy, as a sum of squares, in noise of unit variance."""
        spectra = np.fft.rfft(np.diag(self._window))[:, self._low : self._high]
        rows = np.concatenate((spectra.real, spectra.imag), axis=1)
        weights = np.linalg.eigvalsh(rows.T @ rows)
        return np.asarray(weights[weights > 1e-9 * weights.max()])
