"""Noise at the input of a detector, and the threshold that follows from a level of noise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fingertip.design import Design

DEVIATIONS = 6.0
"""Deviations between noise level and threshold: noise crosses it
less than once in a year of 30 ms windows.
"""


@dataclass(frozen=True)
class NoiseLevel:
    """Mean and standard deviation of the window mean in noise alone [V]."""

    mean_v: float
    deviation_v: float

    @property
    def threshold_v(self) -> float:
        """Noise-derived threshold: the mean plus `DEVIATIONS` standard deviations [V]."""
        return self.mean_v + DEVIATIONS * self.deviation_v

    @property
    def rounded_threshold_v(self) -> float:
        """Noise-derived threshold, rounded up to two digits [V]."""
        threshold_v = self.threshold_v
        digit = 10.0 ** (math.floor(math.log10(threshold_v)) - 1) if threshold_v > 0.0 else 1.0
        return float(f"{math.ceil(threshold_v / digit) * digit:.9g}")


def input_noise_v(design: Design) -> float:
    """RMS noise of the sampled voltage [V]: ``detector.noise_v`` after quantisation by the ADC."""
    detector = design.detector
    return quantised_noise_v(detector.noise_v, detector.adc_step_v)


def quantised_noise_v(noise_v: float, step_v: float) -> float:
    """RMS value of Gaussian noise after quantisation [V], at a voltage halfway between two codes,
    the worst case.

    Noise of several steps gains ``step / sqrt(12)``. Noise much smaller than a step vanishes at
    most voltages, but halfway between two codes it toggles between them and amounts to half a step.
    """
    if noise_v > 4 * step_v:
        return math.hypot(noise_v, step_v / math.sqrt(12))
    if noise_v <= 0.0:
        return step_v / 2

    below = [
        0.5 * (1 + math.erf(k * step_v / noise_v / math.sqrt(2)))
        for k in range(math.ceil(8 * noise_v / step_v) + 2)
    ]
    squares = (
        2 * ((k + 0.5) * step_v) ** 2 * (below[k + 1] - below[k]) for k in range(len(below) - 1)
    )
    return math.sqrt(math.fsum(squares))
