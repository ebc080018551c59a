"""Which rule limits where: the verdict on every point, and for each rule its share and its place on the axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingertip.sweep.report.statistics import Bins, by_count, by_value
from fingertip.sweep.report.variance import MIN_POINTS, chance, explained

if TYPE_CHECKING:
    from fingertip.sweep.rows import Table

FEASIBLE = "feasible"
CHECKS = "checks_failed"
"""The output that counts failed checks: a design whose parts are not sound cannot be made, whatever else it is."""
_BINS = 12


@dataclass(frozen=True)
class Verdicts:
    """One word for each point: feasible, the parameter a rule blames, the check that failed, or what became of it."""

    names: tuple[str, ...]
    """`feasible` first, then by the number of points, the greatest first."""
    code: NDArray[np.intp]
    """Index into `names`, shape (points,)."""

    def counts(self) -> NDArray[np.intp]:
        """Points of each verdict, shape (names,)."""
        return np.bincount(self.code, minlength=len(self.names))

    def over(self, bins: Bins) -> NDArray[np.intp]:
        """Points of each verdict in each bin, shape (bins, names)."""
        size = len(self.names)
        return np.bincount(bins.code * size + self.code, minlength=bins.count * size).reshape(bins.count, size)


@dataclass(frozen=True)
class Place:
    """A rule on one axis."""

    axis: str
    share: float
    """Of the rule's variance that the axis explains alone (see `sensitivity`): which parameter to move."""
    limiting: tuple[tuple[Any, Any], ...]
    """Ranges of the axis, least and greatest value, in which no other rule refuses more points."""


@dataclass(frozen=True)
class Limit:
    """A rule (or a failure) and where it limits."""

    rule: str
    points: int
    share: float
    """Of all points."""
    places: tuple[Place, ...]
    """One for each axis, the most telling first."""
    example: str
    """What was said of its first point."""


def feasible(table: Table) -> NDArray[np.bool_]:
    """Which points can be made: computed, and no check failed where checks were asked; shape (points,)."""
    ok = np.asarray(table.status == "ok")
    return ok & ~(table.outputs[CHECKS] > 0) if CHECKS in table.outputs else ok


def verdicts(table: Table) -> Verdicts:
    """The verdict on every point of a sweep."""
    refused = (table.status == "refused") & (table.field != "")
    words = np.where(refused, table.field, table.status)
    check = np.where(table.field == "", CHECKS, np.char.add("check ", table.field.astype(str)))
    words = np.where(feasible(table), FEASIBLE, np.where(words == "ok", check, words))
    names, code = np.unique(words, return_inverse=True)
    counts = np.bincount(code)
    order = sorted(range(len(names)), key=lambda i: (names[i] != FEASIBLE, -counts[i], names[i]))
    if FEASIBLE not in names:
        names, order = np.append(names, FEASIBLE), [len(names), *order]
    place = np.empty(len(names), dtype=np.intp)
    place[order] = np.arange(len(order))
    return Verdicts(tuple(str(names[i]) for i in order), place[code])


def limits(table: Table, found: Verdicts) -> tuple[Limit, ...]:
    """All rules and failures that were met, the most frequent first."""
    counts = found.counts()
    total = len(table.point)
    cuts = {name: by_value(column, _BINS) for name, column in table.axes.items()}
    over = {name: found.over(bins) for name, bins in cuts.items()}
    even = {name: by_count(column, _BINS) for name, column in table.axes.items()}
    told = []
    for i, rule in enumerate(found.names):
        if rule == FEASIBLE or not counts[i]:
            continue
        hit = found.code == i
        places = [Place(name, _weight(hit, even[name]), _ranges(cuts[name], over[name], i)) for name in table.axes]
        places.sort(key=lambda place: -place.share)
        example = str(table.reason[int(np.argmax(hit))])
        told.append(Limit(rule, int(counts[i]), float(counts[i] / total), tuple(places), example))
    return tuple(told)


def _weight(hit: NDArray[np.bool_], bins: Bins) -> float:
    n = len(hit)
    if bins.count < 2 or n < max(MIN_POINTS, 2 * bins.count) or hit.all():
        return 0.0
    share = explained(hit.astype(float), bins)
    return share if share > 2 * chance(bins.count, n) else 0.0


def _ranges(bins: Bins, counts: NDArray[np.intp], rule: int) -> tuple[tuple[Any, Any], ...]:
    """Neighbouring bins in which the rule refuses points and no other rule more, joined."""
    mine = counts[:, rule]
    limiting = np.flatnonzero((mine > 0) & (mine == counts[:, 1:].max(axis=1)))
    low, high = bins.low.tolist(), bins.high.tolist()
    runs = np.split(limiting, np.flatnonzero(np.diff(limiting) > 1) + 1) if len(limiting) else []
    return tuple((low[run[0]], high[run[-1]]) for run in runs)
