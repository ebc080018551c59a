"""Error and CPU time of whole trials on finer and finer grids, against two references
that agree.
"""

from __future__ import annotations

import statistics
import time
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from benchmarks.peers.trial_reference import AFTER_S, BEFORE_S, solve_with_scipy
from fingertip.board.components.values import SUPPLIES
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.sim.runs.scene import SceneRun, run_scene
from fingertip.sim.signal.grid import BASE_HZ, Grid
from fingertip.sim.signal.simulated_finger import FingerSignals
from fingertip.sim.simulation import Trial

QUANTITIES = ("force_n", "tactile_v", "envelope_v")
VARIANTS = ("article", "precision", "comparator")
TARGETS = {"force_n": 5e-5, "envelope_v": 8e-4}
"""Largest errors at the base grid [N, V]."""
CPU_TARGET_S = 0.0275
"""CPU time of such a trial before the finger was computed on one grid [s], on the machine of the
figures in docs/accuracy.md.
"""
TRIAL = Trial("gross", 0.06, 1.0, 5)
"""A trial of the article whose slip every variant of the board shows."""
_REFINEMENTS = (1, 2, 4, 8)
_FINEST = 64
_ROUNDS = 5


@dataclass(frozen=True)
class TrialPoint:
    """One variant on one grid."""

    variant: str
    step_s: float
    cpu_s: float
    """CPU time of the whole trial, about 6 s long [s]."""
    errors: dict[str, float]
    """Largest error of each quantity at a sample, over the whole trial."""


@dataclass
class TrialAccuracy:
    """Errors of a whole trial, and how far its two references differ."""

    points: list[TrialPoint] = field(default_factory=list)
    reference_differences: dict[str, dict[str, float]] = field(default_factory=dict)
    """Variant -> quantity -> largest difference of both references around the onset of slip."""

    def order(self, variant: str, quantity: str) -> float:
        """Order of convergence: slope of the error over the step, both logarithmic."""
        points = [p for p in self.points if p.variant == variant]
        steps = np.log([p.step_s for p in points])
        errors = np.log([p.errors[quantity] for p in points])

        return float(np.polyfit(steps, errors, 1)[0])

    @property
    def misses_target(self) -> bool:
        """True if an error at the base grid is above its target."""
        base = [p for p in self.points if p.step_s == 1 / BASE_HZ]
        return any(p.errors[name] > limit for p in base for name, limit in TARGETS.items())

    def as_data(self) -> dict[str, Any]:
        """Points, orders and differences for JSON."""
        orders = {
            v: {q: self.order(v, q) for q in QUANTITIES}
            for v in dict.fromkeys(p.variant for p in self.points)
        }
        return asdict(self) | {"orders": orders, "targets": TARGETS}

    def as_text(self) -> list[str]:
        """Lines of text."""
        lines = [
            f"whole trial ({TRIAL.surface}, {TRIAL.speed_m_s:g} m/s, {TRIAL.force_n:g} N), "
            "largest errors at a sample; "
            f"targets at {1e6 / BASE_HZ:g} us: {TARGETS['force_n']:g} N, "
            f"{TARGETS['envelope_v']:g} V"
        ]
        for p in self.points:
            errors = ", ".join(f"{name} {error:.1e}" for name, error in p.errors.items())
            lines.append(
                f"  {p.variant:12}{1e6 * p.step_s:8.2f} us{1e3 * p.cpu_s:10.1f} ms   {errors}"
            )

        for variant, found in self.reference_differences.items():
            orders = ", ".join(f"{name} {self.order(variant, name):.1f}" for name in QUANTITIES)
            differences = ", ".join(f"{name} {value:.1e}" for name, value in found.items())
            lines.append(f"  {variant}: order {orders}; the references differ by {differences}")

        return lines


def measure_trial() -> TrialAccuracy:
    """Measure a whole trial with each variant of the board, with compiled loops.

    The first reference is the same program on a grid 64 times as fine, the second one is scipy's
    (`benchmarks.peers.trial_reference`).
    """
    found = TrialAccuracy()
    scene = TRIAL.scene
    quiet = scene.sensing.model_copy(update={"noise": False})
    scene = scene.model_copy(update={"outputs": [*QUANTITIES, "shear_m"], "sensing": quiet})

    for variant in VARIANTS:
        # Sampled at every point of the base grid, without noise and steps of a converter.
        tables = {
            "noise_v": 0.0,
            "adc_bits": 24,
            "sample_rate_hz": BASE_HZ,
            "window_samples": 300,
        }
        design = Design(
            detector=tables, board={"variant": variant, "supply_v": SUPPLIES[variant].nominal_v}
        )
        finest = run_scene(design, scene, TRIAL.seed, grid=Grid(_FINEST)).signals

        for refinement in _REFINEMENTS:
            times = []
            signals = finest
            for _ in range(_ROUNDS):
                start = time.process_time()
                signals = run_scene(design, scene, TRIAL.seed, grid=Grid(refinement)).signals
                times.append(time.process_time() - start)

            errors = {name: _largest_difference(signals, finest, name) for name in QUANTITIES}
            found.points.append(
                TrialPoint(variant, Grid(refinement).step_s, statistics.median(times), errors)
            )

        found.reference_differences[variant] = _compare_with_scipy(
            design, SceneRun(design, scene, TRIAL.seed), finest
        )

    return found


def _compare_with_scipy(design: Design, run: SceneRun, finest: FingerSignals) -> dict[str, float]:
    """Largest difference of each quantity from scipy's solution, in its window."""
    assert run.timeline.slide
    begin = run.timeline.slide.start_s - BEFORE_S
    force_n = _column(finest, "force_n")
    second = solve_with_scipy(design, run, force_n[finest.time_s < begin])
    inside = (finest.time_s > begin + 1e-9) & (finest.time_s < begin + BEFORE_S + AFTER_S - 1e-9)

    return {
        name: float(
            np.abs(
                _column(finest, name)[inside]
                - np.interp(finest.time_s[inside], second.time_s, getattr(second, name))
            ).max()
        )
        for name in QUANTITIES
    }


def _largest_difference(one: FingerSignals, other: FingerSignals, name: str) -> float:
    return float(np.abs(_column(one, name) - _column(other, name)).max())


def _column(signals: FingerSignals, name: str) -> Array:
    return np.asarray(getattr(signals, name), dtype=np.float64)
