"""Manipulation of a grasped object: a pin hits it, and the fingers hold or lose it, with or without
a controller.

`run_manipulation` steps hand, contacts and sensors from one command to the next. The controller
receives what a real one would, the `Observation` of `manipulation_plan`: sampled voltages and the
closing of the motors, and nothing of the ground truth. Any object with a method ``step`` is a
controller. The caller provides detectors and grip laws; this package knows none.

Simplifications, all of them assumptions: The object does not turn, and moves along one line. Along
this line it would slip, and its weight acts once the experimenter releases it; a pin that is
attached bears it. Walls that yield (`object.stiffness_n_per_m`) change closing and grip only. The
palm carries no load in a power grasp. The abduction of the thumb stays fixed, as in the article
(IV.A). A finger is stiff along that line up to its pad. Vibration does not act back on friction.
Stiffness and resonance of a pad stay those at its planned holding force.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.design.parameters.declaration import find_bounds, suggest_name
from fingertip.foundation.errors import Issue, TraceError, checked, raise_issues
from fingertip.foundation.numerics import Array
from fingertip.foundation.validation import round_down, round_up
from fingertip.pad.response import Pad
from fingertip.sim.runs.manipulation_plan import (
    Controller,
    MotionPlan,
    Observation,
    delay_commands,
    plan_motion,
    thumb_force_n,
)
from fingertip.sim.runs.scene_and_manipulation_files import GraspedObject, Hand, ManipulationFile
from fingertip.sim.runs.stepper import HandSignals, ManipulationStepper
from fingertip.sim.signal.grid import CostMeter, Grid, StageCost, report_share
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import Interval, Origin, intervals

MAX_CLOSING_M = 0.5
"""Largest closing that a controller may command, of either sign [m].
No finger closes so far: 30 means millimetres.
"""
CHUNK = 8192
"""Number of points that are computed at a time without a controller."""


@dataclass(frozen=True, eq=False)
class ManipulationResult:
    """Recorded signals of a manipulation, and whether the object was held."""

    scene: ManipulationFile
    seed: int
    plan: MotionPlan
    """Moments and forces as drawn."""
    signals: HandSignals
    lost_s: float | None
    """Moment at which the object left the fingers [s]. None: it was held to the end."""
    stages: tuple[StageCost, ...]
    step_s: float
    """Step of the grid on which it was computed [s]."""

    @property
    def time_s(self) -> Array:
        return self.signals.time_s

    @property
    def fingers(self) -> tuple[str, ...]:
        """Names of the fingers that touch, the thumb first."""
        return self.scene.fingers

    @property
    def force_n(self) -> float:
        """Planned holding force of the thumb [N]."""
        return float(self.plan.force_n[0])

    @property
    def samples(self) -> int:
        return len(self.time_s)

    @property
    def sample_rate_hz(self) -> float:
        return (self.samples - 1) / self.duration_s

    @property
    def duration_s(self) -> float:
        """Time of the last sample [s]."""
        return float(self.time_s[-1])

    @property
    def slips(self) -> tuple[Interval, ...]:
        """True slips of the thumb; empty if the scene does not record them."""
        slip = self.signals.fingers[0].slip
        return () if slip is None else intervals(self.time_s, slip)

    @property
    def out_of_contact_share(self) -> float:
        """Share of the fingers' true slip in which their pads do not touch.

        0 if it is not recorded.
        """
        slip = self.signals.find("slip")
        force_n = self.signals.find("force_n")
        return (
            0.0
            if slip is None or force_n is None or not slip.any()
            else float(np.mean(force_n[slip] <= 0.0))
        )

    @property
    def clip_share(self) -> float | None:
        """Share of the fingers' true slip in which their boards clip.

        None if it is not recorded.
        """
        slip = self.signals.find("slip")
        clips = self.signals.find("clips")
        return (
            None if slip is None or clips is None or not slip.any() else float(np.mean(clips[slip]))
        )

    def output(self, name: str) -> NDArray[Any]:
        """Return an output of the scene: (fingers, samples), or (samples,) for the object's."""
        signal = self.signals.find(name)
        assert signal is not None
        return signal

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """Outputs as columns.

        Those of thumb and object have the plain names, others are called like index_force_n.
        """
        outputs = {name: self.output(name) for name in self.scene.outputs}
        columns_by_name = {
            name: signal if signal.ndim == 1 else signal[0] for name, signal in outputs.items()
        }

        for i, finger in list(enumerate(self.fingers))[1:]:
            columns_by_name |= {
                f"{finger}_{name}": signal[i]
                for name, signal in outputs.items()
                if signal.ndim == 2
            }

        return columns_by_name

    def trace(self, finger: str = "thumb") -> Trace:
        """Return the trace of one finger for a detector: voltage, and the true force and slip.

        Raises TraceError.
        """
        if finger not in self.fingers:
            raise TraceError(
                Issue("finger", f"{finger!r} does not touch; {suggest_name(finger, self.fingers)}")
            )

        signals = self.signals.fingers[self.fingers.index(finger)]
        if signals.voltage_v is None:
            raise TraceError(Issue("outputs", "does not name voltage_v; a trace needs it."))

        return Trace(
            self.time_s,
            signals.voltage_v,
            signals.force_n,
            signals.slip,
            filtered_v=signals.sampled_filtered_v,
            origin=Origin(is_simulated=True),
        )


