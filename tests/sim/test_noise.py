"""Noise where it arises: the amplifiers' ahead of the filter board, the converter's at the samples."""

import random

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.noise import total_v
from fingertip.design import Design
from fingertip.sim import SceneFile, run_scene
from fingertip.sim.electronics.board_noise import gain, input_noise_v
from fingertip.sim.electronics.board_output import replayed_level, rest_level
from fingertip.sim.electronics.converter import quantise, sampled_v

STILL = {"hold": {"mode": "grasp", "min_force_n": 1.0, "max_force_n": 1.0, "min_s": 20.0, "release": False}}
SETTLED = 4000
"""Samples: the grasp has closed, and the filter has forgotten it."""
DESIGN = Design()


def still(design: Design, *outputs: str, **sensing) -> dict[str, np.ndarray]:
    found = run_scene(design, SceneFile(**STILL, sensing=sensing, outputs=list(outputs)), 3)
    return {name: column[SETTLED:] for name, column in found.columns.items()}


@pytest.mark.parametrize("supply", ["split", "single"])
@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
def test_the_simulated_board_is_as_noisy_as_its_budget(variant, supply):
    """Which ngspice's own noise analysis confirms (tests/board/test_noise.py)."""
    design = Design(board={"variant": variant, "supply": supply})
    said = total_v(board_circuit(board_values(design)), design.board.gain_bandwidth_hz, "FILTERED")
    assert said == pytest.approx({"article": 18.6e-3, "precision": 5.65e-3, "comparator": 5.65e-3}[variant], rel=0.1)
    filtered = still(design, "filtered_v")["filtered_v"]
    assert np.std(filtered) == pytest.approx(said, rel=0.03)  # 40 000 samples of a band of a kilohertz: within 1 %


@pytest.mark.parametrize(("rate_hz", "cutoff_hz"), [(1000.0, 67.0), (2000.0, 30.0), (20000.0, 150.0)])
def test_whatever_the_rate_and_the_cutoff(rate_hz, cutoff_hz):
    design = Design(detector={"sample_rate_hz": rate_hz}, board={"variant": "precision", "cutoff_hz": cutoff_hz})
    said = total_v(board_circuit(board_values(design)), design.board.gain_bandwidth_hz, "FILTERED")
    filtered = still(design, "filtered_v")["filtered_v"]
    assert np.std(filtered) == pytest.approx(said, rel=0.05)
    assert input_noise_v(design) * gain(design) == pytest.approx(said)


def test_the_converter_adds_its_own_behind_the_gain():
    """The sampled voltage has its noise and its steps; the board's output is smooth until it is sampled."""
    noisy, silent = still(DESIGN, "voltage_v"), still(DESIGN, "voltage_v", noise=False)
    step = 2 * DESIGN.detector.adc_range_v / 2**DESIGN.detector.adc_bits
    wanted = np.hypot(DESIGN.detector.noise_v, step / np.sqrt(12))
    assert np.std(np.diff(noisy["voltage_v"])) == pytest.approx(wanted * np.sqrt(2), rel=0.02)
    assert np.std(np.diff(silent["voltage_v"])) < step
    sampled = sampled_v(DESIGN, np.full(20_000, 0.1), random.Random(1))
    assert np.std(sampled) == pytest.approx(wanted, rel=0.02)
    assert np.array_equal(sampled_v(DESIGN, np.array([0.1]), None), quantise(np.array([0.1]), 16, 10.0))


def test_without_noise_nothing_moves():
    quiet = still(Design(board={"variant": "precision"}), "tactile_v", "filtered_v", "envelope_v", noise=False)
    for name, column in quiet.items():
        assert np.ptp(column) < 1e-6, name


def test_the_converter_is_nothing_to_the_board():
    """A better converter makes the sampled voltage quieter, and changes no bit of what the board does."""
    better = Design(detector={"noise_v": 0.0})
    assert np.array_equal(still(DESIGN, "envelope_v")["envelope_v"], still(better, "envelope_v")["envelope_v"])


@pytest.mark.parametrize("variant", ["article", "precision"])
def test_the_rest_level_is_what_a_board_at_rest_shows(variant):
    design = Design(board={"variant": variant})
    level = rest_level(design)
    enveloped = sampled_v(design, still(design, "envelope_v")["envelope_v"], random.Random(2))
    width = design.detector.window_samples
    means = np.convolve(enveloped, np.full(width, 1 / width), "valid")
    assert means.mean() == pytest.approx(level.mean_v, abs=0.1 * level.mean_v + 5e-6)
    assert means.std() == pytest.approx(level.deviation_v, rel=0.25)


def test_a_recorded_voltage_carries_the_converters_noise_into_the_board():
    """68 times stronger, so that the threshold has to be higher than behind the board itself."""
    design = Design(board={"variant": "precision"})
    assert replayed_level(design).threshold_v > 3 * rest_level(design).threshold_v
