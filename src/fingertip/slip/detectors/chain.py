"""Detector `digital`: the article's chain in software: high-pass, rectification, envelope, window mean, threshold.

In the article the first three are analog (its board; see `fingertip.slip.detectors.window`), in its predecessor all
were digital. Here the input is the raw tactile voltage: the board's ideal filters by the bilinear transform, an ideal
diode without a dead zone, and the envelope's pole as a follower without the board's faster attack.

Every sample takes the same scalar operations in the same order, so the output is the same to the last bit
however the input is cut into chunks. Nothing looks ahead, and the state between chunks can be pickled.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.slip.detectors.kernel import Loop
from fingertip.slip.detectors.stream import Output, as_samples

Q = 1.0
"""Quality factor of the second-order section that makes the third order a Butterworth (article, eq. 8)."""


@dataclass(frozen=True)
class ChainSettings:
    """What the chain needs to know."""

    sample_rate_hz: float
    cutoff_hz: float
    gain: float
    envelope_cutoff_hz: float
    window_samples: int
    threshold_v: float

    @classmethod
    def of(cls, design: Design) -> ChainSettings:
        """The settings of a design: the board's ideal filters, the detector's window and threshold."""
        board, detector = design.board, design.detector
        return cls(
            detector.sample_rate_hz,
            board.cutoff_hz,
            board.passband_gain,
            board.envelope_cutoff_hz,
            detector.window_samples,
            detector.threshold_v,
        )


@dataclass(frozen=True, eq=False)
class ChainOutput(Output):
    """One value per input sample."""

    filtered_v: Array
    envelope_v: Array

    @property
    def mean_v(self) -> Array:
        """Mean of the envelope over the window that ends with the sample (article, eq. 12)."""
        return self.level_v


class SlipChain:
    """The chain with its state. It starts settled on the first sample it is given, as if that had always
    been there."""

    def __init__(self, settings: ChainSettings) -> None:
        self.settings = settings
        first, second = high_pass(settings)
        # The pole of the analog envelope, sampled: its step response is exact at the samples.
        share = 1 - math.exp(-2 * math.pi * settings.envelope_cutoff_hz / settings.sample_rate_hz)
        self._coefficients = (*first, *second, share)
        self._state = [0.0] * 6
        self._window = [0.0] * settings.window_samples
        self._seen = 0

    @property
    def threshold_v(self) -> float:
        """Mean above which slip is ON [V]."""
        return self.settings.threshold_v

    @property
    def memory_s(self) -> float:
        """The window [s]."""
        return self.settings.window_samples / self.settings.sample_rate_hz

    def process(self, voltage_v: Iterable[float]) -> ChainOutput:
        """Take the next samples [V], any number of them, and return as many outputs."""
        samples = as_samples(voltage_v)
        if len(samples):
            self._settle(float(samples[0]))
        filtered, envelope, mean = _LOOP.run(self._coefficients, self._state, self._window, samples, self._seen)
        self._seen += len(samples)
        bar = self.settings.threshold_v
        return ChainOutput(mean, np.full(len(mean), bar), mean > bar, filtered, envelope)

    def step(self, voltage_v: float) -> bool:
        """Take one sample [V] and return whether slip is ON."""
        self._settle(voltage_v)
        self._seen += 1
        mean = [0.0]
        _LOOP.plain(self._coefficients, self._state, self._window, (voltage_v,), [0.0], [0.0], mean)
        return mean[0] > self.settings.threshold_v

    def _settle(self, x: float) -> None:
        """Before the first sample: the state in which a constant input `x` leaves both sections at exactly zero."""
        if not self._seen:
            self._state[0] = -self._coefficients[0] * x


def _chain_loop(
    coefficients: tuple[float, ...],
    state: MutableSequence[float],
    ring: MutableSequence[float],
    samples: Sequence[float],
    filtered: MutableSequence[float],
    envelopes: MutableSequence[float],
    means: MutableSequence[float],
) -> None:
    g0, g1, p1, b0, b1, b2, a1, a2, share = coefficients
    s1, s2, s3, envelope, total = state[0], state[1], state[2], state[3], state[4]
    place, length = int(state[5]), len(ring)
    for i in range(len(samples)):
        x = samples[i]
        # Both sections in transposed direct form II.
        w = g0 * x + s1
        s1 = g1 * x - p1 * w
        y = b0 * w + s2
        s2 = b1 * w - a1 * y + s3
        s3 = b2 * w - a2 * y
        envelope += share * ((y if y > 0.0 else 0.0) - envelope)
        total += envelope - ring[place]
        ring[place] = envelope
        place += 1
        if place == length:  # the running sum's rounding errors end here instead of adding up for ever
            place, total = 0, 0.0
            for j in range(length):
                total += ring[j]
        filtered[i] = y
        envelopes[i] = envelope
        means[i] = total / length
    state[0], state[1], state[2], state[3], state[4], state[5] = s1, s2, s3, envelope, total, float(place)


_LOOP = Loop(_chain_loop, outputs=3)


def high_pass(
    settings: ChainSettings,
) -> tuple[tuple[float, float, float], tuple[float, float, float, float, float]]:
    """Coefficients of the third-order high-pass: a first-order section with the gain, and one of second
    order.

    Article, eqs. 1, 4 and 9, by the bilinear transform, prewarped so that the response at the cutoff is
    exact.

    Returns
    -------
    first
        ``b0, b1, a1``.
    second
        ``b0, b1, b2, a1, a2``.
    """
    K = math.tan(math.pi * settings.cutoff_hz / settings.sample_rate_hz)
    g = settings.gain / (1 + K)
    norm = 1 / (1 + K / Q + K * K)
    return (g, -g, (K - 1) / (K + 1)), (
        norm,
        -2 * norm,
        norm,
        2 * (K * K - 1) * norm,
        (1 - K / Q + K * K) * norm,
    )


def response(settings: ChainSettings, frequency_hz: float) -> complex:
    """Frequency response of the digital high-pass."""
    (g0, g1, p1), (b0, b1, b2, a1, a2) = high_pass(settings)
    d = cmath.exp(-2j * math.pi * frequency_hz / settings.sample_rate_hz)
    return (g0 + g1 * d) / (1 + p1 * d) * (b0 + b1 * d + b2 * d * d) / (1 + a1 * d + a2 * d * d)


def analog_response(settings: ChainSettings, frequency_hz: float) -> complex:
    """Frequency response of the board's ideal high-pass: article, eq. 9, with j where the article leaves it
    out."""
    s = 1j * frequency_hz / settings.cutoff_hz
    return settings.gain * s / (s + 1) * s * s / (s * s + s / Q + 1)
