"""Pooled results of a campaign, in closed form, and what the campaign asks of simulation and detectors."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.numerics import poisson_interval
from fingertip.lab.campaign import run
from fingertip.lab.campaign.plan import CampaignPlan, Case
from fingertip.lab.campaign.run import (
    LOW_SCALES,
    CampaignResult,
    DetectorResult,
    TrialResult,
    quantile_s,
    run_campaign,
    speed_m_s,
    surface,
)
from fingertip.sim import SceneFile
from fingertip.sim.simulation import article_trials

SCENES = [scene for scene, _ in itertools.islice(article_trials(), 200)]
SLIDE = SCENES[0]
SLIP, CONTACT, MOTOR = (Case(cause, SLIDE, i) for i, cause in enumerate(("slip", "contact", "motor")))


def trial(
    delays_s: Sequence[float] = (), slips: int = 1, alarms: Sequence[str] = (), case: Case = SLIP,
    duration_s: float = 60.0, on_share: float = 0.9, creep_s: float = 0.0,
) -> TrialResult:  # fmt: skip
    return TrialResult(case, duration_s, 1.0, slips, tuple(delays_s), on_share, tuple(alarms), creep_s)


def pool(*trials: TrialResult, scale: float = 1.0) -> DetectorResult:
    return DetectorResult(scale, trials)


@pytest.mark.parametrize(
    ("delays_s", "slips", "fraction", "delay_s"),
    [
        ([0.4, 0.1, 0.3, 0.2], 4, 0.0, 0.1),
        ([0.4, 0.1, 0.3, 0.2], 4, 0.5, 0.3),
        ([0.4, 0.1, 0.3, 0.2], 4, 0.74, 0.3),
        ([0.4, 0.1, 0.3, 0.2], 4, 1.0, 0.4),
        ([0.2, 0.1], 4, 0.49, 0.2),
        ([0.2, 0.1], 4, 0.5, math.inf),
        ([0.2, 0.1], 3, 1.0, math.inf),
        ([], 2, 0.0, math.inf),
        ([], 0, 0.5, math.inf),
    ],
)
def test_delay_of_a_fraction_counts_the_slips_that_were_missed(
    delays_s: list[float], slips: int, fraction: float, delay_s: float
) -> None:
    assert quantile_s(delays_s, slips, fraction) == delay_s


def test_shares_of_the_slips() -> None:
    pooled = pool(trial([0.01, 0.029], 2), trial([0.03]), trial([0.5], on_share=0.5), trial(on_share=0.0))
    assert (pooled.slips, pooled.delays_s) == (5, [0.01, 0.029, 0.03, 0.5])
    assert pooled.found_share == pytest.approx(4 / 5)
    assert pooled.share_within_30_ms == pytest.approx(2 / 5), "less than 30 ms, of all slips"
    assert pool(trial([0.01])).share_within_30_ms == 1.0
    assert pooled.worst_s == 0.5
    assert pooled.on_share == pytest.approx((0.9 + 0.9 + 0.5) / 3), "the one that was missed has none"
    assert pooled.delay_s(0.5) == 0.03


def test_delays_since_the_robot_moved_include_the_creep_before_the_slip() -> None:
    pooled = pool(trial([0.01], creep_s=0.2), trial([0.05], creep_s=0.1))
    assert pooled.motion_delay_s(0.0) == pytest.approx(0.15)
    assert pooled.motion_delay_s(1.0) == pytest.approx(0.21)


def test_without_slips_nothing_is_found() -> None:
    none = pool(trial(slips=0, case=CONTACT))
    assert (none.found_share, none.share_within_30_ms, none.on_share) == (0.0, 0.0, 0.0)
    assert none.worst_s == none.delay_s(0.5) == math.inf
    assert none.group_delays(surface) == {}


def test_alarms_per_minute_leave_out_the_causes_that_are_reported_apart() -> None:
    pooled = pool(
        trial(alarms=["contact"], duration_s=90.0),
        trial(slips=0, alarms=["contact"] * 3, case=CONTACT, duration_s=120.0),
        trial(slips=0, case=CONTACT, duration_s=30.0),
        trial(slips=0, alarms=["motor"] * 9, case=MOTOR, duration_s=600.0),
    )
    assert pooled.alarms() == {"slip": 0, "contact": 4, "motor": 9}
    assert list(pooled.alarms()) == ["slip", "contact", "motor"]
    assert pooled.minutes() == {"slip": 1.5, "contact": 2.5, "motor": 10.0}
    assert (pooled.limited_alarms, pooled.limited_minutes) == (4, 4.0)
    assert pooled.alarms_per_minute == 1.0
    assert pooled.alarm_interval == pytest.approx(tuple(end / 4.0 for end in poisson_interval(4)))
    silent = pool(trial(duration_s=120.0))
    assert silent.alarm_interval == pytest.approx((0.0, -math.log(0.025) / 2.0))


def test_rate_of_scenes_that_are_all_reported_apart_is_not_known() -> None:
    apart = pool(trial(slips=0, alarms=["motor"], case=MOTOR))
    assert apart.alarms_per_minute == 0.0
    assert apart.alarm_interval == (0.0, math.inf)


def test_delays_by_group() -> None:
    """Sliding over a surface is named by it, an object that is pulled by itself too."""
    pulled = next(scene for scene in SCENES if scene.name != SLIDE.name)
    groups = pool(
        trial([0.01]), trial([0.03]), trial(case=Case("slip", pulled, 1)), trial([], 0, case=CONTACT)
    ).group_delays(surface)  # fmt: skip
    assert groups == {
        SLIDE.contact.surface: (pytest.approx(0.02), pytest.approx(0.01), 2),
        f"object, {pulled.contact.surface}": (math.inf, 0.0, 0),
    }
    touched = SceneFile(scene="contact", contact={"surface": "smooth"})
    assert run.scene_surface(touched) == "object, smooth"
    speeds = pool(trial([0.01])).group_delays(speed_m_s)
    assert list(speeds) == [SLIDE.slide.speed_m_s]


def test_thresholds_are_found_by_their_factor_and_by_their_alarms() -> None:
    results = tuple(
        pool(trial(alarms=["contact"] * count), scale=scale) for scale, count in ((0.5, 4), (1.0, 2), (2.0, 1))
    )
    campaign = CampaignResult(CampaignPlan(), 0, {"fast": results})
    assert campaign.at_nominal_threshold("fast") is results[1]
    assert campaign.at_alarm_rate("fast", 2.0) is results[1], "the limit itself is kept"
    assert campaign.at_alarm_rate("fast", 1.99) is results[2]
    assert campaign.at_alarm_rate("fast", 9.0) is results[0]
    assert campaign.at_alarm_rate("fast", 0.5) is None


def test_every_case_is_simulated_once_and_evaluated_at_every_threshold(monkeypatch: pytest.MonkeyPatch) -> None:
    cases = [Case("slip", SLIDE, seed) for seed in (7, 8, 9)]
    simulated: list[tuple[int, tuple[str, ...]]] = []
    shares: list[float] = []

    def simulate(_: Design, case: Case, detectors: Sequence[str]) -> tuple[Any, float]:
        simulated.append((case.seed, tuple(detectors)))
        return SimpleNamespace(seed=case.seed), 2.0 * case.seed

    def evaluate(
        case: Case, trace: Any, force_n: float, name: str, _: Design, scales: Sequence[float]
    ) -> list[TrialResult]:
        assert (trace.seed, force_n) == (case.seed, 2.0 * case.seed)
        return [trial([scale], case=case, alarms=[name]) for scale in scales]

    monkeypatch.setattr(run, "generate_cases", lambda plan, seed: cases if seed == 7 else [])
    monkeypatch.setattr(run, "simulate_trace", simulate)
    monkeypatch.setattr(run, "evaluate", evaluate)
    plan = CampaignPlan()
    found = run_campaign(Design(), plan, ("fast", "analog"), (3.0, 0.5), first_seed=7, advance=shares.append)
    assert (found.plan, found.first_seed) == (plan, 7)
    assert simulated == [(seed, ("fast", "analog")) for seed in (7, 8, 9)]
    assert shares == pytest.approx([0.0, 1 / 3, 2 / 3])
    scales = {"fast": [0.5, 1.0, 3.0], "analog": sorted({*LOW_SCALES, 0.5, 1.0, 3.0})}
    for name, results in found.detectors.items():
        assert [result.scale for result in results] == scales[name]
        for result in results:
            assert [t.case.seed for t in result.trials] == [7, 8, 9]
            assert result.delays_s == [result.scale] * 3
            assert [t.alarms for t in result.trials] == [(name,)] * 3
    assert np.isfinite(found.at_nominal_threshold("fast").worst_s)


@pytest.mark.parametrize("count", [0, 1, 4, 30, 400])
@pytest.mark.parametrize("confidence", [0.9, 0.95])
def test_the_interval_of_a_rate_is_that_of_the_chi_square_distribution(count: int, confidence: float) -> None:
    from scipy import stats

    low, high = poisson_interval(count, confidence)
    tail = (1 - confidence) / 2
    assert low == pytest.approx(stats.chi2.ppf(tail, 2 * count) / 2 if count else 0.0, rel=1e-9)
    assert high == pytest.approx(stats.chi2.ppf(1 - tail, 2 * count + 2) / 2, rel=1e-9)
