"""Fit of the simulation to recordings: force curve and turn-on, noise, and level of vibration.

Each figure has a 95 % interval. The curve follows from the voltages under known weights, ahead of
the slide. Noise and level compare each trial with its simulated counterpart, in the voltage: the
variance of noise adds, and vibration is nearly proportional to the roughness that the pad feels.
Student's t of the trials gives the intervals.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fingertip.calibration.printer import apply_calibration
from fingertip.calibration.sensor import MIN_LOADS, MIN_WEIGHINGS, calibrate_sensor, parse_weighings
from fingertip.catalogues.electronics import HYSTERESIS, PART_TO_PART
from fingertip.design import Design
from fingertip.foundation.numerics import CONFIDENCE, t_quantile
from fingertip.lab.campaign.run import measure_vibration_n
from fingertip.recorded_trials.trials import TrialFile
from fingertip.sim.signal.bridge import TURN_ON_WIDTH_N
from fingertip.slip.traces.trace import Trace

LOOK_S = 0.4
KEEP_OFF_S = 0.05
"""Time before the motion in which the finger holds still, and
what is left out of it at its end [s].
"""
_TURN_ONS = 60
_MIN_TURN_ON_N = 0.01
_SAME_LEVEL = 0.02


@dataclass(frozen=True)
class Fitted:
    """One figure of the simulation: stated by the design or the
    surface, and from `count` trials, with its interval.
    """

    name: str
    unit: str
    stated: float
    value: float
    low: float
    high: float
    count: int
    spread: float = 1.0
    """Factor within which real values lie about the stated one; beyond it the simulation
    must move.
    """

    def __str__(self) -> str:
        must_move = self.high < self.stated / self.spread or self.low > self.stated * self.spread
        span = (
            f"({self.low:.4g} to {self.high:.4g}, {self.count} trials){'   must move' * must_move}"
        )
        return f"{self.name:28} {self.stated:9.4g} -> {self.value:.4g} {self.unit} {span}"


def still_part(trial: TrialFile) -> slice:
    """Find the samples in which the finger rests on the slide before it moves, or else
    holds still.
    """
    trace, step_s = trial.trace, _step_s(trial.trace)
    if trace.slip is not None and trace.slip.any():
        end_s = float(trace.time_s[np.argmax(trace.slip)]) - KEEP_OFF_S
    else:
        end_s = next(
            (end for name, (_, end) in trial.labels.phases.items() if name in ("wait", "hold")), 0.0
        )

    end = round(end_s / step_s)
    return slice(max(0, end - round(LOOK_S / step_s)), end)


def mean_interval(values: Sequence[float]) -> tuple[float, float, float]:
    """Mean, and the ends of its 95 % interval; infinite with one value."""
    known = np.array([value for value in values if math.isfinite(value)])
    mean = float(known.mean()) if len(known) else math.nan
    if len(known) < 2:
        return mean, -math.inf, math.inf

    half = t_quantile(CONFIDENCE, len(known) - 1) * float(known.std(ddof=1)) / math.sqrt(len(known))
    return mean, mean - half, mean + half


def fit_curve(
    design: Design, trials: Sequence[TrialFile], sense_n: Callable[[TrialFile], float]
) -> tuple[Design, tuple[Fitted, ...], str]:
    """Fit turn-on and power law; return the design with them, and a sentence if the weights do not
    suffice.

    `sense_n` returns the force that a calibrated sensor shows under the weight of a trial [N]: the
    part of a force that reaches the sensor changes with it. The turn-on is the one about which the
    weighings scatter least. Its interval holds those that Student's t does not reject, and the next
    ones of the grid; the intervals of the power law hold those of all these turn-ons. Raises
    TraceError.
    """
    known = [
        (sense_n(trial), float(np.mean(trial.trace.voltage_v[still_part(trial)])))
        for trial in trials
        if trial.labels.force_n and trial.labels.kind in ("slide", "hold")
    ]
    loads = {round(force, 3) for force, _ in known}

    if len(loads) <= MIN_LOADS or len(known) <= MIN_WEIGHINGS:
        return (
            design,
            (),
            (
                f"the curve is not fitted: {len(known)} trials under {len(loads)} known forces; "
                "record at least "
                f"{MIN_WEIGHINGS + 1} under {MIN_LOADS + 1}, with --force-n"
            ),
        )

    idle = [
        float(np.mean(trial.trace.voltage_v[: max(1, round(0.5 / _step_s(trial.trace)))]))
        for trial in trials
    ]
    rows = [(0.0, float(np.mean(idle))), *known]
    weighings = parse_weighings(
        "\n".join(["force_n,voltage_v", *(f"{f},{v}" for f, v in rows)]), "recordings"
    )
    highest_n = max(min(force for force, _ in known) - TURN_ON_WIDTH_N - 1e-4, 2 * _MIN_TURN_ON_N)
    fits = [
        calibrate_sensor(design.with_values({"force_curve.turn_on_n": turn_on_n}), weighings)
        for turn_on_n in np.linspace(_MIN_TURN_ON_N, highest_n, _TURN_ONS).round(6).tolist()
    ]
    best = min(fits, key=lambda fit: fit.law.scatter)
    count = len(weighings.rows)
    allowed = best.law.scatter**2 * (
        1 + t_quantile(CONFIDENCE, max(1, count - 3)) ** 2 / max(1, count - 3)
    )
    kept = [at for at, fit in enumerate(fits) if fit.law.scatter**2 <= allowed]
    near = [fit.law for fit in fits[max(0, kept[0] - 1) : kept[-1] + 2]]
    exponents = [
        law.exponent + sign * law.coverage_factor * law.exponent_uncertainty
        for law in near
        for sign in (-1, 1)
    ]
    conductances_us = [
        1e6
        * law.conductance_s
        * math.exp(
            sign
            * law.coverage_factor
            * law.scatter
            * math.sqrt(1 / count + law.mean_log_force**2 / law.squares)
        )
        for law in near
        for sign in (-1, 1)
    ]
    stated = design.force_curve
    turn_ons_n = [law.turn_on_n for law in near]
    law = best.law
    figures = tuple(
        Fitted(
            name=f"force_curve.{name}",
            unit=unit,
            stated=getattr(stated, name),
            value=value,
            low=min(values),
            high=max(values),
            count=count,
            spread=spread,
        )
        for name, unit, value, values, spread in (
            ("turn_on_n", "N", law.turn_on_n, turn_ons_n, 1.0),
            ("exponent", "", law.exponent, exponents, 1.0),
            ("conductance_us", "uS", 1e6 * law.conductance_s, conductances_us, PART_TO_PART[0]),
        )
    )
    factor = max(best.interval_factor, 1 + HYSTERESIS)
    changes = {
        **best.changes,
        "force_curve.turn_on_n": round(law.turn_on_n, 4),
        "force_curve.interval_factor": factor,
    }

    return apply_calibration(design, changes), figures, ""


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
        math.sqrt(max(0.0, used_v**2 + each)) for each in mean_interval(differences)
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
    """Logarithm of the roughness of the round before, and of its
    ratio of vibration, recorded to simulated.
    """

    def add_round(self, pairs: Pairs) -> Fitted | None:
        """Take slides that were simulated with `um`; None if none
        of them shows vibration above its noise.
        """
        ratios = [(_excess(measured), _excess(simulated)) for measured, simulated in pairs]
        logs = [0.5 * math.log(a / b) for a, b in ratios if a > 0.0 and b > 0.0]
        if not logs:
            return None

        mean = mean_interval(logs)
        used = math.log(self.um)
        slope = 1.0
        if self._before and abs(used - self._before[0]) > _SAME_LEVEL:
            slope = min(max((self._before[1] - mean[0]) / (used - self._before[0]), 0.5), 2.0)

        self._before = used, mean[0]
        self.um, low, high = (math.exp(used + each / slope) for each in mean)
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
    """Variance of the voltage in the middle three fifths of the
    motion, beyond that of its noise [V2].
    """
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
