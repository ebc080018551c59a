"""The same finger on the article's board and converter: what the article built, beside what the design builds."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.campaign.plan import HELD_OUT_FROM, CampaignPlan
from fingertip.campaign.run import run_campaign
from fingertip.design import Design

ARTICLE = "article"
"""Name of the bundled design with the article's board and converter."""


@dataclass(frozen=True)
class ArticleBoardResult:
    """Result of one detector on the article's board; delays are infinite if too few slips are found."""

    detector: str
    found_share: float
    median_s: float
    """Median delay from gross slip [s]."""
    p90_s: float
    """90th percentile from gross slip [s]."""
    motion_p90_s: float
    """90th percentile from the start of the robot's motion [s]."""
    alarms_per_minute: float


def with_article_board(design: Design) -> Design:
    """Copy of a design with the board and the converter of the bundled design `article`."""
    article = Design.load(ARTICLE)
    return Design(
        **(design.model_dump() | {"board": article.board.model_dump(), "detector": article.detector.model_dump()})
    )


def study_article_board(
    design: Design, plan: CampaignPlan, first_seed: int = HELD_OUT_FROM
) -> list[ArticleBoardResult]:
    """Run the cases of a plan on the article's board with every detector; none if the design has that board."""
    changed = with_article_board(design)
    if changed == design:
        return []
    result = run_campaign(changed, plan, scales=(1.0,), first_seed=first_seed)
    rows = []
    for name in result.detectors:
        pooled = result.at_nominal_threshold(name)
        rows.append(
            ArticleBoardResult(
                name, pooled.found_share, pooled.delay_s(0.5), pooled.delay_s(0.9), pooled.motion_delay_s(0.9),
                pooled.alarms_per_minute,
            )
        )  # fmt: skip
    return rows
