"""Remedies for a design that breaks rules: values that pass, found by algebra or by search, and
always verified.

What is promised
----------------
- A message ends in a remedy: a bound of its field ("at least 3.2 mm"), values of other fields ("set
  mold.wall_mm=6.3"), or the fit ("add --fit"). Consequences follow without one; the last tells what
  fixes them all.
- The remedies of one refusal, all applied together at the values they print, give a design that
  passes every rule.
- What was changed comes first. Where one changed number resolves everything, it alone is the
  remedy, with the nearest value that passes; else each blamed field gets its own bound. The last
  resort is to return what was changed towards its values before the change, as far as necessary.
- "add --fit" stands where a fit was tried and passes with all that was changed. It names what the
  fit moves.
- An alternative ("or hand.tendon_distance_mm=0") resolves by itself what is wrong with the printed
  parts, or with the electronics: their rules read no common parameter.

Rules that read a parameter which is not valid by itself are not checked. They may find more once it
is valid.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS, find_kind
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.rules.ruleset import BrokenRule, Interval, find_violations
from fingertip.design.search import Search, is_number, round_inwards

_MAX_ROUNDS = 3
"""Maximum number of times that fields which are blamed move to their bounds."""
Values = dict[str, Any]
FitFunction = Callable[[DesignTables, Collection[str]], Sequence[str] | None]
"""Function that fits a design, the named parameters unchanged, and returns the names of what it
moved; None if it finds no design that passes.
"""
SettleFunction = Callable[[Values], Values | None]
"""Function that adds to the values of a remedy what a fit needs; None if no fit follows."""
Ends = tuple[float | None, float | None]
"""Ends of an interval of values that pass; None for an end beyond the field's own bounds."""


@dataclass(frozen=True)
class Refusal:
    """Design that breaks rules, and what is known of the cause."""

    tables: DesignTables
    broken: tuple[BrokenRule, ...]
    before: DesignTables
    """The design before the changes that may have caused the refusal."""
    changed: tuple[str, ...]
    search: Search
    settled: bool = False
    """True if a fit follows the remedy. Alternatives are left out then: no fit was tried with them.
    """

    @cached_property
    def blamed(self) -> dict[str, list[BrokenRule]]:
        """Broken rules by the field that they blame."""
        by_field: dict[str, list[BrokenRule]] = {}
        for broken in self.broken:
            by_field.setdefault(broken.rule.field, []).append(broken)

        return by_field

    def reads(self, name: str) -> frozenset[str]:
        """Parameters that the rules read which blame a field."""
        return frozenset().union(*(broken.own_reads for broken in self.blamed[name]))

    def may_move(self, name: str) -> bool:
        """Tell whether a remedy may name a parameter: no measurement, unless it was changed."""
        return not self.changed or name in self.changed or find_kind(name) != "measurement"

    def resolves(self, values: Mapping[str, Any]) -> bool:
        """Tell whether the design passes with some values."""
        return self.search.passes(self.tables.with_values(values))


def resolve(refusal: Refusal, fits: bool = False) -> Values:
    """Find values of parameters that pass all rules together, by the simplest way that finds some.

    The result is empty only where a fit of the design passes, and no simple way finds values.
    """
    values = (
        _move_one(refusal, refusal.changed or refusal.blamed)
        or _move_to_bounds(refusal)
        or _return_choice(refusal)
    )
    if values or fits:
        return values

    every_parameter = () if refusal.changed else PARAMETERS
    return _move_one(refusal, every_parameter) or _return_towards_before(refusal)


def _move_one(refusal: Refusal, names: Iterable[str]) -> Values:
    """Move one number that all broken rules read to the nearest value that passes.

    Blamed ones are tried first.
    """
    common = frozenset.intersection(*(broken.own_reads for broken in refusal.broken))
    for name in sorted(filter(is_number, names), key=lambda name: name not in refusal.blamed):
        if name in common:
            value = find_passing_value(refusal.search, refusal.tables, name, refusal.broken)
            if value is not None:
                return {name: value}

    return {}


