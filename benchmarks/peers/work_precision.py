"""Work-precision diagrams: error and CPU time of several solvers on one problem, as data and as
text.

Solvers are compared at levels of the error, by the ratio of their costs there, and by the geometric
mean of these ratios: of CPU times, and of evaluations of the right-hand side, which no machine and
no compiler changes. A solver's cost at a level is interpolated between its measured points, both
axes logarithmic. Only points count that no other point of the same solver beats in both, error and
cost.
"""

from __future__ import annotations

import math
import os
import platform
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from fingertip.foundation.numerics import Array

MIN_ERROR_RATIO = 100.0
"""Smallest ratio of an error to the difference of the two
references at which the error counts as known.
"""
_ROUNDS = 5
_REPEAT_BELOW_S = 1.0


@dataclass(frozen=True)
class Outcome:
    """Result of one run, and the cost of its integration."""

    result: Array
    cpu_s: float
    evaluations: int = 0
    """Evaluations of the right-hand side; 0: not known."""
    reference: Array | None = None
    """Reference of this run, where it is not that of the diagram."""


@dataclass(frozen=True)
class Job:
    """One solver at one setting, to be measured."""

    solver: str
    setting: str
    run: Callable[[], Outcome]


@dataclass(frozen=True)
class Point:
    """One solver at one setting."""

    solver: str
    setting: str
    cpu_s: float
    error: float
    evaluations: int = 0


Cost = Literal["cpu_s", "evaluations"]


@dataclass(frozen=True)
class Comparison:
    """CPU time of a solver as a multiple of fingertip's."""

    ratios: tuple[float | None, ...]
    """Ratio at each level; None where one of both has no point that is accurate enough."""
    mean: float | None
    """Geometric mean of the ratios that are known."""
    evaluations: float | None
    """The same mean of the evaluations."""
    target: float | None
    """Smallest mean to be reached."""

    @property
    def is_missed(self) -> bool:
        """True if there is a target, the solver was measured, and the mean is below the target."""
        return self.target is not None and self.mean is not None and self.mean < self.target


