"""Remedies for a design that breaks rules: values that pass, found by algebra or by search, and always verified.

What is promised
----------------
- Every message ends in a remedy: a bound of the blamed field ("at least 3.2 mm", "at most", "between"), or values of
  other fields ("set mold.wall_mm=6.3").
- The remedies of one refusal, all applied together at the values they print, give a design that passes every rule.
  `find_remedies` checks all rules with exactly these values before it prints them.
- Where one parameter that was changed resolves several issues, its issue comes first, with the nearest value that
  resolves all of them.
- Where no single value helps, the messages name a combination. The last resort is to return changed parameters towards
  their values before the change, as far as necessary.
- An alternative ("or hand.tendon_distance_mm=0") resolves the refusal by itself, and also beside the other remedy.

Rules that read a parameter which is not valid by itself are not checked. They may find more once it is valid.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.rules.ruleset import BrokenRule, Interval, find_violations
from fingertip.design.search import Search, is_number, round_inwards

_MAX_STEPS = 8
"""Maximum number of values that a combination changes one after another."""
Values = dict[str, Any]


@dataclass(frozen=True)
class PassingRange:
    """Values of a blamed field that pass its rules, with ends rounded as a message prints them."""

    intervals: tuple[tuple[float | None, float | None], ...]
    """Lower and upper ends; None where an interval has no end within the field's own bounds."""
    value: float
    """The end that is nearest to the field's present value."""


@dataclass
class Refusal:
    tables: DesignTables
    broken: tuple[BrokenRule, ...]
    before: DesignTables
    """The design before the changes that may have caused the refusal."""
    changed: tuple[str, ...]
    search: Search
    ranges: dict[str, PassingRange] = field(default_factory=dict)
    """Ranges of blamed fields, computed from their rules, whose bounds are part of the remedy."""

    @cached_property
    def blamed(self) -> dict[str, list[BrokenRule]]:
        found: dict[str, list[BrokenRule]] = {}
        for broken in self.broken:
            found.setdefault(broken.rule.field, []).append(broken)
        return found

    def reads(self, name: str) -> frozenset[str]:
        return frozenset().union(*(broken.own_reads for broken in self.blamed[name]))

    def resolves(self, values: Mapping[str, Any]) -> bool:
        return self.search.passes(self.tables.with_values(values))


def resolve(refusal: Refusal) -> Values:
    """Find values of parameters that pass all rules together, by the simplest way that finds some."""
    for way in (_move_blamed_field, _move_one_field, _return_blamed_choice, _move_to_bounds, _move_step_by_step):
        if values := way(refusal):
            return values
    return _return_towards_before(refusal)


def _move_blamed_field(refusal: Refusal) -> Values:
    """Move the only blamed field to the bound of its rules, or to the nearest value that passes."""
    if len(refusal.blamed) > 1:
        return {}
    (name,) = refusal.blamed
    passing = _find_range(refusal, name)
    if passing and refusal.resolves({name: passing.value}):
        refusal.ranges[name] = passing
        return {name: passing.value}
    if not passing and all(broken.violation.passing for broken in refusal.broken):
        return {}  # By algebra, no value within the field's own bounds passes.
    value = refusal.search.nearest(refusal.tables, name)
    return {} if value is None else {name: value}


def _move_one_field(refusal: Refusal) -> Values:
    """Move one field that all broken rules read to the nearest value that passes; changed fields are tried first."""
    common = frozenset.intersection(*(broken.own_reads for broken in refusal.broken))
    if len(refusal.blamed) == 1:
        common -= set(refusal.blamed)  # tried before
        names = [*refusal.changed, *PARAMETERS]
    else:
        names = sorted(refusal.changed, key=lambda name: name not in refusal.blamed)
    names = [name for name in dict.fromkeys(names) if name in common]
    for name in names:
        value = refusal.search.nearest(refusal.tables, name, thorough=name in refusal.changed)
        if value is not None:
            return {name: value}
    return {}


def _return_blamed_choice(refusal: Refusal) -> Values:
    """Return the only blamed field to its value before the change, if it is a choice: choices have no nearest value."""
    if len(refusal.blamed) > 1:
        return {}
    (name,) = refusal.blamed
    value = refusal.before.value(name)
    return {name: value} if not is_number(name) and refusal.resolves({name: value}) else {}


def _move_to_bounds(refusal: Refusal) -> Values:
    known = {name: passing for name in refusal.blamed if (passing := _find_range(refusal, name))}
    values = {name: passing.value for name, passing in known.items()}
    if len(known) < len(refusal.blamed) or not refusal.resolves(values):
        return {}
    refusal.ranges |= known
    return values


