"""Remedies for a design that breaks rules: values that pass, found by algebra or by search, and always verified.

What is promised
----------------
- Every message ends in a remedy: a bound of the blamed field ("at least 3.2 mm", "at most", "between"), or values of
  other fields ("set mold.land_mm=6.3").
- The remedies of one refusal, all applied together at the values they print, give a design that passes every rule.
  `find_remedies` checks all rules with exactly these values before it prints them.
- Where one parameter that was changed resolves several issues, its issue comes first, with the nearest value that
  resolves all of them.
- Where no single value helps, the messages name a combination. The last resort is to return changed parameters towards
  their values before the change, as far as necessary.
- An alternative ("or board.variant=article") resolves the refusal by itself, and also beside the other remedy.

Rules that read a parameter which is not valid by itself are not checked. They may find more once it is valid.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from fingertip.design.parameters.declaration import find_unit, format_unit
from fingertip.design.parameters.design_tables import PARAMETERS, DesignTables
from fingertip.design.rules import RULES
from fingertip.design.rules.ruleset import BrokenRule, Interval, Rule, find_violations
from fingertip.design.rules.search import (
    Search,
    bounds_of,
    cheapest_first,
    format_value,
    is_number,
    join_assignments,
    round_bound,
)
from fingertip.errors import Issue

_MAX_STEPS = 8
"""Maximum number of values that a combination changes one after another."""
_MAX_ALTERNATIVES = 2
"""Maximum number of alternatives that are searched for."""

Values = dict[str, Any]
"""Values of parameters by their dotted names."""


@dataclass(frozen=True)
class Bound:
    """Bound of a blamed field, as a message prints it."""

    text: str
    value: float
    """Value at the bound that is nearest to the field's present one."""


@dataclass
class Refusal:
    """A design that breaks rules."""

    tables: DesignTables
    broken: tuple[BrokenRule, ...]
    before: DesignTables
    """The design before the changes that may have caused the refusal."""
    changed: tuple[str, ...]
    """Parameters that were changed."""
    search: Search
    bounds: dict[str, Bound] = field(default_factory=dict)
    """Bounds of blamed fields, computed from their rules, that are part of the remedy."""

    @cached_property
    def blamed(self) -> dict[str, list[BrokenRule]]:
        """Broken rules by the field they blame."""
        found: dict[str, list[BrokenRule]] = {}
        for broken in self.broken:
            found.setdefault(broken.rule.field, []).append(broken)
        return found

    def reads(self, name: str) -> frozenset[str]:
        """Return the parameters that decide the violations of the rules that blame a field."""
        return frozenset().union(*(broken.reads for broken in self.blamed[name]))

    def resolves(self, values: Mapping[str, Any]) -> bool:
        """Whether the design passes all rules with these values."""
        return self.search.passes(self.tables.with_values(values))


def find_remedies(
    tables: DesignTables,
    broken: Sequence[BrokenRule],
    before: DesignTables | None = None,
    changed: Sequence[str] = (),
    unreadable: frozenset[str] = frozenset(),
    rules: Iterable[Rule] = RULES,
) -> list[Issue]:
    """Describe what is wrong with a design, each problem with a remedy.

    Parameters
    ----------
    tables
        The design. Parameters in `unreadable` hold any valid value.
    broken
        Rules it breaks, at least one.
    before
        The design before the changes; the defaults if None.
    changed
        Parameters that were changed; those that differ from `before` if empty.
    unreadable
        Parameters whose own values are not valid.
    rules
        Rules that the remedies have to pass.

    Returns
    -------
    list of Issue
        One issue for each blamed field. If one changed parameter that no rule blames resolves several issues, an issue
        of its own comes first.
    """
    before = before or DesignTables()
    names = changed or [name for name in PARAMETERS if tables.value(name) != before.value(name)]
    search = Search(cheapest_first(rules), cheapest_first(one.rule for one in broken), unreadable, before)
    refusal = Refusal(tables, tuple(broken), before, tuple(names), search)
    for resolve in (_move_blamed_field, _move_one_field, _move_to_bounds, _move_step_by_step):
        if values := resolve(refusal):
            return list(_describe(refusal, values))
    return list(_describe(refusal, _return_towards_before(refusal)))


