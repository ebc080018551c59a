"""The article's own protocol, its zero of time and its figures beside ours, and its board and converter."""

from __future__ import annotations

import pytest

from fingertip.design import Design
from fingertip.lab.campaign.plan import CampaignPlan
from fingertip.lab.studies import article as article_protocol
from fingertip.lab.studies.article import (
    DEVICES,
    MOVED_M,
    ProtocolStudy,
    find_encoder_zero_s,
    study_article_protocol,
)
from fingertip.lab.studies.boards import study_article_board, with_article_board
from fingertip.sim.runs.timeline import TrapezoidalMove

SLIDE = TrapezoidalMove.with_speed(1.2345, 0.04, 0.04)


def test_zero_is_the_first_reading_that_shows_the_motion() -> None:
    """At 1 m/s2, 10 um have passed after 4.5 ms and 100 um after 14.1 ms."""
    assert find_encoder_zero_s(SLIDE, 0.0, 0.0) == pytest.approx(1.2345 + 0.01)  # nothing has moved at the start
    assert find_encoder_zero_s(SLIDE, 0.003, 0.0) == pytest.approx(1.2345 + 0.003)
    assert find_encoder_zero_s(SLIDE, 0.003, 1e-5) == pytest.approx(1.2345 + 0.013)
    assert find_encoder_zero_s(SLIDE, 0.005, 1e-5) == pytest.approx(1.2345 + 0.005)
    assert find_encoder_zero_s(SLIDE, 0.005, 1e-4) == pytest.approx(1.2345 + 0.015)


@pytest.fixture(scope="module")
def study() -> ProtocolStudy:
    patch = pytest.MonkeyPatch()
    patch.setattr(article_protocol, "run_closed_loop", lambda *args, **kwargs: [])
    patch.setattr(article_protocol, "summarise", lambda trials: [None])
    try:
        return study_article_protocol(Design(), 4, 1)
    finally:
        patch.undo()


@pytest.mark.full
def test_every_device_and_zero_is_there_and_a_later_zero_shortens_delays(study: ProtocolStudy) -> None:
    assert [(r.device, r.moved_m) for r in study.results] == [(d, m) for d in DEVICES for m in MOVED_M]
    assert {r.trials for r in study.results} == {4}
    for device in ("precision board", "digital chain"):
        means = [study.find(device, moved_m).mean_s for moved_m in MOVED_M]
        assert means == sorted(means, reverse=True)
        assert means[0] - means[2] == pytest.approx(0.014, abs=0.006)
    assert study.find("precision board").threshold_v < study.find("digital chain").threshold_v


def test_the_finger_stays_and_the_board_is_the_article_s():
    design = Design(skin={"width_mm": 18.0})
    changed, article = with_article_board(design), Design.load("article")
    assert changed.skin == design.skin
    assert (changed.board, changed.detector) == (article.board, article.detector)
    assert changed.board.variant == "article"
    assert changed.detector.adc_range_v == 10.0


def test_every_detector_is_compared_and_the_article_itself_is_not():
    rows = study_article_board(Design(), CampaignPlan(2, 0.5))
    assert [row.detector for row in rows] == ["analog", "digital", "fft", "fast"]
    fast = rows[-1]
    assert fast.found_share == 1.0
    assert fast.median_s < fast.motion_p90_s < 0.1
    assert study_article_board(Design.load("article"), CampaignPlan(2, 0.5)) == []
