"""Wider mix: signals with known content, what boards make of them, and
what is made of a detector's flags on them.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks import slip_robustness
from benchmarks.slip import mix, mix_signals
from benchmarks.slip.mix import MixSize, assess
from benchmarks.slip.mix_signals import LabelledSignal, Slide, filter_as_board
from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, check_first_seed
from fingertip.sim.simulation import article_trials
from fingertip.slip.traces.truth import Interval
from tests.designs import ARTICLE

DESIGN = ARTICLE
SLIP = next(article_trials())[0]


def flags(*parts: tuple[float, float], seconds: float = 4.0) -> np.ndarray:
    t = np.arange(round(seconds * 1000)) / 1000
    return np.logical_or.reduce([(t >= a - 1e-9) & (t < b - 1e-9) for a, b in parts])


def known(**fields: object) -> LabelledSignal:
    return replace(
        LabelledSignal("test", 1000.0, np.zeros(4000), (Slide(0.99, 1.0, 2.0),)), **fields
    )


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


def test_long_slides_have_each_strength_and_each_is_twice_the_one_before() -> None:
    plan = mix._plan_events(DESIGN, 8, itertools.count())
    strengths_v = [draw.args[-1] for draw in plan if draw.func is mix_signals.long_slide]
    assert DESIGN.detector.noise_v < strengths_v[0]
    assert strengths_v == pytest.approx([strengths_v[0] * factor for factor in (1, 2, 4, 8)])


def test_a_slip_is_found_from_5_ms_before_its_onset_to_its_end():
    for start, delay in ((0.995, 0.0), (1.0, 0.0), (1.02, 0.02), (1.999, 0.999)):
        found = assess(known(), flags((start, 2.5)), 0.05)
        assert found.delays_s == pytest.approx((delay,))
        assert found.motion_delays_s == pytest.approx((start - 0.99,))
        assert found.alarms == 0
    for start in (0.994, 2.0):
        assert assess(known(), flags((start, 2.5)), 0.05).delays_s == ()
    assert assess(known(), flags((0.9, 2.5)), 0.05).alarms == 1
    assert assess(known(), flags((1.5, 1.8)), 0.05).on_shares == pytest.approx((0.3,))


def test_alarms_count_once_for_one_event_and_from_the_stated_moment():
    on = flags((0.1, 0.2), (0.25, 0.3), (2.04, 2.1), (3.0, 3.1))
    assert assess(known(), on, 0.05).alarms_s == pytest.approx((0.1, 3.0))
    late = assess(known(alarms_from_s=0.5), on, 0.05)
    assert late.alarms == 1
    assert late.minutes == pytest.approx(3.5 / 60)


def test_an_event_is_disturbed_by_an_alarm_up_to_a_reaction_later():
    event = known(slides=(), events=(Interval(1.0, 1.1),))
    for start, disturbed in ((0.99, 0), (1.0, 1), (1.25, 1), (1.31, 0)):
        assert assess(event, flags((start, start + 0.05)), 0.05).disturbed == disturbed


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
        assert mix_signals.low_burst(DESIGN, seed, 0.006, 0.025).kind == "burst below 60 Hz"


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
def test_fast_keeps_the_limits_of_the_wider_mix_where_few_signals_show_it():
    signals = slip_robustness.generate_all(
        DESIGN, 24, 4.0, MixSize(30, 12), HELD_OUT_FROM + 77_000_000
    )
    both = slip_robustness.run_both_points(DESIGN, signals)
    early, found = (slip_robustness.pool(both[point]) for point in ("incipient", "on"))
    assert early["slip"].found_share == 1.0
    assert early["slip"].delay_s(0.9) < 0.045  # of 24; it is 28 ms of 960
    assert found["slip"].delay_s(0.5) < 0.04
    assert early["campaign"].alarms <= 1
    assert found["campaign"].alarms <= 1
    assert found["grip change"].disturbed_share <= 0.05
    assert found["fast closing"].disturbed_share <= 0.05
    assert found["tap"].disturbed_share <= 0.05
    assert found["controller's step"].disturbed_share <= 0.1
    assert early["burst above 60 Hz"].delay_s(0.9) <= 0.03  # of 18; it is 18 ms of 48
    assert early["burst below 60 Hz"].delay_s(0.9) <= 0.045
    assert found["long slide"].smallest_on_share > 0.98
    assert found["10 bits"].alarms_per_minute < 1.0


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
