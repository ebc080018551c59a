"""The article's chain, digitally and sample by sample: high-pass, rectification, envelope, window mean,
threshold.

Every sample takes the same scalar operations in the same order, so the output is the same to the last bit
however the input is cut into chunks. Nothing looks ahead, and the state between chunks can be pickled.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design

Array = NDArray[np.float64]

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
class ChainOutput:
    """One value per input sample."""

    filtered_v: Array
    envelope_v: Array
    mean_v: Array
    """Mean of the envelope over the window that ends with the sample (article, eq. 12)."""
    on: NDArray[np.bool_]


class SlipChain:
    """The chain with its state. It starts settled on the first sample it is given, as if that had always
    been there."""

    def __init__(self, settings: ChainSettings) -> None:
        self.settings = settings
        self._first, self._second = high_pass(settings)
        # The pole of the analog envelope, sampled: its step response is exact at the samples.
        self._share = 1 - math.exp(-2 * math.pi * settings.envelope_cutoff_hz / settings.sample_rate_hz)
        self._states: tuple[float, float, float] | None = None
        self._envelope = 0.0
        self._window = [0.0] * settings.window_samples
        self._place = 0
        self._sum = 0.0

    def process(self, voltage_v: Iterable[float]) -> ChainOutput:
        """Take the next samples [V], any number of them, and return as many outputs."""
        samples: list[float] = voltage_v.tolist() if isinstance(voltage_v, np.ndarray) else list(voltage_v)
        if self._states is None:
            if not samples:
                return _output([], [], [], self.settings.threshold_v)
            self._states = self._settled(samples[0])
        g0, g1, p1 = self._first
        b0, b1, b2, a1, a2 = self._second
        s1, s2, s3 = self._states
        envelope, share, window, place, total = (
            self._envelope,
            self._share,
            self._window,
            self._place,
            self._sum,
        )
        length = len(window)
        filtered, envelopes, means = [], [], []
        for x in samples:
            # Both sections in transposed direct form II.
            w = g0 * x + s1
            s1 = g1 * x - p1 * w
            y = b0 * w + s2
            s2 = b1 * w - a1 * y + s3
            s3 = b2 * w - a2 * y
            envelope += share * ((y if y > 0.0 else 0.0) - envelope)
            total += envelope - window[place]
            window[place] = envelope
            place += 1
            if place == length:  # the running sum's rounding errors end here instead of adding up for ever
                place, total = 0, math.fsum(window)
            filtered.append(y)
            envelopes.append(envelope)
            means.append(total / length)
        self._states, self._envelope, self._place, self._sum = (s1, s2, s3), envelope, place, total
        return _output(filtered, envelopes, means, self.settings.threshold_v)

    def _settled(self, x: float) -> tuple[float, float, float]:
        """State in which a constant input `x` leaves both sections at exactly zero."""
        return -self._first[0] * x, 0.0, 0.0


def _output(filtered: list[float], envelope: list[float], mean: list[float], threshold_v: float) -> ChainOutput:
    means = np.array(mean, dtype=np.float64)
    return ChainOutput(
        np.array(filtered, dtype=np.float64), np.array(envelope, dtype=np.float64), means, means > threshold_v
    )


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
