"""Best designs of a sweep: its objectives, the Pareto front, and the files that hold its points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.design.design_file import to_toml
from fingertip.design.finger_set import build_set, set_to_toml
from fingertip.foundation.files import format_csv
from fingertip.sweep.database import SweepTable
from fingertip.sweep.designs import DesignBuilder
from fingertip.sweep.report import statistics
from fingertip.sweep.sweep_plan import SweepPlan

_STEM_LENGTH = 34
"""Most characters of the sweep's name in that of its best design, which has at most 40."""
Costs = NDArray[np.float64]
"""Objectives of many points, shape (points, objectives). All are finite and to be minimised."""


@dataclass(frozen=True)
class Objective:
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
    """Row of the front nearest to the ideal point; None without a candidate or an objective."""
    equals: int = 0
    """Number of other rows with the values of the best one in every objective."""

    def describe_equals(self) -> str:
        many = (
            f"{self.equals} other point{'s have' if self.equals > 1 else ' has'} the same "
            "value of every objective"
        )
        return f" {many}; add one to choose among them." if self.equals else ""


def select_best(table: SweepTable, objectives: tuple[Objective, ...]) -> Selection:
    """Select the Pareto front of a table and its best row; of equal rows the first is the best."""
    rows = np.flatnonzero(statistics.find_feasible(table))
    if not objectives:
        return Selection(
            objectives=objectives,
            candidates=rows,
            excluded=0,
            front=rows[:0],
            best=None,
        )

    costs = np.stack([o.sign * table.outputs[o.output][rows] for o in objectives], axis=1)
    finite = np.isfinite(costs).all(axis=1)
    candidates = rows[finite]
    costs = costs[finite]

    if not len(candidates):
        return Selection(
            objectives=objectives,
            candidates=candidates,
            excluded=len(rows),
            front=candidates,
            best=None,
        )

    front = find_pareto_front(costs)
    nearest = find_nearest_to_ideal(costs, front)
    equals = int((costs == costs[nearest]).all(axis=1).sum()) - 1
    best = int(candidates[nearest])
    excluded = len(rows) - len(candidates)

    return Selection(
        objectives=objectives,
        candidates=candidates,
        excluded=excluded,
        front=candidates[front],
        best=best,
        equals=equals,
    )


def find_pareto_front(costs: Costs) -> NDArray[np.intp]:
    """Find the rows that no other row dominates, ascending.

    A row dominates another if it is as low in every objective and lower in at least one. Equal rows
    are all kept. The result is exact: costs are compared, never added.
    """
    rows, index = np.unique(costs, axis=0, return_inverse=True)
    if rows.shape[1] == 2:  # they are sorted by the first objective, then by the second
        on_front = np.asarray(rows[:, 1] < np.minimum.accumulate(np.append(np.inf, rows[:-1, 1])))
    else:
        on_front = _find_front_of_many(rows)

    return np.flatnonzero(on_front[index.reshape(-1)])


def find_nearest_to_ideal(costs: Costs, front: NDArray[np.intp]) -> int:
    """Find the row of the front nearest to the ideal point, which has the minimum of every
    objective.

    Each objective is scaled by its range over the front (compromise programming, Zeleny 1973). Of
    equal rows the first is taken. With a single objective this is its minimum.
    """
    rows = costs[front]
    span = np.ptp(rows, axis=0)
    distance = (rows - rows.min(axis=0)) / np.where(span > 0, span, 1.0)

    return int(front[np.argmin(np.sum(distance**2, axis=1))])


def _find_front_of_many(rows: Costs) -> NDArray[np.bool_]:
    ranks = np.stack(
        [np.unique(column, return_inverse=True)[1].reshape(-1) for column in rows.T], axis=1
    )
    # A row that dominates another has a lower sum of ranks. So no remaining row dominates the one
    # with the lowest sum.
    remaining = np.argsort(ranks.sum(axis=1), kind="stable")
    on_front = np.zeros(len(rows), dtype=bool)

    while len(remaining):
        first = remaining[0]
        remaining = remaining[1:]
        on_front[first] = True
        # Only rows that are lower in at least one objective are not dominated by it.
        remaining = remaining[np.any(ranks[remaining] < ranks[first], axis=1)]

    return on_front


def name_best_design(plan: SweepPlan) -> str:
    """Name the best design or set after the sweep, so that its files do not replace the base's."""
    base = plan.file.design["name"] if plan.is_set else plan.designs[""].name
    stem = plan.file.name[:_STEM_LENGTH]
    name = f"{stem}_best"

    return name if name != base else f"{name}2"


def format_best_design(plan: SweepPlan, table: SweepTable, selection: Selection) -> str:
    """Write the best design or set as a file.

    Its heading names the sweep, the point and the outputs.
    """
    row = selection.best
    assert row is not None
    point = int(table.point[row])
    parameters = plan.point(point)
    goals = " and ".join(map(str, selection.objectives))
    method = f"Best of {len(selection.candidates)} feasible designs to {goals}."

    if len(selection.objectives) > 1:
        method = (
            f"Best compromise among {len(selection.candidates)} feasible designs to {goals}: "
            "of the Pareto front, "
        )
        method += "the design nearest to the ideal point."

    lines = [f"Point {point} of the sweep {plan.file.name}. {method}{selection.describe_equals()}"]
    lines += [_explain_name(plan)]
    lines += [f"Meshes and checks are those of tolerance_mm = {plan.file.tolerance_mm:g}."]
    lines += [f"  {name} = {value}" for name, value in parameters.items()]
    lines += [f"  {name}: {column[row]:.6g}" for name, column in table.outputs.items()]
    heading = "\n".join(lines)
    name = name_best_design(plan)
    built = {finger: DesignBuilder(plan, finger).build(parameters) for finger in plan.designs}
    if plan.is_set:
        return set_to_toml(build_set(name, plan.file.design["side"], built), heading)

    return to_toml(built[""].with_values({"name": name}), heading)


def _explain_name(plan: SweepPlan) -> str:
    name = name_best_design(plan)
    if plan.is_set:
        return f"Its name is {name}: its files do not replace those of {plan.file.design['name']}."

    base = plan.designs[""].name
    return (
        f"Its name is {name}: its files do not replace those of {base}, and the letters in its "
        "core are others."
    )


def format_front(table: SweepTable, selection: Selection) -> bytes:
    """Write the rows of the Pareto front as CSV."""
    columns = [table.point, *table.axes.values(), *table.outputs.values()]
    front = (
        [c[row].item() if c.dtype != object else c[row] for c in columns] for row in selection.front
    )
    # Only NaN differs from itself.
    rows = (["" if value != value else value for value in values] for values in front)

    return format_csv(["point", *table.axes, *table.outputs], rows)
