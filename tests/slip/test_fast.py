"""Detector `fast`: its filters, checks, features, floor and flags, by other implementations and on
signals that nobody simulated.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import signal as scipy_signal

from fingertip.slip.detectors import fast_decision
from fingertip.slip.detectors.analog_and_digital import FirstOrder, SecondOrder
from fingertip.slip.detectors.fast import FastDetector, FastOutput, IncipientDetector, collect_rows
from fingertip.slip.detectors.fast_features import FEATURES, RING, log2_steps, measure
from fingertip.slip.detectors.fast_inputs import ENERGIES, Filter
from fingertip.slip.detectors.fast_record import load_record
from fingertip.slip.detectors.fast_settings import (
    BANDS_HZ,
    FAULT_S,
    SLOW_HZ,
    FastSettings,
    design_filters,
    white_energies,
)
from fingertip.slip.detectors.fast_table import (
    DEPTH,
    NO_TABLE,
    NODES,
    BlowTable,
    load_table,
    read_table,
    write_table,
)

RATE_HZ = 2000.0
NOISE_V = 4e-4
SETTINGS = FastSettings(RATE_HZ, NOISE_V)
ALWAYS_A_BLOW = replace(NO_TABLE, offset=np.float32(-5.0))


def noise(seconds: float, deviation_v: float = NOISE_V, seed: int = 1) -> np.ndarray:
    count = round(seconds * RATE_HZ)
    return np.random.default_rng(seed).normal(0.0, deviation_v, count)


def times(volts: np.ndarray) -> np.ndarray:
    return np.arange(len(volts)) / RATE_HZ


def band_noise(seconds: float, rms_v: float, seed: int = 2) -> np.ndarray:
    """Noise of 60 to 200 Hz, as a slip's vibration."""
    sos = scipy_signal.butter(2, [60.0, 200.0], "band", fs=RATE_HZ, output="sos")
    raw = scipy_signal.sosfilt(sos, noise(seconds + 0.5, 1.0, seed))[round(0.5 * RATE_HZ) :]
    return np.asarray(rms_v * raw / raw.std())


def smoothstep(x: np.ndarray) -> np.ndarray:
    x = np.clip(x, 0.0, 1.0)
    return np.asarray(x * x * (3 - 2 * x))


def run(volts: np.ndarray, table: BlowTable | None = None) -> FastOutput:
    return FastDetector(SETTINGS, table).process(volts)


def first_s(flags: np.ndarray) -> float:
    return float(np.flatnonzero(flags)[0]) / RATE_HZ


@pytest.mark.parametrize("rate_hz", [1000.0, 2000.0, 20_000.0])
def test_filters_have_the_responses_of_their_names(rate_hz: float) -> None:
    filters = design_filters(rate_hz, 67.0)
    b, a = scipy_signal.butter(3, 67.0, "high", fs=rate_hz)
    frequencies = np.array([5.0, 40.0, 67.0, 130.0, 300.0])
    _, expected = scipy_signal.freqz(b, a, frequencies, fs=rate_hz)
    difference = 1 - np.exp(-2j * math.pi * frequencies / rate_hz)
    high = difference * respond(filters.high_1, frequencies, rate_hz)
    assert high * respond(filters.high_2, frequencies, rate_hz) == pytest.approx(expected)

    b, a = scipy_signal.butter(2, SLOW_HZ[1], fs=rate_hz)
    _, expected = scipy_signal.freqz(b, a, frequencies, fs=rate_hz)
    assert respond(filters.slow, frequencies, rate_hz) == pytest.approx(expected)

    for band, (begin_hz, end_hz) in zip(filters.bands, BANDS_HZ, strict=True):
        middle = np.array([math.sqrt(begin_hz * min(end_hz, 0.38 * rate_hz))])
        assert np.abs(respond(band, middle, rate_hz)) == pytest.approx(1.0)
        outside = np.array([begin_hz / 4, min(4 * end_hz, 0.49 * rate_hz)])
        assert np.all(np.abs(respond(band, outside, rate_hz)) < 0.5)