@checked
def run_manipulation(
    design: Design,
    scene: ManipulationFile,
    controller: Controller | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
    grid: Grid | None = None,
) -> ManipulationResult:
    """Simulate a manipulation.

    The design gives the shape of the pads, the board, the ADC and its noise; all fingers are alike.
    The controller closes the loop; None keeps the planned grip. The seed is that of grip, friction,
    surfaces and noise: the same design, scene, seed and commands give the same columns. `progress`
    and `grid` are as for `run_scene`.

    Raises TraceError if the seed is negative, the plan needs more force than a finger can press
    with, the board of this design has no such output, or a command of the controller is not valid.
    """
    if controller is not None and not hasattr(controller, "step"):
        message = (
            f"is {controller!r:.60}, which has no method step; see "
            "fingertip.sim.runs.manipulation_plan.Controller, or leave it out."
        )
        raise TraceError(Issue("controller", message))

    outputs = frozenset(scene.outputs) | ({"voltage_v"} if controller else set())
    if controller and "envelope_v" in outputs:
        outputs |= {"sampled_envelope_v"}

    stepper = start_manipulation(
        design,
        scene=scene,
        seed=seed,
        outputs=outputs,
        grid=grid,
        meter=CostMeter(),
    )
    done = report_share(scene.name, stepper.plan.duration_s, progress)
    ends = (
        advance_as_planned(stepper) if controller is None else _advance_in_loop(stepper, controller)
    )
    for end in ends:
        done(end / stepper.grid.rate_hz)

    signals = HandSignals.join(stepper.chunks)
    beyond = np.flatnonzero(signals.object_m >= scene.object.length_m)
    lost_s = float(signals.time_s[beyond[0]]) if stepper.is_lost and len(beyond) else None
    return ManipulationResult(
        scene=scene,
        seed=seed,
        plan=stepper.plan,
        signals=signals,
        lost_s=lost_s,
        stages=stepper.meter.costs,
        step_s=stepper.grid.step_s,
    )


def start_manipulation(
    design: Design,
    scene: ManipulationFile,
    seed: int,
    outputs: frozenset[str],
    grid: Grid | None,
    meter: CostMeter,
) -> ManipulationStepper:
    raise_issues(TraceError, _find_issues(design, scene, seed))
    pad = Pad.from_design(design)
    plan = plan_motion(design, scene, pad, seed)
    return ManipulationStepper(
        design=design,
        scene=scene,
        plan=plan,
        pad=pad,
        seed=seed,
        outputs=outputs,
        grid=grid or Grid(),
        meter=meter,
    )


def advance_as_planned(stepper: ManipulationStepper, chunk: int = CHUNK) -> Iterator[int]:
    """Advance with the planned grip, chunk by chunk; yield the number of points computed so far."""
    count = stepper.point_count
    rate_hz = stepper.grid.rate_hz
    period, delay = stepper.scene.hand.count_points(rate_hz)
    commands = stepper.plan.planned_m(np.arange(0, count, period) / rate_hz)

    # No controller needs intermediate values, so a chunk may be long.
    for start in range(0, count, chunk):
        end = min(start + chunk, count)
        stepper.advance(
            delay_commands(
                commands,
                start=start,
                end=end,
                period=period,
                delay=delay,
            )
        )
        yield end


