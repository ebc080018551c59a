"""Motion of a pad that a carriage drags over a surface, by one of three integrators, chunk by chunk."""

from __future__ import annotations

import math
import random
from typing import Protocol

import numpy as np

from fingertip.foundation.numerics import Array
from fingertip.sim.contact import coupled
from fingertip.sim.contact.friction import ELASTO_PLASTIC, Friction
from fingertip.sim.contact.pad import DAMPING_RATIO, HAND_N_PER_M, Pad
from fingertip.sim.contact.surface_profile import SurfaceProfile
from fingertip.sim.contact.tangential import DraggedPad, Mount, PadMotion
from fingertip.sim.contact.vibration import ProfileForce, transmit
from fingertip.sim.scene.scene_file import Motor, Tap
from fingertip.sim.scene.timeline import smoothstep
from fingertip.sim.signal.finger import FingerDrive
from fingertip.sim.signal.grid import CostMeter, Grid, StageCost

_FAST_CONTACT = coupled.NormalContact(2000.0, 1.0)
"""Contact that follows the load, because it is far faster than any change of the load."""
_TOLERANCE_N = 1e-6
"""Permitted error of one step of the error-controlled integration [N]."""


class SlidingPad(Protocol):
    """Pad on a carriage."""

    def process(self, carriage_m: Array, carriage_m_s: Array, load_n: Array, push_n: Array | None) -> FingerDrive:
        """Follow the pad over the next points: position [m] and velocity [m/s] of the carriage, and forces [N]."""
        ...


def mount_pad(pad: Pad, force_n: float) -> Mount:
    """Tangential mount of a pad at a holding force [N]."""
    k = pad.tangential_stiffness_n_per_m(force_n)
    return Mount(pad.mass_kg, k, 2 * DAMPING_RATIO * math.sqrt(k * pad.mass_kg))


def make_elasto_plastic(friction: Friction) -> Friction:
    """Return the same friction with bristles that do not creep below breakaway."""
    return Friction(**(vars(friction) | {"elastic": ELASTO_PLASTIC}))


class SteppedPad:
    """Pad with plain bristles, integrated with the steps of the grid. The contact force follows elsewhere."""

    def __init__(self, friction: Friction, mount: Mount, grid: Grid, meter: CostMeter) -> None:
        self._pad, self._meter = DraggedPad(friction, mount, grid.step_s), meter

    def process(self, carriage_m: Array, carriage_m_s: Array, load_n: Array, push_n: Array | None) -> FingerDrive:
        """Follow the pad over the next points."""
        with self._meter.stage("friction", 3, 2 * len(load_n)):
            motion = self._pad.process(carriage_m, carriage_m_s, load_n)
        return _describe(motion, carriage_m, load_n, push_n)


class ErrorControlledPad:
    """Pad with elasto-plastic bristles, integrated with error control. The contact force follows elsewhere."""

    def __init__(self, friction: Friction, mount: Mount, grid: Grid, max_load_n: float, meter: CostMeter) -> None:
        self._contact = coupled.CoupledContact(friction, mount, _FAST_CONTACT, grid.step_s, max_load_n, _TOLERANCE_N)
        self._meter = meter

    def process(self, carriage_m: Array, carriage_m_s: Array, load_n: Array, push_n: Array | None) -> FingerDrive:
        """Follow the pad over the next points."""
        with self._meter.stage("friction", coupled.STATES):
            motion = self._contact.process(carriage_m, carriage_m_s, load_n)
        self._meter.add(StageCost("friction", coupled.STATES, motion.evaluations, 0.0))
        return _describe(motion, carriage_m, load_n, push_n)


class CoupledPad:
    """Pad whose contact is integrated in both directions, so that vibration acts back on friction.

    The surface profile is read along the path that results without this feedback.
    """

    def __init__(
        self,
        friction: Friction,
        mount: Mount,
        pad: Pad,
        held_n: float,
        profile: SurfaceProfile,
        grid: Grid,
        max_load_n: float,
        meter: CostMeter,
    ) -> None:
        plain = Friction(**(vars(friction) | {"elastic": 0.0}))
        self._first = DraggedPad(plain, mount, grid.step_s)
        self._profile = ProfileForce(pad, profile, grid.step_s)
        hand_ratio = HAND_N_PER_M / pad.normal_stiffness_n_per_m(held_n)
        normal = coupled.NormalContact(pad.resonance_hz(held_n), DAMPING_RATIO, hand_ratio)
        self._contact = coupled.CoupledContact(friction, mount, normal, grid.step_s, max_load_n, _TOLERANCE_N)
        self._meter = meter

    def process(self, carriage_m: Array, carriage_m_s: Array, load_n: Array, push_n: Array | None) -> FingerDrive:
        """Follow the pad over the next points. The contact force is part of the result."""
        with self._meter.stage("coupled contact", coupled.STATES, 2 * len(load_n)):
            first = self._first.process(carriage_m, carriage_m_s, load_n)
            pressing = load_n + self._profile.process(load_n, first.position_m)
            if push_n is not None:
                pressing = pressing + transmit(load_n) * push_n
            motion = self._contact.process(carriage_m, carriage_m_s, pressing)
        self._meter.add(StageCost("coupled contact", coupled.STATES, motion.evaluations, 0.0))
        contact_n = np.where(load_n > 0.0, motion.force_n, 0.0)
        return _describe(motion, carriage_m, load_n, push_n, contact_n)


def _describe(
    motion: PadMotion | coupled.CoupledMotion,
    carriage_m: Array,
    load_n: Array,
    push_n: Array | None,
    contact_n: Array | None = None,
) -> FingerDrive:
    """Describe a motion as the drive of a finger."""
    return FingerDrive(
        load_n=load_n,
        push_n=push_n,
        path_m=motion.position_m,
        velocity_m_s=motion.velocity_m_s,
        bristle_m=motion.bristle_m,
        shear_m=carriage_m - motion.position_m,
        contact_n=contact_n,
    )


# Disturbances that are not slip: knocks and motors shake the contact.


MOTOR_RAMP_S = 0.02
"""Time in which the vibration of a motor starts and stops [s]. Assumption."""


def knock_force_n(tap: Tap, held_s: float, time_s: Array) -> Array:
    """Force of the knocks [N]. Each one rises and falls as a smooth step."""
    total = np.zeros_like(time_s)
    for i in range(tap.count):
        t = (time_s - held_s - tap.at_s - i * tap.interval_s) / tap.rise_s
        total += smoothstep(t) - smoothstep(t - 1)
    return tap.force_n * total


def draw_motor_phases(rng: random.Random) -> tuple[float, float]:
    """Draw the phases of fundamental and second harmonic [rad]."""
    return 2 * math.pi * rng.random(), 2 * math.pi * rng.random()


def motor_force_n(motor: Motor, phases: tuple[float, float], held_s: float, time_s: Array) -> Array:
    """Force of the motors' vibration [N]. Units: `phases` [rad]."""
    w = 2 * math.pi * motor.frequency_hz
    t = time_s - held_s - motor.at_s
    envelope = smoothstep(t / MOTOR_RAMP_S) - smoothstep((t - motor.duration_s) / MOTOR_RAMP_S + 1)
    force = np.zeros_like(t)
    # math.sin point by point: the last bit of a vectorised sine varies between processors.
    for i in np.flatnonzero(envelope).tolist():
        x = w * float(t[i])
        force[i] = math.sin(x + phases[0]) + motor.harmonic * math.sin(2 * x + phases[1])
    return motor.force_n * envelope * force
