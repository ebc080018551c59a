"""Disturbances that are not slip: knocks and motors shake the contact."""

from __future__ import annotations

import math
import random

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.scene.scene_file import Motor, Tap
from fingertip.sim.scene.timeline import smoothstep

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


def draw_motor_phases(rng: random.Random) -> tuple[float, float]:
    """Draw the phases of fundamental and second harmonic [rad]."""
    return 2 * math.pi * rng.random(), 2 * math.pi * rng.random()


def motor_force_n(motor: Motor, phases: tuple[float, float], held_s: float, time_s: Array) -> Array:
    """Force of the motors' vibration [N].

    Parameters
    ----------
    motor
        Table ``motor`` of the scene.
    phases
        Phases of fundamental and second harmonic [rad].
    held_s
        Moment at which the holding force is reached [s].
    time_s
        Time grid [s].
    """
    w = 2 * math.pi * motor.frequency_hz
    t = time_s - held_s - motor.at_s
    envelope = smoothstep(t / MOTOR_RAMP_S) - smoothstep((t - motor.duration_s) / MOTOR_RAMP_S + 1)
    force = np.zeros_like(t)
    # math.sin point by point: the last bit of a vectorised sine varies between processors.
    for i in np.flatnonzero(envelope).tolist():
        x = w * float(t[i])
        force[i] = math.sin(x + phases[0]) + motor.harmonic * math.sin(2 * x + phases[1])
    return motor.force_n * envelope * force
