"""Stepper of a manipulation: motors, motion of the object, and the fingers, chunk by chunk.

Every part carries its state, so the cuts between chunks change no bit. Parts that no output needs do not run: there is
no vibration for slip alone, and no sensor where neither an output nor a controller needs a voltage.
"""

from __future__ import annotations

import math
import random
from dataclasses import astuple, dataclass, field, fields, replace

import numpy as np

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.pad.response import Pad
from fingertip.sim.contact.friction import LOAD_SCALE_N, RELAX_PER_S
from fingertip.sim.contact.tangential import MAX_PHASE
from fingertip.sim.runs import grasp_loop
from fingertip.sim.runs.files import ManipulationFile
from fingertip.sim.runs.motion import MotionPlan, Motors, put_on_object
from fingertip.sim.runs.timeline import mount_pad
from fingertip.sim.signal.finger import Finger, FingerDrive, FingerSetup, FingerSignals
from fingertip.sim.signal.grid import BASE_HZ, CostMeter, Grid, SampleClock, Sampler

PROFILE_MARGIN_M = 2e-3
"""Length of the surface profile before the point of first touch [m], because objects are also pushed back a little."""


@dataclass(frozen=True, eq=False)
class HandSignals:
    """Signals of a manipulation at the instants of the ADC: (fingers, samples), those of the object (samples,)."""

    time_s: Array
    fingers: tuple[FingerSignals, ...]
    """Signals of each finger. Its velocity is that of the object over the pad, the opposite of a scene's."""
    closing_m: Array
    command_m: Array
    object_m: Array
    pin_n: Array

    @classmethod
    def join(cls, chunks: list[HandSignals]) -> HandSignals:
        by_finger = zip(*(chunk.fingers for chunk in chunks), strict=True)
        names = [field.name for field in fields(cls) if field.name != "fingers"]
        joined = {name: np.concatenate([getattr(chunk, name) for chunk in chunks], axis=-1) for name in names}
        return cls(fingers=tuple(FingerSignals.join([*parts]) for parts in by_finger), **joined)

    def find(self, name: str) -> Array | None:
        """Return a signal by the name of its output, or None if it was not computed."""
        if hasattr(self, name):
            return np.asarray(getattr(self, name))
        found = [getattr(finger, name) for finger in self.fingers]
        return None if found[0] is None else np.stack(found)


