"""What is found of a sweep, in words for people."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fingertip.sweep.report.feasibility import Limit, feasible
from fingertip.sweep.report.sensitivity import Sensitivity, Weight
from fingertip.sweep.report.summary import Findings, point_data, spread
from fingertip.sweep.rows import STATUSES

_MAX_LISTED = 12


def as_text(found: Findings) -> str:
    """For people: counts, rules, ranges, weights, and the best design."""
    parts = [_counts(found), *_rules(found.limits), *_outputs(found), *_weights(found.sensitivities), *_best(found)]
    return "\n".join(parts)


def best_sentence(found: Findings) -> str:
    """Which design to take, or why there is none and what to do."""
    choice, table = found.choice, found.table
    if not len(table.point):
        return "no point has been computed yet."
    if not feasible(table).any():
        worst = found.limits[0]
        place = worst.places[0] if worst.places else None
        move = f" It depends most on {place.axis}: move that." if place and place.share > 0 else ""
        words = f" Its words for the first point: {worst.example}" if worst.example else ""
        return (
            f"none of {len(table.point)} points is feasible; most are refused by {worst.rule} "
            f"({_percent(worst.share)}).{move}{words}"
        )
    if not choice.objectives:
        return "the sweep names no objective; add minimise or maximise to its file to have a best design."
    goal = " and ".join(f"{one.word} {one.output}" for one in choice.objectives)
    if choice.best is None:
        return f"none of {choice.unbounded} feasible points has a finite number to {goal}."
    left = f" ({choice.unbounded} without a finite number left out)" if choice.unbounded else ""
    point = int(table.point[choice.best])
    if len(choice.objectives) == 1:
        return f"point {point} is best to {goal}, of {len(choice.candidates)} feasible points{left}."
    return (
        f"point {point} is nearest to the best of each to {goal}, of {counted(len(choice.front), 'point')} that none "
        f"beats, among {len(choice.candidates)} feasible{left}."
    )


def counted(count: int, what: str) -> str:
    """`1 point`, `2 points`."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def _counts(found: Findings) -> str:
    table = found.table
    ok = int(feasible(table).sum())
    counted = {status: int(np.sum(table.status == status)) for status in STATUSES}
    words = ", ".join(f"{count} {status}" for status, count in counted.items() if count)
    share = f" ({_percent(ok / len(table.point))})" if len(table.point) else ""
    return f"{found.plan.file.name}: {len(table.point)} of {found.plan.size} points: {words}; {ok} feasible{share}"


def _rules(found: Sequence[Limit]) -> list[str]:
    if not found:
        return []
    lines = ["", "what limits                          points   share   depends on, limits there most"]
    for one in found[:_MAX_LISTED]:
        place = one.places[0] if one.places else None
        where = ""
        if place and place.share > 0:
            ranges = ", ".join(_ends(*ends) for ends in place.limiting)
            where = f"{place.axis} ({_percent(place.share)})" + (f": {ranges}" if ranges else "")
        lines.append(f"{one.rule:34} {one.points:8} {_percent(one.share):>7}   {where}".rstrip())
    if len(found) > _MAX_LISTED:
        lines.append(f"and {len(found) - _MAX_LISTED} rarer")
    return lines


def _outputs(found: Findings) -> list[str]:
    ok = feasible(found.table)
    if not ok.any() or not found.table.outputs:
        return []
    lines = ["", "output, of feasible points             least     median   greatest"]
    for name, column in found.table.outputs.items():
        data = spread(column[ok])
        figures = " ".join(f"{_shown(data[key]):>10}" for key in ("least", "median", "greatest"))
        lines.append(f"{name:34} {figures}" + (f"   {data['unbounded']} unbounded" if data["unbounded"] else ""))
    return lines


def _weights(found: Sequence[Sensitivity]) -> list[str]:
    if not found:
        return []
    lines = ["", "what weighs how much: share of the variance an axis explains alone, + rises, - falls with it"]
    for one in found:
        told = [f"{w.axis} {_percent(w.share)}{_direction(w)}" for w in one.weights if w.share > 0]
        lines.append(f"{one.output:34} {', '.join(told) or 'none alone more than chance'}")
    return lines


def _direction(weight: Weight) -> str:
    if not abs(weight.rank_correlation) >= 0.1:  # of words it is NaN
        return ""
    return " +" if weight.rank_correlation > 0 else " -"


def _best(found: Findings) -> list[str]:
    lines = ["", best_sentence(found)]
    if found.choice.best is not None:
        data = point_data(found, found.choice.best)
        lines += [f"  {name} = {_shown(value)}" for name, value in data["parameters"].items()]
        lines += [f"  {name}: {_shown(value)}" for name, value in data["outputs"].items()]
    return lines


def _shown(value: Any) -> str:
    return "-" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)


def _ends(low: Any, high: Any) -> str:
    return _shown(low) if low == high else f"{_shown(low)} to {_shown(high)}"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.01 else "< 1 %"
