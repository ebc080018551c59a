"""The article's twelve manipulations (III.C) with a detector in the loop: four objects, three times each.

A robot's pin hits a grasped object at 8 cm/s. The results say whether the object is held, how soon the hand moves, and
whether the grip was ever tightened without slip. The same manipulations without control show what the detector adds.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.campaign.evaluate import select_board_outputs
from fingertip.campaign.grip import GripController, GripDecision, GripSettings
from fingertip.campaign.plan import HELD_OUT_FROM
from fingertip.design import Design
from fingertip.jit import compiled
from fingertip.sim import ManipulationFile, ManipulationResult, article_manipulations, run_manipulation
from fingertip.slip.intervals import INCIPIENT_S

FIRST_SEED = HELD_OUT_FROM + 1_000_000
"""Seed of the first manipulation; all of them are held out."""
NO_CONTROL = "no control"
"""Name that stands for a detector where there is no control."""
REACTION_M = 1e-4
"""Closing of a finger that counts as a reaction [m]. Assumption: well above an encoder's step."""
MAX_SINCE_SLIP_S = 0.15
"""Longest time since true slip for which a grip increase is justified [s]: the detectors' memory and one control
period. Assumption."""
_OUTPUTS = ["voltage_v", "force_n", "slip", "closing_m", "object_m"]
"""Outputs of every manipulation; the board's envelope is added where the detector reads it."""


@dataclass(frozen=True, eq=False)
class ClosedLoopTrial:
    """Result of one manipulation with one detector in the loop, or without control."""

    detector: str
    name: str
    """Name of the object."""
    seed: int
    held: bool
    onset_s: float | None
    """First true slip of any finger after the pin touches the object [s]; None: it never slipped."""
    reaction_s: float | None
    """Time from the onset until a finger moves [s]; None: none moved."""
    grips: int
    """Number of grip increases."""
    false_grips: int
    """Number of grip increases without true slip just before."""
    suppressed: int
    """Number of suppressed detections without true slip; consecutive periods count once."""
    suppressed_true: int
    """Number of suppressed detections in true slip before any grip increase; consecutive periods count once."""
    manipulation: ManipulationResult
    decisions: tuple[GripDecision, ...]


def run_closed_loop(
    design: Design,
    detectors: Sequence[str] = ("analog", "fast"),
    repeats: int = 3,
    first_seed: int = FIRST_SEED,
    uncontrolled: bool = True,
) -> list[ClosedLoopTrial]:
    """Run every manipulation without control, unless `uncontrolled` is false, then with each detector."""
    trials = []
    with compiled():
        for detector in (*((NO_CONTROL,) if uncontrolled else ()), *detectors):
            for scene, seed in plan_manipulations(repeats, first_seed):
                controller = None
                if detector != NO_CONTROL:
                    sampled = select_board_outputs(design, [detector])
                    scene = scene.model_copy(update={"outputs": [*_OUTPUTS, *sampled]})
                    controller = GripController(design, GripSettings(detector), len(scene.fingers))
                manipulation = run_manipulation(design, scene, controller, seed)
                trials.append(evaluate_manipulation(detector, manipulation, controller.decisions if controller else ()))
    return trials


def plan_manipulations(repeats: int, first_seed: int) -> Iterator[tuple[ManipulationFile, int]]:
    """Scene and seed of the manipulations, `repeats` times for each object."""
    counts: dict[str, int] = {}
    for scene, seed in article_manipulations(first_seed):
        counts[scene.name] = counts.get(scene.name, 0) + 1
        if counts[scene.name] <= repeats:
            yield scene.model_copy(update={"outputs": _OUTPUTS}), seed


def evaluate_manipulation(
    detector: str, manipulation: ManipulationResult, decisions: Sequence[GripDecision]
) -> ClosedLoopTrial:
    """Evaluate one manipulation against the true slip."""
    time_s, closing = manipulation.time_s, manipulation.signals.closing_m
    slip = any_finger_slips(manipulation)
    slipping = np.flatnonzero(slip & (time_s >= manipulation.plan.knock_s))
    onset_s = reaction_s = None
    if slipping.size:
        first = int(slipping[0])
        onset_s = float(time_s[first])
        further = (closing[:, first:] - closing[:, first : first + 1]).max(axis=0)
        moved = np.flatnonzero(further > REACTION_M)
        reaction_s = float(time_s[first + moved[0]]) - onset_s if moved.size else None

    def is_true(at_s: float) -> bool:
        recent = (time_s > at_s - MAX_SINCE_SLIP_S) & (time_s <= at_s + INCIPIENT_S)
        return bool(slip[recent].any())

    grips = [decision.time_s for decision in decisions if decision.tightened]
    suppressed = [
        decision.time_s
        for before, decision in zip((None, *decisions), decisions, strict=False)
        if decision.detected and decision.suppressed and not (before and before.detected and before.suppressed)
    ]
    suppressed_true = [at for at in suppressed if is_true(at) and not any(grip < at for grip in grips)]
    return ClosedLoopTrial(
        detector,
        manipulation.scene.name,
        manipulation.seed,
        manipulation.lost_s is None,
        onset_s,
        reaction_s,
        len(grips),
        sum(not is_true(at) for at in grips),
        sum(not is_true(at) for at in suppressed),
        len(suppressed_true),
        manipulation,
        tuple(decisions),
    )


def any_finger_slips(manipulation: ManipulationResult) -> NDArray[np.bool_]:
    """Return whether any finger slips, at each sample."""
    slipping: NDArray[np.bool_] = np.logical_or.reduce(manipulation.output("slip"), axis=0)
    return slipping


@dataclass(frozen=True)
class ClosedLoopSummary:
    """Pooled results of all manipulations with one detector."""

    detector: str
    count: int
    held: int
    slipped: int
    """Number of manipulations in which the object slipped."""
    reactions_s: tuple[float, ...]
    """Reaction times where the object slipped and the hand moved, in ascending order [s]."""
    unanswered: int
    """Number of slips after which no finger moved."""
    false_grips: int
    suppressed: int
    suppressed_true: int


def summarise(trials: Sequence[ClosedLoopTrial]) -> list[ClosedLoopSummary]:
    """Pool the results by detector."""
    summaries = []
    for detector in dict.fromkeys(trial.detector for trial in trials):
        group = [trial for trial in trials if trial.detector == detector]
        slipped = [trial for trial in group if trial.onset_s is not None]
        summaries.append(
            ClosedLoopSummary(
                detector,
                len(group),
                sum(trial.held for trial in group),
                len(slipped),
                tuple(sorted(trial.reaction_s for trial in slipped if trial.reaction_s is not None)),
                sum(trial.reaction_s is None for trial in slipped),
                sum(trial.false_grips for trial in group),
                sum(trial.suppressed for trial in group),
                sum(trial.suppressed_true for trial in group),
            )
        )
    return summaries
