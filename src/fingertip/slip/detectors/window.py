"""Detector `analog`: the article's, on its board's output. Filters, diode and envelope are analog; only the window and
the threshold are software (III.A, eq. 12).

Its input is the enveloped voltage as the converter samples it. That the threshold is the design's says nothing about
the board's noise: a diode without bias passes next to none, a precision rectifier passes what `digital` shows.
"""

from __future__ import annotations

from collections.abc import Iterable, MutableSequence, Sequence

import numpy as np

from fingertip.design import Design
from fingertip.slip.detectors.kernel import Loop
from fingertip.slip.detectors.stream import Output, as_samples


class Window:
    """Mean of the last samples against a threshold; before the first sample the board was at rest, at 0 V.

    Parameters
    ----------
    sample_rate_hz
        Of the input [Hz].
    window_samples
        Length L of the window.
    threshold_v
        Mean above which slip is ON [V].
    """

    def __init__(self, sample_rate_hz: float, window_samples: int, threshold_v: float) -> None:
        self.sample_rate_hz = sample_rate_hz
        self.threshold_v = threshold_v
        self._ring = [0.0] * window_samples
        self._state = [0.0, 0.0]
        self._seen = 0

    @classmethod
    def of(cls, design: Design, scale: float = 1.0) -> Window:
        """The window and threshold of a design, the threshold times a factor."""
        detector = design.detector
        return cls(detector.sample_rate_hz, detector.window_samples, detector.threshold_v * scale)

    @property
    def memory_s(self) -> float:
        """The window [s]."""
        return len(self._ring) / self.sample_rate_hz

    def process(self, voltage_v: Iterable[float]) -> Output:
        """Take the next samples of the envelope [V], any number of them, and return as many outputs."""
        samples = as_samples(voltage_v)
        (mean,) = _LOOP.run((), self._state, self._ring, samples, self._seen)
        self._seen += len(samples)
        return Output(mean, np.full(len(mean), self.threshold_v), mean > self.threshold_v)

    def step(self, voltage_v: float) -> bool:
        """Take one sample [V] and return whether slip is ON."""
        self._seen += 1
        mean = [0.0]
        _LOOP.plain((), self._state, self._ring, (voltage_v,), mean)
        return mean[0] > self.threshold_v


def _window_loop(
    coefficients: tuple[float, ...],
    state: MutableSequence[float],
    ring: MutableSequence[float],
    samples: Sequence[float],
    means: MutableSequence[float],
) -> None:
    total, place, length = state[0], int(state[1]), len(ring)
    for i in range(len(samples)):
        x = samples[i]
        total += x - ring[place]
        ring[place] = x
        place += 1
        if place == length:  # rounding errors end here, as in the chain's window
            place, total = 0, 0.0
            for j in range(length):
                total += ring[j]
        means[i] = total / length
    state[0], state[1] = total, float(place)


_LOOP = Loop(_window_loop, outputs=1)