# Ways to resolve a refusal, the simplest first. Each returns the values to set, or nothing.


def _move_blamed_field(refusal: Refusal) -> Values:
    """Move the only blamed field to the bound of its rules, or to the nearest value that passes."""
    if len(refusal.blamed) > 1:
        return {}
    (name,) = refusal.blamed
    if (bound := _find_bound(refusal, name)) and refusal.resolves({name: bound.value}):
        refusal.bounds[name] = bound
        return {name: bound.value}
    value = refusal.search.nearest(refusal.tables, name)
    return {} if value is None else {name: value}


def _move_one_field(refusal: Refusal) -> Values:
    """Move one field that all broken rules read to the nearest value that passes; changed fields are tried first."""
    common = frozenset.intersection(*(broken.reads for broken in refusal.broken))
    names = [name for name in refusal.changed if name in common]
    names.sort(key=lambda name: name not in refusal.blamed)
    if len(refusal.blamed) == 1:
        names += [name for name in PARAMETERS if name in common and name not in names]
    for name in names:
        if (value := refusal.search.nearest(refusal.tables, name)) is not None:
            return {name: value}
    return {}


def _move_to_bounds(refusal: Refusal) -> Values:
    """Move every blamed field to the bound of its own rules."""
    bounds = {name: _find_bound(refusal, name) for name in refusal.blamed}
    known = {name: bound for name, bound in bounds.items() if bound is not None}
    values = {name: bound.value for name, bound in known.items()}
    if len(known) < len(bounds) or not refusal.resolves(values):
        return {}
    refusal.bounds |= known
    return values


def _move_step_by_step(refusal: Refusal) -> Values:
    """Resolve one broken rule after another, each by the field that leaves the fewest rules broken."""
    values: Values = {}
    tables, broken = refusal.tables, refusal.broken
    for _ in range(_MAX_STEPS):
        if not broken:
            return _use_bounds(refusal, _leave_out_needless(refusal, values))
        best: tuple[int, Values, tuple[BrokenRule, ...]] | None = None
        for name in _candidates(refusal, broken[0]):
            value = None if name in values else refusal.search.nearest(tables, name, broken[0].rule)
            if value is None:
                continue
            moved = tables.with_values({name: value})
            left = tuple(find_violations(refusal.search.rules, moved, refusal.search.unreadable))
            if best is None or len(left) < best[0]:
                best = (len(left), {name: value}, left)
            if len(left) < len(broken):
                break
        if best is None or best[0] > len(broken):
            return {}
        values |= best[1]
        tables, broken = tables.with_values(best[1]), best[2]
    return {}


def _candidates(refusal: Refusal, broken: BrokenRule) -> Iterator[str]:
    """Yield the fields that may repair a rule: the blamed and the changed ones; all it reads if none was changed."""
    changed = [name for name in refusal.changed if is_number(name)]
    for name in dict.fromkeys((broken.rule.field, *(changed or PARAMETERS))):
        if name in broken.reads:
            yield name


def _return_towards_before(refusal: Refusal) -> Values:
    """Find the changed parameters that must return towards their values before the change, and how far.

    The defaults pass all rules, so that this succeeds for every design.
    """
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
    """Leave out values without which the rest still resolves the refusal."""
    for name in list(values):
        fewer = {other: value for other, value in values.items() if other != name}
        if fewer and refusal.resolves(fewer):
            values = fewer
    return values


def _use_bounds(refusal: Refusal, values: Values) -> Values:
    """Replace values of blamed fields by the bounds of their rules, where that passes too."""
    for name in values:
        if name in refusal.blamed and (bound := _find_bound(refusal, name)):
            exact = {**values, name: bound.value}
            if refusal.resolves(exact):
                refusal.bounds[name] = bound
                values = exact
    return values


