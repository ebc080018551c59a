"""Validation of a design: the campaign, the closed loop, the studies, and whether the requirements are met."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fingertip.design import Design
from fingertip.foundation.progress import Work
from fingertip.lab.campaign.grip import ClosedLoopTrial, run_closed_loop, summarise
from fingertip.lab.campaign.plan import HELD_OUT_FROM, RANGE_SEEDS, SEED_RANGES, CampaignPlan, check_first_seed
from fingertip.lab.campaign.requirements import Requirement, RequirementLimits, check_closed_loop, check_detection
from fingertip.lab.campaign.run import CampaignResult, run_campaign
from fingertip.lab.report import omissions, tables
from fingertip.lab.report.tables import StudyResults
from fingertip.lab.studies.article import study_article_board, study_article_protocol
from fingertip.lab.studies.article_figures import compute_spectra, study_windows
from fingertip.lab.studies.bounds import compute_bounds_s, study_motor_discrimination
from fingertip.lab.studies.sensitivity import study_accelerations, study_assumptions
from fingertip.lab.studies.step_sensitivity import study_sampling_rates, study_steps
from fingertip.lab.studies.variants import study_board_variants, study_knock_rejection
from fingertip.lab.wider_mix.mix import MixSize, generate_mix, run_detector
from fingertip.lab.wider_mix.mix import summarise as summarise_mix
from fingertip.sim.contact.pad import Pad
from fingertip.slip.detectors.registry import find_detector_type

STUDY_TRIALS = 24
"""Largest number of trials in each study beside the campaign: three for each surface and object."""
MAX_STEP_TRIALS = 60
"""Largest number of trials that are repeated with a finer time step: half of the default plan's, as each takes the
time of ten."""

MIX_SEED_OFFSET = 500_000
"""Distance of the wider mix's first seed from the campaign's."""

FILES = (
    "validation.txt", "validation.json", "omissions.md", "delays.png", "surfaces.png", "surfaces_digital.png",
    "spectra.png", "windows.png", "comparison.png", "trial.png", "trials_surfaces.png", "trials_objects.png",
    "window_trial.png", "closed_loop_power.png", "closed_loop_pinch.png",
)  # fmt: skip
"""Names of all files of a validation."""


@dataclass(frozen=True, eq=False)
class Validation:
    """Results of a validation."""

    design: Design
    detector: str
    """Detector that the requirements apply to."""
    campaign: CampaignResult
    closed_loop: tuple[ClosedLoopTrial, ...]
    requirements: tuple[Requirement, ...]
    studies: StudyResults

    @property
    def passed(self) -> bool:
        """True if every requirement is met."""
        return all(requirement.passed for requirement in self.requirements)

    def as_data(self) -> dict[str, Any]:
        """Return all results for JSON."""
        return tables.as_data(self.campaign, self.detector, self.requirements, self.studies)

    def as_text(self) -> str:
        """Return the details of the results as text."""
        return tables.as_text(self.campaign, self.detector, self.studies)

    def as_verdict(self) -> str:
        """Return whether the requirements are met, and each of them with its value, as text."""
        missed = sum(not requirement.passed for requirement in self.requirements)
        count = len(self.requirements)
        verdict = f"{missed} of {count} requirements are MISSED" if missed else f"all {count} requirements are met"
        lines = [f"{self.design.name}, detector {self.detector}: {verdict}"]
        lines += [f"  {'met   ' if one.passed else 'MISSED'}  {one.message}" for one in self.requirements]
        return "\n".join(lines)

    def files(self, with_plots: bool = True) -> dict[str, bytes]:
        """Return file name -> content: the results, the plots, and the page of omissions.

        Raises MissingLibraryError.
        """
        return {
            "validation.txt": f"{self.as_verdict()}\n\n{self.as_text()}\n".encode(),
            "validation.json": (json.dumps(self.as_data(), indent=2, allow_nan=False) + "\n").encode(),
            **(self._draw_plots() if with_plots else {}),
            "omissions.md": self._write_omissions().encode(),
        }

    def _write_omissions(self) -> str:
        return omissions.as_markdown(self.campaign, self.requirements, self.closed_loop, self.studies, self.detector)

    def _draw_plots(self) -> dict[str, bytes]:
        from fingertip.lab.report import plots, trial_plots

        return {
            "delays.png": plots.plot_delays(self.campaign),
            "surfaces.png": plots.plot_surfaces(self.campaign, self.detector),
            "surfaces_digital.png": plots.plot_surfaces(self.campaign, "digital"),
            "spectra.png": plots.plot_spectra(self.studies.spectra),
            "windows.png": plots.plot_windows(self.studies.windows),
            "comparison.png": plots.plot_comparison(self.campaign, self.studies.bound_s(0.5)),
            **trial_plots.plot_trials(self.design),
            **trial_plots.plot_closed_loop(self.closed_loop, self.detector),
        }


def estimate_stages_s(plan: CampaignPlan) -> dict[str, float]:
    """Estimate the duration of each stage [s] for its share of the progress; measured on one core."""
    cases = plan.trials + 15 * plan.negative_minutes  # a scene takes some four seconds
    return {
        "trials": 0.2 * cases,
        "further ranges of seeds": 0.12 * cases,
        "wider mix": 0.4 * plan.trials,
        "closed loop": 17.0,
        "bound": 0.02 * plan.trials,
        "assumptions": 15.0,
        "time step": 0.3 * min(MAX_STEP_TRIALS, plan.trials / 2),
        "windows and spectra": 1.0,
        "accelerations": 8.0,
        "sampling rates": 0.2 * min(2 * STUDY_TRIALS, plan.trials),
        "boards": 5.0,
        "the article's board": 0.1 * cases,
        "the article's protocol": 0.2 * plan.trials + 12.0,
        "motors and knocks": 5.0,
    }


def validate(
    design: Design,
    plan: CampaignPlan | None = None,
    detector: str = "fast",
    limits: RequirementLimits | None = None,
    progress: Callable[[str], None] = lambda _: None,
    first_seed: int = HELD_OUT_FROM,
) -> Validation:
    """Test a design's detectors on simulated slips and on scenes without slip. Raises TraceError."""
    find_detector_type(detector)
    check_first_seed(first_seed)
    plan, limits = plan or CampaignPlan(), limits or RequirementLimits()
    work = Work("validate", estimate_stages_s(plan), progress)
    work.begin("trials")
    result = run_campaign(design, plan, progress=progress, first_seed=first_seed, advance=work.advance)
    ranges = [result.at_nominal_threshold(detector)]
    work.begin("further ranges of seeds")
    for i in range(1, SEED_RANGES):
        seed = first_seed + i * RANGE_SEEDS
        ranges.append(run_campaign(design, plan, (detector,), (1.0,), first_seed=seed).at_nominal_threshold(detector))
        work.advance(i / SEED_RANGES)
    work.begin("wider mix")
    mix_size = MixSize.for_trials(plan.trials)
    mix = summarise_mix(run_detector(detector, design, generate_mix(design, mix_size, first_seed + MIX_SEED_OFFSET)))
    work.begin("closed loop")
    loop_detectors = tuple(dict.fromkeys(("analog", "fast", detector)))
    loop_repeats = 3 if plan.trials >= 12 else 1
    manipulations = run_closed_loop(design, loop_detectors, loop_repeats)
    summaries = summarise(manipulations)
    required = next(summary for summary in summaries if summary.detector == detector)
    requirements = (*check_detection(result, detector, limits), *check_closed_loop(required, limits))
    trials = min(STUDY_TRIALS, plan.trials)
    work.begin("bound")
    bounds_s = compute_bounds_s(design, plan, first_seed)
    work.begin("assumptions")
    variations = study_assumptions(design, detector, trials)
    work.begin("time step")
    steps = study_steps(design, min(MAX_STEP_TRIALS, (plan.trials + 1) // 2))
    work.begin("windows and spectra")
    windows, spectra = study_windows(design, trials), compute_spectra(design)
    work.begin("accelerations")
    accelerations = study_accelerations(design, trials)
    work.begin("sampling rates")
    rates = study_sampling_rates(design, min(2 * STUDY_TRIALS, plan.trials))
    work.begin("boards")
    boards = study_board_variants(design, trials)
    work.begin("the article's board")
    article = study_article_board(design, plan, first_seed)
    work.begin("the article's protocol")
    protocol = study_article_protocol(design, plan.trials, loop_repeats, first_seed)
    work.begin("motors and knocks")
    motor, knocks = study_motor_discrimination(design, trials), study_knock_rejection(design)
    studies = StudyResults(
        bounds_s=bounds_s,
        variations=variations,
        steps=steps,
        patch_radius_m=Pad.from_design(design).patch_radius_m(1.0),
        windows=windows,
        spectra=spectra,
        accelerations=accelerations,
        rates=rates,
        boards=boards,
        article=article,
        protocol=protocol,
        motor=motor,
        knocks=knocks,
        closed_loop=summaries,
        seed_ranges=ranges,
        wider_mix=mix,
    )
    return Validation(design, detector, result, tuple(manipulations), requirements, studies)