@dataclass
class WorkPrecision:
    """Points of one problem, and the runs that gave no point."""

    problem: str
    unit: str
    levels: tuple[float, ...]
    """Errors at which solvers are compared, in `unit`."""
    targets: dict[str, float] = field(default_factory=dict)
    """Solver -> how many times fingertip's CPU time it should
    take, as a geometric mean over the levels.
    """
    solvers: dict[str, str] = field(default_factory=dict)
    """Solver -> version and settings; fingertip comes first."""
    reference_difference: float = 0.0
    """Largest difference between the two references, in `unit`."""
    points: list[Point] = field(default_factory=list)
    omissions: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def measure(
        self,
        jobs: Sequence[Job],
        reference: Array,
        advance: Callable[[float], None] = lambda _: None,
    ) -> None:
        """Measure jobs in rounds, so that a change of the machine's speed meets all solvers.

        The CPU time of a job is the median of five rounds; jobs that take more than a second run
        once. A job that fails, or whose error is not known, is listed among the omissions.
        `advance` is called with the share done.
        """
        times: dict[Job, list[float]] = {job: [] for job in jobs}
        results: dict[Job, Outcome] = {}
        remaining = list(jobs)

        for number in range(_ROUNDS):
            for i, job in enumerate(tuple(remaining)):
                # The first round takes as long as all others: it runs the slow jobs too.
                share = i / len(jobs)
                advance(
                    share / 2 if number == 0 else (1 + (number - 1 + share) / (_ROUNDS - 1)) / 2
                )
                try:
                    outcome = job.run()
                except (
                    Exception
                ) as error:  # another solver may fail in any way; the failure is reported
                    reason = f"failed ({type(error).__name__}: {str(error)[:80]})"
                    self.omissions.append(f"{job.solver}, {job.setting}: {reason}")
                    results.pop(job, None)
                    remaining.remove(job)
                    continue

                times[job].append(outcome.cpu_s)
                results[job] = outcome
                if outcome.cpu_s > _REPEAT_BELOW_S:
                    remaining.remove(job)

        for job, outcome in results.items():
            expected = reference if outcome.reference is None else outcome.reference
            cpu_s = statistics.median(times[job])
            self.add_result(
                job.solver,
                setting=job.setting,
                cpu_s=cpu_s,
                result=outcome.result,
                reference=expected,
                evaluations=outcome.evaluations,
            )

    def add_result(
        self,
        solver: str,
        setting: str,
        cpu_s: float,
        result: Array,
        reference: Array,
        evaluations: int = 0,
    ) -> None:
        """Add a result as a point, or list it among the omissions."""
        error = (
            float(np.abs(result - reference).max())
            if result.shape == reference.shape
            else float("nan")
        )
        if not np.isfinite(error):
            self.omissions.append(f"{solver}, {setting}: result is not finite at every sample")
        elif error < MIN_ERROR_RATIO * self.reference_difference:
            self.omissions.append(
                f"{solver}, {setting}: error of {error:.1e} {self.unit} is too small to measure; "
                "an error counts from "
                f"{MIN_ERROR_RATIO:g} times the difference of the references, "
                f"{self.reference_difference:.1e} {self.unit} (CPU time {cpu_s:.3g} s)"
            )
        else:
            self.points.append(
                Point(
                    solver=solver,
                    setting=setting,
                    cpu_s=cpu_s,
                    error=error,
                    evaluations=evaluations,
                )
            )

    def leave_out(self, missing: Mapping[str, str]) -> None:
        """Name solvers that cannot be measured, each with the reason."""
        for name, reason in missing.items():
            self.solvers[name] = "NOT MEASURED"
            self.omissions.append(f"{name}: NOT MEASURED: {reason}")

    def best_points(self, solver: str, cost: Cost = "cpu_s") -> list[tuple[float, float]]:
        """Error and cost of a solver's points that none of its others
        beats, from the cheapest to the most accurate.
        """
        best: list[tuple[float, float]] = []
        points = (
            (float(getattr(p, cost)), p.error)
            for p in self.points
            if p.solver == solver and getattr(p, cost)
        )

        for spent, error in sorted(points):
            if not best or error < best[-1][0]:
                best.append((error, spent))

        return best

    def cost_at(self, solver: str, error: float, cost: Cost = "cpu_s") -> float | None:
        """Cost of a solver at an error, interpolated; None if none of its points is that accurate.

        At an error above that of its cheapest point it is the cost of that point.
        """
        best = self.best_points(solver, cost)
        if best and error >= best[0][0]:
            return best[0][1]

        for (coarse, less), (fine, more) in pairwise(best):
            if fine <= error:
                return less * math.exp(
                    math.log(coarse / error) / math.log(coarse / fine) * math.log(more / less)
                )

        return None

    def compare(self, solver: str) -> Comparison:
        """Compare a solver with the first, fingertip."""
        ratios = self._ratios(solver, "cpu_s")
        mean, evaluations = (
            _geometric_mean(found) for found in (ratios, self._ratios(solver, "evaluations"))
        )
        return Comparison(ratios, mean, evaluations, self.targets.get(solver))

    def _ratios(self, solver: str, cost: Cost) -> tuple[float | None, ...]:
        """Cost of a solver as a multiple of the first one's at each level."""
        ours = next(iter(self.solvers))
        costs = (
            (self.cost_at(solver, level, cost), self.cost_at(ours, level, cost))
            for level in self.levels
        )
        return tuple(theirs / base if theirs and base else None for theirs, base in costs)

    def comparisons(self) -> dict[str, Comparison]:
        """Comparison of each solver with fingertip, the smallest margin first."""
        found = {solver: self.compare(solver) for solver in list(self.solvers)[1:]}
        return dict(sorted(found.items(), key=lambda item: item[1].mean or math.inf))

    @property
    def misses_target(self) -> bool:
        """True if a solver was measured and takes less than its multiple of fingertip's
        CPU time.
        """
        return any(comparison.is_missed for comparison in self.comparisons().values())

    def as_data(self) -> dict[str, Any]:
        """Diagram for JSON."""
        return asdict(self) | {
            "comparisons": {name: asdict(found) for name, found in self.comparisons().items()}
        }

    def as_text(self) -> list[str]:
        """Diagram as lines of text."""
        unit = self.unit
        lines = [f"{self.problem}: the references differ by {self.reference_difference:.1e} {unit}"]
        lines += [f"  {name}: {text}" for name, text in self.solvers.items()]
        lines += [
            f"  {p.solver:28}{p.setting:34}{p.error:10.1e} {unit}{1e3 * p.cpu_s:12.2f} "
            f"ms{p.evaluations or '-':>10}"
            for p in self.points
        ]
        levels = ", ".join(f"{level:g}" for level in self.levels)
        lines.append(
            f"  CPU time as a multiple of fingertip's at errors of {levels} {unit}, its geometric "
            "mean, and that of "
            "the evaluations:"
        )
        lines += [
            f"    {name:28}{self._comparison_text(found)}"
            for name, found in self.comparisons().items()
        ]
        lines += [f"  note: {line}" for line in self.notes]
        if self.omissions:
            lines.append("  omitted:")

        return lines + [f"    {line}" for line in self.omissions]

    @staticmethod
    def _comparison_text(found: Comparison) -> str:
        target = "" if found.target is None else f", target {found.target:g}"
        if found.mean is None:
            return "NOT COMPARED" + target

        ratios = ", ".join(f"{ratio:.1f}" if ratio else "not reached" for ratio in found.ratios)
        if found.target is None:
            verdict = ""
        elif found.is_missed:
            verdict = ": missed"
        else:
            verdict = ": reached"

        part = " of the levels reached" if None in found.ratios else ""
        evaluations = "" if found.evaluations is None else f"; evaluations {found.evaluations:.2f}"
        return f"{ratios}; mean {found.mean:.1f}{part}{target}{verdict}{evaluations}"


def _geometric_mean(ratios: Sequence[float | None]) -> float | None:
    """Geometric mean of the ratios that are known."""
    known = [ratio for ratio in ratios if ratio]
    return math.exp(statistics.fmean(map(math.log, known))) if known else None


def describe_machine() -> dict[str, Any]:
    """Describe the machine that the times are measured on, and its load."""
    return {
        "machine": platform.machine(),
        "cores": os.cpu_count(),
        "load": [round(x, 2) for x in os.getloadavg()],
        "python": platform.python_version(),
    }
