"""Discrimination of slip from a motor's tones: the shortest time in which any detector could distinguish them.

A motor causes a tone and its second harmonic. The best-fitting pair of such tones, of any frequency, phase and
amplitude, over a constant and a slope, is subtracted from a segment of the voltage. The residual of a motor is noise,
and somewhat more for a motor whose amplitude grows. The residual of slip, which is not a tone, is larger than that once
the segment is long enough: a few periods. In a shorter time no detector on one force axis can distinguish them; it
must take motors for slip, or be late.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.campaign.evaluate import simulate_trace
from fingertip.campaign.plan import HELD_OUT_FROM, NEGATIVE_SCENES, CampaignPlan, Case, generate_cases
from fingertip.design import Design
from fingertip.jit import compiled
from fingertip.slip.detectors.noise import input_noise_v

SEGMENTS_S = (0.02, 0.03, 0.04, 0.06, 0.08, 0.1, 0.15)
"""Lengths of the segments [s]."""
FREQUENCIES_HZ = tuple(np.arange(25.0, 121.0, 2.5).tolist())
"""Frequencies of the lower tone that are tried [Hz]."""


@dataclass(frozen=True)
class DiscriminationResult:
    """Result for one length of the segment."""

    segment_s: float
    motor_residual: float
    """Largest residual of any motor, relative to the noise."""
    slip_residual: float
    """Median residual of slip, relative to the noise."""
    distinguished_share: float
    """Fraction of the slips whose residual is larger than that of every motor."""


def study_motor_discrimination(
    design: Design, trials: int = 24, motors: int = 8, first_seed: int = HELD_OUT_FROM,
    segments_s: Sequence[float] = SEGMENTS_S,
) -> list[DiscriminationResult]:  # fmt: skip
    """Compare slips and motors from their onset on, for each length of the segment."""
    rate, noise = design.detector.sample_rate_hz, input_noise_v(design)
    motor_scene = NEGATIVE_SCENES["motor"][0]
    cases = [case for case in generate_cases(CampaignPlan(trials, 0.5), first_seed) if case.cause == "slip"]
    cases += [Case("motor", motor_scene, first_seed + 10_000 + i) for i in range(motors)]
    segments: dict[str, list[Array]] = {"slip": [], "motor": []}
    longest = round(max(segments_s) * rate)
    with compiled():
        for case in cases:
            trace, _ = simulate_trace(design, case, [])
            assert trace.slip is not None
            slip = case.cause == "slip"
            start = int(np.flatnonzero(trace.slip)[0]) if slip else round(_motor_onset_s(trace.time_s) * rate)
            segments[case.cause].append(trace.voltage_v[start : start + longest])
    results = []
    for segment_s in segments_s:
        count = round(segment_s * rate)
        bases = [_tone_pair_basis(count, rate, f) for f in FREQUENCIES_HZ]
        residuals = {
            cause: [_residual(segment[:count], bases) / noise for segment in recorded]
            for cause, recorded in segments.items()
        }
        worst = max(residuals["motor"])
        fraction = float(np.mean([value > worst for value in residuals["slip"]]))
        results.append(DiscriminationResult(segment_s, worst, float(np.median(residuals["slip"])), fraction))
    return results


def _motor_onset_s(time_s: Array) -> float:
    """Moment at which the motor starts [s]: a known time before the end of its scene."""
    scene = NEGATIVE_SCENES["motor"][0]
    hold, motor = scene.hold, scene.motor
    tail = motor.duration_s + hold.wait_s + (hold.close_s if hold.release else 0.0) + hold.after_s
    return float(time_s[-1]) - tail


def _tone_pair_basis(count: int, rate_hz: float, frequency_hz: float) -> Array:
    """Orthonormal basis of a pair of tones, a constant and a slope."""
    t = np.arange(count) / rate_hz
    w = 2 * math.pi * frequency_hz
    columns = [np.ones(count), t, np.cos(w * t), np.sin(w * t), np.cos(2 * w * t), np.sin(2 * w * t)]
    basis: Array = np.linalg.qr(np.array(columns).T)[0]
    return basis


def _residual(segment: Array, bases: Sequence[Array]) -> float:
    """RMS residual of the best-fitting pair of tones, per degree of freedom that remains."""
    square = min(float(segment @ segment - np.sum((basis.T @ segment) ** 2)) for basis in bases)
    return math.sqrt(max(square, 0.0) / (len(segment) - 7))
