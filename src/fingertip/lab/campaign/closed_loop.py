"""Closed loop of the article (III.C, figures 16 and 17): a grip that tightens when slip is detected.

The controller sees what a real one would see (`fingertip.sim.Observation`): sampled voltages and the fingers' closing.
Each finger has a detector, and the design's bridge converts its voltage back to a force. A detection is suppressed
while the forces grow fast, "assuming that, when the forces are growing, slippage occurrence cannot happen" (IV.A). This
suppresses contacts, and the vibration of the hand's own motors while they close. A detection that is not suppressed
makes every finger close further, by what its pad needs to press harder by a fixed ratio. Then the controller ignores
detections until motors and detectors have settled.

In the article's twelve manipulations, four objects three times each, a robot's pin hits a grasped object at 8 cm/s. The
results say whether the object is held, how soon the hand moves, and whether the grip was ever tightened without slip.
The same manipulations without control show what the detector adds.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, Issue, gather
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Array
from fingertip.lab.campaign.plan import HELD_OUT_FROM
from fingertip.lab.campaign.run import select_board_outputs
from fingertip.pad.response import Pad
from fingertip.sim import (
    ManipulationFile,
    ManipulationResult,
    Observation,
    Simulation,
    article_manipulations,
    run_manipulation,
)
from fingertip.sim.signal.bridge import reads_whole_finger
from fingertip.sim.signal.converter import compute_bridge_v
from fingertip.sim.simulation import REPEATS_PER_MANIPULATION
from fingertip.slip import DETECTORS, make_detector
from fingertip.slip.detectors.registry import find_detector_type, select_inputs
from fingertip.slip.traces.truth import INCIPIENT_S

_MIN_PRESENT_N = 0.1
"""Smallest present force that the force ratio is applied to [N]: with a smaller one a finger would hardly close."""
FIRST_SEED = HELD_OUT_FROM + 1_000_000
"""Seed of the first manipulation; all of them are held out."""
NO_CONTROL = "no control"
REACTION_M = 1e-4
"""Closing of a finger that counts as a reaction [m]. Assumption: well above an encoder's step."""
MAX_SINCE_SLIP_S = 0.15
"""Longest time since true slip for which a grip increase is justified [s]. Assumption: a detector's memory."""
_OUTPUTS = ["voltage_v", "force_n", "slip", "closing_m", "object_m"]
"""Outputs of every manipulation; the board's envelope is added where the detector reads it."""
_END_S = 0.2
"""Time at the end over which the force is averaged [s]."""
_TABLE_N = np.concatenate((np.linspace(0.0, 2.0, 401), np.linspace(2.05, 20.0, 360)))


@dataclass(frozen=True)
class GripSettings:
    """Settings of the grip law. Times and ratios were chosen on the tuning seeds of `fingertip.lab.campaign.plan`."""

    detector: str = "fast"
    threshold_scale: float = 1.0
    """Factor of the detector's threshold."""
    max_growth_n_s: float = 8.0
    """Growth of a finger's force above which detections are suppressed [N/s]: more than vibration appears to cause."""
    growth_window_s: float = 0.1
    max_closing_m_s: float = 0.005
    """Closing speed above which detections are suppressed [m/s]: the force grows with it, the motor vibrates."""
    suppression_s: float = 0.1
    """Time for which detections remain suppressed after growth or closing [s]: detectors have a memory."""
    force_ratio: float = 1.6
    """Factor by which every finger's force is increased at a detection."""
    refractory_s: float = 0.06
    """Time after an increase in which no other one follows [s]: until then the motors have begun to move."""
    max_force_n: float = 10.0


@dataclass(frozen=True)
class GripDecision:
    time_s: float
    detected: bool
    """True if any finger's detector was ON in the period."""
    suppressed: bool
    """True if a detection was, or would have been, suppressed."""
    tightened: bool
    """True if the fingers were commanded to close further."""


