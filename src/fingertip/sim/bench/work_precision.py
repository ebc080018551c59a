"""Work-precision diagrams: error and CPU time of several solvers on one problem, as data and as text."""

from __future__ import annotations

import os
import platform
import statistics
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from fingertip import extras
from fingertip.arrays import Array

MIN_ERROR_RATIO = 100.0
"""Smallest ratio of an error to the difference of the two references at which the error counts as known."""
_REPEAT_BELOW_S = 1.0


@dataclass(frozen=True)
class Point:
    """One solver at one setting."""

    solver: str
    setting: str
    cpu_s: float
    error: float


@dataclass
class WorkPrecision:
    """Points of one problem, and the runs that gave no point."""

    problem: str
    unit: str
    target: float
    """Error that is small enough in practice, in `unit`."""
    target_ratios: dict[str, float] = field(default_factory=dict)
    """Solver -> how many times fingertip's CPU time it should take at that error."""
    reference_difference: float = 0.0
    """Largest difference between the two references, in `unit`."""
    input_s: float = 0.0
    """CPU time of generating the input once [s]; part of every solver's points."""
    points: list[Point] = field(default_factory=list)
    omissions: list[str] = field(default_factory=list)

    def measure(self, solver: str, setting: str, run: Callable[[], Array], reference: Array) -> None:
        """Measure a run; list it among the omissions if it fails or its error is not known."""
        try:
            result, cpu = measure_cpu_s(run)
        except Exception as error:  # another solver may fail in any way; the failure is reported
            self.omissions.append(f"{solver}, {setting}: failed ({type(error).__name__}: {str(error)[:80]})")
            return
        self.add_result(solver, setting, cpu, result, reference)

    def add_result(self, solver: str, setting: str, cpu_s: float, result: Array, reference: Array) -> None:
        """Add a result as a point, or list it among the omissions."""
        error = float(np.abs(result - reference).max()) if result.shape == reference.shape else float("nan")
        if not np.isfinite(error):
            self.omissions.append(f"{solver}, {setting}: result is not finite at every sample")
        elif error < MIN_ERROR_RATIO * self.reference_difference:
            self.omissions.append(
                f"{solver}, {setting}: error of {error:.1e} {self.unit} is too small to measure; an error counts from "
                f"{MIN_ERROR_RATIO:g} times the difference of the references, "
                f"{self.reference_difference:.1e} {self.unit} (CPU time {cpu_s:.3g} s)"
            )
        else:
            self.points.append(Point(solver, setting, cpu_s + self.input_s, error))

    def fastest_point(self, solver: str, max_error: float) -> Point | None:
        """Fastest point of a solver with at most this error."""
        good = [p for p in self.points if p.solver == solver and p.error <= max_error]
        return min(good, key=lambda p: p.cpu_s, default=None)

    def cpu_ratio(self, base: str, solver: str) -> float | None:
        """Ratio of the CPU time of `solver` to that of `base`, at an error at which `base` is at least as accurate.

        The solver's fastest point within the target is compared with the fastest point of `base` that is at least as
        accurate.
        """
        other = self.fastest_point(solver, self.target)
        best = self.fastest_point(base, other.error) if other else None
        return other.cpu_s / best.cpu_s if other and best else None

    def cpu_ratios(self) -> dict[str, float | None]:
        """Ratio of the CPU time of each solver to that of the first, fingertip; None without a point to compare."""
        solvers = list(dict.fromkeys(point.solver for point in self.points))
        return {solver: self.cpu_ratio(solvers[0], solver) for solver in solvers[1:]}

    def as_data(self) -> dict[str, Any]:
        """Diagram for JSON."""
        return asdict(self) | {"cpu_ratios": self.cpu_ratios()}

    def as_text(self) -> list[str]:
        """Diagram as lines of text."""
        unit = self.unit
        lines = [f"{self.problem}: the references differ by {self.reference_difference:.1e} {unit}"]
        lines += [f"  {p.solver:28}{p.setting:28}{p.error:10.1e} {unit}{1e3 * p.cpu_s:12.2f} ms" for p in self.points]
        for solver, ratio in self.cpu_ratios().items():
            text = f"{ratio:.0f} times fingertip's CPU time" if ratio else "no comparable point"
            if solver in self.target_ratios:
                text += f" (target {self.target_ratios[solver]:g})"
            lines.append(
                f"  {solver}: {text} at an error of at most {self.target:g} {unit}, with fingertip's no larger"
            )
        if self.omissions:
            lines.append("  omitted:")
        return lines + [f"    {line}" for line in self.omissions]


def measure_cpu_s(run: Callable[[], Array]) -> tuple[Array, float]:
    """Return a result, and the median CPU time of five runs [s] (of one run if it is slow)."""
    times = []
    for _ in range(5):
        start = time.process_time()
        result = run()
        times.append(time.process_time() - start)
        if times[-1] > _REPEAT_BELOW_S:
            break
    return result, statistics.median(times)


def describe_machine() -> dict[str, Any]:
    """Describe the machine that the times are measured on, and its load."""
    return {
        "machine": platform.machine(),
        "cores": os.cpu_count(),
        "load": [round(x, 2) for x in os.getloadavg()],
        "python": platform.python_version(),
    }


def require_libraries() -> None:
    """Raise unless the libraries that the benchmark compares with and draws with are installed.

    Raises
    ------
    MissingLibraryError
        With the names of the missing packages.
    """
    extras.require("fingertip bench", "scipy", "numba", "matplotlib")
