"""Manipulation of a grasped object: a pin hits it, and the fingers hold or lose it, with or without a controller.

`run_manipulation` steps hand, contacts and sensors from one command to the next. The controller receives what a real
one would: sampled voltages and the closing of the motors (`fingertip.sim.Observation`), and nothing of the ground
truth. Any object with a method ``step`` is a controller. The caller provides detectors and grip laws; this package
knows none.

Simplifications, all of them assumptions: The object is rigid, does not turn, and moves along one line. Along this line
it would slip, and its weight acts once the experimenter releases it. The palm carries no load in a power grasp. The
abduction of the thumb stays fixed, as in the article (IV.A). A finger is stiff along that line up to its pad. Vibration
does not act back on friction. Stiffness and resonance of a pad stay those at its planned holding force.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.design.issues import suggest_name
from fingertip.errors import Issue, TraceError
from fingertip.sim.contact.pad import Pad
from fingertip.sim.signal.comparator import describe_missing_comparator, simulate_pin_v
from fingertip.sim.hand.controller import Controller, Observation
from fingertip.sim.hand.manipulation_file import OUTPUTS, ManipulationFile
from fingertip.sim.hand.motion_plan import MotionPlan, plan_motion, thumb_force_n
from fingertip.sim.hand.stepper import ManipulationStepper
from fingertip.sim.stages.pipeline import LONG_S
from fingertip.sim.stages.stage import StageStats
from fingertip.sim.validation import raise_issues
from fingertip.slip.traces.trace import Trace


@dataclass(frozen=True, eq=False)
class ManipulationResult:
    """Recorded signals of a manipulation, and whether the object was held."""

    scene: ManipulationFile
    seed: int
    plan: MotionPlan
    """Moments and forces as drawn."""
    time_s: Array
    """Times of the samples [s]."""
    signals: dict[str, NDArray[Any]]
    """Signals by output, (fingers, samples). Those of the object, object_m and pin_n, are (samples,)."""
    lost_s: float | None
    """Moment at which the object left the fingers [s]. None: it was held to the end."""
    stages: tuple[StageStats, ...]
    """Stages that ran, with their cost."""

    @property
    def fingers(self) -> tuple[str, ...]:
        """Names of the fingers that touch, the thumb first."""
        return self.scene.fingers

    @property
    def force_n(self) -> float:
        """Planned holding force of the thumb [N]."""
        return float(self.plan.force_n[0])

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """Outputs as columns. Those of thumb and object have the plain names, others are called like index_force_n."""
        found = {}
        for name in self.scene.outputs:
            signal = self.signals[name]
            found[name] = signal if signal.ndim == 1 else signal[0]
        for i, finger in list(enumerate(self.fingers))[1:]:
            renamed = {f"{finger}_{name}": self.signals[name] for name in self.scene.outputs}
            found |= {name: signal[i] for name, signal in renamed.items() if signal.ndim == 2}
        return found

    def trace(self, finger: str = "thumb") -> Trace:
        """Return the trace of one finger for a detector: voltage, and the true force and slip.

        Raises
        ------
        TraceError
            If the finger does not touch, or the voltage is not among the outputs of the scene.
        """
        if finger not in self.fingers:
            raise TraceError(Issue("finger", f"{finger!r} does not touch; {suggest_name(finger, self.fingers)}"))
        if "voltage_v" not in self.signals:
            raise TraceError(Issue("outputs", "does not name voltage_v; a trace needs it."))
        i = self.fingers.index(finger)
        signals = {name: signal[i] for name, signal in self.signals.items() if signal.ndim == 2}
        return Trace(self.time_s, signals["voltage_v"], signals.get("force_n"), signals.get("slip"))


def run_manipulation(
    design: Design,
    scene: ManipulationFile,
    controller: Controller | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> ManipulationResult:
    """Simulate a manipulation.

    Parameters
    ----------
    design
        Gives the shape of the pads, the board, the ADC and its noise. All fingers are alike.
    scene
        Object, grasp, knock and hand, and the outputs to record.
    controller
        Controller that closes the loop. None keeps the planned grip.
    seed
        Seed of grip, friction, surfaces and noise. The same design, scene, seed and commands give the same columns.
    progress
        Receives progress messages, for scenes longer than `LONG_S`.

    Raises
    ------
    TraceError
        If the seed is negative, the plan needs more force than a finger can press with, the board of this design has no
        such output, or a command of the controller is not valid.
    """
    pad = Pad.from_design(design)
    raise_issues(_find_issues(design, scene, seed))
    plan = plan_motion(scene, pad, seed)
    if progress and plan.duration_s > LONG_S:
        progress(f"{scene.name}, {plan.duration_s:.1f} s")
    outputs = frozenset(scene.outputs) | ({"voltage_v"} if controller else set())
    stepper = ManipulationStepper(design, scene, plan, pad, seed, outputs)
    rate = design.detector.sample_rate_hz
    count = math.ceil(plan.duration_s * rate)
    period, delay = max(1, round(scene.hand.period_s * rate)), round(scene.hand.delay_s * rate)
    starts = range(0, count, period)
    if controller is None:
        # No controller needs intermediate values, so one step covers the whole duration.
        commands = plan.planned_m(np.array(starts) / rate)
        stepper.advance(_delay_commands(commands, 0, count, period, delay))
    else:
        commands = np.zeros((len(scene.fingers), len(starts)))
        for i, start in enumerate(starts):
            planned = plan.planned_m(np.array([start / rate]))[:, 0]
            assert stepper.samples
            voltage, envelope = stepper.samples.voltage_v, stepper.samples.envelope_v
            closing = stepper.motors.closing_m
            observation = Observation(start / rate, voltage.copy(), closing.copy(), planned, envelope)
            commands[:, i] = _validate_command(controller.step(observation), start / rate, len(scene.fingers))
            stepper.advance(_delay_commands(commands, start, min(start + period, count), period, delay))
    return _collect_result(stepper, count)


def _delay_commands(commands: Array, start: int, end: int, period: int, delay: int) -> Array:
    """Command in force before each sample after `start`. Command i is given at i * period and takes `delay` samples."""
    latest = (np.arange(start, end) - delay) // period
    return np.where(latest >= 0, commands[:, np.maximum(latest, 0)], 0.0)


def _validate_command(command: Array, time_s: float, count: int) -> Array:
    command = np.asarray(command, dtype=np.float64)
    if command.shape != (count,):
        message = f"returned shape {command.shape} at {time_s:g} s; must be ({count},); return one closing per finger."
        raise TraceError(Issue("controller", message))
    if not np.isfinite(command).all():
        bad = int(np.flatnonzero(~np.isfinite(command))[0])
        message = f"returned {command[bad]} for finger {bad} at {time_s:g} s; return finite closings [m]."
        raise TraceError(Issue("controller", message))
    return command


def _collect_result(stepper: ManipulationStepper, count: int) -> ManipulationResult:
    design, scene = stepper.design, stepper.scene
    signals: dict[str, NDArray[Any]] = {
        name: np.concatenate(chunks, axis=-1) for name, chunks in stepper.chunks.items()
    }
    step = 1 / design.detector.sample_rate_hz
    time_s = np.arange(count + 1, dtype=np.float64) * step
    if "slip_pin_v" in scene.outputs:
        board_outputs = zip(signals["filtered_v"], signals["envelope_v"], strict=True)
        signals["slip_pin_v"] = np.stack([simulate_pin_v(design, step, *outputs) for outputs in board_outputs])
    beyond = np.flatnonzero(signals["object_m"] >= scene.object.length_m)
    lost_s = float(time_s[beyond[0]]) if stepper.is_lost else None
    if "force_n" not in scene.outputs:
        signals.pop("force_n")
    signals = {name: signals[name] for name in OUTPUTS if name in signals}
    stages = tuple(stepper.stats.values())
    return ManipulationResult(scene, stepper.seed, stepper.plan, time_s, signals, lost_s, stages)


def _find_issues(design: Design, scene: ManipulationFile, seed: int) -> list[Issue]:
    issues = []
    if seed < 0:
        issues.append(Issue("--seed", f"{seed} is negative; choose a whole number of at least 0."))
    needed, available = thumb_force_n(scene, scene.grasp.max_margin), scene.hand.max_force_n
    if needed > available:
        message = (
            f"{available:g} N is less than the thumb needs for {scene.object.mass_kg:g} kg; at least {needed:g} N."
        )
        issues.append(Issue("hand.max_force_n", message))
    if "slip_pin_v" in scene.outputs and design.board.variant != "comparator":
        issues.append(Issue("outputs", describe_missing_comparator(design)))
    return issues
