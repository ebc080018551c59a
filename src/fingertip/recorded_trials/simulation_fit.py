"""Fit of the simulation to recordings: force curve and turn-on, noise, and level of vibration.

Each figure has a 95 % interval. The curve follows from the voltages under known weights, ahead of
the slide. Noise and level compare each trial with its simulated counterpart, in the voltage: the
variance of noise adds, and vibration is nearly proportional to the roughness that the pad feels.
Student's t of the trials gives the intervals.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fingertip.calibration.printer import apply_calibration
from fingertip.calibration.sensor import (
    MIN_LOADS,
    MIN_WEIGHINGS,
    PowerLaw,
    SensorCalibration,
    Weighings,
    calibrate_sensor,
    parse_weighings,
)
from fingertip.catalogues.electronics import HYSTERESIS, PART_TO_PART
from fingertip.design import Design
from fingertip.design.parameters.sensor_and_skin import ForceCurve
from fingertip.foundation.numerics import CONFIDENCE, t_quantile
from fingertip.lab.campaign.run import measure_vibration_n
from fingertip.recorded_trials.trials import TrialFile
from fingertip.sim.signal.bridge import TURN_ON_WIDTH_N
from fingertip.slip.traces.trace import Trace

LOOK_S = 0.4
KEEP_OFF_S = 0.05
"""Time ahead of the motion in which the finger holds still, and its end that is left out [s]."""
_TURN_ONS = 60
_MIN_TURN_ON_N = 0.01
_SAME_LEVEL = 0.02


@dataclass(frozen=True)
class Fitted:
    """One figure of the simulation: as stated, and as fitted to `count` trials, with interval."""

    name: str
    unit: str
    stated: float
    value: float
    low: float
    high: float
    count: int
    spread: float = 1.0
    """Factor within which real values lie; the simulation must move if the interval is outside."""

    def __str__(self) -> str:
        must_move = self.high < self.stated / self.spread or self.low > self.stated * self.spread
        span = (
            f"({self.low:.4g} to {self.high:.4g}, {self.count} trials){'   must move' * must_move}"
        )
        return f"{self.name:28} {self.stated:9.4g} -> {self.value:.4g} {self.unit} {span}"


def still_part(trial: TrialFile) -> slice:
    """Return the samples in which the finger rests on the slide before it moves, or holds still."""
    trace = trial.trace
    step_s = _step_s(trace)
    if trace.slip is not None and trace.slip.any():
        end_s = float(trace.time_s[np.argmax(trace.slip)]) - KEEP_OFF_S
    else:
        phases = trial.labels.phases.items()
        end_s = next((end for name, (_, end) in phases if name in ("wait", "hold")), 0.0)

    end = round(end_s / step_s)
    return slice(max(0, end - round(LOOK_S / step_s)), end)


def mean_interval(values: Sequence[float]) -> tuple[float, float, float]:
    """Return the mean of the finite values and its 95 % interval; infinite for one value."""
    finite = np.array([value for value in values if math.isfinite(value)])
    count = len(finite)
    mean = float(finite.mean()) if count else math.nan
    if count < 2:
        return mean, -math.inf, math.inf

    half = t_quantile(CONFIDENCE, count - 1) * float(finite.std(ddof=1)) / math.sqrt(count)
    return mean, mean - half, mean + half


def fit_curve(
    design: Design, trials: Sequence[TrialFile], sense_n: Callable[[TrialFile], float]
) -> tuple[Design, tuple[Fitted, ...], str]:
    """Fit turn-on and power law; return the fitted design, its figures, and a note if none is
    fitted.

    `sense_n` returns the force that a calibrated sensor shows under the weight of a trial [N]: the
    part of a force that reaches the sensor changes with it. The turn-on is the one about which the
    weighings scatter least. Its interval holds those that Student's t does not reject, and the next
    ones of the grid; the intervals of the power law hold those of all these turn-ons. Raises
    TraceError.
    """
    loaded = [
        (sense_n(trial), float(np.mean(trial.trace.voltage_v[still_part(trial)])))
        for trial in trials
        if trial.labels.force_n and trial.labels.kind in ("slide", "hold")
    ]
    loads = {round(force, 3) for force, _ in loaded}

    if len(loads) <= MIN_LOADS or len(loaded) <= MIN_WEIGHINGS:
        note = (
            f"the curve is not fitted: {len(loaded)} trials under {len(loads)} known forces; "
            "record at least "
            f"{MIN_WEIGHINGS + 1} under {MIN_LOADS + 1}, with --force-n"
        )
        return design, (), note

    weighings = _collect_weighings(trials, loaded)
    fits = _fit_each_turn_on(design, weighings, min(force_n for force_n, _ in loaded))
    best = min(fits, key=lambda fit: fit.law.scatter)
    count = len(weighings.rows)
    figures = _describe_law(design.force_curve, best.law, _select_likely(fits, count), count)
    changes = {
        **best.changes,
        "force_curve.turn_on_n": round(best.law.turn_on_n, 4),
        "force_curve.interval_factor": max(best.interval_factor, 1 + HYSTERESIS),
    }

    return apply_calibration(design, changes), figures, ""


def _collect_weighings(
    trials: Sequence[TrialFile], loaded: Sequence[tuple[float, float]]
) -> Weighings:
    """Collect forces [N] and voltages [V], with the mean voltage before trials at no force."""
    idle_v = [
        float(np.mean(trial.trace.voltage_v[: max(1, round(0.5 / _step_s(trial.trace)))]))
        for trial in trials
    ]
    rows = [(0.0, float(np.mean(idle_v))), *loaded]
    lines = ["force_n,voltage_v", *(f"{force_n},{volts}" for force_n, volts in rows)]
    return parse_weighings("\n".join(lines), "recordings")


def _fit_each_turn_on(
    design: Design, weighings: Weighings, smallest_n: float
) -> list[SensorCalibration]:
    """Fit a power law for each turn-on of a grid, up to a smallest force [N]."""
    highest_n = max(smallest_n - TURN_ON_WIDTH_N - 1e-4, 2 * _MIN_TURN_ON_N)
    return [
        calibrate_sensor(design.with_values({"force_curve.turn_on_n": turn_on_n}), weighings)
        for turn_on_n in np.linspace(_MIN_TURN_ON_N, highest_n, _TURN_ONS).round(6).tolist()
    ]


def _select_likely(fits: Sequence[SensorCalibration], count: int) -> list[PowerLaw]:
    """Select the laws that Student's t does not reject, and the next ones of the grid."""
    least = min(fit.law.scatter for fit in fits)
    freedom = max(1, count - 3)
    largest = least**2 * (1 + t_quantile(CONFIDENCE, freedom) ** 2 / freedom)
    likely = [i for i, fit in enumerate(fits) if fit.law.scatter**2 <= largest]
    return [fit.law for fit in fits[max(0, likely[0] - 1) : likely[-1] + 2]]


