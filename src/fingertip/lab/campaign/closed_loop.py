"""Closed loop of the article (III.C, figures 16 and 17): a grip that tightens when slip is
detected.

The hand and its law are `fingertip.sim.runs.grip`.

In the article's twelve manipulations, four objects three times each, a robot's pin hits a grasped
object at 8 cm/s. The results say whether the object is held, how soon the hand moves, and whether
the grip was ever tightened without slip. The same manipulations without control show what the
detector adds.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, Issue, gather, raise_issues
from fingertip.foundation.workers import call_each
from fingertip.lab.campaign.campaign import HELD_OUT_FROM
from fingertip.lab.campaign.run import select_board_outputs
from fingertip.sim.runs.grip import GripController, GripDecision, GripSettings
from fingertip.sim.runs.manipulation import ManipulationResult, run_manipulation
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile
from fingertip.sim.simulation import REPEATS_PER_MANIPULATION, Simulation, article_manipulations
from fingertip.slip.detectors.registry import check_detector, find_detector_type
from fingertip.slip.traces.truth import INCIPIENT_S

FIRST_SEED = HELD_OUT_FROM + 1_000_000
"""Seed of the first manipulation; all of them are held out."""
NO_CONTROL = "no control"
REACTION_M = 1e-4
"""Closing of a finger that counts as a reaction [m]. Assumption: well above an encoder's step."""
MAX_SINCE_SLIP_S = 0.15
"""Longest time since true slip for which a grip increase is justified [s].
Assumption: a detector's memory.
"""
_OUTPUTS = ["voltage_v", "force_n", "slip", "closing_m", "object_m"]
"""Outputs of every manipulation; the board's envelope is added where the detector reads it."""
_END_S = 0.2
"""Time at the end over which the force is averaged [s]."""


def find_grip_issues(detector: str, simulation: Simulation | None) -> list[Issue]:
    """Report an unknown detector, and a simulation without a hand.

    None stands for a simulation that did not load.
    """
    issues: list[Issue] = []
    if simulation and not isinstance(simulation.scene, ManipulationFile):
        remedy = "give a manipulation, such as real_manipulation"
        issues.append(Issue("--grip", f"closes the loop of a hand; {remedy}."))

    with gather(issues):
        if simulation:
            check_detector(simulation.design, detector, "--grip")
        else:
            find_detector_type(detector, "--grip")

    return issues


def run_with_grip(
    simulation: Simulation, detector: str = "fast", progress: Callable[[str], None] | None = None
) -> tuple[ManipulationResult, tuple[float, ...]]:
    """Run a manipulation, and tighten the grip whenever a detector finds slip.

    Returns the result, and the times at which the grip was tightened [s]. Raises FingertipError.
    """
    scene = simulation.scene
    design = simulation.design
    raise_issues(FingertipError, find_grip_issues(detector, simulation))
    assert isinstance(scene, ManipulationFile)
    result, decisions = _close_loop(
        design,
        scene=scene,
        detector=detector,
        seed=simulation.seed,
        progress=progress,
    )

    return result, tuple(decision.time_s for decision in decisions if decision.tightened)


def _close_loop(
    design: Design,
    scene: ManipulationFile,
    detector: str,
    seed: int,
    progress: Callable[[str], None] | None = None,
) -> tuple[ManipulationResult, Sequence[GripDecision]]:
    """Run a manipulation with a grip controller, and add the outputs that the controller reads."""
    needed = ["voltage_v", *select_board_outputs(design, [detector])]
    missing = [name for name in needed if name not in scene.outputs]
    scene = scene.model_copy(update={"outputs": [*scene.outputs, *missing]})
    controller = GripController(design, GripSettings(detector), len(scene.fingers))

    return run_manipulation(design, scene, controller, seed, progress), controller.decisions


@dataclass(frozen=True)
class ClosedLoopTrial:
    """Result of one manipulation with one detector in the loop, or without control."""

    detector: str
    name: str
    seed: int
    held: bool
    onset_s: float | None
    """First true slip of any finger after the pin touches the object [s]; None without one."""
    reaction_s: float | None
    """Time from the onset until a finger moves [s]; None: none moved."""
    false_grips: int
    """Number of grip increases without true slip just before."""
    suppressed: int
    """Number of suppressed detections without true slip; consecutive periods count once."""
    suppressed_true: int
    """Number of such detections in true slip before any grip increase."""
    slipped_m: float
    """Distance that the object slips past any finger [m]."""
    force_ratio: float
    """Mean force of the fingers at the end, over the planned one; NaN if the object was lost."""


def run_closed_loop(
    design: Design, detectors: Sequence[str], repeats: int, uncontrolled: bool = True
) -> list[ClosedLoopTrial]:
    """Run every manipulation with each detector, and first without control if `uncontrolled`."""
    names = [NO_CONTROL, *detectors] if uncontrolled else detectors
    runs = itertools.product(names, plan_manipulations(repeats, FIRST_SEED))
    return list(
        call_each(partial(_run_trial, design, name, scene, seed) for name, (scene, seed) in runs)
    )


def _run_trial(
    design: Design, detector: str, scene: ManipulationFile, seed: int
) -> ClosedLoopTrial:
    if detector == NO_CONTROL:
        return evaluate_manipulation(detector, run_manipulation(design, scene, None, seed), ())

    return evaluate_manipulation(detector, *_close_loop(design, scene, detector, seed))


