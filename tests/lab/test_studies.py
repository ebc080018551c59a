"""Studies beside a campaign: assumptions, the time step, the
article's protocol, board and converter.
"""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.lab.campaign.campaign import NEGATIVE_SCENES, CampaignPlan, Case
from fingertip.lab.campaign.run import find_onset_s, measure_vibration_n, median_of_known
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.runs.timeline import TrapezoidalMove
from fingertip.sim.simulation import article_trials
from fingertip.slip.detectors.analog_and_digital import noise_level
from fingertip.slip.traces.trace import Trace
from tests.approved import check_text
from tests.designs import ARTICLE, article_design
from tools.article import page
from tools.article import protocol as article_protocol
from tools.article.boards import study_article_board, with_article_board
from tools.article.previous_works import FFT_SHARE, PLATE_FACTORS, RIDGED, study_previous_works
from tools.article.protocol import (
    DEVICES,
    MOVED_M,
    ProtocolStudy,
    find_encoder_zero_s,
    study_article_protocol,
    study_windows,
    with_window,
)
from tools.article.sensitivity import (
    VARIATIONS,
    BySurface,
    Factor,
    Variation,
    change_converter,
    measure_envelope_v,
    study_assumptions,
)
from tools.article.steps import (
    COMPARED,
    _find_shift_s,
    _pool_shifts,
    compare_grids,
    study_sampling_rates,
)
from tools.article.studies import DATA, study

SLIDE = next(article_trials())[0]


@pytest.mark.every_case
@pytest.mark.parametrize("variation", VARIATIONS, ids=lambda variation: variation.label)
def test_every_variation_fits_every_scene_and_changes_something(variation: Variation) -> None:
    scenes = [scene for scene, _ in article_trials()] + [
        scene for scene, _ in NEGATIVE_SCENES.values()
    ]
    changed = [variation.vary_scene(scene) for scene in scenes]
    assert changed != scenes or variation.vary_design(Design()) != Design()


def test_change_is_a_value_or_a_factor() -> None:
    varied = Variation(
        "", {"scene.slide.speed_m_s": Factor(0.5), "scene.contact.patch_average": True}
    )
    scene = varied.vary_scene(SLIDE)
    assert scene.slide.speed_m_s == SLIDE.slide.speed_m_s / 2
    assert scene.contact.patch_average
    assert varied.vary_design(Design()) == Design()
    assert Variation("", {"detector.noise_v": 1e-3}).vary_scene(SLIDE) is SLIDE


def test_change_by_surface_leaves_the_others_as_they_are() -> None:
    varied = Variation("", {"scene.surface.longest_wave_mm": BySurface({"gross": 2.5})})
    waves_mm = {
        s.contact.surface: varied.vary_scene(s).surface.longest_wave_mm for s, _ in article_trials()
    }
    assert waves_mm.pop("gross") == 2.5
    assert set(waves_mm.values()) == {SLIDE.surface.longest_wave_mm}


@pytest.mark.full
def test_envelope_rises_with_the_force_and_falls_under_the_law_of_a_ball() -> None:
    hertz = Variation("", {"scene.surface.load_law": "hertz"})
    half = Variation(
        "", {"scene.hold.min_force_n": Factor(0.5), "scene.hold.max_force_n": Factor(0.5)}
    )
    light, firm = (measure_envelope_v(ARTICLE, "gross", force_n, (1, 2)) for force_n in (0.5, 2.0))
    assert 1.1 * light < firm
    assert measure_envelope_v(ARTICLE, "gross", 0.5, (1, 2), half) == light
    light, firm = (
        measure_envelope_v(ARTICLE, "gross", force_n, (1, 2), hertz) for force_n in (0.5, 2.0)
    )
    assert light > 2 * firm


@pytest.mark.full
def test_previous_works_are_slower_or_miss_more_with_higher_thresholds() -> None:
    found = study_previous_works(Design.load("article"), 4)
    assert [(row.surface, row.factor, row.trials) for row in found.plates] == [
        (name, factor, 15) for name in RIDGED for factor in PLATE_FACTORS
    ]
    low, high = map(found.means_s, PLATE_FACTORS)
    assert max(low) < 0.025 < min(high)
    rows = {
        row["figure"]: row["ours"].get("digital chain")
        for row in json.loads(DATA.read_text())["protocol"]
    }
    assert rows["mean delay on three ridged plates"] == ", ".join(
        f"{1000 * mean_s:.1f} ms" for mean_s in low
    )
    noise, late = found.plain_fft
    assert (noise.below_100_ms, noise.trials) == (4, 4)
    assert late.below_100_ms < FFT_SHARE * 4
    assert noise.threshold_v < 0.0003 < late.threshold_v
    assert noise.contacts >= late.contacts


def test_page_beside_the_article_is_that_of_the_data() -> None:
    data = json.loads(DATA.read_text())
    figures = json.loads(page.FIGURES.read_text())
    check_text(page.PAGE, page.render_page(data, figures))


