"""Noise of the simulation: the amplifiers' ahead of the filter, the ADC's at the samples."""

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.noise import add_noise
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.sim import SceneFile, run_scene
from fingertip.sim.signal.converter import (
    AdcRange,
    compute_input_noise_v,
    compute_noise_gain,
    sample_v,
    simulate_quiescent_level,
    simulate_replay_level,
)
from fingertip.sim.signal.grid import open_stream
from tests.designs import ARTICLE, article_design

CONSTANT_FORCE = {"hold": {"mode": "grasp", "min_force_n": 1.0, "max_force_n": 1.0, "min_s": 20.0, "release": False}}
SETTLED = 4000
"""Number of samples after which the grasp is closed and the filter settled."""
DESIGN = ARTICLE


def simulate_hold(design: Design, *outputs: str, **sensing) -> dict[str, np.ndarray]:
    """Columns of a scene with constant force, after it has settled."""
    found = run_scene(design, SceneFile(**CONSTANT_FORCE, sensing=sensing, outputs=list(outputs)), 3)
    return {name: column[SETTLED:] for name, column in found.columns.items()}


@pytest.mark.full
@pytest.mark.parametrize("supply", ["split", "single"])
@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
def test_simulated_board_is_as_noisy_as_its_noise_budget(variant, supply):
    """ngspice's noise analysis confirms the budget (tests/board/test_noise.py)."""
    design = article_design(board={"variant": variant, "supply": supply})
    budget = add_noise(board_circuit(board_values(design)), find_gain_bandwidth_hz(design.board)).total_v("FILTERED")
    assert budget == pytest.approx({"article": 18.6e-3, "precision": 5.65e-3, "comparator": 5.65e-3}[variant], rel=0.1)
    filtered = simulate_hold(design, "filtered_v")["filtered_v"]
    assert np.std(filtered) == pytest.approx(budget, rel=0.03)  # 40 000 samples of a band of a kilohertz: within 1 %
    assert compute_input_noise_v(design) * compute_noise_gain(design) == pytest.approx(budget)


def test_adc_adds_its_noise_behind_the_gain():
    """The sampled voltage has the ADC's noise and steps; the board's output has them only once it is sampled."""
    noisy, silent = (
        simulate_hold(DESIGN, "voltage_v"),
        simulate_hold(DESIGN, "voltage_v", noise=False),
    )
    step = 2 * DESIGN.detector.adc_range_v / 2**DESIGN.detector.adc_bits
    expected = np.hypot(DESIGN.detector.noise_v, step / np.sqrt(12))
    assert np.std(np.diff(noisy["voltage_v"])) == pytest.approx(expected * np.sqrt(2), rel=0.02)
    assert np.std(np.diff(silent["voltage_v"])) < step
    sampled = sample_v(DESIGN, np.full(20_000, 0.1), open_stream(1, "test"))
    assert np.std(sampled) == pytest.approx(expected, rel=0.02)
    assert np.array_equal(
        sample_v(DESIGN, np.array([0.1]), None), AdcRange(16, -10.0, 10.0).quantise_v(np.array([0.1]))
    )


def test_signals_are_constant_without_noise():
    quiet = simulate_hold(
        article_design(board={"variant": "precision"}), "tactile_v", "filtered_v", "envelope_v", noise=False
    )
    for name, column in quiet.items():
        assert np.ptp(column) < 1e-6, name


def test_adc_does_not_affect_the_board():
    """An ADC without noise does not change a bit of the board's output."""
    better = article_design(detector={"noise_v": 0.0})
    assert np.array_equal(
        simulate_hold(DESIGN, "envelope_v")["envelope_v"],
        simulate_hold(better, "envelope_v")["envelope_v"],
    )


@pytest.mark.parametrize("variant", ["article", "precision"])
def test_quiescent_level_is_that_of_a_scene_with_constant_force(variant):
    design = article_design(board={"variant": variant})
    level = simulate_quiescent_level(design)
    envelope_v = sample_v(design, simulate_hold(design, "envelope_v")["envelope_v"], open_stream(2, "test"))
    width = design.detector.window_samples
    means = np.convolve(envelope_v, np.full(width, 1 / width), "valid")
    assert means.mean() == pytest.approx(level.mean_v, abs=0.1 * level.mean_v + 5e-6)
    assert means.std() == pytest.approx(level.deviation_v, rel=0.25)


def test_recorded_voltage_carries_the_adc_noise_into_the_board():
    """The board amplifies it 68 times, so that the threshold has to be higher than behind the board itself."""
    design = article_design(board={"variant": "precision"})
    assert simulate_replay_level(design).threshold_v > 3 * simulate_quiescent_level(design).threshold_v
