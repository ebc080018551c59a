"""The best feasible design by the sweep's objectives, and those that none beats."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design.export import to_toml
from fingertip.design.model import Design
from fingertip.sweep.design_builder import changed
from fingertip.sweep.report.feasibility import feasible
from fingertip.sweep.report.pareto import front, nearest_to_ideal

if TYPE_CHECKING:
    from fingertip.sweep.plan import Plan
    from fingertip.sweep.rows import Table


@dataclass(frozen=True)
class Objective:
    """An output, and which end of it is wanted."""

    output: str
    sign: int
    """1: to minimise; -1: to maximise."""

    @property
    def word(self) -> str:
        """As the sweep file says it."""
        return "minimise" if self.sign > 0 else "maximise"


@dataclass(frozen=True)
class Choice:
    """The designs that come into question, and which of them to take. Rows are those of the table."""

    objectives: tuple[Objective, ...]
    candidates: NDArray[np.intp]
    """Feasible rows of which every objective is a finite number, ascending."""
    unbounded: int
    """Feasible rows left out because an objective is not."""
    front: NDArray[np.intp]
    """Rows that no candidate beats in every objective, ascending."""
    best: int | None
    """The front's row nearest to the best of every objective (see `pareto.nearest_to_ideal`); None without any."""


def objectives(plan: Plan) -> tuple[Objective, ...]:
    """Those of a sweep: what it minimises, then what it maximises."""
    minimum = [Objective(name, 1) for name in plan.file.minimise]
    return (*minimum, *(Objective(name, -1) for name in plan.file.maximise))


def choose(table: Table, wanted: tuple[Objective, ...]) -> Choice:
    """The front of a table and its best row; ties go to the first point."""
    rows = np.flatnonzero(feasible(table))
    if not wanted:
        return Choice(wanted, rows, 0, rows[:0], None)
    costs = np.stack([one.sign * table.outputs[one.output][rows] for one in wanted], axis=1)
    finite = np.isfinite(costs).all(axis=1)
    candidates, costs = rows[finite], costs[finite]
    if not len(candidates):
        return Choice(wanted, candidates, len(rows), candidates, None)
    on_front = front(costs)
    best = int(candidates[nearest_to_ideal(costs, on_front)])
    return Choice(wanted, candidates, len(rows) - len(candidates), candidates[on_front], best)


def design_of(plan: Plan, values: Mapping[str, Any]) -> Design:
    """The design of a point: the sweep's base design with the point's parameters, those of the scene left out."""
    own = {name: value for name, value in values.items() if not name.startswith("scene.")}
    return Design(**changed(plan.design.model_dump(), own))


def as_toml(plan: Plan, table: Table, choice: Choice) -> str:
    """The best design as a file that every command takes; its heading says what it is.

    Parameters
    ----------
    plan, table, choice
        Of one sweep; `choice.best` is a row.
    """
    row = choice.best
    assert row is not None
    point = int(table.point[row])
    values = plan.point(point)
    goal = " and ".join(f"{one.word} {one.output}" for one in choice.objectives)
    how = (
        f"The best of {len(choice.candidates)} feasible designs, to {goal}."
        if len(choice.objectives) == 1
        else f"Among {len(choice.candidates)} feasible designs the one nearest to the best of each, to {goal}."
    )
    lines = [f"Point {point} of the sweep {plan.file.name}. {how}"]
    lines += [f"  {name} = {value}" for name, value in values.items()]
    lines += [f"  {name}: {column[row]:.6g}" for name, column in table.outputs.items()]
    return to_toml(design_of(plan, values), "\n".join(lines))
