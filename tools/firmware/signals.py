"""Signals on which the library's costs are measured, and the comparison of its intervals with the detector's."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.campaign.evaluate import simulate_trace
from fingertip.campaign.plan import HELD_OUT_FROM, CampaignPlan, generate_cases
from fingertip.design import Design
from fingertip.slip.detectors.noise import input_noise_v

QUIET_V = 2.0
"""Voltage of a constant force [V]: within the range of any design's converter."""
SLIP_DEVIATIONS = 8.0
"""Deviation of a lasting slip's vibration over that of the noise."""


def campaign_voltages(design: Design, stride: int = 1) -> Iterator[Array]:
    """Simulate the campaign's cases, or one of each few, and yield their voltages [V]."""
    for number, case in enumerate(generate_cases(CampaignPlan(), HELD_OUT_FROM)):
        if number % stride == 0:
            yield simulate_trace(design, case, board=False)[0].voltage_v


def quiet_voltage(design: Design, seconds: float, seed: int = 1) -> Array:
    """Noise of the design at a constant force [V]."""
    count = round(seconds * design.detector.sample_rate_hz)
    return QUIET_V + np.random.default_rng(seed).normal(0.0, input_noise_v(design), count)


def slip_voltage(design: Design, seconds: float, seed: int = 2) -> Array:
    """Noise, and half a second later a vibration in the band of slip that lasts [V]."""
    volts = quiet_voltage(design, seconds, seed)
    time_s = np.arange(len(volts)) / design.detector.sample_rate_hz
    vibration = np.random.default_rng(seed + 1).normal(0.0, SLIP_DEVIATIONS * input_noise_v(design), len(volts))
    return volts + np.where(time_s > 0.5, vibration * np.sin(2 * math.pi * 70.0 * time_s), 0.0)


def find_intervals(on: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First sample of each ON interval, and the first one after it."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], on, [False])).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def count_differences(expected: NDArray[np.bool_], found: NDArray[np.bool_], samples: int = 1) -> tuple[int, int]:
    """Count the intervals of both sides, and those without a counterpart within some samples at both ends."""
    first, second = find_intervals(expected), find_intervals(found)

    def unmatched(these: list[tuple[int, int]], those: list[tuple[int, int]]) -> int:
        return sum(not any(max(abs(a - c), abs(b - d)) <= samples for c, d in those) for a, b in these)

    return unmatched(first, second) + unmatched(second, first), len(first) + len(second)
