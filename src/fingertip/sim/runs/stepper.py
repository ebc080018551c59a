"""Stepper of a manipulation: motors, motion of the object, and the fingers, chunk by chunk.

Every part carries its state, so the cuts between chunks change no bit. Parts that no output needs
do not run: there is no vibration for slip alone, and no sensor where neither an output nor a
controller needs a voltage.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field, fields, replace

import numpy as np

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.pad.response import Pad
from fingertip.sim.runs.grasp_loop import Grasp, GraspMotion, HeldObject, Pin
from fingertip.sim.runs.manipulation_plan import MotionPlan, Motors, put_on_object
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile
from fingertip.sim.runs.timeline import limit_error_n, mount_pad
from fingertip.sim.signal.grid import CostMeter, Grid, SampleClock, Sampler
from fingertip.sim.signal.simulated_finger import Finger, FingerDrive, FingerSetup, FingerSignals

PROFILE_MARGIN_M = 2e-3
"""Length of the surface profile before the point of first touch [m], because objects are also
pushed back a little.
"""


@dataclass(frozen=True, eq=False)
class HandSignals:
    """Signals of a manipulation at the instants of the ADC: (fingers, samples), those of the object
    (samples,).
    """

    time_s: Array
    fingers: tuple[FingerSignals, ...]
    """Signals of each finger.
    Its velocity is that of the object over the pad, the opposite of a scene's.
    """
    closing_m: Array
    command_m: Array
    object_m: Array
    pin_n: Array

    @classmethod
    def join(cls, chunks: list[HandSignals]) -> HandSignals:
        by_finger = zip(*(chunk.fingers for chunk in chunks), strict=True)
        names = [field.name for field in fields(cls) if field.name != "fingers"]
        joined = {
            name: np.concatenate([getattr(chunk, name) for chunk in chunks], axis=-1)
            for name in names
        }
        return cls(fingers=tuple(FingerSignals.join([*parts]) for parts in by_finger), **joined)

    def find(self, name: str) -> Array | None:
        """Return a signal by the name of its output, or None if it was not computed."""
        if hasattr(self, name):
            return np.asarray(getattr(self, name))

        values = [getattr(finger, name) for finger in self.fingers]
        return None if values[0] is None else np.stack(values)


@dataclass
class ManipulationStepper:
    """Manipulation in progress. The first chunk is the open hand at time 0."""

    design: Design
    scene: ManipulationFile
    plan: MotionPlan
    pad: Pad
    seed: int
    outputs: frozenset[str]
    grid: Grid
    meter: CostMeter = field(default_factory=CostMeter)
    chunks: list[HandSignals] = field(default_factory=list)

    def __post_init__(self) -> None:
        scene, plan, count = self.scene, self.plan, len(self.scene.fingers)
        grip = put_on_object(self.pad, scene.object)
        self.motors = Motors(
            hand=scene.hand,
            pad=grip,
            fingers=scene.fingers,
            reach_m=plan.reach_m,
            step_s=self.grid.step_s,
        )
        knock = scene.knock
        target = scene.object
        pin = Pin(knock.stiffness_n_per_m, knock.damping_s_per_m, knock.attached)
        mounts = tuple(mount_pad(self.pad, force) for force in plan.force_n.tolist())
        held_object = HeldObject(
            friction=plan.friction,
            mounts=mounts,
            mass_kg=target.mass_kg,
            length_m=target.length_m,
            pin=pin,
        )
        self._grasp = Grasp(
            held_object,
            step_s=self.grid.step_s,
            max_load_n=float(plan.force_n.max()),
            tolerance_n=limit_error_n(self.grid),
        )
        self._last_load_n = np.zeros(count)
        self._points = 1
        self._clock = SampleClock(self.grid, self.design.detector.sample_rate_hz)
        self._samplers = [Sampler() for _ in range(2 * count + 2)]
        self._fingers = [
            Finger(self._set_up(i), self.grid, self.outputs, self.meter) for i in range(count)
        ]
        still = self._closing_m = np.zeros((count, 1))
        rest = GraspMotion(
            load_n=still,
            position_m=still,
            over_object_m_s=still,
            bristle_m=still,
            object_m=np.zeros(1),
            pin_n=np.zeros(1),
        )
        self._record(still, still, _describe_drives(rest, still, still), rest)

    @property
    def point_count(self) -> int:
        """Number of points from the first one after the open hand to the end of the plan."""
        return self.grid.count_points(self.plan.duration_s, self.design.detector.sample_rate_hz) - 1

    @property
    def is_lost(self) -> bool:
        return self._grasp.is_lost

    def advance(self, command_m: Array) -> None:
        """Advance by one point of the grid per command."""
        count, length = command_m.shape
        with self.meter.stage("hand", 2, length):
            motors = self.motors.follow(command_m)

        self._closing_m = motors.closing_m
        loads = np.concatenate((self._last_load_n[:, None], motors.force_n), axis=1)
        time_s = self.grid.time_s(self._points - 1, length + 1)
        self._points += length

        with self.meter.stage("object", 3 * count + 2):
            moved = self._grasp.advance(loads, self.plan.weight_n(time_s), *self.plan.pin_m(time_s))

        self.meter.add("object", 3 * count + 2, moved.evaluations)
        self._last_load_n = motors.force_n[:, -1] * (0.0 if self.is_lost else 1.0)

        # The pin hits off centre: it presses on the thumb and relieves the fingers.
        pressed_n = self.scene.knock.normal_share * moved.pin_n
        shares = [1.0, *[-1.0 / (count - 1)] * (count - 1)]
        pushes = motors.vibration_n + np.array(shares)[:, None] * pressed_n
        drives = _describe_drives(moved, pushes, motors.jump_n)
        self._record(motors.closing_m, command_m, drives, moved)

    def select_window(self, point: int, period: int) -> tuple[slice, Array]:
        """Select the samples of the last chunk in the period before one of its points, and the
        closing there [m].
        """
        before = self._clock.count_until(self._points - 1) - len(self.chunks[-1].time_s)
        first, end = (self._clock.count_until(at) - before for at in (point - period, point))
        return slice(first, end), self._closing_m[:, point - self._points].copy()

    def _record(
        self,
        closing: Array,
        command: Array,
        drives: list[FingerDrive],
        moved: GraspMotion,
    ) -> None:
        """Let the fingers follow, and sample what the hand itself shows."""
        fingers = [
            finger.process(drive) for finger, drive in zip(self._fingers, drives, strict=True)
        ]
        at = self._clock.advance(len(moved.object_m))
        count = len(fingers)
        rows = [*closing, *command, moved.object_m, moved.pin_n]
        sampled = [
            sampler.process(row, at) for sampler, row in zip(self._samplers, rows, strict=True)
        ]
        # The velocity of the object over the pad is the opposite of a finger's own.
        turned = [
            finger
            if finger.velocity_m_s is None
            else replace(finger, velocity_m_s=0.0 - finger.velocity_m_s)
            for finger in fingers
        ]
        closing_m = np.stack(sampled[:count])
        command_m = np.stack(sampled[count : 2 * count])
        self.chunks.append(
            HandSignals(at.time_s, tuple(turned), closing_m, command_m, *sampled[2 * count :])
        )

    def _set_up(self, finger: int) -> FingerSetup:
        name = self.scene.fingers[finger]
        scene = self.scene
        return FingerSetup(
            design=self.design,
            pad=self.pad,
            held_n=float(self.plan.force_n[finger]),
            friction=self.plan.friction,
            open_random=lambda purpose: random.Random(f"{self.seed}:{name}:{purpose}"),
            seed=(self.seed, name),
            surface=scene.complete().surface,
            profile_start_m=-PROFILE_MARGIN_M,
            profile_length_m=PROFILE_MARGIN_M + scene.object.length_m,
            patch_average=scene.object.patch_average,
            path=scene,
            event_origin_s=self.plan.closed_s,
        )


def _describe_drives(moved: GraspMotion, pushes: Array, jumps: Array) -> list[FingerDrive]:
    """Loads and motion of each finger.

    The object moves under the pad, so the pad moves backwards over it.
    """
    pads = zip(
        moved.load_n,
        pushes,
        jumps,
        moved.position_m,
        moved.over_object_m_s,
        moved.bristle_m,
        strict=True,
    )
    return [
        FingerDrive(
            load_n=load,
            push_n=push,
            push_jump_n=jump,
            path_m=moved.object_m - bent,
            velocity_m_s=np.where(load > 0.0, speed, 0.0),
            bristle_m=bristle,
            shear_m=bent,
        )
        for load, push, jump, bent, speed, bristle in pads
    ]