def _move_to_bounds(refusal: Refusal) -> Values:
    """Move each blamed field to the bound of its rules, and then those that further rules blame."""
    tables = refusal.tables
    broken = list(refusal.broken)
    values = Values()

    for _ in range(_MAX_ROUNDS):
        for name in sorted({violated.rule.field for violated in broken}):
            ends = list_ends(tables, name, find_intervals(name, broken))
            if not ends or not refusal.may_move(name):
                return {}

            values[name] = ends[0]

        tables = refusal.tables.with_values(values)
        broken = list(find_violations(refusal.search.rules, tables, refusal.search.invalid))
        if not broken:
            return values

    return {}


def _return_choice(refusal: Refusal) -> Values:
    """Return one changed choice to its value before: choices have no nearest value."""
    returned = (
        {name: refusal.before.value(name)} for name in refusal.changed if not is_number(name)
    )
    return next(filter(refusal.resolves, returned), {})


def _return_towards_before(refusal: Refusal) -> Values:
    """Return parameters towards their values before.

    This succeeds always: the defaults pass all rules.
    """
    before = refusal.before if refusal.search.passes(refusal.before) else DesignTables()
    tables = before
    values = Values()
    differing = [name for name in PARAMETERS if refusal.tables.value(name) != before.value(name)]

    # Restore what the design has, one parameter after another, as far as that passes. What was
    # changed comes last.
    for name in sorted(differing, key=lambda name: name in refusal.changed):
        present = refusal.tables.value(name)
        if not refusal.search.passes(tables.with_values({name: present})):
            values[name] = before.value(name)
            if is_number(name):
                values[name] = refusal.search.refine(tables, name, present, values[name])

            present = values[name]

        tables = tables.with_values({name: present})

    for name in list(values):
        fewer = {kept: value for kept, value in values.items() if kept != name}
        if fewer and refusal.resolves(fewer):
            values = fewer

    return values


def settle(refusal: Refusal, values: Values, settled: SettleFunction) -> Values:
    """Return a choice that a rule names, or else the values, with what a fit needs to follow.

    If no fit follows, return what was changed to its value before. Each choice costs a fit.
    """
    candidates = []
    for violated in refusal.broken:
        for name, value in violated.violation.alternatives.items():
            if not is_number(name):
                candidates.append({name: value})

    for candidate in (*candidates, values):
        with_fit = settled(candidate)
        if with_fit:
            return with_fit

    present = ((name, refusal.before.value(name)) for name in refusal.changed)
    return {name: value for name, value in present if value != refusal.tables.value(name)}


def find_passing_value(
    search: Search, tables: DesignTables, name: str, broken: Iterable[BrokenRule]
) -> Any:
    """Find the passing value nearest to the present one, exact bounds of rules first, or None."""
    intervals = list[Ends]()
    for violated in broken:
        if violated.rule.field == name:
            intervals += find_intervals(name, [violated])
    for end in list_ends(tables, name, intervals):
        if search.passes(tables.with_values({name: end})):
            return end

    return search.nearest(tables, name)


def find_intervals(name: str, broken: Iterable[BrokenRule]) -> list[Ends]:
    """Compute the values of a field that pass all rules which blame it.

    They are rounded inwards, as a message prints them.
    """
    passing: list[Interval] = [(-math.inf, math.inf)]
    for violated in broken:
        if violated.rule.field == name:
            pairs = itertools.product(passing, violated.violation.passing)
            passing = [
                (max(low, own_low), min(high, own_high))
                for (low, high), (own_low, own_high) in pairs
            ]

    rounded = [
        (_round_end(name, low, up=True), _round_end(name, high, up=False))
        for low, high in passing
        if low <= high
    ]
    return [(low, high) for low, high in rounded if low is None or high is None or low <= high]


def list_ends(tables: DesignTables, name: str, intervals: Iterable[Ends]) -> Sequence[float]:
    """List the ends of intervals, the nearest to the present value of their field first."""
    ends = {end for interval in intervals for end in interval if end is not None}
    return sorted(ends, key=lambda end: abs(end - tables.value(name)))


def _round_end(name: str, end: float, up: bool) -> float | None:
    """Round an end of an interval inwards; None if it lies outside the field's own bounds."""
    if not math.isfinite(end):
        return None

    rounded = round_inwards(name, end, up)
    return rounded if find_bounds(PARAMETERS[name]).contain(rounded) else None