class GripController:
    def __init__(self, design: Design, settings: GripSettings, fingers: int) -> None:
        self.settings = settings
        self.decisions: list[GripDecision] = []
        self._pad = Pad.from_design(design)
        self._detectors = [
            make_detector(settings.detector, design, threshold_scale=settings.threshold_scale) for _ in range(fingers)
        ]
        # The hand knows what part of a grip's force its sensors feel.
        volts = compute_bridge_v(design, self._pad.sensed_n(_TABLE_N, None, reads_whole_finger(design, "board")))
        order = np.argsort(volts)
        self._volts, self._forces = volts[order], _TABLE_N[order]
        self._history: deque[tuple[float, Array]] = deque()
        self._last_growth_s = -math.inf
        self._tightened_s = -math.inf
        self._added_m = np.zeros(fingers)

    def step(self, observation: Observation) -> Array:
        """Return the commanded closing [m]: the planned closing, and what detections have added to it."""
        s, now = self.settings, observation.time_s
        samples = select_inputs(observation, s.detector)
        assert samples, f"the scene's outputs do not include {DETECTORS[s.detector].input_column}"
        detected = self._detect(samples)
        # Growth of force and closing over the window.
        force = np.array([float(np.interp(v.mean(), self._volts, self._forces)) for v in observation.voltage_v])
        self._history.append((now, np.array([force, observation.closing_m])))
        while self._history[0][0] < now - s.growth_window_s - 1e-9:
            self._history.popleft()
        then, before = self._history[0]
        growth_n_s, closing_m_s = (np.array([force, observation.closing_m]) - before) / max(now - then, 1e-9)
        if float(np.max(growth_n_s)) > s.max_growth_n_s or float(np.max(closing_m_s)) > s.max_closing_m_s:
            self._last_growth_s = now
        refractory = now < self._tightened_s + s.refractory_s
        suppressed = now <= self._last_growth_s + s.suppression_s
        tightened = detected and not suppressed and not refractory
        if tightened:
            self._tightened_s = now
            self._added_m += [self._further_m(f) for f in force]
        self.decisions.append(GripDecision(now, detected, suppressed, tightened))
        return np.asarray(observation.planned_m + self._added_m)

    def _further_m(self, force_n: float) -> float:
        """Closing that increases a finger's force by the ratio [m]."""
        present_n = max(force_n, _MIN_PRESENT_N)
        target_n = min(present_n * self.settings.force_ratio, self.settings.max_force_n)
        return self._pad.depth_m(target_n) - self._pad.depth_m(present_n)

    def _detect(self, samples: tuple[Array, ...]) -> bool:
        """Process the new samples of all fingers; return whether any detector was ON at any of them."""
        # Every detector must process every sample, even if the first one is already ON.
        on = [bool(detector.process(*rows).on.any()) for detector, *rows in zip(self._detectors, *samples, strict=True)]
        return any(on)


def find_grip_issues(detector: str, simulation: Simulation | None) -> list[Issue]:
    """Report an unknown detector, and a simulation without a hand. None stands for a simulation that did not load."""
    issues: list[Issue] = []
    if simulation and not isinstance(simulation.scene, ManipulationFile):
        remedy = "give a manipulation, such as real_manipulation"
        issues.append(Issue("--grip", f"closes the loop of a hand; {remedy}."))
    with gather(issues):
        find_detector_type(detector, "--grip")
    return issues


def run_with_grip(
    simulation: Simulation, detector: str = "fast", progress: Callable[[str], None] | None = None
) -> tuple[ManipulationResult, tuple[float, ...]]:
    """Tighten the grip whenever a detector finds slip; also return the moments [s]. Raises FingertipError."""
    scene, design = simulation.scene, simulation.design
    if issues := find_grip_issues(detector, simulation):
        raise FingertipError(issues)
    assert isinstance(scene, ManipulationFile)
    needed = ["voltage_v", *select_board_outputs(design, [detector])]
    missing = [name for name in needed if name not in scene.outputs]
    scene = scene.model_copy(update={"outputs": [*scene.outputs, *missing]})
    controller = GripController(design, GripSettings(detector), len(scene.fingers))
    result = run_manipulation(design, scene, controller, simulation.seed, progress)
    return result, tuple(decision.time_s for decision in controller.decisions if decision.tightened)


