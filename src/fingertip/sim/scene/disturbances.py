"""Disturbances that are not slip: knocks and motors shake the contact, drift and a touched cable change the voltage."""

from __future__ import annotations

import math
import random

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.scene.scene_file import Cable, Drift, Motor, Tap
from fingertip.sim.scene.timeline import smoothstep

CREEP_FROM_S = 1.0
"""Time under load from which creep is counted in decades [s]: data sheets read the sensor then. Assumption."""
MOTOR_RAMP_S = 0.02
"""Time in which the vibration of a motor starts and stops [s]. Assumption."""


def knock_force_n(tap: Tap, held_s: float, time_s: Array) -> Array:
    """Force of the knocks [N]. Each one rises and falls as a smooth step.

    Parameters
    ----------
    tap
        Table ``tap`` of the scene.
    held_s
        Moment at which the holding force is reached [s].
    time_s
        Time grid [s].
    """
    total = np.zeros_like(time_s)
    for i in range(tap.count):
        t = (time_s - held_s - tap.at_s - i * tap.interval_s) / tap.rise_s
        total += smoothstep(t) - smoothstep(t - 1)
    return tap.force_n * total


def motor_force_n(motor: Motor, rng: random.Random, held_s: float, time_s: Array) -> Array:
    """Force of the motors' vibration [N]. The seed sets its phases.

    Parameters
    ----------
    motor
        Table ``motor`` of the scene.
    rng
        Source of the phases.
    held_s
        Moment at which the holding force is reached [s].
    time_s
        Time grid [s].
    """
    phases = [2 * math.pi * rng.random() for _ in range(2)]
    w = 2 * math.pi * motor.frequency_hz
    t = time_s - held_s - motor.at_s
    envelope = smoothstep(t / MOTOR_RAMP_S) - smoothstep((t - motor.duration_s) / MOTOR_RAMP_S + 1)
    force = np.zeros_like(t)
    # math.sin point by point: the last bit of a vectorised sine varies between processors.
    for i in np.flatnonzero(envelope).tolist():
        x = w * float(t[i])
        force[i] = math.sin(x + phases[0]) + motor.harmonic * math.sin(2 * x + phases[1])
    return motor.force_n * envelope * force


def apply_creep(drift: Drift, sensor_n: Array, step_s: float) -> Array:
    """Force that a creeping sensor shows [N]: it grows by a fixed fraction per decade of time under load."""
    out, loaded_steps = [], 0
    for force in sensor_n.tolist():
        loaded_steps = loaded_steps + 1 if force > 0.0 else 0
        out.append(force * (1 + drift.share_per_decade * math.log10(1 + loaded_steps * step_s / CREEP_FROM_S)))
    return np.array(out)


def cable_voltage_v(cable: Cable, held_s: float, time_s: Array) -> tuple[Array, Array]:
    """Voltage that a touched cable adds [V]: a jump that decays at each end of the touch, and mains hum in between.

    Returns
    -------
    tuple of two arrays
        The voltage at each sample, and the voltage right before it. They differ where a jump has happened since the
        previous sample: such a jump is assumed to happen at the sample.
    """
    out, before = [], []
    ends, last = (0.0, cable.duration_s), -math.inf
    for t in (time_s - held_s - cable.at_s).tolist():
        v, jump = 0.0, 0.0
        for end, sign in zip(ends, (1.0, -1.0), strict=True):
            if t >= end:
                part = sign * cable.step_v * math.exp(-(t - end) / cable.decay_s)
                v += part
                jump += part if last < end else 0.0
        if 0.0 <= t < cable.duration_s:
            v += cable.hum_v * math.sin(2 * math.pi * cable.hum_hz * t)
        out.append(v)
        before.append(v - jump)
        last = t
    return np.array(out), np.array(before)
