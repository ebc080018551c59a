"""Methods that the article compares itself with (IV.B): its digital predecessor on ridged plates,
and a plain FFT.

The article states of the predecessor the mean delay on each of three ridged surfaces, 36 to 48 ms,
but neither ridges nor threshold. Of the FFT it states a window of 128 samples (64 ms), a threshold
on the amplitude, and that it found less than 65 % of the slips, the others only after 100 ms. Both
run here with the threshold that the noise allows, and with higher ones, which show where the
article's figures would lie. Nothing is tuned to them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, Case
from fingertip.lab.campaign.run import TrialResult, run_cases, score_trial, simulate_trace
from fingertip.sim.contact.surface_files import SURFACES
from fingertip.sim.simulation import article_trials
from fingertip.slip.detectors.fft import FftDetector
from tools.article.boards import with_article_board
from tools.article.protocol import LATE_S, find_delays_s, with_threshold
from tools.article.steps import generate_trials

RIDGED = tuple(name for name, surface in SURFACES.items() if surface.ridge_depth_um)
PLATE_FACTORS = (1.0, 5.0)
"""Factors of the threshold on the ridged plates; with the second
one the means are about the article's.
"""
FFT_FACTORS = tuple(2.0 ** (i / 2) for i in range(20))
"""Factors of the plain FFT's threshold."""
FFT_SHARE = 0.65
"""Share of the slips that the article's FFT found, at most (IV.B)."""


@dataclass(frozen=True)
class PlateResult:
    """Detector `digital` on one ridged plate, at one factor of its threshold."""

    surface: str
    factor: float
    trials: int
    found: int
    mean_s: float
    """Mean delay of the slips found, from the encoders' zero [s]; NaN if none was found."""


@dataclass(frozen=True)
class PlainFftResult:
    """Plain FFT at one threshold, which is an RMS value in one bin."""

    threshold_v: float
    trials: int
    found: int
    below_100_ms: int
    contacts: int
    """Number of trials in which it is ON before slip: when the finger touches, or in the grasp."""


@dataclass(frozen=True)
class PreviousWorks:
    plates: Sequence[PlateResult]
    plain_fft: Sequence[PlainFftResult]
    """Results at the threshold of the noise, and at the first that
    finds as little as the article, if any does.
    """

    def means_s(self, factor: float) -> list[float]:
        """Mean delay on each plate at one factor of the threshold [s]."""
        return [row.mean_s for row in self.plates if row.factor == factor]


def study_previous_works(
    design: Design, trials: int = 120, first_seed: int = HELD_OUT_FROM
) -> PreviousWorks:
    """Run both with the finger of a design on the article's board and converter."""
    board = with_threshold(with_article_board(design), "digital")
    return PreviousWorks(
        _study_ridged_plates(board, first_seed), _study_plain_fft(board, trials, first_seed)
    )


def _study_ridged_plates(board: Design, first_seed: int) -> list[PlateResult]:
    """Run the article's trials of one surface, 5 at each of its velocities, on each plate."""
    scenes = [scene for scene, _ in article_trials() if scene.contact.surface == "medium"]
    results = []

    for name in RIDGED:
        changed = (
            s.model_copy(update={"contact": s.contact.model_copy(update={"surface": name})})
            for s in scenes
        )
        cases = [Case("slip", scene, first_seed + i) for i, scene in enumerate(changed)]
        for pooled in run_cases(board, cases, {"digital": PLATE_FACTORS})["digital"]:
            delays_s = [delay for _, delay in find_delays_s(pooled.trials, 0.0)]
            mean_s = float(np.mean(delays_s)) if delays_s else math.nan
            results.append(
                PlateResult(
                    surface=name,
                    factor=pooled.scale,
                    trials=len(cases),
                    found=len(delays_s),
                    mean_s=mean_s,
                )
            )

    return results


def _study_plain_fft(board: Design, trials: int, first_seed: int) -> list[PlainFftResult]:
    threshold_v = FftDetector(board, is_plain=True).threshold_v
    collected: list[list[TrialResult]] = [[] for _ in FFT_FACTORS]
    for case in generate_trials(trials, first_seed):
        trace = simulate_trace(board, case, ["fft"])
        plain = FftDetector(board, is_plain=True)
        statistic_v = plain.process(trace.voltage_v).statistic_v

        for results, factor in zip(collected, FFT_FACTORS, strict=True):
            results.append(
                score_trial(case, trace, statistic_v > factor * threshold_v, plain.memory_s)
            )

    rows = [
        _pool(factor * threshold_v, found)
        for factor, found in zip(FFT_FACTORS, collected, strict=True)
    ]
    return rows[:1] + [row for row in rows[1:] if row.below_100_ms < FFT_SHARE * row.trials][:1]


def _pool(threshold_v: float, trials: Sequence[TrialResult]) -> PlainFftResult:
    delays_s = [delay for _, delay in find_delays_s(trials, 0.0)]
    contacts = sum("contact" in trial.alarms for trial in trials)
    below = sum(delay < LATE_S for delay in delays_s)
    return PlainFftResult(
        threshold_v=threshold_v,
        trials=len(trials),
        found=len(delays_s),
        below_100_ms=below,
        contacts=contacts,
    )
