"""Detector `analog` by board variant, and every detector on the article's board and converter.

A silicon diode conducts from some 0.45 V, which is 6.7 mV of vibration ahead of the gain. The
article does not name its diode, and does not say how strong its vibrations were:
`tools.article.level` infers that. Without the dead zone noise allows a much lower threshold than on
the sampled voltage, because the ADC's noise dominates and the board's gain comes before it. A lower
threshold finds slip sooner, and reports more load changes as slip.
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from fingertip.lab.board_comparison import with_variant
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, CampaignPlan, generate_cases
from fingertip.lab.campaign.run import DetectorResult, run_campaign, run_cases, surface
from fingertip.sim.signal.converter import simulate_quiescent_level

VARIANTS = ("article", "precision")


@dataclass(frozen=True)
class BoardResult:
    """Result of the detector `analog` on one board at one threshold;
    delays are infinite if too few slips are found.
    """

    variant: str
    threshold_v: float
    by_rule: bool
    """True if the threshold follows from the noise of this
    board's output; otherwise it is the design's.
    """
    found_share: float
    median_s: float
    p90_s: float
    below_30_ms: float
    worst_mean_s: float
    """Mean delay of the slips found on the worst surface [s]."""
    alarms_per_minute: float


def study_board_variants(
    design: Design, trials: int = 24, negative_minutes: float = 2.0
) -> list[BoardResult]:
    """Run the same cases on each board, at the design's threshold
    and at the one that its noise allows.
    """
    cases = list(generate_cases(CampaignPlan(trials, negative_minutes)))
    results = []

    for variant in VARIANTS:
        try:
            changed = with_variant(design, variant)
        except DesignError:  # another variant may need other values
            continue

        rule_v = simulate_quiescent_level(changed).rounded_threshold_v
        design_v = changed.detector.threshold_v
        pair = run_cases(changed, cases, {"analog": (1.0, rule_v / design_v)})["analog"]

        for by_rule, threshold_v, pooled in zip(
            (False, True), (design_v, rule_v), pair, strict=True
        ):
            worst_s = max(mean for mean, _, _ in pooled.group_delays(surface).values())
            found = pooled.found_share
            delays_s = (pooled.delay_s(0.5), pooled.delay_s(0.9))
            figures = (
                found,
                *delays_s,
                pooled.share_within_30_ms,
                worst_s,
                pooled.alarms_per_minute,
            )
            results.append(BoardResult(changed.board.variant, threshold_v, by_rule, *figures))

    return results


def with_article_board(design: Design) -> Design:
    """Copy of a design with the board and the converter of the bundled design `article`."""
    article = Design.load("article").model_dump()
    return Design(**(design.model_dump() | {name: article[name] for name in ("board", "detector")}))


def study_article_board(
    design: Design, plan: CampaignPlan, first_seed: int = HELD_OUT_FROM
) -> dict[str, DetectorResult]:
    """Run the cases of a plan on the article's board with every
    detector; none if the design has that board.
    """
    changed = with_article_board(design)
    if changed == design:
        return {}

    result = run_campaign(changed, plan, scales=(1.0,), first_seed=first_seed)
    return {name: result.at_nominal_threshold(name) for name in result.detectors}
