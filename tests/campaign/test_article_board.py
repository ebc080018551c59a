"""Validation beside the article: the same finger on the article's board and converter."""

from __future__ import annotations

from fingertip.design import Design
from fingertip.lab.campaign.plan import CampaignPlan
from fingertip.lab.studies.article import study_article_board, with_article_board


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
