"""A design that breaks rules, and its description: one message for each blamed field, with its part of the remedy."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from fingertip.design.geometry.design_tables import DesignTables
from fingertip.design.parameters.declaration import find_unit, format_unit
from fingertip.design.parameters.tables import PARAMETERS
from fingertip.design.rules.ruleset import BrokenRule
from fingertip.design.rules.search import Search, format_value, is_number, join_assignments
from fingertip.foundation.errors import Issue

_MAX_ALTERNATIVES = 2
"""Maximum number of alternatives of a message."""
_MAX_CHANGED = 3
"""Maximum number of changed parameters among which alternatives are searched. More of them are a design of its own, in
which none stands out."""
_BUNDLED_DESIGNS = {
    "fsr400": "fsr400",
    "fsr400_short": "fsr400",
    "fsr402": "fsr402",
    "fsr402_short": "fsr402",
}
"""Bundled design for each sensor of the catalogue."""

Values = dict[str, Any]
"""Values of parameters by their dotted names."""


@dataclass(frozen=True)
class PassingRange:
    """Values of a blamed field that pass its rules, with ends rounded as a message prints them."""

    intervals: tuple[tuple[float | None, float | None], ...]
    """Lower and upper ends; None where an interval has no end within the field's own bounds."""
    value: float
    """The end that is nearest to the field's present value."""


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
    ranges: dict[str, PassingRange] = field(default_factory=dict)
    """Ranges of blamed fields, computed from their rules, whose bounds are part of the remedy."""

    @cached_property
    def blamed(self) -> dict[str, list[BrokenRule]]:
        """Broken rules by the field they blame."""
        found: dict[str, list[BrokenRule]] = {}
        for broken in self.broken:
            found.setdefault(broken.rule.field, []).append(broken)
        return found

    def reads(self, name: str) -> frozenset[str]:
        """Return the parameters that the broken rules which blame a field read."""
        return frozenset().union(*(broken.own_reads for broken in self.blamed[name]))

    def resolves(self, values: Mapping[str, Any]) -> bool:
        """Return whether the design passes all rules with these values."""
        return self.search.passes(self.tables.with_values(values))


def describe_refusal(refusal: Refusal, values: Values) -> Iterator[Issue]:
    """Yield one issue for each blamed field, with its part of the remedy."""
    blamed = refusal.blamed
    unblamed = [name for name in values if name not in blamed]
    if len(blamed) > 1 and len(values) == 1 and unblamed:
        (name,) = values
        present = f"{format_value(name, refusal.tables.value(name))}{format_unit(find_unit(PARAMETERS[name]))}"
        bound = _format_bound(refusal, name, values)
        yield Issue(name, f"{present} breaks {len(blamed)} rules, listed below; {bound}.")
        unblamed = []
    parts = {name: [other for other in values if other in refusal.reads(name)] for name in blamed}
    # What no broken rule reads repairs rules that are checked once these pass: it stands in the first message.
    homeless = [name for name in values if not any(name in part for part in parts.values())]
    parts[next(iter(parts))] += homeless
    for name, broken in sorted(blamed.items(), key=lambda item: len(values) == 1 and item[0] not in values):
        part = {other: values[other] for other in parts[name] or values}
        extra = {other: values[other] for other in unblamed if other in part}
        if name in values:
            together = f", together with {join_assignments(extra)}" if extra else ""
            remedy = _format_bound(refusal, name, values) + together
        else:
            assignments = join_assignments(part)
            fixes = "fixes" if len(part) == 1 else "fix"
            remedy = f"set {assignments}" if extra else f"{assignments} also {fixes} this"
        yield Issue(name, f"{broken[0].violation.problem}; {remedy}{_find_alternatives(refusal, name, values)}.")


def _format_bound(refusal: Refusal, name: str, values: Values) -> str:
    """Write the value that a field needs as a bound. The only blamed field may have several bounds, all verified."""
    value = values[name]
    if not is_number(name):
        return f"set {join_assignments({name: value})}{_suggest_bundled_design(refusal, name)}"
    unit = f"{format_unit(find_unit(PARAMETERS[name]))}{_note(refusal, name)}"
    texts = [f"{'at least' if value > refusal.tables.value(name) else 'at most'} {format_value(name, value)}"]
    passing = refusal.ranges.get(name)
    if passing and len(refusal.blamed) == 1:
        ends: dict[float | None, str] = {
            end: format_value(name, end)
            for interval in passing.intervals
            for end in interval
            if end is not None and (end == value or refusal.resolves(values | {name: end}))
        }
        texts = []
        for low, high in passing.intervals:
            if low in ends and low == high:
                texts.append(ends[low])
            elif low in ends and high in ends:
                texts.append(f"between {ends[low]} and {ends[high]}")
            elif low in ends or high in ends:
                texts.append(f"at least {ends[low]}" if low in ends else f"at most {ends[high]}")
    return " or ".join(texts) + unit


def _suggest_bundled_design(refusal: Refusal, name: str) -> str:
    """Name the bundled design for a sensor that the present design does not fit."""
    present, before = refusal.tables.value(name), refusal.before.value(name)
    design = _BUNDLED_DESIGNS.get(present) if name == "sensor.model" else None
    is_other = design and _BUNDLED_DESIGNS.get(before) != design
    return f", or start from the bundled design {design}" if is_other else ""


def _note(refusal: Refusal, name: str) -> str:
    """Return the condition of a bound, if only one field is blamed."""
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
    if len(refusal.changed) <= _MAX_CHANGED:
        for other in changed[: max(0, _MAX_ALTERNATIVES - len(found))]:
            found[other] = refusal.search.nearest(refusal.tables, other, thorough=False)
    beside = Values()
    for other, value in found.items():
        if (
            value is not None
            and refusal.resolves({other: value})
            and refusal.resolves(values | beside | {other: value})
        ):
            beside[other] = value
    return "".join(f", or {join_assignments({other: value})}" for other, value in beside.items())