@dataclass(frozen=True, eq=False)
class ClosedLoopTrial:
    """Result of one manipulation with one detector in the loop, or without control."""

    detector: str
    name: str
    seed: int
    held: bool
    onset_s: float | None
    """First true slip of any finger after the pin touches the object [s]; None: it never slipped."""
    reaction_s: float | None
    """Time from the onset until a finger moves [s]; None: none moved."""
    grips: int
    false_grips: int
    """Number of grip increases without true slip just before."""
    suppressed: int
    """Number of suppressed detections without true slip; consecutive periods count once."""
    suppressed_true: int
    """Number of suppressed detections in true slip before any grip increase; consecutive periods count once."""
    slipped_m: float
    """Way of the object while it slips past any finger [m]."""
    force_ratio: float
    """Mean force of the fingers at the end, over the planned one; NaN if the object was lost."""
    manipulation: ManipulationResult
    decisions: tuple[GripDecision, ...]


def run_closed_loop(
    design: Design, detectors: Sequence[str], repeats: int, uncontrolled: bool = True
) -> list[ClosedLoopTrial]:
    """Run every manipulation without control, unless `uncontrolled` is false, then with each detector."""
    trials = []
    with compiled():
        for detector in (*((NO_CONTROL,) if uncontrolled else ()), *detectors):
            for scene, seed in plan_manipulations(repeats, FIRST_SEED):
                controller = None
                if detector != NO_CONTROL:
                    sampled = select_board_outputs(design, [detector])
                    scene = scene.model_copy(update={"outputs": [*_OUTPUTS, *sampled]})
                    controller = GripController(design, GripSettings(detector), len(scene.fingers))
                manipulation = run_manipulation(design, scene, controller, seed)
                trials.append(evaluate_manipulation(detector, manipulation, controller.decisions if controller else ()))
    return trials


def plan_manipulations(repeats: int, first_seed: int) -> Iterator[tuple[ManipulationFile, int]]:
    for i, (scene, seed) in enumerate(article_manipulations(first_seed)):
        if i % REPEATS_PER_MANIPULATION < repeats:
            yield scene.model_copy(update={"outputs": _OUTPUTS}), seed


def evaluate_manipulation(
    detector: str, manipulation: ManipulationResult, decisions: Sequence[GripDecision]
) -> ClosedLoopTrial:
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
        float(np.abs(np.diff(manipulation.signals.object_m))[slip[1:]].sum()),
        _find_force_ratio(manipulation),
        manipulation,
        tuple(decisions),
    )


def _find_force_ratio(manipulation: ManipulationResult) -> float:
    if manipulation.lost_s is not None:
        return math.nan
    last = manipulation.time_s > manipulation.time_s[-1] - _END_S
    return float(np.mean(manipulation.output("force_n")[:, last].mean(axis=1) / manipulation.plan.force_n))


def any_finger_slips(manipulation: ManipulationResult) -> NDArray[np.bool_]:
    return np.asarray(np.logical_or.reduce(manipulation.output("slip"), axis=0), dtype=np.bool_)


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
    """Median way that the objects slip [m]."""
    force_ratio: float
    """Mean force at the end over the planned one, of those held; NaN if none is."""


def summarise(trials: Sequence[ClosedLoopTrial]) -> list[ClosedLoopSummary]:
    groups: dict[str, list[ClosedLoopTrial]] = {}
    for trial in trials:
        groups.setdefault(trial.detector, []).append(trial)
    return [_summarise_group(detector, group) for detector, group in groups.items()]


def _summarise_group(detector: str, group: Sequence[ClosedLoopTrial]) -> ClosedLoopSummary:
    slipped = [trial for trial in group if trial.onset_s is not None]
    reactions_s = tuple(sorted(trial.reaction_s for trial in slipped if trial.reaction_s is not None))
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
