"""Best feasible design by the sweep's objectives, and the designs of the Pareto front."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design.files import to_toml
from fingertip.design.model import Design
from fingertip.foundation.errors import DesignError
from fingertip.sweep.designs import apply_changes
from fingertip.sweep.report.feasibility import find_feasible
from fingertip.sweep.report.statistics import find_nearest_to_ideal, find_pareto_front

if TYPE_CHECKING:
    from fingertip.sweep.plan import SweepPlan
    from fingertip.sweep.rows import SweepTable


@dataclass(frozen=True)
class Objective:
    """Output to minimise or to maximise."""

    output: str
    sign: int
    """1 to minimise, -1 to maximise."""

    @property
    def goal(self) -> str:
        """`minimise` or `maximise`, as in a sweep file."""
        return "minimise" if self.sign > 0 else "maximise"

    def __str__(self) -> str:
        return f"{self.goal} {self.output}"


@dataclass(frozen=True)
class Selection:
    """Best design, Pareto front and candidates, as rows of the table."""

    objectives: tuple[Objective, ...]
    candidates: NDArray[np.intp]
    """Feasible rows with a finite value of every objective, ascending."""
    excluded: int
    """Number of feasible rows without one."""
    front: NDArray[np.intp]
    """Rows of the Pareto front: no candidate dominates them. Ascending."""
    best: int | None
    """Row of the front nearest to the ideal point (see `statistics.find_nearest_to_ideal`); None without a
    candidate or an objective."""


def list_objectives(plan: SweepPlan) -> tuple[Objective, ...]:
    """List the objectives of a sweep: what it minimises, then what it maximises."""
    minimise = [Objective(name, 1) for name in plan.file.minimise]
    return (*minimise, *(Objective(name, -1) for name in plan.file.maximise))


def select_best(table: SweepTable, objectives: tuple[Objective, ...]) -> Selection:
    """Select the Pareto front of a table and its best row; of equal rows the first is the best."""
    rows = np.flatnonzero(find_feasible(table))
    if not objectives:
        return Selection(objectives, rows, 0, rows[:0], None)
    costs = np.stack([o.sign * table.outputs[o.output][rows] for o in objectives], axis=1)
    finite = np.isfinite(costs).all(axis=1)
    candidates, costs = rows[finite], costs[finite]
    if not len(candidates):
        return Selection(objectives, candidates, len(rows), candidates, None)
    front = find_pareto_front(costs)
    best = int(candidates[find_nearest_to_ideal(costs, front)])
    return Selection(objectives, candidates, len(rows) - len(candidates), candidates[front], best)


def build_design(plan: SweepPlan, parameters: Mapping[str, Any]) -> Design:
    """Build the design of a point from the sweep's base design; parameters of the scene are ignored."""
    design_parameters = {name: value for name, value in parameters.items() if not name.startswith("scene.")}
    return Design(**apply_changes(plan.design.model_dump(), design_parameters))


def explain_refusal(plan: SweepPlan, parameters: Mapping[str, Any], field: str, problem: str) -> str:
    """Explain why a point is refused, with a remedy, which the rows of a sweep leave out."""
    base = plan.design.model_dump()
    changes = {name: value for name, value in parameters.items() if not name.startswith("scene.")}
    try:
        Design.from_tables(apply_changes(base, changes), base, list(changes))
    except DesignError as error:
        for issue in error.issues:
            if issue.field == field and issue.message.startswith(problem.partition(" (and ")[0].rstrip(".")):
                return issue.message
    return problem


def format_best_design(plan: SweepPlan, table: SweepTable, selection: Selection) -> str:
    """Write the best design as a design file; its heading names the sweep, the point and the outputs."""
    row = selection.best
    assert row is not None
    point = int(table.point[row])
    parameters = plan.point(point)
    goals = " and ".join(map(str, selection.objectives))
    method = (
        f"Best of {len(selection.candidates)} feasible designs to {goals}."
        if len(selection.objectives) == 1
        else f"Best compromise among {len(selection.candidates)} feasible designs to {goals}: of the Pareto front, the "
        "design nearest to the ideal point."
    )
    lines = [f"Point {point} of the sweep {plan.file.name}. {method}"]
    lines += [f"  {name} = {value}" for name, value in parameters.items()]
    lines += [f"  {name}: {column[row]:.6g}" for name, column in table.outputs.items()]
    return to_toml(build_design(plan, parameters), "\n".join(lines))