def _move_step_by_step(refusal: Refusal) -> Values:
    """Resolve one broken rule after another, each by the field that leaves the fewest rules broken."""
    values: Values = {}
    tables, broken = refusal.tables, refusal.broken
    for _ in range(_MAX_STEPS):
        if not broken:
            return _use_bounds(refusal, _leave_out_needless(refusal, values))
        # Repair the first broken rule. The first field that reduces the number of broken rules is good enough.
        best: tuple[int, Values, tuple[BrokenRule, ...]] | None = None
        changed = [name for name in refusal.changed if is_number(name)]
        for name in dict.fromkeys((broken[0].rule.field, *(changed or PARAMETERS))):
            may_repair = name in broken[0].own_reads and name not in values
            value = _repair(refusal, tables, broken[0], name) if may_repair else None
            if value is None:
                continue
            moved = tables.with_values({name: value})
            left = tuple(find_violations(refusal.search.rules, moved, refusal.search.invalid))
            if best is None or len(left) < best[0]:
                best = (len(left), {name: value}, left)
            if len(left) < len(broken):
                break
        # Give up where every repair breaks more rules than it mends.
        if best is None or best[0] > len(broken):
            return {}
        values |= best[1]
        tables, broken = tables.with_values(best[1]), best[2]
    return {}


def _repair(refusal: Refusal, tables: DesignTables, broken: BrokenRule, name: str) -> Any:
    """Find the value of a field with which one rule passes, by algebra or by search; None if there is none."""
    if name == broken.rule.field and broken.violation.passing:
        passing = _round_range(tables, name, broken.violation.passing)
        return passing and passing.value
    return refusal.search.nearest(tables, name, broken.rule)


def _return_towards_before(refusal: Refusal) -> Values:
    """Return changed parameters towards their values before; the defaults pass all rules, so this succeeds always."""
    before = refusal.before
    if not refusal.search.passes(before):
        before = DesignTables()
    tables, values = before, Values()
    differing = [name for name in PARAMETERS if refusal.tables.value(name) != before.value(name)]
    # Restore what the design has, one parameter after another, as long as that passes. What was changed comes last.
    for name in sorted(differing, key=lambda name: name in refusal.changed):
        restored = tables.with_values({name: refusal.tables.value(name)})
        if refusal.search.passes(restored):
            tables = restored
        else:
            values[name] = before.value(name)
    # The others cannot be restored. Numbers among them move as near as possible to what the design has.
    for name in values:
        if is_number(name):
            values[name] = refusal.search.refine(tables, name, refusal.tables.value(name), values[name])
            tables = tables.with_values({name: values[name]})
    return _use_bounds(refusal, _leave_out_needless(refusal, values))


def _leave_out_needless(refusal: Refusal, values: Values) -> Values:
    for name in list(values):
        fewer = {other: value for other, value in values.items() if other != name}
        if fewer and refusal.resolves(fewer):
            values = fewer
    return values


def _use_bounds(refusal: Refusal, values: Values) -> Values:
    for name in values:
        if name in refusal.blamed and (passing := _find_range(refusal, name)):
            exact = {**values, name: passing.value}
            if refusal.resolves(exact):
                refusal.ranges[name] = passing
                values = exact
    return values


# Ways to resolve a refusal, the simplest first. Each returns the values to set, or nothing.
def find_passing_value(search: Search, tables: DesignTables, name: str, broken: Sequence[BrokenRule]) -> Any:
    """Find the passing value nearest to the present one, exact bounds of rules first; None if there is none."""
    own = [one for one in broken if one.rule.field == name]
    passing = _round_range(tables, name, _intersect_intervals(own)) if own else None
    if passing and search.passes(tables.with_values({name: passing.value})):
        return passing.value
    return search.nearest(tables, name)


def _find_range(refusal: Refusal, name: str) -> PassingRange | None:
    """Compute the values of a blamed field that pass its broken rules; None if none lies within its own bounds."""
    return _round_range(refusal.tables, name, _intersect_intervals(refusal.blamed[name]))


def _intersect_intervals(broken: Iterable[BrokenRule]) -> tuple[Interval, ...]:
    """Intersect the values of the blamed field that pass each of several broken rules."""
    passing: tuple[Interval, ...] = ((-math.inf, math.inf),)
    for one in broken:
        passing = tuple(
            (max(low, other_low), min(high, other_high))
            for low, high in passing
            for other_low, other_high in one.violation.passing
        )
    return passing


def _round_range(tables: DesignTables, name: str, passing: Iterable[Interval]) -> PassingRange | None:
    """Round intervals of a field inwards, to what lies within the field's own bounds; None if nothing does."""
    rounded = [
        (_round_end(name, low, up=True), _round_end(name, high, up=False)) for low, high in passing if low <= high
    ]
    intervals = tuple((low, high) for low, high in rounded if low is None or high is None or low <= high)
    ends = [end for interval in intervals for end in interval if end is not None]
    present = tables.value(name)
    return PassingRange(intervals, min(ends, key=lambda end: abs(end - present))) if ends else None


def _round_end(name: str, end: float, up: bool) -> float | None:
    """Round an end of an interval inwards; None if it lies outside the field's own bounds."""
    if not math.isfinite(end):
        return None
    rounded = round_inwards(name, end, up)
    return rounded if find_bounds(PARAMETERS[name]).contain(rounded) else None
