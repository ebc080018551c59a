"""All studies of one design: results, tables, plots, and a page of what their figures rest on."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from fingertip.design import Design
from fingertip.documents.template import render_text
from fingertip.foundation.progress import Work
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, CampaignPlan
from fingertip.lab.report.results import format_ms
from fingertip.pad.response import Pad
from fingertip.sim.contact.surface_files import ARTICLE_SURFACES, SURFACES
from tools.article import plots, sensitivity, tables
from tools.article.boards import study_article_board, study_board_variants
from tools.article.previous_works import study_previous_works
from tools.article.protocol import study_article_protocol, study_windows
from tools.article.robustness import LEVELS_ARE_ASSUMED, format_milli, format_mn, format_mv
from tools.article.sensitivity import study_assumptions
from tools.article.steps import GOAL_SHARE, study_sampling_rates, study_steps
from tools.article.tables import StudyResults

T = TypeVar("T")
DATA = Path(__file__).with_name("beside_article.json")
"""Figures of the article's finger and board under all laws, which `tools.article.page` measures."""
TEMPLATE = Path(__file__).with_name("studies.md")
STUDY_TRIALS = 24
"""Largest number of trials in each study: three for each surface and object."""
MAX_STEP_TRIALS = 60
"""Largest number of trials that are repeated with a finer time step, each in the time of ten."""
_EXPLAINED = {
    "patch": sensitivity.PATCH_AVERAGE,
    "stick_slip": sensitivity.STICK_SLIP,
    "both": sensitivity.BOTH,
    "elasto_plastic": sensitivity.ELASTO_PLASTIC,
}
"""Name in the template -> label of a variation that it explains."""


@dataclass(frozen=True, eq=False)
class Studies:
    design: Design
    detector: str
    """Detector whose assumptions are changed."""
    results: StudyResults

    def files(self) -> dict[str, bytes]:
        """Return file name -> content: tables, what they rest on, and plots."""
        text = f"{self.design.name}\n\n{tables.as_text(self.detector, self.results)}\n"
        return {
            "studies.txt": text.encode(),
            "studies.md": as_markdown(self).encode(),
            "windows.png": plots.plot_windows(self.results.windows),
        }


def estimate_stages_s(plan: CampaignPlan) -> dict[str, float]:
    """Estimate the duration of each stage [s] for its share of the progress; measured on
    one core.
    """
    return {
        "assumptions": 22.0,
        "time step": 0.3 * min(MAX_STEP_TRIALS, plan.trials / 2),
        "windows": 1.0,
        "sampling rates": 0.2 * min(2 * STUDY_TRIALS, plan.trials),
        "boards": 5.0,
        "the article's board": 0.1 * (plan.trials + 15 * plan.negative_minutes),
        "the article's protocol": 0.2 * plan.trials + 12.0,
        "previous works": 0.1 * plan.trials,
    }


def study(
    design: Design,
    plan: CampaignPlan,
    detector: str = "fast",
    progress: Callable[[str], None] = lambda _: None,
    first_seed: int = HELD_OUT_FROM,
) -> Studies:
    """Make all studies of a design that has a filter board."""
    work = Work("studies", estimate_stages_s(plan), progress)
    trials = min(STUDY_TRIALS, plan.trials)

    def run(stage: str, study: Callable[..., T], *arguments: Any) -> T:
        work.begin(stage)
        return study(design, *arguments)

    repeats = 3 if plan.trials >= 12 else 1
    results = StudyResults(
        variations=run("assumptions", study_assumptions, detector, trials),
        steps=run("time step", study_steps, min(MAX_STEP_TRIALS, (plan.trials + 1) // 2)),
        patch_radius_m=Pad.from_design(design).patch_radius_m(1.0),
        windows=run("windows", study_windows, trials),
        rates=run("sampling rates", study_sampling_rates, min(2 * STUDY_TRIALS, plan.trials)),
        boards=run("boards", study_board_variants, trials),
        article=run("the article's board", study_article_board, plan, first_seed),
        protocol=run(
            "the article's protocol", study_article_protocol, plan.trials, repeats, first_seed
        ),
        previous=run("previous works", study_previous_works, plan.trials, first_seed),
    )
    return Studies(design, detector, results)


def as_markdown(studies: Studies) -> str:
    """Write the page of what the studies find and rest on."""
    steps = studies.results.steps
    results = studies.results
    return render_text(
        TEMPLATE.read_text(encoding="utf-8"),
        **collect_effects(results.variations, results.patch_radius_m),
        design=studies.design.name,
        detector=studies.detector,
        steps=steps,
        goal_share=GOAL_SHARE,
        goal_missed=[row.detector for row in steps.shifts if not row.meets_goal],
        found_once=[
            f"{row.detector} {row.one_grid_only}" for row in steps.shifts if row.one_grid_only
        ],
        largest_errors=[
            f"{row.signal} {format_milli(row.worst, row.signal)}" for row in steps.errors
        ],
    )


def collect_effects(
    variations: Sequence[sensitivity.VariationResult], patch_radius_m: float
) -> dict[str, Any]:
    """Collect what the page says of effects that the trials leave out."""
    base = variations[0]
    rows = {v.label: v for v in variations}
    patch = rows.get(sensitivity.PATCH_AVERAGE)

    return {
        **{name: rows.get(label) for name, label in _EXPLAINED.items()},
        "base": base,
        "other_effects": [
            v for v in variations[1:] if v.is_realistic and v.label not in _EXPLAINED.values()
        ],
        "laws": [v for v in variations if v.is_law],
        "beside": json.loads(DATA.read_bytes()),
        "loaded_on": sensitivity.LOADED_ON,
        "loads_n": sensitivity.LOADS_N,
        "patch_radius_m": patch_radius_m,
        "patch_ratio": base.vibration_n / patch.vibration_n
        if patch and patch.vibration_n
        else math.inf,
        "wavelengths_mm": sorted({SURFACES[name].longest_wave_mm for name in ARTICLE_SURFACES}),
        "held_longer": sensitivity.HELD_LONGER,
        "levels_are_assumed": LEVELS_ARE_ASSUMED,
        "isfinite": math.isfinite,
        "ms": format_ms,
        "mn": format_mn,
        "mv": format_mv,
    }
