"""Time grid, anti-aliasing poles, steps and noise of the converter."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.noise import add_noise
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.front_end import SUPPRESSOR_F
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.parts.nets import ADC_ENVELOPE, ADC_FILTERED, ADC_TACTILE
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.signal.converter import (
    AdcRange,
    AntiAliasFilter,
    EnvelopeSource,
    compute_input_noise_v,
    compute_noise_gain,
    simulate_quiescent_level,
    simulate_replay_level,
)
from fingertip.sim.signal.grid import (
    Grid,
    SampleClock,
    Sampler,
    count_samples,
    draw_noise,
    open_stream,
)
from fingertip.slip.detectors.noise_and_threshold import DEVIATIONS
from tests.designs import ARTICLE, article_design, load_article
from tests.oracles.filter_formulas import envelope_pin_transfer, tactile_pin_transfer

CONTROLLER = Design(
    board={"variant": "precision", "supply_v": 3.3},
    detector={"adc_bits": 12, "adc_range_v": 3.3, "adc_polarity": "unipolar"},
)
FAST = article_design(detector={"sample_rate_hz": 20_000.0, "window_samples": 600})
GROUND_V = 1.65
"""Signal ground of that board, by its divider."""


@pytest.mark.parametrize(
    ("pin", "design"),
    [(ADC_TACTILE, ARTICLE), (ADC_ENVELOPE, FAST), (ADC_FILTERED, CONTROLLER)],
    ids=str,
)
def test_tones_have_the_gain_of_the_transfer_function(pin, design):
    rate = design.detector.sample_rate_hz
    interface = board_values(design).adc_interface
    if design is CONTROLLER:  # a suppressor lies in parallel
        interface = replace(interface, output_f=interface.output_f + SUPPRESSOR_F)
    for share in (0.01, 0.05, 0.1):
        t = np.arange(4000) / rate
        turn = 2j * np.pi * share * rate * t
        out = AntiAliasFilter.ahead_of(pin, design).process(np.exp(turn).real)
        settled = slice(1000, 4000)  # whole periods of every tone
        gain = 2 * np.mean(out[settled] * np.exp(-turn[settled]))
        transfer = tactile_pin_transfer if pin == ADC_TACTILE else envelope_pin_transfer
        # Straight lines between a tone's samples contain the tone and its images, which alias onto
        # it behind the poles.
        images = [share + k for k in range(-400, 401)]
        expected = sum(np.sinc(image) ** 2 * transfer(image * rate, interface) for image in images)
        assert gain == pytest.approx(expected, rel=1e-6)


def test_ramp_is_delayed_by_the_sum_of_the_time_constants():
    c = board_values(ARTICLE).adc_interface
    lag_s = c.first_ohm * (c.first_f + c.second_f) + c.second_ohm * c.second_f
    t = np.arange(400) / 2000
    out = AntiAliasFilter.ahead_of(ADC_TACTILE, ARTICLE).process(t)
    assert t[-1] - out[-1] == pytest.approx(lag_s, rel=1e-9)
    assert 1.0 < 2000 * lag_s < 1.6


def test_converter_from_zero_has_one_sided_range():
    d = CONTROLLER.detector
    assert (d.adc_low_v, d.adc_range_v, d.adc_step_v) == (0.0, 3.3, 3.3 / 4096)
    assert ARTICLE.detector.adc_step_v == 20 / 65536
    assert AdcRange.from_design(CONTROLLER) == AdcRange(12, 0.0, 3.3)
    shifted = AdcRange.from_design(CONTROLLER).above_signal_ground(CONTROLLER)
    assert (shifted.low_v, shifted.high_v) == pytest.approx((-GROUND_V, 3.3 - GROUND_V))
    ends = -GROUND_V, 3.3 - GROUND_V - 3.3 / 4096
    assert shifted.quantise_v(np.array([-2.0, 2.0])) == pytest.approx(ends)


def test_software_computes_the_envelope_from_the_samples_of_the_filtered_signal():
    """Against the difference equation, in any chunks; a board with
    an envelope leaves it as it is sampled.
    """
    volts = np.random.default_rng(2).normal(0.0, 0.5, 300)
    pole = np.exp(-2 * np.pi * 36.17 / 2000)
    expected = []
    envelope = 0.0
    for v in volts:
        envelope = pole * envelope + (1 - pole) * max(v, 0.0)
        expected.append(envelope)
    source = EnvelopeSource(CONTROLLER)
    assert source.pin == ADC_FILTERED
    assert source.select(volts, -volts) is volts
    found = np.concatenate([source.finish(part) for part in np.split(volts, [0, 1, 7, 150])])
    assert found == pytest.approx(np.array(expected), abs=1e-15)
    on_board = EnvelopeSource(ARTICLE)
    assert (
        on_board.pin,
        on_board.select(-volts, volts) is volts,
        on_board.finish(volts) is volts,
    ) == (
        ADC_ENVELOPE,
        True,
        True,
    )


@pytest.mark.full
def test_filtered_signal_is_sampled_around_the_signal_ground():
    """Slip shows in S in many steps of 12 bits, while T has steps of
    0.8 mV for some millivolts of vibration.
    """
    outputs = ["voltage_v", "filtered_v", "sampled_filtered_v"]
    scene = SceneFile(hold={"wait_s": 0.2}, slide={"distance_m": 0.02}, outputs=outputs)
    found = run_scene(CONTROLLER, scene, 0).columns
    step = CONTROLLER.detector.adc_step_v
    for name, low_v in (("voltage_v", 0.0), ("sampled_filtered_v", -GROUND_V)):
        codes = (found[name] - low_v) / step
        assert np.abs(codes - np.round(codes)).max() < 1e-6
    delayed = AntiAliasFilter.ahead_of(ADC_FILTERED, CONTROLLER).process(found["filtered_v"])
    assert np.abs(found["sampled_filtered_v"] - delayed).max() < 0.05 * np.ptp(delayed)
    assert np.ptp(found["sampled_filtered_v"]) > 20 * np.ptp(found["voltage_v"][-200:])


@pytest.mark.parametrize(
    ("duration", "rate", "count"), [(0.0, 2000.0, 1), (1.0, 2000.0, 2001), (0.00051, 2000.0, 3)]
)
def test_recording_has_a_sample_at_its_end_or_after_it(duration, rate, count):
    assert count_samples(duration, rate) == count


@pytest.mark.every_case
@pytest.mark.parametrize("rate", [1000.0, 1999.7, 3000.0, 10_000.0, 20_000.0])
@pytest.mark.parametrize("refinement", [1, 3])
def test_last_point_is_the_first_that_is_not_before_the_last_sample(rate, refinement):
    grid = Grid(refinement)
    last = (count_samples(0.7531, rate) - 1) / rate
    points = grid.count_points(0.7531, rate)
    assert (points - 2) / grid.rate_hz < last - 1e-12
    assert last <= (points - 1) / grid.rate_hz + 1e-9


@pytest.mark.parametrize("rate", [1000.0, 2000.0, 3000.0, 2500.0, 1999.7, 20_000.0])
def test_samples_lie_on_the_straight_line_between_points(rate):
    grid = Grid()
    clock = SampleClock(Grid(), rate)
    sampler = Sampler()
    count = grid.count_points(0.5, rate)
    values = 3.0 * grid.time_s(0, count) + 1.0
    times = []
    found = []
    for a, b in pairwise((0, 1, 2, 5, 1000, 1001, count)):
        at = clock.advance(b - a)
        times.append(at.time_s)
        found.append(sampler.process(values[a:b], at))
    time_s = np.concatenate(times)
    assert np.array_equal(time_s, np.arange(count_samples(0.5, rate)) / rate)
    assert np.concatenate(found) == pytest.approx(3.0 * time_s + 1.0, abs=1e-12)


CONSTANT_FORCE = {
    "hold": {
        "mode": "grasp",
        "min_force_n": 1.0,
        "max_force_n": 1.0,
        "min_s": 20.0,
        "release": False,
    }
}
SETTLED = 4000
"""Number of samples after which the grasp is closed and the filter settled."""


def simulate_hold(design: Design, *outputs: str, **sensing) -> dict[str, np.ndarray]:
    found = run_scene(
        design, SceneFile(**CONSTANT_FORCE, sensing=sensing, outputs=list(outputs)), 3
    )
    return {name: column[SETTLED:] for name, column in found.columns.items()}


def sample_v(design: Design, voltage_v: np.ndarray, seed: int) -> np.ndarray:
    noise_v = draw_noise(open_stream(seed, "test"), design.detector.noise_v, len(voltage_v))
    return AdcRange.from_design(design).above_signal_ground(design).quantise_v(voltage_v + noise_v)


@pytest.mark.full
@pytest.mark.parametrize("variant", VARIANT_CHANGES)
def test_simulated_board_is_as_noisy_as_its_noise_budget(variant):
    """ngspice's noise analysis confirms the budget (tests/board/test_spice.py)."""
    design = load_article(VARIANT_CHANGES[variant])
    budget = add_noise(
        board_circuit(board_values(design)), find_gain_bandwidth_hz(design.board)
    ).total_v("FILTERED")
    assert budget == pytest.approx(
        {"article": 20.1e-3, "precision": 0.132e-3, "comparator": 0.098e-3}[variant], rel=0.1
    )
    filtered = simulate_hold(design, "filtered_v")["filtered_v"]
    # 40 000 samples of a band of a kilohertz: within 1 %.
    assert np.std(filtered) == pytest.approx(budget, rel=0.03)
    assert compute_input_noise_v(design) * compute_noise_gain(design) == pytest.approx(budget)


