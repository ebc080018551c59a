"""Detector `fast`: its filters, floors and trees, and signals that nobody simulated."""

from __future__ import annotations

import math
from dataclasses import astuple, replace

import numpy as np
import pytest

from benchmarks.slip.mix_signals import draw_band_noise
from fingertip.slip.detectors import fast_settings, fast_state
from fingertip.slip.detectors.fast import FastDetector, IncipientDetector
from fingertip.slip.detectors.fast_coefficients import (
    DEPTH,
    FEATURES,
    HIGH_HZ,
    LOW_HZ,
    NODES,
    RESTORED_HZ,
    SLOW_HZ,
    UPPER_HZ,
    FastModel,
    design_board_filter,
    design_filters,
    load_model,
    noise_energies,
)
from fingertip.slip.detectors.fast_decision_and_floors import learn_floors
from fingertip.slip.detectors.fast_settings import STAY_SCORE, FastSettings, FilteredSignal

NOISE_V = 4e-4
SETTINGS = FastSettings(2000.0, NOISE_V)

NO_TREES = FastModel(np.zeros(0), np.zeros(0), np.zeros(0), -50.0, 1.0, 0.0, 0.0)


def noise(
    seconds: float, deviation_v: float = NOISE_V, seed: int = 1, rate: float = 2000.0
) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, deviation_v, round(seconds * rate))


def times(volts: np.ndarray, rate: float = 2000.0) -> np.ndarray:
    return np.arange(len(volts)) / rate


def filter_edge(volts: np.ndarray, rate: float = 2000.0) -> np.ndarray:
    """Restored signal below the upper edge of the bands, by scipy's filters."""
    from scipy import signal as scipy_signal

    restored = scipy_signal.sosfilt(
        scipy_signal.butter(3, RESTORED_HZ, "high", fs=rate, output="sos"), volts
    )
    return np.asarray(
        scipy_signal.sosfilt(scipy_signal.butter(2, HIGH_HZ, fs=rate, output="sos"), restored)
    )


def smoothstep(x: np.ndarray) -> np.ndarray:
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3 - 2 * x)


@pytest.mark.parametrize("rate", [1000.0, 2000.0, 20000.0])
def test_filters_are_butterworth_filters(rate):
    from scipy import signal as scipy_signal

    filters = design_filters(rate)
    impulse = np.zeros(1000)
    impulse[0] = 1.0
    edge = filter_edge(impulse, rate)
    wide = scipy_signal.sosfilt(scipy_signal.butter(2, LOW_HZ, "high", fs=rate, output="sos"), edge)
    upper = scipy_signal.sosfilt(
        scipy_signal.butter(2, UPPER_HZ, "high", fs=rate, output="sos"), edge
    )
    found = filters.impulse_responses(1000)
    assert found[0] == pytest.approx(wide, abs=1e-12)
    assert found[1] == pytest.approx(upper, abs=1e-12)
    b, a = scipy_signal.butter(2, SLOW_HZ, fs=rate)
    assert (*filters.slow,) == pytest.approx((*b, *a[1:]), abs=1e-12)
    volts = np.concatenate(([0.0], 0.01 * impulse))  # an impulse of 1 V is a glitch
    output = FastDetector(FastSettings(rate, NOISE_V)).process(volts)
    assert 100 * output.filtered_v[1:] == pytest.approx(wide, abs=1e-12)


@pytest.mark.every_case
@pytest.mark.parametrize("cutoff_hz", [30.0, 67.0, 150.0])
@pytest.mark.parametrize("rate", [1000.0, 2000.0, 20000.0])
def test_the_board_filter_and_its_restoration_are_one_high_pass(rate, cutoff_hz):
    """Both filters in series have the frequency response of the
    high-pass at `RESTORED_HZ`, as scipy designs it.
    """
    from scipy import signal as scipy_signal

    f_hz = np.geomspace(1.0, 0.45 * rate, 50)

    def response(sections) -> np.ndarray:
        total = np.ones(len(f_hz), dtype=complex)
        for b0, b1, *rest in sections:
            b2, a1, a2 = (0.0, rest[0], 0.0) if len(rest) == 1 else rest
            total *= scipy_signal.freqz([b0, b1, b2], [1.0, a1, a2], f_hz, fs=rate)[1]
        return total

    board, restore = design_board_filter(rate, cutoff_hz)
    expected = {
        hz: scipy_signal.freqz(*scipy_signal.butter(3, hz, "high", fs=rate), f_hz, fs=rate)[1]
        for hz in (cutoff_hz, RESTORED_HZ)
    }
    assert np.abs(response(board) - expected[cutoff_hz]).max() < 1e-6
    assert np.abs(response((*board, *restore)) - expected[RESTORED_HZ]).max() < 1e-4