def plan_manipulations(repeats: int, first_seed: int) -> Iterator[tuple[ManipulationFile, int]]:
    """Yield the article's manipulations with their seeds, each so many times."""
    for i, (scene, seed) in enumerate(article_manipulations(first_seed)):
        if i % REPEATS_PER_MANIPULATION < repeats:
            yield scene.model_copy(update={"outputs": _OUTPUTS}), seed


def evaluate_manipulation(
    detector: str, manipulation: ManipulationResult, decisions: Sequence[GripDecision]
) -> ClosedLoopTrial:
    """Compare the decisions of the grip controller with the true slip of a manipulation."""
    time_s = manipulation.time_s
    slip = np.logical_or.reduce(manipulation.output("slip"), axis=0)
    onset_s, reaction_s = _find_reaction(manipulation, slip)

    def is_true(at_s: float) -> bool:
        recent = (time_s > at_s - MAX_SINCE_SLIP_S) & (time_s <= at_s + INCIPIENT_S)
        return bool(slip[recent].any())

    grips = [decision.time_s for decision in decisions if decision.tightened]
    suppressed = _list_suppressed_s(decisions)
    suppressed_true = [
        at for at in suppressed if is_true(at) and not any(grip < at for grip in grips)
    ]
    return ClosedLoopTrial(
        detector=detector,
        name=manipulation.scene.name,
        seed=manipulation.seed,
        held=manipulation.lost_s is None,
        onset_s=onset_s,
        reaction_s=reaction_s,
        false_grips=sum(not is_true(at) for at in grips),
        suppressed=sum(not is_true(at) for at in suppressed),
        suppressed_true=len(suppressed_true),
        slipped_m=float(np.abs(np.diff(manipulation.signals.object_m))[slip[1:]].sum()),
        force_ratio=_find_force_ratio(manipulation),
    )


def _find_reaction(
    manipulation: ManipulationResult, slip: NDArray[np.bool_]
) -> tuple[float | None, float | None]:
    """Find the first slip after the knock [s], and the time from it until a finger moves [s]."""
    time_s = manipulation.time_s
    slipping = np.flatnonzero(slip & (time_s >= manipulation.plan.knock_s))
    if not slipping.size:
        return None, None

    first = int(slipping[0])
    onset_s = float(time_s[first])
    closing = manipulation.signals.closing_m
    further = (closing[:, first:] - closing[:, first : first + 1]).max(axis=0)
    moved = np.flatnonzero(further > REACTION_M)
    return onset_s, float(time_s[first + moved[0]]) - onset_s if moved.size else None


def _list_suppressed_s(decisions: Sequence[GripDecision]) -> list[float]:
    """List when detections began to be suppressed [s]; consecutive ones count once."""
    times_s = []
    was_suppressed = False

    for decision in decisions:
        is_suppressed = decision.detected and decision.suppressed
        if is_suppressed and not was_suppressed:
            times_s.append(decision.time_s)

        was_suppressed = is_suppressed

    return times_s


def _find_force_ratio(manipulation: ManipulationResult) -> float:
    """Find the mean force at the end over the planned one; NaN if the object was lost."""
    if manipulation.lost_s is not None:
        return math.nan

    is_last = manipulation.time_s > manipulation.time_s[-1] - _END_S
    mean_n = manipulation.output("force_n")[:, is_last].mean(axis=1)
    return float(np.mean(mean_n / manipulation.plan.force_n))


@dataclass(frozen=True)
class ClosedLoopSummary:
    """Pooled results of all manipulations with one detector."""

    detector: str
    count: int
    held: int
    slipped: int
    reactions_s: tuple[float, ...]
    """Reaction times where the object slipped and the hand moved, in ascending order [s]."""
    unanswered: int
    """Number of slips after which no finger moved."""
    false_grips: int
    suppressed: int
    suppressed_true: int
    slipped_m: float
    """Median distance that the objects slip [m]."""
    force_ratio: float
    """Mean force at the end over the planned one, where the object is held; NaN if none is."""


def summarise(trials: Sequence[ClosedLoopTrial]) -> list[ClosedLoopSummary]:
    """Pool the trials of each detector."""
    groups: dict[str, list[ClosedLoopTrial]] = {}
    for trial in trials:
        groups.setdefault(trial.detector, []).append(trial)

    return [_summarise_group(detector, group) for detector, group in groups.items()]


def _summarise_group(detector: str, group: Sequence[ClosedLoopTrial]) -> ClosedLoopSummary:
    slipped = [trial for trial in group if trial.onset_s is not None]
    reactions_s = tuple(
        sorted(trial.reaction_s for trial in slipped if trial.reaction_s is not None)
    )
    ratios = [trial.force_ratio for trial in group if trial.held]
    return ClosedLoopSummary(
        detector,
        count=len(group),
        held=len(ratios),
        slipped=len(slipped),
        reactions_s=reactions_s,
        unanswered=len(slipped) - len(reactions_s),
        false_grips=sum(trial.false_grips for trial in group),
        suppressed=sum(trial.suppressed for trial in group),
        suppressed_true=sum(trial.suppressed_true for trial in group),
        slipped_m=float(np.median([trial.slipped_m for trial in group])),
        force_ratio=float(np.mean(ratios)) if ratios else math.nan,
    )