def count_substeps(scene: ManipulationFile, plan: MotionPlan, pad: Pad) -> int:
    """Number of steps of pads and object per step of the grid: so many that they resolve the motion on the bristles.

    Pads and object swing against each other on the bristles of all fingers, most stiffly where the tendons stall. A
    refined grid keeps the number, so that all errors fall with its step.
    """
    friction, most = plan.friction, scene.hand.max_force_n
    stiffness = pad.tangential_stiffness_n_per_m(float(plan.force_n.max())) + most * friction.sigma0
    # Thumb and fingers press with the same force.
    rate_2 = stiffness / pad.backing.mass_kg + 2 * most * friction.sigma0 / scene.object.mass_kg
    return max(1, math.ceil(math.sqrt(rate_2) / BASE_HZ / MAX_PHASE))


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
        self.motors = Motors(scene.hand, grip, scene.fingers, plan.reach_m, self.grid.step_s)
        self._mounts = np.array([astuple(mount_pad(self.pad, force)) for force in plan.force_n.tolist()]).ravel()
        self._state = np.zeros(grasp_loop.PAD_STATES * count + grasp_loop.OBJECT_STATES)
        self._scratch = np.zeros(grasp_loop.SCRATCH_SIZE * count)
        self._last_load_n = np.zeros(count)
        self._parts = count_substeps(scene, plan, self.pad)
        self._points = 1
        self._clock = SampleClock(self.grid, self.design.detector.sample_rate_hz)
        self._samplers = [Sampler() for _ in range(2 * count + 2)]
        self._fingers = [Finger(self._set_up(i), self.grid, self.outputs, self.meter) for i in range(count)]
        still, none = np.zeros((count, 1)), np.zeros(1)
        self._closing_m = still
        self._record(still, still, _describe_drives(still, still, still, still, still, still, none), none, none)

    @property
    def point_count(self) -> int:
        """Number of points from the first one after the open hand to the end of the plan."""
        return self.grid.count_points(self.plan.duration_s, self.design.detector.sample_rate_hz) - 1

    @property
    def is_lost(self) -> bool:
        return bool(self._state[grasp_loop.PAD_STATES * len(self.scene.fingers) + grasp_loop.HAS_LEFT] > 0.0)

    def advance(self, command_m: Array) -> None:
        """Advance by one point of the grid per command."""
        count, length = command_m.shape
        with self.meter.stage("hand", 2, length):
            motors = self.motors.follow(command_m)
        self._closing_m = motors.closing_m
        loads = np.concatenate((self._last_load_n[:, None], motors.force_n), axis=1)
        time_s = self.grid.time_s(self._points - 1, length + 1)
        self._points += length

        # Object and pads along the direction of slip. The loop sets the loads of a lost object to 0.
        with self.meter.stage("object", 3 * count + 2, 2 * length):
            shear, over_object_m_s, bristle, object_m, pin_n = self._move(time_s, loads)
        self._last_load_n = motors.force_n[:, -1] * (0.0 if self.is_lost else 1.0)

        # The pin hits off centre: it presses on the thumb and relieves the fingers.
        pressed_n = self.scene.knock.normal_share * pin_n
        shares = [1.0, *[-1.0 / (count - 1)] * (count - 1)]
        pushes = motors.vibration_n + np.array(shares)[:, None] * pressed_n
        drives = _describe_drives(loads[:, 1:], pushes, motors.jump_n, shear, over_object_m_s, bristle, object_m)
        self._record(motors.closing_m, command_m, drives, object_m, pin_n)

    def select_window(self, point: int, period: int) -> tuple[slice, Array]:
        """Select the samples of the last chunk in the period before one of its points, and the closing there [m]."""
        before = self._clock.count_until(self._points - 1) - len(self.chunks[-1].time_s)
        first, end = (max(self._clock.count_until(at) - before, 0) for at in (point - period, point))
        return slice(first, end), self._closing_m[:, point - self._points].copy()

    def _move(self, time_s: Array, loads: Array) -> tuple[Array, ...]:
        """Compute shear, velocity over the object and bristles of each pad, position of the object, and pin force."""
        scene, friction, count = self.scene, self.plan.friction, len(self.scene.fingers)
        fine_s, fine_loads = _refine(time_s[None], self._parts)[0], _refine(loads, self._parts)
        length = len(fine_s) - 1
        pin_x, pin_v = self.plan.pin_m(fine_s)
        shear, over_object_m_s, bristle = (np.zeros(count * length) for _ in range(3))
        object_m, pin = np.zeros(length), np.zeros(length)
        flat = fine_loads.ravel()
        grasp_loop.run(
            (friction.mu_c, friction.mu_s - friction.mu_c, friction.stribeck_m_s),
            (friction.sigma0, friction.sigma1, friction.sigma2, RELAX_PER_S, LOAD_SCALE_N),
            self.grid.step_s / self._parts, scene.object.mass_kg,
            (scene.knock.stiffness_n_per_m, scene.knock.damping_s_per_m, float(scene.knock.attached)),
            scene.object.length_m, count, length, self._mounts, self.plan.weight_n(fine_s), pin_x, pin_v,
            self._state, self._scratch, flat, shear, over_object_m_s, bristle, object_m, pin,
        )  # fmt: skip
        every = slice(self._parts - 1, None, self._parts)
        loads[:, 1:] = flat.reshape(count, -1)[:, 1:][:, every]
        by_finger = (values.reshape(count, -1)[:, every] for values in (shear, over_object_m_s, bristle))
        return (*by_finger, object_m[every], pin[every])

    def _record(self, closing: Array, command: Array, drives: list[FingerDrive], object_m: Array, pin_n: Array) -> None:
        """Let the fingers follow, and sample what the hand itself shows."""
        fingers = [finger.process(drive) for finger, drive in zip(self._fingers, drives, strict=True)]
        at = self._clock.advance(len(object_m))
        count = len(fingers)
        rows = [*closing, *command, object_m, pin_n]
        sampled = [sampler.process(row, at) for sampler, row in zip(self._samplers, rows, strict=True)]
        # The velocity of the object over the pad is the opposite of a finger's own.
        turned = [
            finger if finger.velocity_m_s is None else replace(finger, velocity_m_s=0.0 - finger.velocity_m_s)
            for finger in fingers
        ]
        closing_m, command_m = np.stack(sampled[:count]), np.stack(sampled[count : 2 * count])
        self.chunks.append(HandSignals(at.time_s, tuple(turned), closing_m, command_m, *sampled[2 * count :]))

    def _set_up(self, finger: int) -> FingerSetup:
        scene, name = self.scene, self.scene.fingers[finger]
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


def _describe_drives(
    loads: Array, pushes: Array, jumps: Array, shear: Array, speeds: Array, bristles: Array, object_m: Array
) -> list[FingerDrive]:
    """Loads and motion of each finger. The object moves under the pad, so the pad moves backwards over it."""
    return [
        FingerDrive(load, push, jump, object_m - bent, np.where(load > 0.0, speed, 0.0), bristle, bent)
        for load, push, jump, bent, speed, bristle in zip(loads, pushes, jumps, shear, speeds, bristles, strict=True)
    ]


def _refine(values: Array, parts: int) -> Array:
    if parts == 1:
        return values.copy()
    fraction = np.arange(1, parts + 1) / parts
    steps = values[:, :-1, None] + (values[:, 1:] - values[:, :-1])[:, :, None] * fraction
    steps[:, :, -1] = values[:, 1:]
    return np.concatenate((values[:, :1], steps.reshape(len(values), -1)), axis=1)