@pytest.mark.full
def test_adc_adds_its_noise_behind_the_gain():
    """The sampled voltage has the ADC's noise and steps; the board's
    output has them only once it is sampled.
    """
    noisy = simulate_hold(ARTICLE, "voltage_v")
    silent = simulate_hold(ARTICLE, "voltage_v", noise=False)
    step = 2 * ARTICLE.detector.adc_range_v / 2**ARTICLE.detector.adc_bits
    expected = np.hypot(ARTICLE.detector.noise_v, step / np.sqrt(12))
    assert np.std(np.diff(noisy["voltage_v"])) == pytest.approx(expected * np.sqrt(2), rel=0.02)
    assert np.std(np.diff(silent["voltage_v"])) < step
    assert np.std(sample_v(ARTICLE, np.full(20_000, 0.1), 1)) == pytest.approx(expected, rel=0.02)
    assert AdcRange.from_design(ARTICLE).above_signal_ground(ARTICLE) == AdcRange(16, -10.0, 10.0)


@pytest.mark.full
@pytest.mark.parametrize("variant", ["article", "precision"])
def test_quiescent_level_is_that_of_a_scene_with_constant_force(variant):
    design = article_design(board={"variant": variant})
    level = simulate_quiescent_level(design)
    output = "envelope_v" if design.board.has_envelope else "filtered_v"
    sampled_v = sample_v(design, simulate_hold(design, output)[output], 2)
    envelope_v = EnvelopeSource(design).finish(sampled_v)
    width = design.detector.window_samples
    means = np.convolve(envelope_v, np.full(width, 1 / width), "valid")
    assert means.mean() == pytest.approx(level.mean_v, abs=0.1 * level.mean_v + 5e-6)
    # The level's deviation is at least that of a step of the converter.
    least_v = design.detector.adc_step_v / DEVIATIONS
    assert max(means.std(), least_v) == pytest.approx(level.deviation_v, rel=0.25)


def test_recorded_voltage_carries_the_adc_noise_into_the_board():
    """The board amplifies it 68 times, so that the threshold has to
    be higher than behind the board itself.
    """
    design = article_design(board={"variant": "precision"})
    assert (
        simulate_replay_level(design).threshold_v > 3 * simulate_quiescent_level(design).threshold_v
    )