def _advance_in_loop(stepper: ManipulationStepper, controller: Controller) -> Iterator[int]:
    """Advance with the commands of a controller; yield the number of points computed so far."""
    rate_hz = stepper.grid.rate_hz
    count = stepper.point_count
    fingers = len(stepper.scene.fingers)
    period, delay = stepper.scene.hand.count_points(rate_hz)
    starts = range(0, count, period)
    planned = stepper.plan.planned_m(np.array(starts) / rate_hz)
    commands = planned.copy()
    commanded = 0
    known = 0

    # A command acts after its delay. What happens until then is known, and is computed in one
    # chunk.
    while commanded < len(starts):
        while commanded < len(starts) and starts[commanded] <= known:
            command = controller.step(
                _observe(stepper, starts[commanded], period, planned[:, commanded])
            )
            commands[:, commanded] = _validate_command(
                command, starts[commanded] / rate_hz, fingers
            )
            commanded += 1

        end = min((commanded + delay // period) * period, count)
        if end > known:
            stepper.advance(
                delay_commands(
                    commands,
                    start=known,
                    end=end,
                    period=period,
                    delay=delay,
                )
            )

        known = end
        yield known


def _observe(
    stepper: ManipulationStepper, point: int, period: int, planned_m: Array
) -> Observation:
    """Collect what a controller sees at a point of the last chunk: the samples since its last
    command.
    """
    window, closing_m = stepper.select_window(point, period)

    def find(name: str) -> Array | None:
        values = stepper.chunks[-1].find(name)
        return None if values is None else values[:, window]

    voltage_v = find("voltage_v")
    assert voltage_v is not None
    time_s = point / stepper.grid.rate_hz
    return Observation(
        time_s=time_s,
        voltage_v=voltage_v,
        closing_m=closing_m,
        planned_m=planned_m,
        envelope_v=find("sampled_envelope_v"),
        filtered_v=find("sampled_filtered_v"),
    )


def _validate_command(command: Array, time_s: float, count: int) -> Array:
    command = np.asarray(command, dtype=np.float64)
    if command.shape != (count,):
        message = (
            f"returned shape {command.shape} at {time_s:g} s; must be ({count},); return "
            "one closing per finger."
        )
        raise TraceError(Issue("controller", message))

    if not np.isfinite(command).all():
        bad = int(np.flatnonzero(~np.isfinite(command))[0])
        message = (
            f"returned {command[bad]} for finger {bad} at {time_s:g} s; return finite closings [m]."
        )
        raise TraceError(Issue("controller", message))

    if (np.abs(command) > MAX_CLOSING_M).any():
        bad = int(np.abs(command).argmax())
        problem = f"returned {command[bad]:g} m for finger {bad} at {time_s:g} s"
        message = f"{problem}; return closings in metres, at most {MAX_CLOSING_M:g} m."
        raise TraceError(Issue("controller", message))

    return command


def _find_issues(design: Design, scene: ManipulationFile, seed: int) -> list[Issue]:
    issues = []
    needed = thumb_force_n(scene, 1.0)
    available = scene.hand.max_force_n
    mass_kg = scene.object.mass_kg
    strongest = find_bounds(Hand.model_fields["max_force_n"]).maximum or math.inf
    max_kg = mass_kg * strongest / needed
    min_kg = find_bounds(GraspedObject.model_fields["mass_kg"]).minimum or 0.0

    if needed > strongest and max_kg < min_kg:
        friction = scene.complete().surface.friction
        mu_s, mu_c = (round_up(mu * min_kg / max_kg) for mu in (friction.mu_s, friction.mu_c))
        changes = (
            f"surface.static_friction={mu_s:g} and surface.kinetic_friction={mu_c:g} and "
            f"object.mass_kg={min_kg:g}"
        )
        message = f"{friction.mu_s:g} holds no object, not even one of {min_kg:g} kg; set {changes}"
        issues.append(Issue("surface.static_friction", message))
    elif needed > strongest:
        max_kg = round_down(max_kg)
        message = (
            f"{mass_kg:g} kg with grasp.max_margin needs a thumb of {needed:.0f} N; at most "
            f"{max_kg:g} kg."
        )
        issues.append(Issue("object.mass_kg", message))
    elif needed > available:
        is_given = scene.knock.attached or scene.grasp.force_n
        what = (
            "than the thumb is to press with"
            if is_given
            else f"than the thumb needs for {mass_kg:g} kg"
        )
        message = f"{available:g} N is less {what}; at least {round_up(needed):g} N."
        issues.append(Issue("hand.max_force_n", message))

    design_issues = list(scene.find_design_issues(design, seed))
    after_seed = int(seed < 0)
    return [*design_issues[:after_seed], *issues, *design_issues[after_seed:]]