def respond(
    section: FirstOrder | SecondOrder, frequencies: np.ndarray, rate_hz: float
) -> np.ndarray:
    order = (len(section) + 1) // 2
    _, response = scipy_signal.freqz(
        section[:order], [1.0, *section[order:]], frequencies, fs=rate_hz
    )
    return np.asarray(response)


def test_energies_of_white_noise_are_those_of_long_noise() -> None:
    settings = FastSettings(RATE_HZ, 1.0)
    detector = FastDetector(settings, ALWAYS_A_BLOW)
    block = detector._take(noise(200.0, 1.0), None)
    found = block.ticks.sums[1000:, 1 : 1 + ENERGIES].mean(axis=0)
    assert found == pytest.approx(white_energies(RATE_HZ, 67.0), rel=0.05)


@pytest.mark.parametrize("order", [1, 2])
def test_the_filter_has_the_bits_of_scipy_in_single_precision(order: int) -> None:
    filters = design_filters(RATE_HZ, 67.0)
    section = filters.high_1 if order == 1 else filters.bands[1]
    b = np.array(section[: (len(section) + 1) // 2], dtype=np.float32)
    a = np.array([1.0, *section[len(b) :]], dtype=np.float32)
    values = noise(1.0).astype(np.float32)
    state = np.zeros(order, dtype=np.float32)
    expected, _ = scipy_signal.lfilter(
        np.resize(b, order + 1) if order > 1 else b, a, values, zi=state
    )
    one = Filter(section)
    found = np.concatenate([one.process(values[:77]), one.process(values[77:])])
    assert found.tobytes() == expected.astype(np.float32).tobytes()


def test_features_are_what_their_names_say() -> None:
    """Each feature again, in double precision and by another way."""
    rng = np.random.default_rng(3)
    energy = rng.lognormal(0.0, 1.0, (RING, ENERGIES)).astype(np.float32)
    tone = rng.normal(0.0, 0.1, (RING, 3)).astype(np.float32)
    tone[:, 2] = energy[:, -1]
    force = rng.normal(0.0, 1.0, RING).astype(np.float32)
    floors = rng.lognormal(0.0, 0.3, ENERGIES).astype(np.float32)
    row = measure(
        energy=energy, tone=tone, force=force, floors=floors, level_ratio=np.float32(3.0), age=7
    )
    found = dict(zip(FEATURES, row.tolist(), strict=True))
    wide = energy[:, -1].astype(float)
    total = wide[:8].mean()

    expected = {
        "vibration of slice 1 over its floor": wide[2:4].mean() / floors[-1],
        "60-120 Hz, share of the vibration": energy[:8, 2].mean() / total,
        "60-120 Hz, new over old half": energy[:4, 2].mean() / energy[4:8, 2].mean(),
        "3-28 Hz over its floor": energy[:8, 0].mean() / floors[0],
        "greatest slice over the last 16 ms": wide[:30].reshape(15, 2).mean(axis=1).max() / total,
        "change of force in 4 ms": (force[0] - force[2]) ** 2 / total,
        "change of force in 62 ms": (force[0] - force[31]) ** 2 / total,
        "steepest change of force": max((force[j] - force[j + 2]) ** 2 for j in range(0, 30, 2))
        / total,
        "mean vibration over its floor": 3.0,
        "last 32 ms over the last 16 ms": wide[:16].mean() / total,
        "16 ms before over its floor": wide[8:16].mean() / floors[-1],
    }
    for name, ratio in expected.items():
        assert found[name] == pytest.approx(math.log2(ratio), abs=0.09), name

    assert found["ticks since the crossing"] == 7.0
    assert found["loud ticks"] == np.count_nonzero(wide > 4 * floors[-1])
    product = tone[:8, 0].sum() / wide[:8].sum()
    assert found["product with 1 ms before"] == pytest.approx(product, rel=1e-5)


def test_a_tone_leaves_no_rest_and_noise_does() -> None:
    def find_rest(volts: np.ndarray) -> float:
        rows, _ = collect_rows(
            FastDetector(SETTINGS, NO_TABLE), volts, None, np.zeros(len(volts), dtype=bool)
        )
        return float(np.median(rows[20:, FEATURES.index("what is no tone in 32 ms")]))

    quiet = noise(1.0, 1e-5)
    vibration = np.concatenate([quiet, quiet])
    tone = vibration.copy()
    tone[2000:] += 0.01 * np.sin(2 * math.pi * 120.0 * times(quiet))
    rough = vibration.copy()
    rough[2000:] += noise(1.0, 0.01, seed=5)
    assert find_rest(tone) < -8.0
    assert find_rest(rough) > -1.0


def test_the_logarithm_is_exact_at_powers_of_two_and_rises() -> None:
    powers = np.ldexp(np.ones(40, dtype=np.float32), np.arange(-20, 20))
    assert log2_steps(powers).tolist() == list(range(-20, 20))
    ratios = np.geomspace(1e-9, 1e9, 10_001).astype(np.float32)
    steps = log2_steps(ratios)
    assert np.all(np.diff(steps) >= 0.0)
    assert np.max(np.abs(steps - np.log2(ratios))) < 0.09


def test_trees_are_evaluated_as_they_are_stored() -> None:
    table = load_table()
    rng = np.random.default_rng(0)
    for _ in range(20):
        row = rng.normal(0.0, 4.0, len(FEATURES)).astype(np.float32)
        score = np.float32(table.offset)
        for tree in range(table.trees):
            node = 0
            for _ in range(DEPTH):
                feature = table.features[tree, node]
                node = 2 * node + (2 if row[feature] > table.thresholds[tree, node] else 1)

            score = np.float32(score + table.leaves[tree, node - NODES])

        assert table.evaluate(row) == score


def test_a_table_is_read_as_it_was_written() -> None:
    table = load_table()
    again = read_table(json.loads(write_table(table, {"seed": 1})))
    assert np.array_equal(again.features, table.features)
    assert np.array_equal(again.thresholds, table.thresholds)
    assert np.array_equal(again.leaves, table.leaves)
    assert again.offset == table.offset
    assert 0 <= table.features.min() <= table.features.max() < len(FEATURES)


def test_the_unit_of_the_input_does_not_matter() -> None:
    volts = noise(3.0)
    volts[4000:] += band_noise(1.0, 0.005)
    one = run(volts)
    factor = 2.0**14
    other = FastDetector(replace(SETTINGS, noise_v=factor * NOISE_V)).process(factor * volts)
    assert one.on.any()
    assert np.array_equal(one.on, other.on)
    assert np.array_equal(one.incipient, other.incipient)
    assert np.array_equal(factor * one.statistic_v, other.statistic_v)


@pytest.mark.parametrize("factor", [0.5, 1.0, 4.0])
def test_four_of_five_means_of_noise_lie_below_the_floor(factor: float) -> None:
    volts = noise(30.0, factor * NOISE_V)
    detector = FastDetector(SETTINGS)
    output = detector.process(volts)
    late = slice(round(10 * RATE_HZ), None)
    floor_v = output.threshold_v / fast_decision.SHORT_RATIO
    mean_v = np.convolve(np.abs(output.filtered_v), np.ones(64) / 64)[: len(volts)]
    assert 0.7 < np.mean(mean_v[late] < floor_v[late]) < 0.9
    assert detector.noise_v == pytest.approx(factor * NOISE_V, rel=0.1)
    assert not output.incipient.any()


def test_floors_stand_while_slip_is_on_and_after_it() -> None:
    volts = noise(4.0)
    volts[3000:5000] += band_noise(1.0, 0.01)
    output = run(volts)
    begin, end = np.flatnonzero(output.incipient)[[0, -1]]
    stands = output.threshold_v[begin : end + round(0.3 * RATE_HZ)]
    assert np.ptp(stands) == 0.0
    assert output.threshold_v[-1] != stands[-1]


def test_vibration_that_is_vetoed_for_a_second_is_learned() -> None:
    volts = noise(8.0)
    volts[4000:] += band_noise(6.0, 0.003)
    detector = FastDetector(SETTINGS, ALWAYS_A_BLOW)
    output = detector.process(volts)
    assert not output.on.any()
    assert np.ptp(output.threshold_v[4000:5900]) < 0.2 * output.threshold_v[4000]
    assert not output.incipient[-4000:].any()


def test_noise_that_ends_hides_slip_no_longer() -> None:
    volts = np.concatenate([noise(1.0, 20 * NOISE_V), noise(2.0)])
    volts[3000:] += band_noise(1.5, 0.004)
    assert 1.5 < first_s(run(volts).on) < 1.55


def test_a_contact_in_the_first_learning_is_forgotten() -> None:
    """The detector begins while the force grows, as where a hand closes at once."""
    volts = noise(1.4) - 0.3 * np.clip((times(noise(1.4)) - 0.1) / 0.2, 0.0, 1.0)
    volts[2000:2400] += band_noise(0.2, 25 * NOISE_V)
    on = FastDetector(SETTINGS).process(volts).on
    assert not on[:2000].any()
    assert on[2000:2080].any()


@pytest.mark.parametrize("frequency_hz", [50.0, 100.0, 180.0])
def test_a_tone_of_two_seconds_is_learned_as_rest(frequency_hz: float) -> None:
    volts = noise(10.0)
    volts[6000:] += 0.01 * np.sin(2 * math.pi * frequency_hz * times(volts)[6000:])
    output = run(volts)
    assert not output.incipient[round(5.5 * RATE_HZ) :].any()


@pytest.mark.parametrize("stuck", [slice(0, 4000), slice(2000, 6000), slice(2000, 2100)])
def test_a_voltage_that_stands_still_teaches_no_floor(stuck: slice) -> None:
    volts = 2.0 + noise(6.0)
    volts[stuck] = volts[stuck.start]
    assert not run(volts).incipient.any()


@pytest.mark.parametrize(
    ("rise_s", "change_v"), [(0.02, -0.1), (0.05, 0.3), (0.15, -0.5), (0.5, 1.0)]
)
def test_a_change_of_grip_is_not_slip(rise_s: float, change_v: float) -> None:
    volts = 4.0 + noise(2.5)
    volts += change_v * smoothstep((times(volts) - 1.5) / rise_s)
    assert not run(volts).on.any()


def test_a_knock_is_not_slip_and_slip_after_it_is_found() -> None:
    t = np.arange(4000) / RATE_HZ
    since_s = np.clip(t - 1.0, 0, None)
    volts = 4.0 + noise(2.0)
    volts += 0.3 * np.sin(2 * math.pi * 90 * since_s) * np.exp(-since_s / 0.01)
    assert not run(volts).on.any()
    volts[2600:] += band_noise(0.7, 0.01)
    assert 1.3 < first_s(run(volts).on) < 1.335


@pytest.mark.parametrize("step_v", [0.0008, 0.005, 0.02])
def test_coarse_steps_are_not_slip(step_v: float) -> None:
    """A converter toggles between codes, and a slow force passes many of them."""
    t = np.arange(20_000) / RATE_HZ
    for offset in (0.0, 0.25, 0.5):
        drift = 4.0 + (offset + 0.3 * np.sin(2 * math.pi * 0.1 * t)) * step_v
        toggling = np.round((drift + 0.1 * step_v / NOISE_V * noise(10.0)) / step_v) * step_v
        assert not run(toggling).on.any()

    ramp = 4.0 - 0.5 * np.clip((t - 2.0) / 0.5, 0.0, 1.0) + noise(10.0, 0.02 * step_v)
    assert not run(np.round(ramp / step_v) * step_v).on.any()


def test_outputs_for_a_controller() -> None:
    volts = 4.0 + noise(3.0)
    volts[4000:] += band_noise(1.0, 0.02)
    output = run(volts)
    assert 2.0 < first_s(output.incipient) < first_s(output.on) < 2.03
    assert np.all(output.incipient[output.on])
    begin = int(np.flatnonzero(output.incipient)[0])
    assert output.statistic_v[begin] > output.threshold_v[begin]
    assert output.statistic_v[begin - 1] <= output.threshold_v[begin - 1]

    early = IncipientDetector(SETTINGS)
    assert np.array_equal(early.process(volts).on, output.incipient)
    assert early.is_incipient


def test_a_greater_threshold_is_later_and_a_smaller_one_sooner() -> None:
    volts = noise(3.0)
    volts[4000:] += band_noise(1.0, 0.0015)
    onsets_s = []
    for scale in (0.8, 1.0, 1.3):
        output = FastDetector(replace(SETTINGS, threshold_scale=scale)).process(volts)
        onsets_s.append((first_s(output.incipient), first_s(output.on)))

    assert onsets_s == sorted(onsets_s)
    assert onsets_s[0] < onsets_s[-1]


def test_samples_that_are_no_voltage_and_glitches_are_replaced_and_told() -> None:
    volts = 2.0 + noise(4.0)
    odd = {2000: np.nan, 3000: np.inf, 4000: 2.7, 5000: -1e9, 6000: 1.2}
    for place, value in odd.items():
        volts[place] = value

    output = run(volts)
    assert not output.incipient.any()
    told = np.flatnonzero(np.diff(output.is_replaced.astype(int), prepend=0) > 0)
    assert told.tolist() == [2000, 3000, 4001, 5000, 6001]
    assert output.is_replaced.sum() == len(odd) * round(FAULT_S * RATE_HZ)


def test_of_a_jump_that_the_next_sample_confirms_one_sample_is_late() -> None:
    volts = 2.0 + noise(2.0)
    volts[2000:] += 0.4
    output = run(volts)
    assert not output.is_replaced.any()
    assert np.argmax(np.abs(output.filtered_v)) == 2001


def test_after_a_gap_the_detector_begins_anew() -> None:
    volts = 2.0 + noise(4.0)
    volts[3000:3200] = np.nan
    volts[3200:] += 0.7
    output = run(volts)
    assert not output.incipient.any()
    volts[3220:] += band_noise(4.0, 0.02)[: len(volts) - 3220]
    assert 1.65 <= first_s(run(volts).on) < 1.69


def test_a_voltage_that_no_force_gives_is_told_after_50_ms() -> None:
    volts = 2.0 + noise(2.0)
    volts[2000:2050] = 0.01
    volts[3000:3500] = 0.01
    detector = FastDetector(replace(SETTINGS, possible_v=(0.1, 3.0)))
    told = np.flatnonzero(detector.process(volts).is_outside)
    assert told[0] == 3000 + round(FAULT_S * RATE_HZ)
    assert told[-1] == 3499


def test_a_start_in_slip_is_decided_with_the_floors_of_a_rest() -> None:
    rested = FastDetector(SETTINGS)
    rested.process(noise(1.0))
    slip = noise(1.0, seed=7) + band_noise(1.0, 0.01)
    assert not run(slip).on.any()
    on = FastDetector(SETTINGS, floors=rested.floors).process(slip).on
    assert first_s(on) < 0.1
    assert on[200:].mean() > 0.98


def test_rows_for_the_training_are_those_at_which_the_table_is_asked() -> None:
    volts = noise(3.0)
    volts[3000:4000] += band_noise(0.5, 0.01)
    is_slip = np.zeros(len(volts), dtype=bool)
    is_slip[3000:4000] = True
    rows, places = collect_rows(FastDetector(SETTINGS), volts, None, is_slip)
    assert rows.shape == (len(places), len(FEATURES))
    assert np.all(np.isfinite(rows))
    assert 1.5 < places[0] / RATE_HZ < 1.53
    assert np.all(np.diff(places) > 0)


def test_the_record_names_the_class_of_each_strength() -> None:
    record = load_record()
    ratios = [one.least_ratio for one in record.classes]
    assert ratios == sorted(ratios)
    assert record.find(0.0) is record.classes[0]
    for one in record.classes:
        assert record.find(one.least_ratio) is one
        assert one.slides > 20
        assert list(one.delay_s) == sorted(one.delay_s)
