"""The stages of a manipulation, stepped: motors, forces, the object's motion, vibration, sensors.

Every stage carries its state, so that it does not matter to any bit how its time is cut. What nobody asked for is not
made: no vibration for slip alone, no sensor where neither a voltage nor a controller wants one.
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
from fingertip.sim.contact.friction import GROSS_SLIP_M_S
from fingertip.sim.contact.pad import DAMPING_RATIO, Pad
from fingertip.sim.contact.surfaces import SURFACES
from fingertip.sim.electronics.amplifiers import amplified
from fingertip.sim.electronics.analog import Stream
from fingertip.sim.hand import grasp_loop
from fingertip.sim.hand.finger import Sensed, Shaken
from fingertip.sim.hand.manipulation_file import ManipulationFile
from fingertip.sim.hand.motion_plan import Plan
from fingertip.sim.hand.motors import Motors
from fingertip.sim.stages.context import LONGEST_STEP_S
from fingertip.sim.stages.stage import Ran

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Samples:
    """What the converters gave, (fingers, samples)."""

    voltage_v: Array
    envelope_v: Array | None
    """Of the boards; None where no output needs them."""


@dataclass
class Run:
    """A manipulation under way."""

    design: Design
    scene: ManipulationFile
    plan: Plan
    pad: Pad
    seed: int
    wanted: frozenset[str]
    """Names of outputs."""
    at: int = 0
    """Samples made after the first."""
    samples: Samples | None = None
    """The newest; None where no sensor runs."""
    parts: dict[str, list[NDArray[Any]]] = field(default_factory=dict)
    ran: dict[str, Ran] = field(default_factory=dict)

    def __post_init__(self) -> None:
        scene, plan, count = self.scene, self.plan, len(self.scene.fingers)
        rate = self.design.detector.sample_rate_hz
        self._every = math.ceil(1 / (rate * LONGEST_STEP_S) - 1e-9)
        self._step_s = 1 / (rate * self._every)
        self.motors = Motors(scene.hand, self.pad, scene.fingers, plan.reach_m, 1 / rate)
        mounts = []
        for force in plan.force_n.tolist():
            k = self.pad.tangential_stiffness_n_per_m(force)
            mounts += [self.pad.mass_kg, k, 2 * DAMPING_RATIO * math.sqrt(k * self.pad.mass_kg)]
        self._mounts = np.array(mounts)
        self._state = np.zeros(3 * count + 3)
        self._scratch = np.zeros(grasp_loop.WIDTH * count)
        self._load = np.zeros(count)
        self._quiet = np.zeros(count)
        self._shaken: list[Shaken] = []
        self._sensed: list[Sensed] = []
        self._boards: Stream | None = None
        boards = bool({"envelope_v", "slip_pin_v"} & self.wanted)
        sensing = boards or "voltage_v" in self.wanted
        if sensing or "force_n" in self.wanted:
            self._shaken = self._timed("profile", 0, 0, lambda: [self._shaker(i) for i in range(count)])
        if sensing:
            streams = [functools.partial(self._stream, finger=i) for i in range(count)]
            self._sensed = [Sensed(self.design, scene.sensing, stream) for stream in streams]
        if boards:
            self._boards = Stream(amplified(self.design, scene.sensing.amplifiers), 1 / rate, count)
        first = np.zeros((count, 1))
        self._note(
            closing_m=first, command_m=first, force_n=first, velocity_m_s=first, slip=first > 0.0,
            object_m=first[0], pin_n=first[0],
        )  # fmt: skip
        if sensing:
            self._sense(first, first)

    @property
    def lost(self) -> bool:
        """Whether the object has left the fingers."""
        return bool(self._state[-1] > 0.0)

    def advance(self, command_m: Array) -> None:
        """Go on by as many samples as there are commands (closing [m], (fingers, samples)), each in force up to its
        sample."""
        count, length = command_m.shape
        closing, force, shaking = self._timed("hand", 2, length, lambda: self.motors.follow(command_m))
        grid = length * self._every
        loads = self._on_grid(self._load, force)
        time_s = (self.at * self._every + np.arange(grid + 1)) * self._step_s
        way, over, bristle, moved, pin = self._timed(
            "object", 3 * count + 2, 2 * grid, lambda: self._move(time_s, loads)
        )
        self._load = force[:, -1] * (0.0 if self.lost else 1.0)
        every = slice(self._every - 1, None, self._every)
        contact = loads[:, 1:]
        if self._shaken:
            pushes = self._on_grid(self._quiet, shaking)[:, 1:]
            self._quiet = shaking[:, -1].copy()
            contact = self._timed("contact", 3 * count, grid, lambda: self._shake(contact, moved - way, pushes, pin))
        self.at += length
        velocity = np.where(loads[:, 1:][:, every] > 0.0, over[:, every], 0.0)
        sliding = self.plan.friction.sliding_m_s(velocity, bristle[:, every])
        self._note(
            closing_m=closing, command_m=command_m, force_n=contact[:, every], velocity_m_s=velocity,
            slip=sliding > GROSS_SLIP_M_S, object_m=moved[every], pin_n=pin[every],
        )  # fmt: skip
        if self._sensed:
            self._timed("sensor", count, length, lambda: self._sense(contact[:, every], way[:, every]))

    def _move(self, time_s: Array, loads: Array) -> tuple[Array, ...]:
        scene, friction, count = self.scene, self.plan.friction, len(self.scene.fingers)
        length = len(time_s) - 1
        pin_x, pin_v = self.plan.pin_m(time_s)
        way, over, bristle = (np.zeros(count * length) for _ in range(3))
        moved, pin = np.zeros(length), np.zeros(length)
        flat = loads.ravel()
        grasp_loop.run(
            (friction.mu_c, friction.mu_s - friction.mu_c, friction.stribeck_m_s),
            (friction.sigma0, friction.sigma1, friction.sigma2),
            self._step_s, scene.object.mass_kg, (scene.knock.stiffness_n_per_m, scene.knock.damping_s_per_m),
            scene.object.length_m, count, length, self._mounts, self.plan.weight_n(time_s), pin_x, pin_v,
            self._state, self._scratch, flat, way, over, bristle, moved, pin,
        )  # fmt: skip
        loads[...] = flat.reshape(loads.shape)
        return way.reshape(count, -1), over.reshape(count, -1), bristle.reshape(count, -1), moved, pin

    def _shake(self, loads: Array, slid: Array, pushes: Array, pin: Array) -> Array:
        """The pin hits a little off the middle: what it adds to the thumb it takes from the fingers."""
        share = self.scene.knock.normal_share * pin
        against = -share / (len(loads) - 1)
        return np.stack(
            [
                shaken.contact_n(loads[i], slid[i], pushes[i] + (against if i else share))
                for i, shaken in enumerate(self._shaken)
            ]
        )

    def _sense(self, contact: Array, shear: Array) -> None:
        fingers = self._sensed
        bridge = [s.bridge_v(contact[i], shear[i]) for i, s in enumerate(fingers)]
        sampled = np.stack([s.sampled_v(v) for s, v in zip(fingers, bridge, strict=True)])
        self._note(voltage_v=sampled)
        out = None
        if self._boards:
            tactile = np.stack([s.tactile_v(v) for s, v in zip(fingers, bridge, strict=True)])
            filtered, enveloped = self._boards.process(tactile)
            self._note(filtered_v=filtered, envelope_v=enveloped)
            out = np.stack([s.sampled_envelope_v(v) for s, v in zip(fingers, enveloped, strict=True)])
        self.samples = Samples(sampled, out)

    def _on_grid(self, before: Array, values: Array) -> Array:
        """Values at samples, straight between them on the grid; the first is the one before."""
        ends = np.concatenate((before[:, None], values), axis=1)
        share = np.arange(1, self._every + 1) / self._every
        inner = ends[:, :-1, None] + (ends[:, 1:] - ends[:, :-1])[:, :, None] * share
        inner[:, :, -1] = ends[:, 1:]
        return np.concatenate((before[:, None], inner.reshape(len(values), -1)), axis=1)

    def _shaker(self, finger: int) -> Shaken:
        surface = SURFACES[self.scene.object.surface]
        held = float(self.plan.force_n[finger])
        length = self.scene.object.length_m
        return Shaken(self.pad, held, self._step_s, surface, length, self._stream("surface", finger))

    def _stream(self, what: str, finger: int) -> random.Random:
        """Random numbers of one finger for one purpose."""
        return random.Random(f"{self.seed}:{self.scene.fingers[finger]}:{what}")

    def _note(self, **made: Array | NDArray[np.bool_]) -> None:
        for name, values in made.items():
            self.parts.setdefault(name, []).append(values)

    def _timed(self, name: str, states: int, evaluations: int, work: Callable[[], T]) -> T:
        start = time.process_time()
        result = work()
        before = self.ran.get(name, Ran(name, states, 0, 0.0))
        took = before.cpu_s + time.process_time() - start
        self.ran[name] = Ran(name, states, before.evaluations + evaluations, took)
        return result
