"""What is not slip: taps and motors shake the contact, drift and a touched cable change the voltage."""

from __future__ import annotations

import math
import random

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.scenes.scene_sections import Cable, Drift, Motor, Tap
from fingertip.sim.scenes.timeline import rise

CREEP_FROM_S = 1.0
"""Creep is counted in decades of time after this, at which data sheets read the sensor. Assumption."""


def taps_n(tap: Tap, held_s: float, time_s: Array) -> Array:
    """Force of the taps [N]: each rises and falls as ``x^2 (3 - 2 x)``."""
    total = np.zeros_like(time_s)
    for i in range(tap.count):
        t = (time_s - held_s - tap.at_s - i * tap.interval_s) / tap.rise_s
        total += rise(t) - rise(t - 1)
    return tap.force_n * total


def motor_n(motor: Motor, rng: random.Random, held_s: float, time_s: Array) -> Array:
    """Force of the motors' vibration [N]; the seed sets its phases. It swells and ends within 20 ms."""
    phases = [2 * math.pi * rng.random() for _ in range(2)]
    w = 2 * math.pi * motor.frequency_hz
    t = time_s - held_s - motor.at_s
    swell = rise(t / 0.02) - rise((t - motor.duration_s) / 0.02 + 1)
    force = np.zeros_like(t)
    for i in np.flatnonzero(swell).tolist():
        x = w * float(t[i])
        force[i] = math.sin(x + phases[0]) + motor.harmonic * math.sin(2 * x + phases[1])
    return motor.force_n * swell * force


def creep(drift: Drift, shown_n: Array, step_s: float) -> Array:
    """Force as a creeping sensor shows it [N]: more by a share for each decade of time under load."""
    out, since = [], 0
    for force in shown_n.tolist():
        since = since + 1 if force > 0.0 else 0
        out.append(force * (1 + drift.share_per_decade * math.log10(1 + since * step_s / CREEP_FROM_S)))
    return np.array(out)


def cable_v(cable: Cable, held_s: float, time_s: Array) -> tuple[Array, Array]:
    """Voltage that a touched cable adds [V]: a jump that decays, at each end, and hum between. Second: the same right
    before each sample, for a jump since the sample before is taken to fall on the sample."""
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
