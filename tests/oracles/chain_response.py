"""Closed-form frequency responses of the article's high-pass filter, digital and analog."""

from __future__ import annotations

import cmath
import math

from fingertip.slip.detectors.analog_and_digital import ChainSettings, high_pass

Q = 1.0
"""Quality factor of the second-order section of a third-order Butterworth filter."""


def digital_response(settings: ChainSettings, frequency_hz: float) -> complex:
    """Frequency response of the digital high-pass filter."""
    (g0, g1, p1), (b0, b1, b2, a1, a2) = high_pass(settings)
    d = cmath.exp(-2j * math.pi * frequency_hz / settings.sample_rate_hz)
    return (g0 + g1 * d) / (1 + p1 * d) * (b0 + b1 * d + b2 * d * d) / (1 + a1 * d + a2 * d * d)


def analog_response(settings: ChainSettings, frequency_hz: float) -> complex:
    """Frequency response of the board's ideal high-pass filter (article, eq. 9, with the j that the article omits)."""
    s = 1j * frequency_hz / settings.cutoff_hz
    return settings.gain * s / (s + 1) * s * s / (s * s + s / Q + 1)
