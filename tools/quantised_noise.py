"""Noise of a converter over all voltages, for studies of what a detector could know at best."""

from __future__ import annotations

import math
from itertools import pairwise

_OFFSETS = 32
"""Number of voltages within one ADC step over which the noise is averaged."""


def mean_quantised_noise_v(noise_v: float, step_v: float) -> float:
    """RMS value of Gaussian noise about its mean after quantisation [V], averaged over all voltages within a step.

    A threshold must exceed `quantised_noise_v` of the detectors, the noise at the worst voltage. The value here is the
    noise in which a signal is observed on average: noise much smaller than a step vanishes at most voltages.
    """
    if noise_v > 4 * step_v:
        return math.hypot(noise_v, step_v / math.sqrt(12))
    if noise_v <= 0.0:
        return 0.0
    squares = []
    for i in range(_OFFSETS):
        offset_v = (i + 0.5) / _OFFSETS * step_v
        reach = math.ceil(8 * noise_v / step_v) + 1
        edges = [((k - 0.5) * step_v - offset_v) / noise_v / math.sqrt(2) for k in range(-reach, reach + 2)]
        probabilities = [(k, 0.5 * (math.erf(b) - math.erf(a))) for k, (a, b) in enumerate(pairwise(edges), -reach)]
        mean = math.fsum(k * p for k, p in probabilities)
        squares.append(math.fsum((k - mean) ** 2 * p for k, p in probabilities))
    return step_v * math.sqrt(math.fsum(squares) / _OFFSETS)
