"""Decisions of the detector `fast` with one tree of one question: nothing depends on how the trees were fitted."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fingertip.slip.detectors import fast_loop
from fingertip.slip.detectors.fast import FastDetector, FastSettings, FilteredSignal
from fingertip.slip.detectors.fast_coefficients import FEATURES, NODES, FastModel

RATE_HZ, NOISE_V = 2000.0, 4e-4
LOUD = 10.0
"""Ratio of the wide energy of 20 ms to its floor above which the tree finds slip."""


def one_question() -> FastModel:
    """Model of one tree: a score of 10 where the wide energy of 20 ms is large, else -10."""
    wide, leaves = FEATURES.index("wide energy, 20 ms"), [-10.0] * ((NODES + 1) // 2) + [10.0] * ((NODES + 1) // 2)
    return FastModel(np.full(NODES, float(wide)), np.full(NODES, LOUD), np.array(leaves), 0.0, 0.0, 0.0, -1.0)


def noise(samples: int, seed: int = 2) -> np.ndarray:
    return np.random.default_rng(seed).normal(0, NOISE_V, samples)


def make() -> FastDetector:
    """Detector that has learned two seconds of noise."""
    detector = FastDetector(FastSettings(RATE_HZ, NOISE_V), one_question())
    detector.process(4.0 + noise(4000))
    return detector


def grasp(rise_s: float) -> np.ndarray:
    """Half a second of noise, at whose end the force changes in a smooth step."""
    x = np.clip((np.arange(1000) / RATE_HZ - 0.5 + rise_s) / rise_s, 0.0, 1.0)
    volts: np.ndarray = 4.0 - 0.4 * x**3 * (10 - 15 * x + 6 * x * x) + noise(1000, 1)
    return volts


@pytest.mark.parametrize("steps", [[1, 2, 3, 4], [-1, -2, -3, -4], [0, -3, -5, -9], [2, 2, 1, 4]])
def test_the_smallest_step_is_found_whichever_way_the_voltage_goes(steps: list[int]) -> None:
    volts = 0.5 + 2.0**-10 * np.array([0, *steps])
    detector = FastDetector(FastSettings(RATE_HZ, NOISE_V, filtered=FilteredSignal(64.0, 4.0)))
    detector.process(volts, volts)
    least = min(abs(b - a) for a, b in zip([0, *steps], steps, strict=False) if a != b)
    assert detector.state[fast_loop.STEP] == least * 2.0**-10
    assert detector.state[fast_loop.FILTERED_STEP] == pytest.approx(least * 2.0**-10 / 64.0)


@pytest.mark.parametrize(("rise_s", "is_doubted"), [(0.2, True), (0.0, False)])
def test_vibration_that_begins_with_the_grasp_holds_the_floor_for_a_third_of_a_second(
    rise_s: float, is_doubted: bool
) -> None:
    """The floor rises in the first tick after 0.3 s, and without a change of force before it stands still."""
    detector = make()
    force = grasp(rise_s) if rise_s else 3.6 + noise(1000, 1)
    detector.process(force)
    assert (detector.state[fast_loop.MOVED] >= 50) == is_doubted
    tone = 3.6 + noise(1200, 4) + 0.0015 * np.sin(math.tau * 130 * np.arange(1200) / RATE_HZ)
    ticks = []
    for tick in np.split(tone, 300):
        detector.process(tick)
        ticks.append([detector.state[i] for i in (fast_loop.ON_TICKS, fast_loop.FLOOR, fast_loop.IS_DOUBTED)])
    held = {floor for count, floor, _ in ticks if 0 < count <= 150}
    later = [floor for count, floor, _ in ticks if 150 < count <= 170]
    assert len(held) == 1
    assert {doubted for count, _, doubted in ticks if count} == {float(is_doubted)}
    assert len(later) == 20
    assert len(set(later) - held) == (20 if is_doubted else 0)


def test_slip_stays_on_while_the_trees_say_so_though_its_vibration_has_ended() -> None:
    """The energy of 20 ms falls by e in 20 ms: from 10^5 times the question's ratio within 0.23 s."""
    detector = make()
    burst = 4.0 + noise(600) + 0.5 * np.sin(math.tau * 130 * np.arange(600) / RATE_HZ)
    assert detector.process(burst).on[-1]
    lasts_s = np.count_nonzero(detector.process(4.0 + noise(2000, 3)).on) / RATE_HZ
    assert 0.15 < lasts_s < 0.35