def _describe_law(
    stated: ForceCurve, law: PowerLaw, likely: Sequence[PowerLaw], count: int
) -> tuple[Fitted, ...]:
    """Return the figures of a law, with the intervals that hold those of all likely laws."""
    exponents = []
    conductances_us = []
    for candidate, sign in itertools.product(likely, (-1, 1)):
        factor = sign * candidate.coverage_factor
        exponents.append(candidate.exponent + factor * candidate.exponent_uncertainty)
        spread = math.sqrt(1 / count + candidate.mean_log_force**2 / candidate.squares)
        ratio = math.exp(factor * candidate.scatter * spread)
        conductances_us.append(1e6 * candidate.conductance_s * ratio)

    turn_ons_n = [candidate.turn_on_n for candidate in likely]
    conductance_us = 1e6 * law.conductance_s
    rows = (
        ("turn_on_n", "N", law.turn_on_n, turn_ons_n, 1.0),
        ("exponent", "", law.exponent, exponents, 1.0),
        ("conductance_us", "uS", conductance_us, conductances_us, PART_TO_PART[0]),
    )
    return tuple(
        Fitted(
            name=f"force_curve.{name}",
            unit=unit,
            stated=getattr(stated, name),
            value=value,
            low=min(ends),
            high=max(ends),
            count=count,
            spread=spread,
        )
        for name, unit, value, ends, spread in rows
    )


def _step_s(trace: Trace) -> float:
    return float(trace.time_s[1] - trace.time_s[0])


Pairs = Sequence[tuple[TrialFile, TrialFile]]
"""Recorded trials, each with its simulated counterpart."""


def fit_noise(stated_v: float, used_v: float, pairs: Pairs) -> Fitted:
    """Fit the white noise [V] for which the voltages at rest vary as much as the recorded ones."""

    def variance(trial: TrialFile) -> float:
        return float(np.mean(np.diff(trial.trace.voltage_v[still_part(trial)]) ** 2)) / 2

    differences = [variance(measured) - variance(simulated) for measured, simulated in pairs]
    value, low, high = (
        math.sqrt(max(0.0, used_v**2 + difference)) for difference in mean_interval(differences)
    )
    return Fitted(
        name="detector.noise_v",
        unit="V",
        stated=stated_v,
        value=value,
        low=low,
        high=high,
        count=len(pairs),
    )


@dataclass
class LevelFit:
    """Fit of the roughness that the pad feels on a surface [um], by the secant of its logarithm.

    Vibration grows a little faster than the roughness, so that the slope of two rounds is needed.
    """

    name: str
    stated_um: float
    um: float
    """Roughness of the next simulation."""
    _before: tuple[float, float] | None = None
    """Logarithms of the last roughness, and of its ratio of recorded to simulated vibration."""

    def add_round(self, pairs: Pairs) -> Fitted | None:
        """Add slides simulated with `um`; None if none shows vibration above its noise."""
        variances = [(_excess(measured), _excess(simulated)) for measured, simulated in pairs]
        logs = [
            0.5 * math.log(measured / simulated)
            for measured, simulated in variances
            if measured > 0.0 and simulated > 0.0
        ]
        if not logs:
            return None

        mean = mean_interval(logs)
        used = math.log(self.um)
        slope = 1.0
        if self._before and abs(used - self._before[0]) > _SAME_LEVEL:
            slope = min(max((self._before[1] - mean[0]) / (used - self._before[0]), 0.5), 2.0)

        self._before = (used, mean[0])
        self.um, low, high = (math.exp(used + log / slope) for log in mean)
        return Fitted(
            name=f"surface.felt_um ({self.name})",
            unit="um",
            stated=self.stated_um,
            value=self.um,
            low=low,
            high=high,
            count=len(logs),
        )


def _excess(trial: TrialFile) -> float:
    """Return the variance of the voltage amid the motion, beyond that of its noise [V2]."""
    trace = trial.trace
    still, sliding = np.zeros((2, len(trace.time_s)), dtype=bool)
    moving = np.flatnonzero(still if trace.slip is None else trace.slip)
    still[still_part(trial)] = True
    sliding[moving[len(moving) // 5 : len(moving) - len(moving) // 5]] = True
    noise, whole = (
        measure_vibration_n(replace(trace, force_n=trace.voltage_v, slip=part))
        for part in (still, sliding)
    )

    return whole**2 - noise**2
