"""Detector `analog` by board variant: with a bare diode, as the article draws it, and with a precision rectifier.

A silicon diode conducts from some 0.45 V, which is 6.7 mV of vibration ahead of the gain. The article does not name its
diode, and does not say how strong its vibrations were. On the simulated ones a bare 1N4148 does not conduct on smooth
surfaces, whatever the threshold; the article's results follow on the board without that dead zone. There the noise
allows a much lower threshold than on the sampled voltage, because the ADC's noise dominates and the board's gain comes
before it. A lower threshold finds slip sooner, and reports more load changes as slip.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from fingertip.design import Design
from fingertip.design.formulas.amplifiers import BAND_CUTOFFS
from fingertip.foundation.errors import DesignError
from fingertip.foundation.jit import compiled
from fingertip.lab.campaign.plan import HELD_OUT_FROM, NEGATIVE_SCENES, CampaignPlan, Case, generate_cases
from fingertip.lab.campaign.run import DetectorResult, TrialResult, evaluate, simulate_trace, surface
from fingertip.sim.signal.converter import simulate_quiescent_level

VARIANTS = ("article", "precision")


@dataclass(frozen=True)
class BoardResult:
    """Result of the detector `analog` on one board at one threshold; delays are infinite if too few slips are found."""

    variant: str
    threshold_v: float
    by_rule: bool
    """True if the threshold follows from the noise of this board's output; otherwise it is the design's."""
    found_share: float
    median_s: float
    p90_s: float
    below_30_ms: float
    """Fraction of the slips that were found within 30 ms."""
    worst_mean_s: float
    """Mean delay of the slips found on the worst surface [s]."""
    alarms_per_minute: float


def _valid_variants(design: Design) -> Iterator[Design]:
    """Designs with each variant, where its rules allow it: another variant may need other values."""
    for variant in VARIANTS:
        try:
            yield with_variant(design, variant)
        except DesignError:
            continue


def with_variant(design: Design, variant: str) -> Design:
    """Copy of the design with another board variant; its band limit is moved above the vibrations if necessary."""
    tables = design.model_dump()
    if design.board.variant != variant:
        minimum = BAND_CUTOFFS * design.board.cutoff_hz
        tables["board"] |= {"variant": variant, "band_limit_hz": max(design.board.band_limit_hz, minimum)}
    return Design(**tables)


def study_board_variants(
    design: Design, trials: int = 24, negative_minutes: float = 2.0, first_seed: int = HELD_OUT_FROM
) -> list[BoardResult]:
    """Run the same cases on each board, at the design's threshold and at the one that its noise allows."""
    results = []
    for changed in _valid_variants(design):
        variant = changed.board.variant
        rule_v = simulate_quiescent_level(changed).rounded_threshold_v
        design_v = changed.detector.threshold_v
        collected: tuple[list[TrialResult], list[TrialResult]] = ([], [])
        with compiled():
            for case in generate_cases(CampaignPlan(trials, negative_minutes), first_seed):
                trace, force_n = simulate_trace(changed, case, ["analog"])
                pair = evaluate(case, trace, force_n, "analog", changed, [1.0, rule_v / design_v])
                for trials_at_threshold, result in zip(collected, pair, strict=True):
                    trials_at_threshold.append(result)
        for by_rule, trials_at_threshold in zip((False, True), collected, strict=True):
            pooled = DetectorResult(1.0, tuple(trials_at_threshold))
            results.append(
                BoardResult(
                    variant,
                    rule_v if by_rule else design_v,
                    by_rule,
                    pooled.found_share,
                    pooled.delay_s(0.5),
                    pooled.delay_s(0.9),
                    pooled.share_within_30_ms,
                    max(mean for mean, _, _ in pooled.group_delays(surface).values()),
                    pooled.alarms_per_minute,
                )
            )
    return results


# Knocks on the held object, from weak to hard: which of them a detector takes for slip.
#
# A knock excites the pad's own resonance, in the band in which slip shows, and lasts as long as the energy window of a
# few milliseconds: on one force axis a weak knock looks like a short slip. A hard knock differs only in its rate of
# change, which no slip reaches. The trees of `fast` weigh slope, decay and one-way movement.


FORCES_N = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
RISES_S = (0.002, 0.004, 0.01)
"""Rise times of a knock [s]: 2 to 10 ms (assumption, as in ``params/scenes/hard_tap.toml``)."""
_SEED_OFFSET = 20_000


@dataclass(frozen=True)
class KnockResult:
    """Result of one detector for knocks of one force and rise time."""

    detector: str
    force_n: float
    """Peak force [N]."""
    rise_s: float
    false_alarm_share: float
    """Fraction of the knocks that were reported as slip: alarms over knocks, at most 1."""


def study_knock_rejection(
    design: Design,
    detectors: Sequence[str] = ("digital", "fast"),
    scenes: int = 3,
    first_seed: int = HELD_OUT_FROM,
    forces_n: Sequence[float] = FORCES_N,
    rises_s: Sequence[float] = RISES_S,
) -> list[KnockResult]:
    """Run scenes with a few knocks each, for every force and rise time."""
    scene = NEGATIVE_SCENES["hard tap"][0]
    results, seed = [], first_seed + _SEED_OFFSET
    with compiled():
        for rise_s in rises_s:
            for force_n in forces_n:
                tap = scene.tap.model_copy(update={"force_n": force_n, "rise_s": rise_s})
                alarms = dict.fromkeys(detectors, 0)
                for _ in range(scenes):
                    case = Case("hard tap", scene.model_copy(update={"tap": tap}), seed)
                    trace, held_n = simulate_trace(design, case, detectors)
                    for name in detectors:
                        (result,) = evaluate(case, trace, held_n, name, design, [1.0])
                        alarms[name] += len(result.alarms)
                    seed += 1
                for name in detectors:
                    fraction = min(1.0, alarms[name] / (scenes * tap.count))
                    results.append(KnockResult(name, force_n, rise_s, fraction))
    return results
