"""Limits of one force axis: a bound on the delay, and what is not distinguished from slip, motors and weak knocks.

The estimated lower bound on the mean delay of a detector that sees the energy of one band only is Lorden's. A change
that increases the information by I per second is found, on average and for a mean time between false alarms of gamma
independent decisions, no sooner than ``ln(gamma) / I`` (G. Lorden, Ann. Math. Stat. 42(6), 1971,
doi:10.1214/aoms/1177693055). CUSUM reaches this bound. Here slip grows, so the information is integrated from the onset
until it reaches ln(gamma).

Gaussian noise of power n in a band of width B that becomes n + s gives ``B (r - 1 - ln r)`` nats per second, with r = 1
+ s / n. The band is the wide one of the detector `fast`, seen through its own causal filters, whose delay is part of
the bound. s is the power that the same trial shows there without noise. The bound covers noise and slip only: it does
not have to distinguish slip from a load change, and it knows in advance how strong this slip will be. It is therefore
not a goal. A detector that also sees the slow force, as `fast` does, may be sooner. The bound is asymptotic, for rare
false alarms, and limits the mean over the noise: the same slip is found a little sooner with some noise, and later with
other noise. Percentiles of few slips may lie below it.

Motors: the best-fitting pair of tones, of any frequency, phase and amplitude, over a constant and a slope, is
subtracted from a segment of the voltage. The residual of a motor is noise, and somewhat more for a motor whose
amplitude grows. The residual of slip, which is not a tone, is larger than that once the segment is long enough: a few
periods. In a shorter time no detector on one force axis can distinguish them; it must take motors for slip, or be late.

Knocks: a knock excites the pad's own resonance, in the band in which slip shows, and lasts as long as the energy window
of a few milliseconds: on one force axis a weak knock looks like a short slip. A hard knock differs only in its rate of
change, which no slip reaches. The trees of `fast` weigh slope, decay and one-way movement.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.foundation.workers import call_each
from fingertip.lab.campaign.plan import HELD_OUT_FROM, NEGATIVE_SCENES, Case, generate_trials
from fingertip.lab.campaign.run import run_cases, simulate_trace
from fingertip.sim import run_scene
from fingertip.slip.detectors.fast import FastDetector, FastSettings
from fingertip.slip.detectors.fast_coefficients import HIGH_HZ, LOW_HZ
from fingertip.slip.detectors.noise import input_noise_v, mean_quantised_noise_v

ALARMS_PER_MINUTE = 0.1
"""Rate of false alarms for which the bound holds [1/min]."""
_MIN_NOISE_V = 1e-12
"""Noise floor used when the design states zero noise [V]."""
_CREEP_S = 0.02
"""Time before gross slip in which the creeping pad's information counts [s]: the robot has moved for some 8 ms."""
_SMOOTHING_S = 0.002
"""Time over which the power is averaged, half of it ahead [s]: the bound may know the slip."""


def compute_bounds_s(design: Design, slips: Iterable[Case]) -> list[float]:
    """Compute the bound on the mean delay of each slip [s], infinite where the information never suffices."""
    noise_v = mean_quantised_noise_v(design.detector.noise_v, design.detector.adc_step_v)
    settings = FastSettings.from_design(design, max(noise_v, _MIN_NOISE_V))
    tables = design.model_dump()
    tables["detector"]["adc_bits"] = 24
    noiseless = Design(**tables)
    return list(call_each(partial(_compute_bound_s, noiseless, settings, case) for case in slips))


def _compute_bound_s(noiseless: Design, settings: FastSettings, case: Case) -> float:
    sensing = case.scene.sensing.model_copy(update={"noise": False})
    scene = case.scene.model_copy(update={"outputs": ["voltage_v", "slip"], "sensing": sensing})
    trace = run_scene(noiseless, scene, case.seed).trace
    assert trace.slip is not None
    slipping, detector = np.flatnonzero(trace.slip), FastDetector(settings)
    rate, width = settings.sample_rate_hz, HIGH_HZ - LOW_HZ
    noise = detector.coefficients.wide_share * settings.noise_v**2  # mean power in the wide band [V^2]
    filtered = detector.process(trace.voltage_v).filtered_v
    begin = max(0, slipping[0] - round(_CREEP_S * rate))
    smoothing = max(1, round(_SMOOTHING_S * rate))
    average = np.full(smoothing, 1 / smoothing)
    power = np.convolve(filtered * filtered, average, "same")[begin : slipping[-1] + 1]
    r = 1 + power / noise
    information = np.cumsum(width * (r - 1 - np.log(r))) / rate
    known = np.flatnonzero(information >= math.log(2 * width * 60 / ALARMS_PER_MINUTE))
    return max(0.0, float(begin + known[0] + 1 - slipping[0]) / rate) if known.size else math.inf


SEGMENTS_S = (0.02, 0.03, 0.04, 0.06, 0.08, 0.1, 0.15)
FREQUENCIES_HZ = tuple(np.arange(25.0, 121.0, 2.5).tolist())
"""Frequencies of the lower tone that are tried [Hz]."""


@dataclass(frozen=True)
class DiscriminationResult:
    segment_s: float
    motor_residual: float
    """Largest residual of any motor, relative to the noise."""
    slip_residual: float
    """Median residual of slip, relative to the noise."""
    distinguished_share: float
    """Fraction of the slips whose residual is larger than that of every motor."""


def study_motor_discrimination(
    design: Design, trials: int = 24, motors: int = 8, segments_s: Sequence[float] = SEGMENTS_S
) -> list[DiscriminationResult]:
    """Compare slips and motors from their onset on, for each length of the segment."""
    rate, noise = design.detector.sample_rate_hz, input_noise_v(design)
    motor_scene = NEGATIVE_SCENES["motor"][0]
    cases = list(generate_trials(trials))
    cases += [Case("motor", motor_scene, HELD_OUT_FROM + 10_000 + i) for i in range(motors)]
    segments: dict[str, list[Array]] = {"slip": [], "motor": []}
    longest = round(max(segments_s) * rate)
    for case in cases:
        trace = simulate_trace(design, case, [])
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


FORCES_N = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
RISES_S = (0.002, 0.004, 0.01)
"""Rise times of a knock [s]: 2 to 10 ms (assumption, as in ``params/scenes/hard_tap.toml``)."""
_SEED_OFFSET = 20_000


@dataclass(frozen=True)
class KnockResult:
    """Result of one detector for knocks of one force and rise time."""

    detector: str
    force_n: float
    rise_s: float
    false_alarm_share: float
    """Fraction of the knocks that were reported as slip: alarms over knocks, at most 1."""


def study_knock_rejection(design: Design, scenes: int = 3, forces_n: Sequence[float] = FORCES_N) -> list[KnockResult]:
    """Run scenes with a few knocks each, for every force and rise time."""
    scene = NEGATIVE_SCENES["hard tap"][0]
    results, seed = [], HELD_OUT_FROM + _SEED_OFFSET
    for rise_s, force_n in itertools.product(RISES_S, forces_n):
        tap = scene.tap.model_copy(update={"force_n": force_n, "rise_s": rise_s})
        cases = [Case("hard tap", scene.model_copy(update={"tap": tap}), seed + i) for i in range(scenes)]
        seed += scenes
        for name, (found,) in run_cases(design, cases, {"digital": (1.0,), "fast": (1.0,)}).items():
            alarms = sum(len(trial.alarms) for trial in found.trials)
            results.append(KnockResult(name, force_n, rise_s, min(1.0, alarms / (scenes * tap.count))))
    return results
