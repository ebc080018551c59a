"""Trials of the studies: some cases of a campaign, and one trial on two grids of time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from fingertip.design import Design
from fingertip.lab.campaign.plan import HELD_OUT_FROM, REPORTED_SEPARATELY, CampaignPlan, Case, generate_cases
from fingertip.lab.campaign.run import evaluate, select_board_outputs
from fingertip.sim import run_scene
from fingertip.sim.runs.scene import SceneRun
from fingertip.sim.signal.grid import Grid
from fingertip.slip.detectors import registry


def generate_limited_cases(plan: CampaignPlan) -> Iterator[Case]:
    """Generate those of all cases whose alarms a requirement limits."""
    return (case for case in generate_cases(plan) if case.cause not in REPORTED_SEPARATELY)


def generate_trials(trials: int, first_seed: int = HELD_OUT_FROM) -> Iterator[Case]:
    return (case for case in generate_cases(CampaignPlan(trials, 0.5), first_seed) if case.cause == "slip")


STEPS_COMPARED = 16
"""Number of steps of the finer grid per step of the shipped one."""
COMPARED = ("force_n", "voltage_v", "envelope_v")


def compare_grids(
    design: Design, case: Case, detectors: Sequence[str] = tuple(registry.DETECTORS), refinement: int = STEPS_COMPARED
) -> tuple[dict[str, float], dict[str, float]]:
    """Run one trial on the shipped grid and on a finer one, with the same noise.

    Returns by signal the largest difference, in the signal's unit, and by detector the shift of the delay [samples]:
    infinite if slips are found on one grid only, NaN if on neither.
    """
    sampled = select_board_outputs(design, detectors)
    signals = COMPARED if design.board.has_filter else COMPARED[:2]
    scene = case.scene.model_copy(update={"outputs": ["slip", *signals, *sampled]})
    shipped = SceneRun(design, scene, case.seed).grid
    assert shipped
    pair = [run_scene(design, scene, case.seed, grid=Grid(parts * shipped.refinement)) for parts in (1, refinement)]
    errors = {name: float(np.max(np.abs(pair[0].columns[name] - pair[1].columns[name]))) for name in signals}
    rate = design.detector.sample_rate_hz
    shifts = {}
    for name in detectors:
        coarse, fine = (evaluate(case, one.trace, name, design, [1.0])[0].delays_s for one in pair)
        shifts[name] = rate * _find_shift_s(coarse, fine)
    return errors, shifts


def _find_shift_s(coarse_s: Sequence[float], fine_s: Sequence[float]) -> float:
    """Largest shift of a delay [s]; infinite if the numbers of slips found differ, NaN if there are none."""
    if len(coarse_s) != len(fine_s):
        return math.inf
    return max((abs(a - b) for a, b in zip(coarse_s, fine_s, strict=True)), default=math.nan)
