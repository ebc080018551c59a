"""Anti-aliasing poles ahead of the ADC in the time domain, against the board's transfer function."""

import numpy as np
import pytest

from fingertip.board import board_values
from fingertip.board.parts.circuit import ADC_ENVELOPE, ADC_FILTERED, ADC_TACTILE
from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.sim.runs.files import SceneFile
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.signal.converter import AdcRange, AntiAliasFilter
from tests.designs import ARTICLE, article_design
from tests.oracles.filter_formulas import envelope_pin_transfer, tactile_pin_transfer

CONTROLLER = Design(
    board={"variant": "precision", "supply": "single_3v3", "supply_v": 3.3},
    detector={"adc_bits": 12, "adc_range_v": 3.3, "adc_polarity": "unipolar"},
)
DESIGNS = [ARTICLE, article_design(detector={"sample_rate_hz": 20_000.0, "window_samples": 600})]
GROUND_V = 3.3 * 44.2 / 99.1
"""Signal ground of that board, by its divider."""


@pytest.mark.parametrize("design", DESIGNS, ids=["2 kHz", "20 kHz"])
@pytest.mark.parametrize("pin", [ADC_TACTILE, ADC_ENVELOPE], ids=["tactile", "envelope"])
def test_tones_have_the_gain_of_the_transfer_function(design, pin):
    rate, interface = design.detector.sample_rate_hz, board_values(design).adc_interface
    for share in (0.01, 0.05, 0.1):
        t = np.arange(4000) / rate
        turn = 2j * np.pi * share * rate * t
        out = AntiAliasFilter.ahead_of(pin, design).process(np.exp(turn).real)
        settled = slice(1000, 4000)  # whole periods of every tone
        gain = 2 * np.mean(out[settled] * np.exp(-turn[settled]))
        transfer = tactile_pin_transfer if pin == ADC_TACTILE else envelope_pin_transfer
        # Straight lines between a tone's samples contain the tone and its images, which alias onto it behind the poles.
        images = [share + k for k in range(-400, 401)]
        expected = sum(np.sinc(image) ** 2 * transfer(image * rate, interface) for image in images)
        assert gain == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("pin", [ADC_TACTILE, ADC_ENVELOPE], ids=["tactile", "envelope"])
def test_any_chunks_give_the_same_bits(pin):
    volts = np.random.default_rng(0).normal(4.0, 0.1, 300)
    whole, parts = AntiAliasFilter.ahead_of(pin, DESIGNS[0]), AntiAliasFilter.ahead_of(pin, DESIGNS[0])
    found = np.concatenate([parts.process(part) for part in np.split(volts, [0, 1, 7, 150])])
    assert np.array_equal(found, whole.process(volts))


def test_ramp_is_delayed_by_the_sum_of_the_time_constants():
    c = board_values(DESIGNS[0]).adc_interface
    lag_s = c.first_ohm * (c.first_f + c.second_f) + c.second_ohm * c.second_f
    t = np.arange(400) / 2000
    out = AntiAliasFilter.ahead_of(ADC_TACTILE, DESIGNS[0]).process(t)
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


def test_pole_of_the_filtered_signal_equals_that_of_the_envelope():
    volts = np.random.default_rng(1).normal(0.0, 0.5, 300)
    filtered, envelope = (
        AntiAliasFilter.ahead_of(pin, CONTROLLER).process(volts) for pin in (ADC_FILTERED, ADC_ENVELOPE)
    )
    assert np.abs(filtered - envelope).max() < 1e-12


def test_filtered_signal_is_sampled_around_the_signal_ground():
    """Slip shows in S in many steps of 12 bits, while T has steps of 0.8 mV for some millivolts of vibration."""
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


def test_filtered_signal_of_another_supply_is_refused():
    scene = SceneFile(outputs=["sampled_filtered_v"])
    with pytest.raises(TraceError, match=r"board\.supply is split; use --set board\.supply=single_3v3"):
        run_scene(ARTICLE, scene, 0)
