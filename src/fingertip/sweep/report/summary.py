"""What is found of a sweep, and all of it as one JSON object."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fingertip.sweep.report.best_design import Choice, choose, objectives
from fingertip.sweep.report.feasibility import Limit, Verdicts, feasible, limits, verdicts
from fingertip.sweep.report.sensitivity import Sensitivity, sensitivities
from fingertip.sweep.rows import STATUSES

if TYPE_CHECKING:
    from fingertip.sweep.plan import Plan
    from fingertip.sweep.rows import Table


@dataclass(frozen=True)
class Findings:
    """All that is said and drawn of a sweep."""

    plan: Plan
    table: Table
    verdicts: Verdicts
    limits: tuple[Limit, ...]
    sensitivities: tuple[Sensitivity, ...]
    choice: Choice

    def sensitivity(self, output: str) -> Sensitivity | None:
        """That of one output, if it varies."""
        return next((one for one in self.sensitivities if one.output == output), None)


def findings(plan: Plan, table: Table) -> Findings:
    """Look at the rows of a sweep, finished or not."""
    found = verdicts(table)
    return Findings(
        plan, table, found, limits(table, found), tuple(sensitivities(table)), choose(table, objectives(plan))
    )


def as_data(found: Findings) -> dict[str, Any]:
    """One JSON object; what is no finite number is null there."""
    table, choice = found.table, found.choice
    ok = feasible(table)
    return {
        "sweep": found.plan.file.name,
        "points": found.plan.size,
        "rows": len(table.point),
        "status": {status: int(np.sum(table.status == status)) for status in STATUSES},
        "feasible": int(ok.sum()),
        "limits": [
            {
                "rule": one.rule,
                "points": one.points,
                "share": number(one.share),
                "axes": [
                    {"axis": p.axis, "share": number(p.share), "limiting": [list(ends) for ends in p.limiting]}
                    for p in one.places
                ],
                "example": one.example,
            }
            for one in found.limits
        ],
        "outputs": {name: spread(column[ok]) for name, column in table.outputs.items()},
        "sensitivity": [
            {
                "output": one.output,
                "points": one.points,
                "noise": number(one.noise),
                "axes": [
                    {"axis": w.axis, "share": number(w.share), "rank_correlation": number(w.rank_correlation)}
                    for w in one.weights
                ],
            }
            for one in found.sensitivities
        ],
        "objectives": [{"output": one.output, "goal": one.word} for one in choice.objectives],
        "best": None if choice.best is None else point_data(found, choice.best),
        "front": [int(table.point[row]) for row in choice.front],
    }


def point_data(found: Findings, row: int) -> dict[str, Any]:
    """One row: its point, parameters and outputs."""
    point = int(found.table.point[row])
    outputs = {name: number(float(column[row])) for name, column in found.table.outputs.items()}
    return {"point": point, "parameters": found.plan.point(point), "outputs": outputs}


def spread(column: Any) -> dict[str, Any]:
    """How many values of an output are finite and how many infinite, and the ends and the middle of the finite."""
    known = column[np.isfinite(column)]
    some = len(known) > 0
    return {
        "points": len(known),
        "unbounded": int(np.isinf(column).sum()),
        "least": number(float(known.min())) if some else None,
        "median": number(float(np.median(known))) if some else None,
        "greatest": number(float(known.max())) if some else None,
    }


def number(value: float) -> float | None:
    """Nine digits of a number, for a computed one's last bits differ between processors; None if it is not finite."""
    return float(f"{value:.9g}") if math.isfinite(value) else None
