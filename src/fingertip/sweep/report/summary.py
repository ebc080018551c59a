"""Summary of a sweep: counts, limiting rules, output ranges, sensitivities and best design, as JSON
and as text.

The best design is the feasible one that the sweep's objectives prefer, of those of the Pareto
front.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from fingertip.design.design import Design
from fingertip.foundation.errors import DesignError, escape_control
from fingertip.foundation.numerics import binomial_interval, quantile_ranks
from fingertip.sweep.database import STATUSES, SweepTable
from fingertip.sweep.designs import apply_changes
from fingertip.sweep.outputs import load_outputs
from fingertip.sweep.report import statistics
from fingertip.sweep.report.best_design_file import (
    Objective,
    Selection,
    name_best_design,
    select_best,
)
from fingertip.sweep.sweep_file import SweepFile
from fingertip.sweep.sweep_plan import SweepPlan
from fingertip.sweep.swept_parameters import select_changes

_MAX_RULES = 12
_MIN_CORRELATION = 0.1
"""Minimum rank correlation whose sign is shown."""


@dataclass(frozen=True)
class SweepSummary:
    plan: SweepPlan
    table: SweepTable
    classes: statistics.PointClasses
    limiting_rules: tuple[statistics.LimitingRule, ...]
    sensitivities: tuple[statistics.OutputSensitivity, ...]
    selection: Selection

    def find_sensitivity(self, output: str) -> statistics.OutputSensitivity | None:
        return next((s for s in self.sensitivities if s.output == output), None)


def summarise(plan: SweepPlan, table: SweepTable) -> SweepSummary:
    classes = statistics.classify_points(table)
    rules = statistics.find_limiting_rules(table, classes)
    sensitivities = tuple(statistics.compute_sensitivities(table))
    objectives = [Objective(name, 1) for name in plan.file.minimise] + [
        Objective(n, -1) for n in plan.file.maximise
    ]

    return SweepSummary(
        plan=plan,
        table=table,
        classes=classes,
        limiting_rules=rules,
        sensitivities=sensitivities,
        selection=select_best(table, tuple(objectives)),
    )


def to_json_data(summary: SweepSummary) -> dict[str, Any]:
    """Convert a summary to one JSON object; numbers that are not finite become null."""
    table = summary.table
    selection = summary.selection
    feasible = statistics.find_feasible(table)

    return {
        "sweep": summary.plan.file.name,
        "points": summary.plan.size,
        "rows": len(table.point),
        "status": {status: int(np.sum(table.status == status)) for status in STATUSES},
        "feasible": int(feasible.sum()),
        "limiting_rules": [_to_json_object(rule) for rule in summary.limiting_rules],
        "outputs": {name: _find_range(column[feasible]) for name, column in table.outputs.items()},
        "sensitivity": [_to_json_object(sensitivity) for sensitivity in summary.sensitivities],
        "objectives": [{"output": o.output, "goal": o.goal} for o in selection.objectives],
        "best": None if selection.best is None else _describe_best_point(summary, selection.best),
        "pareto_front": [int(table.point[row]) for row in selection.front],
    }


def _to_json_object(record: Any) -> dict[str, Any]:
    """Convert the fields of a record; `limiting_ranges` keep every digit of the axis."""
    data = {field.name: getattr(record, field.name) for field in fields(record)}
    data |= {
        name: _to_json_number(value) for name, value in data.items() if isinstance(value, float)
    }
    if "limiting_ranges" in data:
        data["limiting_ranges"] = [list(ends) for ends in data["limiting_ranges"]]

    data |= {name: list(value) for name, value in data.items() if name == "tied_to"}
    return (
        data | {"axes": [_to_json_object(axis) for axis in data["axes"]]}
        if "axes" in data
        else data
    )


def format_text(summary: SweepSummary) -> str:
    lines = [
        _format_counts(summary),
        *_format_rules(summary.limiting_rules),
        *_format_outputs(summary),
    ]
    lines += [*_format_sensitivities(summary.sensitivities), "", describe_best(summary)]
    if summary.selection.best is not None:
        data = _describe_best_point(summary, summary.selection.best)
        lines += [f"  name = {data['name']}"]
        lines += [
            f"  {name} = {_format_value(value)}" for name, value in data["parameters"].items()
        ]
        lines += [f"  {name}: {_format_value(value)}" for name, value in data["outputs"].items()]

    if summary.table.outputs.keys() & {
        name for name, output in load_outputs().items() if output.group == "detection"
    }:
        lines.append(describe_sample(summary.plan.file.trials))

    tolerance_mm = summary.plan.file.tolerance_mm
    is_coarse = tolerance_mm > SweepFile.model_fields["tolerance_mm"].default
    if is_coarse and any((column > 0).any() for column in statistics.list_failed(summary.table)):
        lines.append(
            "The meshes are coarse, which alone may fail a check: try a tolerance_mm below "
            f"{tolerance_mm:g}."
        )

    return "\n".join(map(escape_control, lines))  # a reason may hold any text


def describe_sample(trials: int) -> str:
    """Say how far shares and delays of so many trials can be off."""
    least = binomial_interval(trials, trials)[0]
    low, high = quantile_ranks(trials, 0.5)
    bounds = "are not bounded by so few"
    if low >= 0 and high < trials:
        bounds = f"lie between delays {low + 1} and {high + 1} of {trials} in order"

    return (
        f"Of {trials} trials a point: with 95 %, a share of 1 is above {least:.2f}, and "
        f"medians {bounds}."
    )


def describe_best(summary: SweepSummary) -> str:
    """Describe which design is best; if there is none, why, and what to do."""
    selection = summary.selection
    table = summary.table
    if not len(table.point):
        return "No point has been computed yet."

    if not statistics.find_feasible(table).any():
        rule = summary.limiting_rules[0]
        axis = rule.axes[0] if rule.axes else None
        remedy = example = ""
        if axis and axis.explained_variance > 0:
            remedy = f" It depends most on {axis.axis}: change the range of that axis."
        if rule.example:
            example = f" Message of the first point: {_explain_first_point(summary, rule)}"

        return (
            f"None of {len(table.point)} points is feasible; the most frequent limiting rule is "
            f"{rule.rule} "
            f"({format_percent(rule.share)}).{remedy}{example}"
        )

    if not selection.objectives:
        return (
            "The sweep has no objective; add minimise or maximise to its file to get a best design."
        )

    goals = " and ".join(map(str, selection.objectives))
    if selection.best is None:
        return (
            f"None of {selection.excluded} feasible points has a finite value of every "
            f"objective ({goals})."
        )

    candidates = (
        f"{len(selection.candidates)} feasible "
        f"points{' with finite objectives' if selection.excluded else ''}"
    )
    point = int(table.point[selection.best])
    if len(selection.objectives) == 1:
        return f"Point {point} is the best of {candidates} to {goals}.{selection.describe_equals()}"

    number = len(selection.front)
    front = f"{number} Pareto-optimal point{'s' if number != 1 else ''}"
    chosen = (
        f"of {front} among {candidates}, the nearest to the ideal.{selection.describe_equals()}"
    )
    return f"Point {point} is the best compromise to {goals}: {chosen}"


def _explain_first_point(summary: SweepSummary, rule: statistics.LimitingRule) -> str:
    """Explain why the first point of a rule is refused, with a remedy, which the rows of a sweep
    leave out.
    """
    row = int(np.argmax(summary.classes.indices == summary.classes.names.index(rule.rule)))
    point = summary.plan.point(int(summary.table.point[row]))

    for finger, design in summary.plan.designs.items():
        base = design.model_dump()
        changes = select_changes(point, finger)
        try:
            Design.from_tables(apply_changes(base, changes), base, list(changes))
        except DesignError as error:
            for issue in error.issues:
                field = f"fingers.{finger}: {issue.field}" if finger else issue.field
                if field == rule.rule and issue.message.startswith(
                    rule.example.partition(" (and ")[0].rstrip(".")
                ):
                    return issue.message.replace("add --fit", "set fit = true")

    return rule.example


def _describe_best_point(summary: SweepSummary, row: int) -> dict[str, Any]:
    point = int(summary.table.point[row])
    own_name = name_best_design(summary.plan)
    outputs = {
        name: _to_json_number(float(column[row])) for name, column in summary.table.outputs.items()
    }
    return {
        "point": point,
        "name": own_name,
        "parameters": summary.plan.point(point),
        "outputs": outputs,
    }


def _find_range(column: statistics.Column) -> dict[str, float | None]:
    """Find the range of an output over some points.

    Values that are not finite are counted, and have no minimum.
    """
    finite = column[np.isfinite(column)]
    kinds = (np.min, np.median, np.max)
    low, middle, high = (
        _to_json_number(float(kind(finite))) if len(finite) else None for kind in kinds
    )
    ends = {"minimum": low, "median": middle, "maximum": high}

    return {"points": len(finite), "infinite": int(np.isinf(column).sum()), **ends}


def _to_json_number(value: float) -> float | None:
    """Round to nine digits, because the last bits differ between processors.

    None if the value is not finite.
    """
    return float(f"{value:.9g}") if math.isfinite(value) else None


def _format_counts(summary: SweepSummary) -> str:
    table = summary.table
    feasible = int(statistics.find_feasible(table).sum())
    counts = {status: int(np.sum(table.status == status)) for status in STATUSES}
    statuses = ", ".join(f"{count} {status}" for status, count in counts.items() if count)
    share = f" ({format_percent(feasible / len(table.point))})" if len(table.point) else ""
    total = f"{len(table.point)} of {summary.plan.size} points"

    return f"{summary.plan.file.name}: {total}: {statuses}; {feasible} feasible{share}"


def _format_rules(rules: Sequence[statistics.LimitingRule]) -> list[str]:
    if not rules:
        return []

    lines = [
        "",
        "limiting rule                        points   share   main axis (explained variance): "
        "limiting range",
    ]
    for rule in rules[:_MAX_RULES]:
        axis = rule.axes[0] if rule.axes else None
        influence = ""
        if axis and axis.explained_variance > 0:
            ranges = ", ".join(
                " to ".join(map(_format_value, dict.fromkeys(ends)))
                for ends in axis.limiting_ranges
            )
            influence = f"{axis.axis} ({format_percent(axis.explained_variance)})" + (
                f": {ranges}" if ranges else ""
            )

        lines.append(
            f"{rule.rule:34} {rule.points:8} {format_percent(rule.share):>7}   {influence}".rstrip()
        )

    if len(rules) > _MAX_RULES:
        lines.append(f"and {len(rules) - _MAX_RULES} less frequent")

    return lines


def _format_outputs(summary: SweepSummary) -> list[str]:
    feasible = statistics.find_feasible(summary.table)
    if not feasible.any() or not summary.table.outputs:
        return []

    lines = ["", "output (feasible points)              minimum     median    maximum"]
    for name, column in summary.table.outputs.items():
        ends = _find_range(column[feasible])
        numbers = " ".join(
            f"{_format_value(ends[end]):>10}" for end in ("minimum", "median", "maximum")
        )
        lines.append(
            f"{name:34} {numbers}" + (f"   {ends['infinite']} infinite" if ends["infinite"] else "")
        )

    return lines


def _format_sensitivities(sensitivities: Sequence[statistics.OutputSensitivity]) -> list[str]:
    if not sensitivities:
        return []

    lines = [
        "",
        "share of the variance that each axis explains alone (first-order Sobol index; + rises, - "
        "falls with the axis)",
    ]
    for sensitivity in sensitivities:
        axes = []
        for axis in sensitivity.axes:
            if axis.first_order_index > 0:
                direction = ""
                # False for NaN, of a categorical axis.
                if abs(axis.rank_correlation) >= _MIN_CORRELATION:
                    direction = " +" if axis.rank_correlation > 0 else " -"

                axes.append(f"{axis.axis} {format_percent(axis.first_order_index)}{direction}")

        axes += describe_tied(sensitivity)
        lines.append(f"{sensitivity.output:34} {', '.join(axes) or 'no significant axis'}")

    return lines


def describe_tied(sensitivity: statistics.OutputSensitivity) -> list[str]:
    """Name each group of axes that vary with each other, and so have no index of their own."""
    groups = dict.fromkeys(
        tuple(sorted({axis.axis, *axis.tied_to})) for axis in sensitivity.axes if axis.tied_to
    )
    return [f"{' and '.join(group)} cannot be told apart" for group in groups]


def _format_value(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.6g}"

    return str(value)


def format_percent(share: float, decimals: int = 0) -> str:
    least = 10.0 ** -(2 + decimals)
    return (
        f"{100 * share:.{decimals}f} %" if share >= least or share == 0 else f"< {100 * least:g} %"
    )
