"""Search for values of a parameter that pass the rules, and description of a refused design with its remedies."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from fingertip.catalogues.sensors import CATALOGUE
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import ELECTRONIC_TABLES, PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, find_unit, format_unit
from fingertip.design.rules.ruleset import BrokenRule, Rule, RuleChecker, find_violations
from fingertip.foundation.errors import Issue, join_words
from fingertip.foundation.numerics import bisect

SMALLEST = 1e-300
"""Absolute value below which a number has no digits that count."""
_GRID_INTERVALS = 48
"""Intervals of the fine grid between a parameter's bounds."""
_STRIDE = 4
"""Fine intervals in one interval of the coarse grid."""
_HALVINGS = 9
"""Halvings of the interval between a failing and a passing value."""
_SHORT_DIGITS = (2, 3)
"""Significant digits of the short numbers that are tried in the last interval."""
_DIGITS = (3, 4, 5)
"""Significant digits to which a value that was found is rounded, if it passes then."""


@dataclass(frozen=True)
class Search:
    """Search for values near a design that pass all rules, or the one rule that is asked for; each was checked."""

    rules: tuple[Rule, ...]
    """Rules to pass, those that take long last."""
    suspects: tuple[Rule, ...]
    """Rules that are checked first, because they are likely to fail."""
    invalid: frozenset[str] = frozenset()
    """Parameters whose own values are not valid."""
    before: DesignTables | None = None
    """Design whose values are tried too."""

    def passes(self, tables: DesignTables, only: Rule | None = None) -> bool:
        if only is not None:
            return RuleChecker(tables, self.invalid).passes(only)
        return next(find_violations((*self.suspects, *self.rules), tables, self.invalid), None) is None

    def nearest(self, tables: DesignTables, name: str, only: Rule | None = None, *, thorough: bool = True) -> Any:
        """Find the value of a numeric parameter that passes and is nearest to its present one; None if there is none.

        The value is the nearest one on a coarse grid between the parameter's bounds, or else, if the search is
        thorough, on a fine one. Bisection then refines it. A range of passing values that is narrower than the grid may
        be missed.
        """
        if not is_number(name) or name in self.invalid:
            return None
        present = tables.value(name)
        grid = self.list_grid(name, present)
        sides = [[value for value in grid if (value > present) is above] for above in (True, False)]
        coarse = {value for side in sides for value in (*side[_STRIDE - 1 :: _STRIDE], *side[-1:])}
        failing = {present}
        fine = [value for value in grid if value not in coarse] if thorough else []
        for values in ([value for value in grid if value in coarse], fine):
            for value in values:
                if self.passes(tables.with_values({name: value}), only):
                    between = (v for v in failing if min(present, value) <= v <= max(present, value))
                    return self.refine(tables, name, min(between, key=lambda v: abs(v - value)), value, only)
                failing.add(value)
        return None

    def refine(self, tables: DesignTables, name: str, failing: float, passing: float, only: Rule | None = None) -> Any:
        """Move a passing value of a parameter towards a failing one by bisection, and round it."""

        def passes(value: float) -> bool:
            return self.passes(tables.with_values({name: value}), only)

        def between(share: float) -> float:
            if min(failing, passing) > 0.0 and max(failing, passing) > 4.0 * min(failing, passing):
                return as_typed(name, _blend(failing, passing, share))
            return as_typed(name, failing + share * (passing - failing))

        below, share = bisect(lambda share: not passes(between(share)), 0.0, 1.0, halvings=_HALVINGS)
        best, last_failing = passing if share == 1.0 else between(share), between(below)
        # A bound is often a short number, which then lies between the last failing and the last passing value.
        for digits in _SHORT_DIGITS:
            short = as_typed(name, round_digits(best, digits, up=best < failing))
            is_between = min(last_failing, best) <= short <= max(last_failing, best)
            if is_between and find_bounds(PARAMETERS[name]).contain(short) and passes(short):
                return short
        for digits in _DIGITS:
            rounded = as_typed(name, round_digits(best, digits, up=best > failing))
            if find_bounds(PARAMETERS[name]).contain(rounded) and passes(rounded):
                return rounded
        return best

    def list_grid(self, name: str, present: float) -> Sequence[float]:
        """Values between the parameter's bounds, the nearest to the present one first."""
        bounds = find_bounds(PARAMETERS[name])
        high = bounds.maximum if bounds.maximum is not None else 2.0 * abs(present) + 1.0
        low = bounds.minimum if bounds.minimum is not None else (bounds.above or 0.0) + 1e-6 * high
        is_wide = low > 0.0 and high / low > 300.0
        shares = [i / _GRID_INTERVALS for i in range(_GRID_INTERVALS)]
        values = [low * (high / low) ** share if is_wide else low + (high - low) * share for share in shares]
        values += [high, PARAMETERS[name].default]
        if self.before is not None:
            values.append(self.before.value(name))
        inside = {as_typed(name, value) for value in values if bounds.contain(value)} - {present}

        def distance(value: float) -> float:
            return abs(math.log(value / present)) if is_wide and present > 0.0 else abs(value - present)

        return sorted(inside, key=lambda value: (distance(value), value))


