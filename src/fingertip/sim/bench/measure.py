"""What a work-precision diagram holds, and how its points are measured."""

from __future__ import annotations

import os
import platform
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fingertip.arrays import Array

AGREEMENT = 100.0
"""An error counts only if the two references agree to this fraction of it."""
_REPEAT_BELOW_S = 1.0


@dataclass(frozen=True)
class Point:
    """One solver at one setting."""

    solver: str
    setting: str
    cpu_s: float
    error: float


@dataclass
class Diagram:
    """Points of one problem, and what is not among them."""

    problem: str
    unit: str
    target: float
    """Error that is good enough, in `unit`."""
    goals: dict[str, float] = field(default_factory=dict)
    """Solver -> how many times our CPU time it should take at that error."""
    agreement: float = 0.0
    """Largest difference between the two references, in `unit`."""
    input_s: float = 0.0
    """CPU time of making the input once [s]: part of every point, ours and theirs."""
    points: list[Point] = field(default_factory=list)
    omissions: list[str] = field(default_factory=list)

    def add(self, solver: str, setting: str, run: Callable[[], Array], reference: Array, *, once: bool = False) -> None:
        """Measure a run; list it among the omissions if it fails, or if the references cannot judge its error."""
        try:
            result, cpu = timed(run, once=once)
        except Exception as error:  # another solver may fail in any way; it is reported, not hidden
            self.omissions.append(f"{solver}, {setting}: failed ({type(error).__name__}: {str(error)[:80]})")
            return
        self.judge(solver, setting, cpu, result, reference)

    def judge(self, solver: str, setting: str, cpu_s: float, result: Array, reference: Array) -> None:
        """Take a point, or omit it."""
        worst = float(np.abs(result - reference).max()) if result.shape == reference.shape else float("nan")
        if not np.isfinite(worst):
            self.omissions.append(f"{solver}, {setting}: gave no finite result at every sample")
        elif worst < AGREEMENT * self.agreement:
            self.omissions.append(
                f"{solver}, {setting}: error {worst:.1e} {self.unit} is below {AGREEMENT:g} times the references' "
                f"difference, {self.agreement:.1e} {self.unit} ({cpu_s:.3g} s)"
            )
        else:
            self.points.append(Point(solver, setting, cpu_s + self.input_s, worst))

    def cheapest(self, solver: str, at_most: float) -> Point | None:
        """The solver's fastest point with at most this error."""
        good = [p for p in self.points if p.solver == solver and p.error <= at_most]
        return min(good, key=lambda p: p.cpu_s, default=None)

    def against(self, ours: str, solver: str) -> float | None:
        """CPU time of `solver` over ours, at an error at which ours is at least as good.

        The solver's cheapest point within the target is compared with our cheapest one that is at least as exact.
        """
        theirs = self.cheapest(solver, self.target)
        best = self.cheapest(ours, theirs.error) if theirs else None
        return theirs.cpu_s / best.cpu_s if theirs and best else None


def timed(run: Callable[[], Array], *, once: bool = False) -> tuple[Array, float]:
    """A result, and the median CPU time of three runs [s] (of one, if that took long)."""
    times = []
    for _ in range(1 if once else 5):
        start = time.process_time()
        result = run()
        times.append(time.process_time() - start)
        if times[-1] > _REPEAT_BELOW_S:
            break
    return result, statistics.median(times)


def machine() -> dict[str, Any]:
    """What the times were measured on, and how busy it was."""
    return {
        "machine": platform.machine(),
        "cores": os.cpu_count(),
        "load": [round(x, 2) for x in os.getloadavg()],
        "python": platform.python_version(),
    }
