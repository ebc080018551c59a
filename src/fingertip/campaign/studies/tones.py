"""How long a motor's tones look like slip: the least time in which anything could tell them apart.

A motor gives a tone and its second harmonic. To a stretch of voltage the nearest such pair is fitted, of any frequency,
phase and amplitude, over a constant and a slope. Of a motor it leaves noise, and of a motor that swells somewhat more.
Slip that is no tone leaves more than that, once the stretch is long enough: a few periods. Until then no detector that
sees one force axis can know, whatever it computes; it must take motors for slip, or be late.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.campaign.plan import HELD_OUT_FROM, QUIET, Amount, Case, cases
from fingertip.campaign.record import record
from fingertip.design import Design
from fingertip.sim.jit import compiled
from fingertip.slip.detectors.noise import input_noise_v

STRETCHES_S = (0.02, 0.03, 0.04, 0.06, 0.08, 0.1, 0.15)
FREQUENCIES_HZ = tuple(np.arange(25.0, 121.0, 2.5).tolist())


@dataclass(frozen=True)
class Told:
    """One length of the stretch."""

    stretch_s: float
    motor_left: float
    """What the pair leaves of the worst motor, over the noise."""
    slip_left: float
    """The same of slip, median."""
    told_share: float
    """Slips that leave more than any motor did."""


def tones(
    design: Design, trials: int = 24, motors: int = 8, first_seed: int = HELD_OUT_FROM,
    stretches_s: Sequence[float] = STRETCHES_S,
) -> list[Told]:  # fmt: skip
    """Slips and motors from the onset on, as long as each stretch."""
    rate, noise = design.detector.sample_rate_hz, input_noise_v(design)
    shaken = QUIET["motor"][0]
    planned = [case for case in cases(Amount(trials, 0.5), first_seed) if case.cause == "slip"]
    planned += [Case("motor", shaken, first_seed + 10_000 + i) for i in range(motors)]
    stretches: dict[str, list[Array]] = {"slip": [], "motor": []}
    longest = round(max(stretches_s) * rate)
    with compiled():
        for case in planned:
            trace, _ = record(design, case, board=False)
            assert trace.slip is not None
            start = int(np.flatnonzero(trace.slip)[0]) if case.cause == "slip" else round(_motor_s(trace.time_s) * rate)
            stretches[case.cause].append(trace.voltage_v[start : start + longest])
    out = []
    for stretch_s in stretches_s:
        count = round(stretch_s * rate)
        pairs = [_pair(count, rate, f) for f in FREQUENCIES_HZ]
        left = {cause: [_left(part[:count], pairs) / noise for part in parts] for cause, parts in stretches.items()}
        worst = max(left["motor"])
        told = float(np.mean([value > worst for value in left["slip"]]))
        out.append(Told(stretch_s, worst, float(np.median(left["slip"])), told))
    return out


def _motor_s(time_s: Array) -> float:
    """When the motor begins [s]: its scene ends a known time after it."""
    scene = QUIET["motor"][0]
    hold, motor = scene.hold, scene.motor
    tail = motor.duration_s + hold.wait_s + (hold.close_s if hold.release else 0.0) + hold.after_s
    return float(time_s[-1]) - tail


def _pair(count: int, rate_hz: float, frequency_hz: float) -> Array:
    """An orthonormal basis of the pair, a constant and a slope."""
    t = np.arange(count) / rate_hz
    w = 2 * math.pi * frequency_hz
    columns = [np.ones(count), t, np.cos(w * t), np.sin(w * t), np.cos(2 * w * t), np.sin(2 * w * t)]
    basis: Array = np.linalg.qr(np.array(columns).T)[0]
    return basis


def _left(part: Array, pairs: Sequence[Array]) -> float:
    """Rms of what the nearest pair leaves, for as many degrees of freedom as it leaves."""
    square = min(float(part @ part - np.sum((basis.T @ part) ** 2)) for basis in pairs)
    return math.sqrt(max(square, 0.0) / (len(part) - 7))
