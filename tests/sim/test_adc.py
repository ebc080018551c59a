"""Anti-aliasing poles ahead of the ADC in the time domain, against the board's transfer function."""

import numpy as np
import pytest

from fingertip.board import board_values
from fingertip.design import Design
from fingertip.sim.signal.converter import AntiAliasFilter
from tests.oracles.filter_formulas import envelope_pin_transfer, tactile_pin_transfer

DESIGNS = [Design(), Design(detector={"sample_rate_hz": 20_000.0, "window_samples": 600})]


@pytest.mark.parametrize("design", DESIGNS, ids=["2 kHz", "20 kHz"])
@pytest.mark.parametrize("pin", ["tactile", "envelope"])
def test_tones_have_the_gain_of_the_transfer_function(design, pin):
    rate, interface = design.detector.sample_rate_hz, board_values(design).adc_interface
    for share in (0.01, 0.05, 0.1):
        t = np.arange(4000) / rate
        turn = 2j * np.pi * share * rate * t
        out = getattr(AntiAliasFilter, f"for_{pin}")(design).process(np.exp(turn).real)
        settled = slice(1000, 4000)  # whole periods of every tone
        gain = 2 * np.mean(out[settled] * np.exp(-turn[settled]))
        transfer = tactile_pin_transfer if pin == "tactile" else envelope_pin_transfer
        # Straight lines between a tone's samples contain the tone and its images, which alias onto it behind the poles.
        images = [share + k for k in range(-400, 401)]
        expected = sum(np.sinc(image) ** 2 * transfer(image * rate, interface) for image in images)
        assert gain == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("pin", ["tactile", "envelope"])
def test_any_chunks_give_the_same_bits(pin):
    volts = np.random.default_rng(0).normal(4.0, 0.1, 300)
    whole, parts = (
        getattr(AntiAliasFilter, f"for_{pin}")(DESIGNS[0]),
        getattr(AntiAliasFilter, f"for_{pin}")(DESIGNS[0]),
    )
    found = np.concatenate([parts.process(part) for part in np.split(volts, [0, 1, 7, 150])])
    assert np.array_equal(found, whole.process(volts))


def test_constant_input_gives_the_same_constant():
    out = AntiAliasFilter.for_tactile(DESIGNS[0]).process(np.full(50, 4.4))
    assert np.abs(out - 4.4).max() < 1e-12


def test_ramp_is_delayed_by_the_sum_of_the_time_constants():
    c = board_values(DESIGNS[0]).adc_interface
    lag_s = c.first_ohm * (c.first_f + c.second_f) + c.second_ohm * c.second_f
    t = np.arange(400) / 2000
    out = AntiAliasFilter.for_tactile(DESIGNS[0]).process(t)
    assert t[-1] - out[-1] == pytest.approx(lag_s, rel=1e-9)
    assert 1.0 < 2000 * lag_s < 1.6
