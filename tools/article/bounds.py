"""Limit of one force axis: a bound on the delay.

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
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import partial

import numpy as np

from fingertip.design import Design
from fingertip.foundation.workers import call_each
from fingertip.lab.campaign.plan import Case
from fingertip.sim import run_scene
from fingertip.slip.detectors.fast import FastDetector
from fingertip.slip.detectors.fast_coefficients import HIGH_HZ, LOW_HZ
from fingertip.slip.detectors.fast_settings import FastSettings
from tools.quantised_noise import mean_quantised_noise_v

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