def test_features_are_what_their_names_say():
    from scipy import signal as scipy_signal
    from scipy.signal import lfilter

    volts = 4.0 + noise(1.2)
    volts += 0.01 * np.sin(2 * math.pi * 100 * times(volts)) * (
        times(volts) > 1.0
    ) - 0.05 * smoothstep((times(volts) - 1.05) / 0.1)
    detector = FastDetector(SETTINGS, NO_TREES)
    _, rows = detector.compute_features(volts)
    at = len(rows) * 4 - 1  # sample of the last tick
    edge = filter_edge(volts - volts[0])
    wide = scipy_signal.sosfilt(
        scipy_signal.butter(2, LOW_HZ, "high", fs=2000.0, output="sos"), edge
    )
    upper = scipy_signal.sosfilt(
        scipy_signal.butter(2, UPPER_HZ, "high", fs=2000.0, output="sos"), edge
    )
    slow = scipy_signal.sosfilt(
        scipy_signal.butter(2, SLOW_HZ, fs=2000.0, output="sos"), volts - volts[0]
    )

    def mean(x: np.ndarray, seconds: float) -> np.ndarray:
        share = 1 / (1 + 2000.0 * seconds)
        return np.asarray(lfilter([share], [1, share - 1], x))

    found = dict(zip(FEATURES, rows[-1], strict=True))
    # The slow force compares with the noise of the voltage, expressed in the wide band.
    slow_floor = noise_energies(2000.0)[0] * detector._state[fast_state.INPUT_FLOOR]
    slopes = (0.01 * 2000.0 * np.diff(slow, prepend=0.0)) ** 2
    greatest = slopes[at + 1 - 200 : at + 1].max()
    energies = {"wide": mean(wide**2, 0.02)[at], "upper": mean(upper**2, 0.02)[at]}
    floor = energies["wide"] / found["wide energy, 20 ms"]
    assert found["upper over wide energy"] == pytest.approx(
        energies["upper"] / energies["wide"], rel=1e-3
    )
    assert found["wide energy, 6 ms"] == pytest.approx(mean(wide**2, 0.006)[at] / floor, rel=1e-6)
    assert found["greatest slope"] == pytest.approx(greatest / slow_floor, rel=1e-3)
    assert found["slope over greatest slope"] == pytest.approx(slopes[at] / greatest, rel=1e-3)
    assert found["change over 100 ms"] == pytest.approx(
        (slow[at] - slow[at - 200]) ** 2 / slow_floor, rel=1e-3
    )
    ticks = 9 + (len(rows) - 1) % 4  # two slots of four, and the present one
    smallest = mean(wide**2, 0.006)[at - 4 * (ticks - 1) : at + 1 : 4].min()
    assert found["smallest wide energy"] == pytest.approx(smallest / floor, rel=1e-6)
    assert found["smallest wide energy over that of 20 ms"] == pytest.approx(
        smallest / energies["wide"], rel=1e-6
    )
    change = slow[at] - slow[at - 96]  # 12 entries of the ring, each of 4 ms
    assert found["signed change over 48 ms"] == pytest.approx(
        change * abs(change) / slow_floor, rel=1e-3
    )
    assert found["wide energy over greatest slope"] == pytest.approx(
        energies["wide"] / greatest, rel=1e-3
    )
    wide_80, upper_80, slope_80 = (
        lfilter([1 / 41], [1, -40 / 41], x[3::4])[-1]
        for x in (mean(wide**2, 0.006), mean(upper**2, 0.006), slopes)
    )
    assert found["wide energy, 80 ms"] == pytest.approx(wide_80 / floor, rel=1e-3)
    assert found["upper over wide energy, 80 ms"] == pytest.approx(upper_80 / wide_80, rel=1e-3)
    assert found["upper energy of 20 ms over that of 80 ms"] == pytest.approx(
        energies["upper"] / upper_80, rel=1e-3
    )
    assert found["slope, 80 ms"] == pytest.approx(slope_80 / slow_floor, rel=1e-3)
    assert found["slope of 80 ms over greatest slope"] == pytest.approx(
        slope_80 / greatest, rel=1e-3
    )


