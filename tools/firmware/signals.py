"""Signals on which the library's costs are measured, and the
comparison of its intervals with the detector's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.design.formulas.filter import filtered_range_v, signal_ground_ratio
from fingertip.foundation.numerics import Array
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, CampaignPlan, generate_cases
from fingertip.lab.campaign.run import simulate_trace
from fingertip.slip.detectors.analog_and_digital import ChainSettings, high_pass
from fingertip.slip.detectors.noise_and_threshold import input_noise_v

QUIET_V = 2.0
"""Voltage of a constant force [V]: within the range of any design's converter."""
SLIP_DEVIATIONS = 8.0
"""Deviation of a lasting slip's vibration over that of the noise."""


@dataclass(frozen=True, eq=False)
class Recording:
    """Signals of the board's connector, as the converter samples them."""

    tactile_v: Array
    filtered_v: Array | None
    """None if the board does not give it."""

    @property
    def inputs(self) -> tuple[Array, ...]:
        """Arguments of the detector."""
        return (self.tactile_v,) if self.filtered_v is None else (self.tactile_v, self.filtered_v)

    def codes(self, design: Design) -> tuple[NDArray[np.int32], NDArray[np.int32] | None]:
        """Convert both signals to the converter's codes."""
        low = design.detector.adc_low_v
        step = design.detector.adc_step_v
        tactile, filtered = (
            None if volts is None else np.round((volts - low) / step).astype(np.int32)
            for volts in (self.tactile_v, self.filtered_v)
        )
        assert tactile is not None

        return tactile, filtered

    def code_pairs(self, design: Design) -> NDArray[np.uint16]:
        """Convert both signals to codes that the converter can give, (samples, 2)."""
        tactile, filtered = self.codes(design)
        pairs = np.column_stack((tactile, np.zeros_like(tactile) if filtered is None else filtered))
        return pairs.clip(0, 2**design.detector.adc_bits - 1).astype(np.uint16)

    def quantised(self, design: Design) -> Recording:
        """Return the voltages of the codes."""
        low = design.detector.adc_low_v
        step = design.detector.adc_step_v
        tactile, filtered = (
            None if codes is None else np.asarray(low + step * codes, np.float64)
            for codes in self.codes(design)
        )
        assert tactile is not None

        return Recording(tactile, filtered)


def campaign_recordings(design: Design, stride: int = 1) -> Iterator[Recording]:
    """Simulate the campaign's cases, or one of each few, and yield what the detector reads."""
    for number, case in enumerate(generate_cases(CampaignPlan(), HELD_OUT_FROM)):
        if number % stride == 0:
            trace = simulate_trace(design, case, ("fast",))
            rest_v = signal_ground_ratio(design.board) * design.board.supply_v
            yield Recording(
                trace.voltage_v, None if trace.filtered_v is None else trace.filtered_v + rest_v
            )


def quiet_recording(design: Design, seconds: float, seed: int = 1) -> Recording:
    """Noise of the design at a constant force."""
    return _record(design, np.zeros(round(seconds * design.detector.sample_rate_hz)), seed)


def slip_recording(design: Design, seconds: float, seed: int = 2) -> Recording:
    """Noise, and half a second later a vibration in the band of slip that lasts."""
    time_s = (
        np.arange(round(seconds * design.detector.sample_rate_hz)) / design.detector.sample_rate_hz
    )
    vibration = np.random.default_rng(seed + 1).normal(
        0.0, SLIP_DEVIATIONS * input_noise_v(design), len(time_s)
    )
    return _record(
        design, np.where(time_s > 0.5, vibration * np.sin(2 * math.pi * 70.0 * time_s), 0.0), seed
    )


def _record(design: Design, vibration_v: Array, seed: int) -> Recording:
    """Sample a vibration at a constant force, and its filtered signal where the board gives one."""
    random = np.random.default_rng(seed)
    noise_v = input_noise_v(design)
    tactile = QUIET_V + vibration_v + random.normal(0.0, noise_v, len(vibration_v))
    range_v = filtered_range_v(design.board, design.detector.adc_range_v)
    if range_v is None:
        return Recording(tactile, None)

    from scipy.signal import lfilter

    first, second = high_pass(ChainSettings.from_design(design))
    filtered = lfilter([first.b0, first.b1], [1.0, first.a1], vibration_v)
    filtered = lfilter([second.b0, second.b1, second.b2], [1.0, second.a1, second.a2], filtered)
    filtered = np.clip(filtered, -range_v, range_v) + random.normal(0.0, noise_v, len(vibration_v))

    return Recording(tactile, signal_ground_ratio(design.board) * design.board.supply_v + filtered)


def find_intervals(on: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First sample of each ON interval, and the first one after it."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], on, [False])).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def count_differences(
    expected: NDArray[np.bool_], found: NDArray[np.bool_], samples: int = 1
) -> tuple[int, int]:
    """Count the intervals of both sides, and those without a
    counterpart within some samples at both ends.
    """
    first = find_intervals(expected)
    second = find_intervals(found)

    def unmatched(these: list[tuple[int, int]], those: list[tuple[int, int]]) -> int:
        return sum(
            not any(max(abs(a - c), abs(b - d)) <= samples for c, d in those) for a, b in these
        )

    return unmatched(first, second) + unmatched(second, first), len(first) + len(second)