@pytest.mark.parametrize("bits", [10, 12])
def test_thresholds_follow_the_step_of_another_converter(bits: int) -> None:
    converter = Variation("", change_converter(bits, 5.0))
    scene = converter.vary_scene(SLIDE).converter
    design = converter.vary_design(Design())
    assert design.detector.adc_step_v == (scene.high_v - scene.low_v) / 2**scene.bits
    assert design.detector.noise_v == Design().detector.noise_v
    ratio = noise_level(design).threshold_v / noise_level(Design()).threshold_v
    assert design.detector.threshold_v / Design().detector.threshold_v == pytest.approx(ratio)
    assert ratio > 1.05


@pytest.mark.full
def test_onset_counts_from_the_start_of_the_slide() -> None:
    scene = SLIDE.model_copy(update={"outputs": ["voltage_v", "force_n", "slip"]})
    longer = scene.model_copy(update={"hold": scene.hold.model_copy(update={"wait_s": 2.0})})
    found = [
        find_onset_s(Design(), Case("slip", s, 1), run_scene(Design(), s, 1).trace)
        for s in (scene, longer)
    ]
    assert 0.005 < found[0] < 0.05
    assert found[0] == pytest.approx(found[1], abs=0.0006)
    contact = Case("contact", NEGATIVE_SCENES["contact"][0], 1)
    assert math.isnan(find_onset_s(Design(), contact, run_scene(Design(), scene, 1).trace))


def test_vibration_is_the_fast_part_of_the_force_in_slip() -> None:
    t = np.arange(8000) / 2000
    slip = (t > 1.0) & (t < 3.0)
    force = 1.0 + 0.2 * np.sin(2 * math.pi * 1.0 * t) + 0.02 * np.sin(2 * math.pi * 120 * t)
    assert measure_vibration_n(Trace(t, t, force, slip)) == pytest.approx(
        0.02 / math.sqrt(2), rel=0.05
    )
    assert math.isnan(measure_vibration_n(Trace(t, t, force, slip & False)))
    assert median_of_known([math.nan, 1.0, 3.0]) == 2.0
    assert math.isnan(median_of_known([math.nan]))


@pytest.mark.full
def test_threshold_of_the_design_follows_a_change_of_noise() -> None:
    """With a constant threshold, twice the noise would keep digital ON all the time."""
    noisier = Variation("twice the noise", {"detector.noise_v": Factor(2.0)})
    base, twice = study_assumptions(ARTICLE, "digital", 8, variations=[noisier])
    assert base.found_share == 1.0
    assert twice.found_share > 0.5
    assert twice.alarms_per_minute < 10


SHORT = SceneFile(
    scene="sliding_finger",
    hold={"wait_s": 0.1, "release": False},
    slide={"distance_m": 0.005, "speed_m_s": 0.05},
)


@pytest.mark.parametrize(
    ("coarse", "fine", "shift"),
    [
        ((0.01,), (0.012,), 0.002),
        ((0.01, 0.02), (0.01, 0.017), 0.003),
        ((0.01,), (), math.inf),
        ((), (), math.nan),
    ],
)
def test_shift_is_that_of_the_slip_that_moves_most(
    coarse: tuple[float, ...], fine: tuple[float, ...], shift: float
) -> None:
    assert _find_shift_s(coarse, fine) == pytest.approx(shift, nan_ok=True)


def test_slip_found_with_one_step_only_counts_as_beyond_a_sample() -> None:
    pooled = _pool_shifts("fast", [0.0] * 18 + [1.0, math.inf, math.nan], 2000.0)
    assert (pooled.trials, pooled.beyond_sample, pooled.one_grid_only) == (20, 1, 1)
    assert pooled.meets_goal
    assert pooled.median_s == 0.0
    assert pooled.worst_s == math.inf
    worse = _pool_shifts("fast", [0.0] * 18 + [2.0, math.inf], 2000.0)
    assert not worse.meets_goal
    empty = _pool_shifts("analog", [math.nan], 2000.0)
    assert (empty.trials, empty.worst_s) == (0, 0.0)


@pytest.mark.full
def test_a_finer_step_changes_little() -> None:
    errors, shifts_samples = compare_grids(Design(), Case("slip", SHORT, 3), ("fast",), 4)
    assert set(errors) == set(COMPARED)
    assert 0.0 < errors["force_n"] < 1e-4
    # A rounding that falls to the other side.
    assert errors["voltage_v"] <= 1.001 * Design().detector.adc_step_v
    assert 0.0 < errors["envelope_v"] < 2e-3
    assert shifts_samples["fast"] < 4.5  # one tick of the trees
    same, _ = compare_grids(Design(), Case("slip", SHORT, 3), ("fast",), 1)
    assert set(same.values()) == {0.0}


MOVE = TrapezoidalMove.with_speed(1.2345, 0.04, 0.04)