def test_the_unit_of_the_input_does_not_matter():
    volts = 4.0 + noise(2.0)
    volts += 0.01 * np.sin(2 * math.pi * 90 * times(volts)) * (times(volts) > 1.0)
    one = FastDetector(SETTINGS).process(volts)
    other = FastDetector(FastSettings(2000.0, NOISE_V * 1024)).process(volts * 1024)
    assert one.on.any()
    assert np.array_equal(one.on, other.on)
    assert np.array_equal(one.confidence, other.confidence)
    assert np.array_equal(one.statistic_v * 1024, other.statistic_v)


def learned_noise_v(detector: FastDetector) -> list[float]:
    """White noise that each of the three floors stands for: of the
    wide band, the upper band and the voltage [V].
    """
    wide, upper = noise_energies(detector.settings.sample_rate_hz)
    shares = {fast_state.FLOOR: wide, fast_state.UPPER_FLOOR: upper, fast_state.INPUT_FLOOR: 1.0}
    return [math.sqrt(detector.state[index] / share) for index, share in shares.items()]


@pytest.mark.full
@pytest.mark.parametrize("factor", [0.6, 2.0])
def test_all_three_floors_learn_white_noise(factor):
    detector = FastDetector(SETTINGS)
    detector.process(4.0 + noise(20.0, factor * NOISE_V))
    assert learned_noise_v(detector) == pytest.approx([factor * NOISE_V] * 3, rel=0.15)
    _, rows = detector.compute_features(4.0 + noise(10.0, factor * NOISE_V, 2))
    assert rows[:, [0, 1, 2, 3]].mean(axis=0) == pytest.approx([1.0] * 4, rel=0.3)


def test_no_floor_sinks_below_a_fifth_of_the_stated_noise():
    """The noise sinks to a tenth: each floor follows as far as a
    fifth of what was stated, and no further.
    """
    detector = FastDetector(SETTINGS)
    detector.process(4.0 + noise(5.0))
    detector.process(4.0 + noise(30.0, 0.1 * NOISE_V, 2))
    assert learned_noise_v(detector) == pytest.approx([0.2 * NOISE_V] * 3, rel=1e-9)


def test_a_loud_moment_counts_as_four_times_the_floor_and_a_quiet_one_tenfold():
    """Floors average over 2 s where they rise, over 0.2 s where they fall."""
    detector = FastDetector(SETTINGS, NO_TREES)
    detector.process(4.0 + noise(20.0))
    for factor, ratio in ((100.0, 1 + (4 - 1) / 1000), (0.5, 1 - 0.5 / 100)):
        before = np.array(learned_noise_v(detector))
        energies = [factor * floor for floor in astuple(detector.floors)]
        learn_floors(detector.coefficients, *energies, False, False, detector._state)
        assert learned_noise_v(detector) == pytest.approx(math.sqrt(ratio) * before, rel=1e-9)


