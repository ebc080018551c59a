"""The article's own protocol (III.C, IV.A): its trials, board, window and threshold, and its zero of time.

Its zero is the slippage onset as a robot's encoders show it at 100 Hz. It states no smallest motion, so three are
tried. Its threshold was chosen empirically and is not stated either; here it follows from the noise of each board's own
output. Nothing is tuned to its figures.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.lab.campaign.evaluate import TrialResult, evaluate, simulate_trace
from fingertip.lab.campaign.grip import ClosedLoopSummary, run_closed_loop, summarise
from fingertip.lab.campaign.plan import HELD_OUT_FROM, CampaignPlan, generate_cases
from fingertip.lab.campaign.run import run_campaign, surface
from fingertip.lab.studies.variants import with_variant
from fingertip.sim.scene.timeline import TrapezoidalMove
from fingertip.sim.signal.converter import simulate_quiescent_level
from fingertip.sim.signal.grid import open_stream
from fingertip.slip.detectors.digital import noise_level
from fingertip.slip.traces.origin import ENCODER_HZ, encoder_band_s

# The same finger on the article's board and converter: what the article built, beside what the design builds.


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


MOVED_M = (0.0, 1e-5, 1e-4)
"""Motions from which on the robot counts as moving [m]: none, and the steps of a good and a common encoder. Assumption:
the article states none."""
PROMPT_S = 0.03
"""Delay below which the article counts a detection as fast [s] (IV.A)."""
LATE_S = 0.1
"""Delay beyond which the article's FFT found slip only [s] (IV.B)."""
BIN_S = 0.005
"""Width of the bins of the article's figure 14 [s]."""
DEVICES = {
    "article's board": ("article", "analog"),
    "precision board": ("precision", "analog"),
    "digital chain": ("article", "digital"),
    "fft": ("article", "fft"),
}
"""Name -> variant of the board, and detector. Both boards have the article's amplifiers ahead of the rectifier; the
precision rectifier has no dead zone."""
_LONGEST_ZERO_S = 0.2


@dataclass(frozen=True)
class ProtocolResult:
    """Result of one device, with one zero of time. Means are NaN where no slip was found."""

    device: str
    threshold_v: float
    """Threshold of the mean envelope [V]; that of `fft` follows from the noise in its band."""
    moved_m: float
    """Motion from which on the robot counts as moving [m]."""
    trials: int
    found: int
    below_30_ms: int
    below_100_ms: int
    mean_s: float
    fullest_bin_s: float
    """Centre of the bin of figure 14 with the most trials [s]."""
    worst_surface_s: float
    """Largest mean delay on a flat surface [s]."""
    worst_object_s: float
    """Largest mean delay on a grasped object [s]."""
    worst_deviation_s: float
    """Largest standard deviation of the delay on any surface or object [s]."""


@dataclass(frozen=True)
class ProtocolStudy:
    """All results under the article's protocol."""

    results: Sequence[ProtocolResult]
    manipulations: dict[str, ClosedLoopSummary]
    """Board -> manipulations with the detector `analog` in the loop."""

    def find(self, device: str, moved_m: float = 0.0) -> ProtocolResult:
        """Find the result of a device with a zero of time."""
        return next(r for r in self.results if (r.device, r.moved_m) == (device, moved_m))


def find_encoder_zero_s(slide: TrapezoidalMove, phase_s: float, moved_m: float) -> float:
    """Time of the first reading of the encoders at which a slide has moved by more than `moved_m` [s]."""
    first_s, next_s = encoder_band_s(slide.start_s)
    readings = np.asarray(
        slide.start_s + phase_s + (next_s - first_s) * np.arange(round(_LONGEST_ZERO_S * ENCODER_HZ)), dtype=np.float64
    )
    return float(readings[np.argmax(slide.position_m(readings) > moved_m)])


def study_article_protocol(
    design: Design, trials: int = 120, repeats: int = 3, first_seed: int = HELD_OUT_FROM
) -> ProtocolStudy:
    """Run the article's trials and manipulations with the finger of a design on the article's board and converter."""
    article = with_article_board(design)
    boards = {
        device: _with_threshold(with_variant(article, variant), name) for device, (variant, name) in DEVICES.items()
    }
    collected: dict[str, list[TrialResult]] = {device: [] for device in DEVICES}
    with compiled():
        for case in generate_cases(CampaignPlan(trials, 0.5), first_seed):
            if case.cause != "slip":
                continue
            for device, (_, name) in DEVICES.items():
                trace, force_n = simulate_trace(boards[device], case, [name])
                collected[device] += evaluate(case, trace, force_n, name, boards[device], [1.0])
    results = [
        _pool(device, boards[device].detector.threshold_v, moved_m, found)
        for device, found in collected.items()
        for moved_m in MOVED_M
    ]
    manipulations = {
        device: summarise(run_closed_loop(boards[device], (name,), repeats, uncontrolled=False))[0]
        for device, (_, name) in DEVICES.items()
        if name == "analog"
    }
    return ProtocolStudy(results, manipulations)


def _with_threshold(board: Design, detector: str) -> Design:
    """Copy of a design with the threshold that the noise of what the detector reads allows."""
    level = simulate_quiescent_level(board) if detector == "analog" else noise_level(board)
    tables = board.model_dump()
    tables["detector"]["threshold_v"] = level.rounded_threshold_v
    return Design(**tables)


def _find_delays_s(trials: Sequence[TrialResult], moved_m: float) -> Iterator[tuple[TrialResult, float]]:
    """Yield each trial whose slip was found, with its delay from the encoders' zero [s]; negative if it was sooner."""
    for trial in trials:
        if not trial.delays_s or trial.motion_s is None:
            continue
        slide = trial.case.scene.slide
        move = TrapezoidalMove.with_speed(trial.motion_s, slide.distance_m, slide.speed_m_s, slide.acceleration_m_s2)
        phase_s = float(open_stream(trial.case.seed, "encoders").random_sample()) / ENCODER_HZ
        yield trial, trial.motion_s + trial.motion_delays_s[0] - find_encoder_zero_s(move, phase_s, moved_m)


def _pool(device: str, threshold_v: float, moved_m: float, trials: Sequence[TrialResult]) -> ProtocolResult:
    """Pool the trials of a device."""
    groups: dict[str, list[float]] = {}
    for trial, delay_s in _find_delays_s(trials, moved_m):
        groups.setdefault(surface(trial), []).append(delay_s)
    delays_s = [delay for group in groups.values() for delay in group]
    bins = [BIN_S * math.floor(delay / BIN_S + 0.5) for delay in delays_s]
    means_s = {name: float(np.mean(group)) for name, group in groups.items()}
    objects = {name for name in means_s if name.startswith("object")}
    return ProtocolResult(
        device,
        threshold_v,
        moved_m,
        len(trials),
        len(delays_s),
        sum(delay < PROMPT_S for delay in delays_s),
        sum(delay < LATE_S for delay in delays_s),
        float(np.mean(delays_s)) if delays_s else math.nan,
        max(sorted(set(bins)), key=bins.count) if bins else math.nan,
        max((means_s[name] for name in means_s if name not in objects), default=math.nan),
        max((means_s[name] for name in objects), default=math.nan),
        max((float(np.std(group)) for group in groups.values()), default=math.nan),
    )
