"""Wider mix: signals with known content, and what boards make of them."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from benchmarks import slip_robustness
from benchmarks.slip import mix, mix_signals
from benchmarks.slip.mix import MixSize
from benchmarks.slip.mix_signals import filter_as_board
from benchmarks.slip.scores import Tally
from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, check_first_seed
from fingertip.sim.simulation import article_trials
from tests.designs import ARTICLE

DESIGN = ARTICLE
SLIP = next(article_trials())[0]


def test_the_mix_has_each_noise_with_slides_and_with_a_still_contact() -> None:
    draws = [
        draw.args for draw in mix._plan_noisy(DESIGN, MixSize(events=1, noisy=6), itertools.count())
    ]
    told = [
        (name, scene.name) for _, scene, _, name, condition in draws if isinstance(condition, dict)
    ]
    for name in (*mix_signals.NOISES, "10 bits"):
        of_noise = [scene for noise, scene in told if noise == name]
        slides = len(of_noise) - of_noise.count("drift")
        assert (slides, len(of_noise) > slides) == (2 if name == "10 bits" else 6, True)


def test_bursts_have_their_strength_and_band():
    from scipy import signal as scipy_signal

    for seed in range(6):
        burst = mix_signals.abrupt_burst(DESIGN, seed, 0.006, 0.025)
        (slide,) = burst.slides
        part = burst.voltage_v[round(slide.onset_s * 2000) : round(slide.end_s * 2000)]
        assert 0.006 <= burst.strength_v <= 0.025
        assert part.std() == pytest.approx(burst.strength_v, rel=0.03)
        above = scipy_signal.butter(8, 67.0, "high", fs=2000.0, output="sos")
        ratio = part.std() / scipy_signal.sosfiltfilt(above, part - part.mean()).std()
        assert (ratio <= 1.5) == (burst.kind == "burst above 60 Hz") or ratio == pytest.approx(
            1.5, rel=0.1
        )


def test_band_noise_has_unit_strength_within_its_band():
    noise = mix_signals.draw_band_noise(np.random.default_rng(0), 8000, 2000.0, 30.0, 90.0)
    assert math.sqrt(float(np.mean(noise**2))) == pytest.approx(1.0)
    power = np.abs(np.fft.rfft(noise)) ** 2
    hz = np.fft.rfftfreq(8000, 1 / 2000)
    assert power[(hz < 29.9) | (hz > 90.1)].sum() < 1e-9 * power.sum()


@pytest.mark.parametrize("name", list(mix_signals.NOISES))
def test_unstated_noise_is_in_the_signal_and_the_slip_is_the_same(name):
    plain = mix_signals.simulate_scene(DESIGN, SLIP, 3, "slip")
    noisy = mix_signals.in_condition(DESIGN, SLIP, 3, name, mix_signals.NOISES[name])
    assert noisy.slides == plain.slides
    assert noisy.alarms_from_s == 1.0
    difference = np.diff(noisy.voltage_v[:2000], 2).std() / np.diff(plain.voltage_v[:2000], 2).std()
    expected = {"noise x0.5": 0.5, "noise x2": 2.0, "noise x5": 5.0, "12 bits": 1.5}
    assert difference == pytest.approx(expected.get(name, 1.0), rel=0.3)
    assert not np.array_equal(noisy.voltage_v, plain.voltage_v)


@pytest.mark.full
def test_fast_keeps_the_limits_of_the_wider_mix_where_few_signals_show_it() -> None:
    found = dict[str, dict[str, Tally]]()
    signals = slip_robustness.generate_all(
        DESIGN,
        trials=24,
        minutes=4.0,
        size=MixSize(30, 12),
        first_seed=HELD_OUT_FROM + 77_000_000,
    )
    slip_robustness.judge(DESIGN, signals, found)
    early = found["incipient"]
    on = found["on"]
    assert early["slip"].found_share == 1.0
    assert on["slip"].quantile_ms(0.5) < 40.0
    assert on["grip change"].taken_share <= 0.05
    assert on["fast closing"].taken_share <= 0.05
    assert on["tap"].taken_share <= 0.05
    assert on["burst above 60 Hz"].quantile_ms(0.9) <= 30.0
    assert on["10 bits"].alarms_per_minute < 1.0


def test_filtered_signal_ends_at_the_limits_of_the_board() -> None:
    design = Design.load("fsr400")
    rate_hz = design.detector.sample_rate_hz
    tone_v = np.sin(2 * np.pi * 300.0 * np.arange(0.5 * rate_hz) / rate_hz)
    settled = slice(len(tone_v) // 2, None)
    peaks_v = []
    for volts in (0.01, 0.02, 50.0):
        filtered_v = filter_as_board(design, 1.6 + volts * tone_v)
        assert filtered_v is not None
        peaks_v.append(filtered_v[settled].max())
        assert filtered_v[settled].min() == pytest.approx(-peaks_v[-1], rel=0.02)
    assert peaks_v[1] == pytest.approx(2 * peaks_v[0])
    assert peaks_v[1] < peaks_v[2] <= design.board.supply_v / 2


def test_seeds_of_training_are_refused_and_the_last_one_leaves_room_for_all_trials_in_32_bits() -> (
    None
):
    last = 2**31 - 1 - 20_000_000
    for seed in (HELD_OUT_FROM, last):
        check_first_seed(seed)
    with pytest.raises(TraceError, match=f"is too large; choose {HELD_OUT_FROM} to {last}"):
        check_first_seed(last + 1)
    for seed in (-1, 1200, 200_000, HELD_OUT_FROM - 1, 2**31):
        with pytest.raises(TraceError, match=f"seed: {seed} is "):
            check_first_seed(seed)