@pytest.mark.second
def test_both_floors_follow_a_tone_that_lasts():
    """The energies of a tone of 150 Hz, which lies in both bands, become the floors."""
    detector = FastDetector(SETTINGS)
    volts = 4.0 + noise(12.0)
    volts += 0.01 * np.sin(2 * math.pi * 150 * times(volts)) * (times(volts) > 2.0)
    pairs = (
        (fast_state.FLOOR, fast_state.WIDE_LONG),
        (fast_state.UPPER_FLOOR, fast_state.UPPER_LONG),
    )
    on = []
    steps = []
    for chunk in np.split(volts, len(volts) // 40):  # ten evaluations of the trees each
        before = [detector.state[floor] for floor, _ in pairs]
        on.append(detector.process(chunk).on)
        if on[-1].all():
            state = detector.state
            steps += [
                (old / state[e], state[f] / state[e])
                for old, (f, e) in zip(before, pairs, strict=True)
            ]
    flags = np.concatenate(on)
    assert flags[4400:9000].all()
    assert not flags[-1000:].any()
    assert all(
        0.3 * detector.state[energy] < detector.state[floor] < 1.1 * detector.state[energy]
        for floor, energy in pairs
    )
    # While ON, what is missing to the energy shrinks with a time constant of 0.5 s.
    shrinks = [(1 - new) / (1 - old) for old, new in steps if 0.2 < old < 0.45]
    assert len(shrinks) > 10
    assert shrinks == pytest.approx([(1 - 0.002 / 0.5) ** 10] * len(shrinks), rel=0.01)


def test_floors_stand_still_while_on_and_while_the_force_changes():
    detector = FastDetector(SETTINGS)
    detector.process(4.0 + noise(5.0))
    before = detector.noise_v
    burst = 4.0 + noise(8.0, seed=2) + band_noise(8.0, 0.003)
    output = detector.process(burst)
    assert output.on[200:].mean() > 0.98
    assert detector.noise_v == pytest.approx(before, rel=0.1)
    # A force that changes for long leaves energy in the band that is not noise.
    swing = 4.0 + 0.3 * np.sin(2 * math.pi * 2 * times(noise(5.0)))
    detector.process(swing + noise(5.0, seed=3))
    assert detector.noise_v == pytest.approx(before, rel=0.2)


def band_noise(
    seconds: float, rms_v: float, low_hz: float = 60.0, high_hz: float = 140.0, seed: int = 5
) -> np.ndarray:
    from scipy import signal as scipy_signal

    sos = scipy_signal.butter(4, [low_hz, high_hz], "band", fs=2000.0, output="sos")
    raw = scipy_signal.sosfilt(sos, noise(seconds + 1.0, 1.0, seed))[2000:]
    return np.asarray(rms_v * raw / raw.std())


@pytest.mark.every_case
@pytest.mark.parametrize("rise_s", [0.02, 0.03, 0.05, 0.1, 0.15])
@pytest.mark.parametrize("change_v", [-0.25, 0.2])
def test_a_change_of_grip_is_not_slip(rise_s, change_v):
    volts = 4.0 + noise(2.5)
    volts += change_v * smoothstep((times(volts) - 1.5) / rise_s)
    assert not FastDetector(SETTINGS).process(volts).on.any()


def test_a_knock_is_not_slip_and_slip_after_it_is_found():
    t = np.arange(4000) / 2000
    since = np.clip(t - 1.0, 0, None)
    ring = 0.3 * np.sin(2 * math.pi * 90 * since) * np.exp(-since / 0.01)
    volts = 4.0 + ring + noise(2.0)
    assert not FastDetector(SETTINGS).process(volts).on.any()
    volts[2600:] += band_noise(0.7, 0.01)
    assert 2600 < np.flatnonzero(FastDetector(SETTINGS).process(volts).on)[0] < 2670


def test_coarse_steps_are_not_slip():
    """A converter whose steps are ten times the noise toggles between two codes."""
    step = 5 / 1023
    t = np.arange(20_000) / 2000
    for offset in (0.0, 0.25, 0.5):
        drift = 4.0 + (offset + 0.3 * np.sin(2 * math.pi * 0.1 * t)) * step
        assert (
            not FastDetector(SETTINGS)
            .process(np.round((drift + noise(10.0)) / step) * step)
            .on.any()
        )


def test_outputs_for_a_controller():
    """ON begins where the confidence reaches 1, and the incipient output is never later."""
    volts = 4.0 + noise(3.0)
    volts[4000:] += band_noise(1.0, 0.02) * np.minimum(1.0, np.arange(2000) / 200)
    detector = FastDetector(SETTINGS)
    output = detector.process(volts)
    first = int(np.flatnonzero(output.on)[0])
    assert output.confidence[first] > 1.0
    assert (output.confidence[first - 4 : first] <= 1.0).all()
    assert output.incipient[first]
    early = IncipientDetector(SETTINGS).process(volts)
    assert np.array_equal(early.on, output.incipient)
    assert np.flatnonzero(output.incipient)[0] <= first
    assert output.statistic_v == pytest.approx(output.confidence * output.threshold_v)
    assert detector.noise_v == pytest.approx(NOISE_V, rel=0.3)


def test_trees_are_evaluated_as_they_are_stored():
    """Walk the trees of the table with another implementation."""
    model = load_model()
    rng = np.random.default_rng(0)
    for _ in range(20):
        row = np.exp(rng.normal(0.0, 2.0, len(FEATURES)))
        score = model.offset
        for tree in range(model.trees):
            path = ""
            for _ in range(DEPTH):
                node = tree * NODES + (1 << len(path)) - 1 + (int(path, 2) if path else 0)
                path += "1" if row[int(model.features[node])] > model.thresholds[node] else "0"
            score += model.leaves[tree * (NODES + 1) + int(path, 2)]
        arguments = (model.features, model.thresholds, model.leaves, model.offset)
        assert fast_state.evaluate_trees(row, 0, *arguments) == pytest.approx(score)


RATE_HZ = 2000.0

LOUD = 10.0
"""Ratio of the wide energy of 20 ms to its floor above which the tree finds slip."""


def ask_one_question() -> FastModel:
    """Model of one tree: a score of 10 where the wide energy of 20 ms is large, else -10."""
    wide = FEATURES.index("wide energy, 20 ms")
    leaves = [-10.0] * ((NODES + 1) // 2) + [10.0] * ((NODES + 1) // 2)
    return FastModel(
        np.full(NODES, float(wide)), np.full(NODES, LOUD), np.array(leaves), 0.0, 0.0, 0.0, -1.0
    )


def white_noise(samples: int, seed: int = 2) -> np.ndarray:
    return np.random.default_rng(seed).normal(0, NOISE_V, samples)


def make_one_question() -> FastDetector:
    detector = FastDetector(FastSettings(RATE_HZ, NOISE_V), ask_one_question())
    detector.process(4.0 + white_noise(4000))
    return detector


def grasp(rise_s: float) -> np.ndarray:
    x = np.clip((np.arange(1000) / RATE_HZ - 0.5 + rise_s) / rise_s, 0.0, 1.0)
    volts: np.ndarray = 4.0 - 0.4 * x**3 * (10 - 15 * x + 6 * x * x) + white_noise(1000, 1)
    return volts


@pytest.mark.parametrize("steps", [[1, 2, 3, 4], [-1, -2, -3, -4], [0, -3, -5, -9], [2, 2, 1, 4]])
def test_the_smallest_step_is_found_whichever_way_the_voltage_goes(steps: list[int]) -> None:
    volts = 0.5 + 2.0**-10 * np.array([0, *steps])
    detector = FastDetector(FastSettings(RATE_HZ, NOISE_V, filtered=FilteredSignal(64.0, 4.0)))
    detector.process(volts, volts)
    least = min(abs(b - a) for a, b in zip([0, *steps], steps, strict=False) if a != b)
    assert detector.state[fast_state.STEP] == least * 2.0**-10
    assert detector.state[fast_state.FILTERED_STEP] == pytest.approx(least * 2.0**-10 / 64.0)


@pytest.mark.parametrize("rise_s", [0.2, 0.0])
def test_no_floor_learns_what_may_be_slip_whatever_came_before_it(rise_s: float) -> None:
    """A tone with or without a grasp before it: the floors stand while
    the tree speaks for slip, and move after it.
    """
    detector = make_one_question()
    detector.process(grasp(rise_s) if rise_s else 3.6 + white_noise(1000, 1))
    tone = 3.6 + white_noise(4000, 4) + 0.0015 * np.sin(math.tau * 130 * np.arange(4000) / RATE_HZ)
    floors = []
    for tick in np.split(tone, 1000):
        output = detector.process(tick)
        floors.append((detector.state[fast_state.INCIPIENT], detector.state[fast_state.FLOOR]))
        assert output.incipient[-1] == (detector.state[fast_state.INCIPIENT] > 0)
    held = [floor for incipient, floor in floors if incipient]
    assert len(held) > 900
    assert len(set(held)) == 1
    detector.process(3.6 + white_noise(2000, 5))
    assert detector.state[fast_state.FLOOR] != held[0]


@pytest.mark.parametrize(("kind", "lasts"), [("noise", True), ("tone", False), ("knock", False)])
def test_vibration_that_lasts_keeps_what_the_trees_began(kind: str, lasts: bool) -> None:
    """The tree says incipient for the first 20 ms alone: noise then becomes ON and stays, with all
    floors as they were, also in 0.2 s of silence and for 0.5 s after it; a tone and what fades do
    not.
    """
    model = replace(ask_one_question(), threshold=20.0, incipient_threshold=-1.5)
    model = replace(
        model, thresholds=np.full(NODES, 100.0), leaves=np.where(model.leaves > 0, -1.4, -1.7)
    )
    detector = FastDetector(FastSettings(RATE_HZ, NOISE_V), model)
    detector.process(4.0 + white_noise(4000))
    time_s = np.arange(2000) / RATE_HZ
    volts = {
        "noise": 5.0 * white_noise(2000, 4),
        "tone": 12.0 * NOISE_V * np.sin(math.tau * 110 * time_s) + 0.2 * white_noise(2000, 7),
        "knock": 0.05 * np.exp(-time_s / 0.015) * np.sin(math.tau * 110 * time_s)
        + white_noise(2000, 7),
    }[kind]
    volts[:40] *= 4.0 if kind == "noise" else 1.0
    volts[1200:1600] *= 0.2 if kind == "noise" else 1.0
    output = detector.process(4.0 + volts)
    assert output.incipient[:100].any()
    assert output.on.any() == lasts
    if lasts:
        first = int(np.argmax(output.on))
        assert 0.11 < (first - int(np.argmax(output.incipient))) / RATE_HZ < 0.14
        assert output.on[first:].all()
        floor_v = detector.threshold_v
        detector.process(4.0 + white_noise(900, 8))
        assert detector.threshold_v == floor_v
        assert not detector.state[fast_state.ON]
        detector.process(4.0 + white_noise(700, 9))
        assert detector.threshold_v != floor_v


def test_on_follows_the_mean_score() -> None:
    """The mean rises from -4 to a score of 1 by 2/27 of the rest
    at each tick, and exceeds 0 at the 21st.
    """
    model = replace(
        ask_one_question(), threshold=0.0, incipient_threshold=0.5, leaves=np.full(NODES + 1, 1.0)
    )
    detector = FastDetector(FastSettings(RATE_HZ, 1000 * NOISE_V), model)
    assert not detector.process(4.0 + white_noise(4000)).incipient.any()
    output = detector.process(4.0 + 6000.0 * white_noise(1000, 7))
    assert np.argmax(output.on) - np.argmax(output.incipient) == 20 * 4


def test_more_must_speak_for_slip_in_more_noise_than_stated() -> None:
    """The threshold rises from 4 to 5 above the lowest score where
    the noise has nine times the stated energy.
    """
    for factor, ratio in ((1.0, 1.0), (3.0, 5.0 / 4.0)):
        volts = 4.0 + factor * noise(6.0)
        volts[-200:] += band_noise(0.1, 0.05)
        models = (
            replace(ask_one_question(), threshold=0.0, noise_rise=rise) for rise in (0.0, 1.0)
        )
        low, high = (
            FastDetector(SETTINGS, model).process(volts).confidence[-1] for model in models
        )
        assert 0.0 < low == pytest.approx(ratio * high)


@pytest.mark.parametrize("score", [-0.5, -2.0])
def test_floors_stand_while_the_score_is_near_slip(score: float) -> None:
    """A score above `STAY_SCORE` that is none of slip holds the floors; one below lets
    them learn.
    """
    model = ask_one_question()
    leaves = np.where(model.leaves > 0, score, model.leaves)
    model = replace(model, leaves=leaves, threshold=5.0, incipient_threshold=4.0)
    detector = FastDetector(FastSettings(RATE_HZ, NOISE_V), model)
    detector.process(4.0 + white_noise(4000))
    volts = 4.0 + white_noise(1400, 4) + 0.0015 * np.sin(math.tau * 130 * np.arange(1400) / RATE_HZ)
    detector.process(volts[:1000])
    before = detector.state[fast_state.FLOOR]
    assert not detector.process(volts[1000:]).incipient.any()
    assert (detector.state[fast_state.FLOOR] == before) == (score > STAY_SCORE)


@pytest.mark.parametrize("stuck", [slice(1600), slice(300), slice(6000, 7000)])
def test_a_voltage_that_stands_still_teaches_no_floor(stuck: slice) -> None:
    """A converter hangs, or the signal is clipped; then there is
    noise as before, and none of it is slip.
    """
    volts = 4.0 + noise(6.0)
    volts[stuck] = 4.0
    assert not FastDetector(SETTINGS).process(volts).incipient.any()


@pytest.mark.parametrize(
    ("kind", "least_s", "most_s"), [("noise", 1.5, 3.0), ("moving", 4.0, 4.1), ("tone", 0.0, 1.5)]
)
def test_floors_learn_strong_vibration_only_if_it_is_a_tone_or_the_force_stands_still(
    kind: str, least_s: float, most_s: float
) -> None:
    """No tree speaks for slip in 4 s of vibration; `moving` has a
    motion of the force at 5 Hz beside it.
    """
    detector = FastDetector(FastSettings(RATE_HZ, NOISE_V), NO_TREES)
    detector.process(4.0 + white_noise(4000))
    time_s = np.arange(8000) / RATE_HZ
    volts = 1.2 * NOISE_V * draw_band_noise(np.random.default_rng(7), 8000, RATE_HZ, 100.0, 170.0)
    if kind == "tone":
        volts = 2.0 * NOISE_V * np.sin(math.tau * 110 * time_s)
    volts = (
        4.0
        + volts
        + 0.2 * white_noise(8000, 3)
        + (kind == "moving") * 0.02 * np.sin(math.tau * 5 * time_s)
    )
    before = detector.state[fast_state.FLOOR]
    moved_s = 4.05
    for at, part in enumerate(np.split(volts, 80)):
        detector.process(part)
        if detector.state[fast_state.FLOOR] > 1.5 * before:
            moved_s = min(moved_s, (at + 1) * 0.05)
    assert least_s <= moved_s <= most_s


def test_a_lost_sample_and_a_glitch_are_told_for_50_ms_and_vibration_that_grows_is_none() -> None:
    time_s = np.arange(2000) / RATE_HZ
    settings = FastSettings(RATE_HZ, NOISE_V, filtered=FilteredSignal(64.0, 4.0))
    lost = np.where(np.arange(2000) == 500, np.nan, 4.0 + white_noise(2000))
    moving = 0.25 * np.clip(time_s / 0.5, 0.02, 1.0) * np.sin(math.tau * 130 * time_s)
    glitch = moving / 25 + 0.1 * (np.arange(2000) == 500)
    for volts, filtered, told in (
        (lost, None, (500, 600)),
        (time_s, moving, (0, 0)),
        (time_s, glitch, (501, 601)),
    ):
        output = FastDetector(settings).process(volts, filtered)
        assert np.flatnonzero(output.is_replaced).tolist() == [*range(*told)]


def test_of_a_jump_that_the_next_sample_confirms_nothing_is_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A jump of 0.3 V decays in the filtered signal: soon the bands
    hold what they hold where no jump is suspected.
    """
    volts = np.full(800, 4.0)
    filtered = np.where(
        np.arange(800) < 500, 0.0, 0.3 * np.exp(-(np.arange(800) - 500) / 5)
    ) + white_noise(800)
    settings = FastSettings(RATE_HZ, NOISE_V, filtered=FilteredSignal(64.0, 4.0))
    suspected = FastDetector(settings).process(volts, filtered).filtered_v
    monkeypatch.setattr(fast_settings, "FILTERED_JUMP_RATIO", math.inf)
    expected = FastDetector(settings).process(volts, filtered).filtered_v
    assert np.abs(suspected - expected)[500:505].max() > 0.05 * np.abs(expected).max()
    assert np.abs(suspected - expected)[510:].max() < 0.02 * np.abs(expected).max()


def test_slip_stays_on_while_the_trees_say_so_though_its_vibration_has_ended() -> None:
    """The energy of 20 ms falls by e in 20 ms: from 10^5 times the question's ratio
    within 0.23 s.
    """
    detector = make_one_question()
    burst = 4.0 + white_noise(600) + 0.5 * np.sin(math.tau * 130 * np.arange(600) / RATE_HZ)
    assert detector.process(burst).on[-1]
    lasts_s = np.count_nonzero(detector.process(4.0 + white_noise(2000, 3)).on) / RATE_HZ
    assert 0.15 < lasts_s < 0.42
