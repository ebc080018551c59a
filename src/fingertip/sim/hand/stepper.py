"""Stepper of a manipulation: motors, forces, motion of the object, vibration and sensors, chunk by chunk.

Every part carries its state, so the cuts between chunks change no bit. Parts that no output needs do not run: there is
no vibration for slip alone, and no sensor where neither an output nor a controller needs a voltage.
"""

from __future__ import annotations

import functools
import math
import random
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.sim.contact.friction import GROSS_SLIP_M_S, RELAX_PER_S
from fingertip.sim.contact.pad import DAMPING_RATIO, Pad
from fingertip.sim.contact.surfaces import SURFACES
from fingertip.sim.signal.filter_board import AnalogStream
from fingertip.sim.signal.analog_circuit import board_with_amplifiers
from fingertip.sim.hand import grasp_loop
from fingertip.sim.hand.finger import FingerSensor, VibratingPad
from fingertip.sim.hand.manipulation_file import ManipulationFile
from fingertip.sim.hand.motion_plan import MotionPlan
from fingertip.sim.hand.motors import Motors
from fingertip.sim.stages.context import MAX_STEP_S
from fingertip.sim.stages.stage import StageStats

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of the ADC in one chunk, (fingers, samples)."""

    voltage_v: Array
    """Sampled tactile voltages [V]."""
    envelope_v: Array | None
    """Sampled envelope outputs of the boards [V]. None where no output needs them."""


@dataclass
class ManipulationStepper:
    """Manipulation in progress."""

    design: Design
    scene: ManipulationFile
    plan: MotionPlan
    pad: Pad
    seed: int
    outputs: frozenset[str]
    """Names of the outputs to compute."""
    position: int = 0
    """Number of samples computed after the first."""
    samples: Samples | None = None
    """Samples of the latest chunk. None where no sensor runs."""
    chunks: dict[str, list[NDArray[Any]]] = field(default_factory=dict)
    """Chunks of each signal."""
    stats: dict[str, StageStats] = field(default_factory=dict)
    """Cost of each stage so far."""

    def __post_init__(self) -> None:
        scene, plan, count = self.scene, self.plan, len(self.scene.fingers)
        rate = self.design.detector.sample_rate_hz
        self._substeps = math.ceil(1 / (rate * MAX_STEP_S) - 1e-9)
        self._step_s = 1 / (rate * self._substeps)
        self.motors = Motors(scene.hand, self.pad, scene.fingers, plan.reach_m, 1 / rate)
        mounts = []
        for force in plan.force_n.tolist():
            k = self.pad.tangential_stiffness_n_per_m(force)
            mounts += [self.pad.mass_kg, k, 2 * DAMPING_RATIO * math.sqrt(k * self.pad.mass_kg)]
        self._mounts = np.array(mounts)
        self._state = np.zeros(grasp_loop.PAD_STATES * count + grasp_loop.OBJECT_STATES)
        self._scratch = np.zeros(grasp_loop.SCRATCH_SIZE * count)
        self._last_load_n = np.zeros(count)
        self._last_motor_n = np.zeros(count)
        self._pads: list[VibratingPad] = []
        self._sensors: list[FingerSensor] = []
        self._boards: AnalogStream | None = None
        needs_boards = bool({"envelope_v", "slip_pin_v"} & self.outputs)
        needs_sensors = needs_boards or "voltage_v" in self.outputs
        if needs_sensors or "force_n" in self.outputs:
            self._pads = self._timed("profile", 0, 0, lambda: [self._build_pad(i) for i in range(count)])
        if needs_sensors:
            streams = [functools.partial(self._random_stream, finger=i) for i in range(count)]
            self._sensors = [FingerSensor(self.design, scene.sensing, stream) for stream in streams]
        if needs_boards:
            self._boards = AnalogStream(board_with_amplifiers(self.design, scene.sensing.amplifiers), 1 / rate, count)
        first = np.zeros((count, 1))
        self._record(
            closing_m=first, command_m=first, force_n=first, velocity_m_s=first, slip=first > 0.0,
            object_m=first[0], pin_n=first[0],
        )  # fmt: skip
        if needs_sensors:
            self._sample(first, first)

    @property
    def is_lost(self) -> bool:
        """True if the object has left the fingers."""
        return bool(self._state[grasp_loop.PAD_STATES * len(self.scene.fingers) + grasp_loop.HAS_LEFT] > 0.0)

    def advance(self, command_m: Array) -> None:
        """Advance by one sample per command.

        Parameters
        ----------
        command_m
            Commanded closing up to each sample [m], (fingers, samples).
        """
        count, length = command_m.shape

        # Motors, and the quasi-static forces on the fine grid.
        closing, force, motor_n = self._timed("hand", 2, length, lambda: self.motors.follow(command_m))
        grid = length * self._substeps
        loads = self._interpolate_to_grid(self._last_load_n, force)
        time_s = (self.position * self._substeps + np.arange(grid + 1)) * self._step_s

        # Object and pads along the direction of slip. The loop sets the loads of a lost object to 0.
        shear, object_over_pad_m_s, bristle, object_m, pin = self._timed(
            "object", 3 * count + 2, 2 * grid, lambda: self._move(time_s, loads)
        )
        self._last_load_n = force[:, -1] * (0.0 if self.is_lost else 1.0)

        # Vibration of the contacts.
        samples = slice(self._substeps - 1, None, self._substeps)
        contact = loads[:, 1:]
        if self._pads:
            pushes = self._interpolate_to_grid(self._last_motor_n, motor_n)[:, 1:]
            self._last_motor_n = motor_n[:, -1].copy()
            contact = self._timed(
                "contact", 3 * count, grid, lambda: self._vibrate(contact, object_m - shear, pushes, pin)
            )

        # True slip, and the sensors.
        self.position += length
        velocity = np.where(loads[:, 1:][:, samples] > 0.0, object_over_pad_m_s[:, samples], 0.0)
        # Bristles bend with the velocity of the pad over the object, the opposite of the recorded one.
        sliding = self.plan.friction.sliding_speed_m_s(-velocity, bristle[:, samples])
        self._record(
            closing_m=closing, command_m=command_m, force_n=contact[:, samples], velocity_m_s=velocity,
            slip=sliding > GROSS_SLIP_M_S, object_m=object_m[samples], pin_n=pin[samples],
        )  # fmt: skip
        if self._sensors:
            self._timed("sensor", count, length, lambda: self._sample(contact[:, samples], shear[:, samples]))

    def _move(self, time_s: Array, loads: Array) -> tuple[Array, ...]:
        """Compute shear, velocity under the object and bristles of each pad, position of the object, and pin force."""
        scene, friction, count = self.scene, self.plan.friction, len(self.scene.fingers)
        length = len(time_s) - 1
        pin_x, pin_v = self.plan.pin_m(time_s)
        shear, object_over_pad_m_s, bristle = (np.zeros(count * length) for _ in range(3))
        object_m, pin = np.zeros(length), np.zeros(length)
        flat = loads.ravel()
        grasp_loop.run(
            (friction.mu_c, friction.mu_s - friction.mu_c, friction.stribeck_m_s),
            (friction.sigma0, friction.sigma1, friction.sigma2, RELAX_PER_S),
            self._step_s, scene.object.mass_kg, (scene.knock.stiffness_n_per_m, scene.knock.damping_s_per_m),
            scene.object.length_m, count, length, self._mounts, self.plan.weight_n(time_s), pin_x, pin_v,
            self._state, self._scratch, flat, shear, object_over_pad_m_s, bristle, object_m, pin,
        )  # fmt: skip
        loads[...] = flat.reshape(loads.shape)
        by_finger = (values.reshape(count, -1) for values in (shear, object_over_pad_m_s, bristle))
        return (*by_finger, object_m, pin)

    def _vibrate(self, loads: Array, path_m: Array, pushes: Array, pin: Array) -> Array:
        """Contact force of each finger. The pin hits off centre: it presses on the thumb and relieves the fingers."""
        normal_n = self.scene.knock.normal_share * pin
        against = -normal_n / (len(loads) - 1)
        return np.stack(
            [
                pad.contact_n(loads[i], path_m[i], pushes[i] + (against if i else normal_n))
                for i, pad in enumerate(self._pads)
            ]
        )

    def _sample(self, contact: Array, shear: Array) -> None:
        sensors = self._sensors
        bridge = [s.bridge_v(contact[i], shear[i]) for i, s in enumerate(sensors)]
        sampled = np.stack([s.sampled_v(v) for s, v in zip(sensors, bridge, strict=True)])
        self._record(voltage_v=sampled)
        sampled_envelope = None
        if self._boards:
            tactile = np.stack([s.tactile_v(v) for s, v in zip(sensors, bridge, strict=True)])
            filtered, envelope = self._boards.process(tactile)
            self._record(filtered_v=filtered, envelope_v=envelope)
            sampled_envelope = np.stack([s.sampled_envelope_v(v) for s, v in zip(sensors, envelope, strict=True)])
        self.samples = Samples(sampled, sampled_envelope)

    def _interpolate_to_grid(self, before: Array, values: Array) -> Array:
        """Interpolate values at samples linearly to the grid, starting with the value before the chunk."""
        ends = np.concatenate((before[:, None], values), axis=1)
        fraction = np.arange(1, self._substeps + 1) / self._substeps
        inner = ends[:, :-1, None] + (ends[:, 1:] - ends[:, :-1])[:, :, None] * fraction
        inner[:, :, -1] = ends[:, 1:]
        return np.concatenate((before[:, None], inner.reshape(len(values), -1)), axis=1)

    def _build_pad(self, finger: int) -> VibratingPad:
        surface = SURFACES[self.scene.object.surface]
        force = float(self.plan.force_n[finger])
        length = self.scene.object.length_m
        return VibratingPad(self.pad, force, self._step_s, surface, length, self._random_stream("surface", finger))

    def _random_stream(self, purpose: str, finger: int) -> random.Random:
        """Random numbers of one finger for one purpose."""
        return random.Random(f"{self.seed}:{self.scene.fingers[finger]}:{purpose}")

    def _record(self, **signals: Array | NDArray[np.bool_]) -> None:
        for name, values in signals.items():
            self.chunks.setdefault(name, []).append(values)

    def _timed(self, name: str, states: int, evaluations: int, work: Callable[[], T]) -> T:
        start = time.process_time()
        result = work()
        before = self.stats.get(name, StageStats(name, states, 0, 0.0))
        cpu_s = before.cpu_s + time.process_time() - start
        self.stats[name] = StageStats(name, states, before.evaluations + evaluations, cpu_s)
        return result