def _find_bound(refusal: Refusal, name: str) -> Bound | None:
    """Compute the bound of a blamed field from its broken rules; None if it lies outside the field's own bounds."""
    passing: tuple[Interval, ...] = ((-math.inf, math.inf),)
    for broken in refusal.blamed[name]:
        passing = tuple(
            (max(low, other_low), min(high, other_high))
            for low, high in passing
            for other_low, other_high in broken.violation.passing
        )
    texts, ends = [], []
    for low, high in passing:
        minimum, maximum = (
            value if math.isfinite(end) and bounds_of(name).contain(value := round_bound(name, end, up)) else None
            for end, up in ((low, True), (high, False))
        ) if low <= high else (None, None)  # fmt: skip
        if minimum is not None and maximum is not None:
            if minimum > maximum:
                continue
            texts.append(f"between {format_value(name, minimum)} and {format_value(name, maximum)}")
        elif minimum is not None:
            texts.append(f"at least {format_value(name, minimum)}")
        elif maximum is not None:
            texts.append(f"at most {format_value(name, maximum)}")
        ends += [end for end in (minimum, maximum) if end is not None]
    if not ends:
        return None
    present = refusal.tables.value(name)
    nearest = min(ends, key=lambda value: abs(value - present))
    unit = format_unit(find_unit(PARAMETERS[name]))
    return Bound(f"{' or '.join(texts)}{unit}{_note(refusal, name)}", nearest)


# Messages


def _describe(refusal: Refusal, values: Values) -> Iterator[Issue]:
    """Yield one issue for each blamed field, with its part of the remedy."""
    blamed = refusal.blamed
    unblamed = [name for name in values if name not in blamed]
    if len(blamed) > 1 and len(values) == 1 and unblamed:
        (name,) = values
        present = f"{format_value(name, refusal.tables.value(name))}{format_unit(find_unit(PARAMETERS[name]))}"
        yield Issue(name, f"{present} breaks {len(blamed)} rules, named below; {_say_bound(refusal, name, values)}.")
        unblamed = []
    parts = {name: [other for other in values if other in refusal.reads(name)] for name in blamed}
    # What no broken rule reads repairs rules that are checked once these pass: it stands in the first message.
    homeless = [name for name in values if not any(name in part for part in parts.values())]
    parts[next(iter(parts))] += homeless
    for name, broken in sorted(blamed.items(), key=lambda item: len(values) == 1 and item[0] not in values):
        part = {other: values[other] for other in parts[name] or values}
        extra = {other: values[other] for other in unblamed if other in part}
        if name in values:
            remedy = _say_bound(refusal, name, values) + (f", together with {join_assignments(extra)}" if extra else "")
        else:
            remedy = f"{'set' if extra else 'resolved by'} {join_assignments(part)}"
        yield Issue(name, f"{broken[0].violation.problem}; {remedy}{_find_alternatives(refusal, name, values)}.")


def _say_bound(refusal: Refusal, name: str, values: Values) -> str:
    """Say the value that a field needs as a bound."""
    if name in refusal.bounds:
        return refusal.bounds[name].text
    if not is_number(name):
        return f"set {join_assignments({name: values[name]})}"
    direction = "at least" if values[name] > refusal.tables.value(name) else "at most"
    unit = format_unit(find_unit(PARAMETERS[name]))
    return f"{direction} {format_value(name, values[name])}{unit}{_note(refusal, name)}"


def _note(refusal: Refusal, name: str) -> str:
    """Condition of a bound, where only one field is blamed."""
    notes = [broken.violation.note for broken in refusal.blamed.get(name, ()) if broken.violation.note]
    return f" {notes[0]}" if notes and len(refusal.blamed) == 1 else ""


def _find_alternatives(refusal: Refusal, name: str, values: Values) -> str:
    """Find alternatives to the bound of the only blamed field: those of its rules, and values of changed fields."""
    if len(refusal.blamed) > 1 or name not in values:
        return ""
    found = Values()
    for broken in refusal.blamed[name]:
        found |= broken.violation.alternatives
    read = refusal.reads(name) - {name, *found}
    changed = [other for other in refusal.changed if other in read and is_number(other)]
    for other in changed[: max(0, _MAX_ALTERNATIVES - len(found))]:
        found[other] = refusal.search.nearest(refusal.tables, other)
    beside = Values()
    for other, value in found.items():
        if (
            value is not None
            and refusal.resolves({other: value})
            and refusal.resolves(values | beside | {other: value})
        ):
            beside[other] = value
    return "".join(f", or {join_assignments({other: value})}" for other, value in beside.items())