def test_zero_is_the_first_reading_that_shows_the_motion() -> None:
    """At 1 m/s2, 10 um have passed after 4.5 ms and 100 um after 14.1 ms."""
    # Nothing has moved at the start.
    assert find_encoder_zero_s(MOVE, 0.0, 0.0) == pytest.approx(1.2345 + 0.01)
    assert find_encoder_zero_s(MOVE, 0.003, 0.0) == pytest.approx(1.2345 + 0.003)
    assert find_encoder_zero_s(MOVE, 0.003, 1e-5) == pytest.approx(1.2345 + 0.013)
    assert find_encoder_zero_s(MOVE, 0.005, 1e-5) == pytest.approx(1.2345 + 0.005)
    assert find_encoder_zero_s(MOVE, 0.005, 1e-4) == pytest.approx(1.2345 + 0.015)
    assert find_encoder_zero_s(MOVE, 0.0, 1.0) == math.inf, "it never moves so far"


@pytest.fixture(scope="module")
def protocol() -> ProtocolStudy:
    patch = pytest.MonkeyPatch()
    patch.setattr(article_protocol, "run_closed_loop", lambda *args, **kwargs: [])
    patch.setattr(article_protocol, "summarise", lambda trials: [None])
    try:
        return study_article_protocol(Design(), 4, 1)
    finally:
        patch.undo()


@pytest.mark.full
def test_every_device_and_zero_is_there_and_a_later_zero_shortens_delays(
    protocol: ProtocolStudy,
) -> None:
    assert [(r.device, r.moved_m) for r in protocol.results] == [
        (d, m) for d in DEVICES for m in MOVED_M
    ]
    assert {r.trials for r in protocol.results} == {4}
    for device in ("precision board", "digital chain"):
        means = [protocol.find(device, moved_m).mean_s for moved_m in MOVED_M]
        assert means == sorted(means, reverse=True)
        assert means[0] - means[2] == pytest.approx(0.014, abs=0.006)
    assert protocol.find("precision board").threshold_v < protocol.find("digital chain").threshold_v


def test_the_finger_stays_and_the_board_is_the_article_s():
    design = Design(skin={"width_mm": 18.0})
    changed = with_article_board(design)
    article = Design.load("article")
    assert changed.skin == design.skin
    assert (changed.board, changed.detector) == (article.board, article.detector)
    assert changed.board.variant == "article"
    assert changed.detector.adc_range_v == 10.0


@pytest.mark.full
def test_every_detector_is_compared_and_the_article_itself_is_not():
    found = study_article_board(Design(), CampaignPlan(2, 0.5))
    assert [*found] == ["analog", "digital", "fft", "incipient", "fast"]
    assert found["fast"].found_share == 1.0
    assert found["fast"].delay_s(0.5) < found["fast"].motion_delay_s(0.9) < 0.1
    assert study_article_board(Design.load("article"), CampaignPlan(2, 0.5)) == {}


@pytest.mark.full
def test_longer_window_is_later_and_has_fewer_contact_alarms():
    short, long = study_windows(ARTICLE, 4, 1.0, windows_s=(0.005, 0.1))
    assert short.threshold_v > long.threshold_v
    assert short.median_s < long.median_s
    assert short.contact_alarms_per_minute > 0.0
    article = with_window(ARTICLE, 0.03).detector
    assert (article.window_samples, article.threshold_v) == (60, pytest.approx(0.017, rel=0.06))


@pytest.mark.full
def test_a_higher_sampling_rate_does_not_lengthen_the_delay():
    slow, own, quick = study_sampling_rates(ARTICLE, 12, 0.5, rates_hz=(1000.0, 10_000.0))
    assert (slow.sample_rate_hz, own.sample_rate_hz, quick.sample_rate_hz) == (
        1000.0,
        2000.0,
        10_000.0,
    )
    assert slow.found_share == own.found_share == quick.found_share == 1.0
    assert slow.median_s >= own.median_s >= quick.median_s - 0.002
    # At most one alarm.
    assert max(slow.alarms_per_minute, own.alarms_per_minute, quick.alarms_per_minute) < 0.6
    wide = article_design(detector={"window_samples": 1200})  # 12 000 at 20 kHz would be too many
    assert [
        row.sample_rate_hz for row in study_sampling_rates(wide, 1, 0.5, rates_hz=(20_000.0,))
    ] == [2000.0]


@pytest.mark.full
def test_all_studies_of_a_design():
    with compiled():
        studies = study(Design.load("fsr400"), CampaignPlan(8, 1.0))
    assert studies.files().keys() >= {"studies.txt", "studies.md"}
    found = studies.results
    assert len(found.variations) == 1 + len(VARIATIONS)
    assert found.steps.trials == 4
    # `fast` misses the goal in one of ten (docs/accuracy.md).
    assert all(row.meets_goal for row in found.steps.shifts if row.detector != "fast")