def _blend(first: float, last: float, share: float) -> float:
    """Blend two positive numbers in equal ratios: the first for a share of 0, the last for 1."""
    ratio = last / first
    if 0.0 < ratio < math.inf:
        blend: float = first * ratio**share
        return blend
    # The ratio of two numbers that differ by more than 308 powers of ten is no number.
    return math.exp((1.0 - share) * math.log(first) + share * math.log(last))


def is_number(name: str) -> bool:
    return PARAMETERS[name].annotation in (float, int)


def as_typed(name: str, value: float) -> float:
    return round(value) if PARAMETERS[name].annotation is int else value


def round_inwards(name: str, value: float, up: bool) -> float:
    """Round a bound of a parameter inwards: to four digits in the electronic tables, else to two decimals."""
    if PARAMETERS[name].annotation is int:
        return math.ceil(value - 1e-9) if up else math.floor(value + 1e-9)
    if _is_electronic(name):
        return round_digits(value, 4, up)
    return (math.ceil(value * 100 - 1e-9) if up else math.floor(value * 100 + 1e-9)) / 100


def round_digits(value: float, digits: int, up: bool) -> float:
    if value == 0.0 or math.isinf(value):
        return value
    if abs(value) < SMALLEST:  # has no more digits to round
        return 0.0 if up == (value < 0.0) else math.copysign(SMALLEST, value)
    step = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)
    # A value that has so few digits already must not lose one to the division's last bit.
    count = round(value / step, 6)
    return float(f"{(math.ceil(count) if up else math.floor(count)) * step:.{digits}g}")


def format_value(name: str, value: Any) -> str:
    """Write a value so that it is the same number when it is typed in."""
    if not isinstance(value, float):
        return str(value)
    text = f"{value:.4g}" if _is_electronic(name) else f"{value:g}"
    return text if float(text) == value else repr(value)


def join_assignments(values: Mapping[str, Any]) -> str:
    """Write values as they are typed after --set, such as "skin.width_mm=18 and bone.wall_mm=1"."""
    return join_words(f"{name}={format_value(name, value)}" for name, value in values.items())


def cheapest_first(rules: Iterable[Rule]) -> tuple[Rule, ...]:
    """Order rules so that those which measure the silicone come late, and those which take longest come last."""
    return tuple(sorted(rules, key=lambda rule: (rule.takes_long, len(rule.prerequisites))))


def _is_electronic(name: str) -> bool:
    return name.partition(".")[0] in ELECTRONIC_TABLES


_MAX_ALTERNATIVES = 2
_MAX_CHANGED = 3
"""Maximum number of changed parameters among which alternatives are searched. More of them are a design of its own, in
which none stands out."""

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
    unit = format_unit(find_unit(PARAMETERS[name]))
    notes = [broken.violation.note for broken in refusal.blamed.get(name, ()) if broken.violation.note]
    if notes and len(refusal.blamed) == 1:
        unit += f" {notes[0]}"
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
    present, before = (CATALOGUE.get(tables.value(name)) for tables in (refusal.tables, refusal.before))
    if name != "sensor.model" or present is None or (before and before.bundled_design == present.bundled_design):
        return ""
    return f", or start from the bundled design {present.bundled_design}"


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
