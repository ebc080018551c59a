"""Messages of a design that is refused: each problem, with a remedy that passes."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from fingertip.catalogues.electronics import SENSORS
from fingertip.design.files import flatten
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS, ParameterTable
from fingertip.design.parameters.declaration import find_bounds, find_unit, format_unit, issues_from_pydantic
from fingertip.design.remedies import Refusal, Values, find_passing_value, resolve
from fingertip.design.rules.ruleset import BrokenRule, Rule, find_violations
from fingertip.design.search import RULES, Search, cheapest_first, format_value, is_number, join_assignments
from fingertip.foundation.errors import Issue

_MAX_ALTERNATIVES = 2
_MAX_CHANGED = 3
"""Maximum number of changed parameters among which alternatives are searched. More of them are a design of its own, in
which none stands out."""


def find_remedies(
    tables: DesignTables,
    broken: Sequence[BrokenRule],
    before: DesignTables | None = None,
    changed: Sequence[str] = (),
    invalid: frozenset[str] = frozenset(),
    rules: Iterable[Rule] = RULES,
) -> list[Issue]:
    """Describe what is wrong with a design, each problem with a remedy."""
    before = before or DesignTables()
    names = changed or [name for name in PARAMETERS if tables.value(name) != before.value(name)]
    search = Search(cheapest_first(rules), cheapest_first(one.rule for one in broken), invalid, before)
    refusal = Refusal(tables, tuple(broken), before, tuple(names), search)
    return list(_describe(refusal, resolve(refusal)))


def _describe(refusal: Refusal, values: Values) -> Iterator[Issue]:
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
    present, before = (SENSORS.get(tables.value(name)) for tables in (refusal.tables, refusal.before))
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


def describe_violations(tables: DesignTables, rules: Iterable[Rule] = RULES) -> Iterator[Issue]:
    blamed: set[str] = set()
    for broken in find_violations(rules, tables):
        if broken.rule.field not in blamed:
            blamed.add(broken.rule.field)
            yield Issue(broken.rule.field, f"{broken.violation.problem}.")


def explain_violations(
    tables: DesignTables, broken: Sequence[BrokenRule], before: Mapping[str, Any] | None, changed: Sequence[str]
) -> list[Issue]:
    """Describe the rules that a design breaks, with remedies; the parameters are those of `find_remedies`."""
    valid_before = None
    if before is not None:
        with contextlib.suppress(ValidationError):
            valid_before = DesignTables(**before)
    return find_remedies(tables, broken, valid_before, changed)


def explain_invalid(tables: Mapping[str, Any], error: ValidationError, changed: Sequence[str]) -> list[Issue]:
    """Describe what is wrong with tables of which some parameters are not valid; rules check the others at once."""
    issues = issues_from_pydantic(error, DesignTables)
    invalid = frozenset(issue.field for issue in issues)
    invalid |= frozenset(_find_misplaced(tables, invalid))
    valid = _keep_valid(tables, invalid)
    broken = list(find_violations(RULES, valid, invalid))
    issues = [_extend_bound(issue, tables, valid, invalid) for issue in issues]
    known = [name for name in changed if name in PARAMETERS]  # an unknown name is one of the issues
    return issues + (find_remedies(valid, broken, None, known, invalid) if broken else [])


def _find_misplaced(tables: Mapping[str, Any], unknown: frozenset[str]) -> Iterator[str]:
    """Find parameters that stand in another table, as below a heading that was lost: their values are not known."""
    known = {name for name, _ in flatten(tables)}
    keys = {name.rpartition(".")[2] for name in unknown - set(PARAMETERS)}
    return (name for name in PARAMETERS if name.rpartition(".")[2] in keys and name not in known)


def _keep_valid(tables: Mapping[str, Any], invalid: frozenset[str]) -> DesignTables:
    """Make tables of the valid parameters, with the defaults in place of the others."""
    fields: dict[str, Any] = {}
    for name, info in DesignTables.model_fields.items():
        table, default = tables.get(name), info.default
        if isinstance(default, ParameterTable):
            values = table if isinstance(table, Mapping) else {}
            known = type(default).model_fields
            valid = {key: v for key, v in values.items() if key in known and f"{name}.{key}" not in invalid}
            fields[name] = default.model_copy(update=valid)
        else:
            fields[name] = default
    return DesignTables.model_construct(**fields)


def _extend_bound(issue: Issue, tables: Mapping[str, Any], valid: DesignTables, invalid: frozenset[str]) -> Issue:
    """Add to a violated bound the value that the rules require, if the bound itself would break them."""
    name = issue.field
    table, _, key = name.partition(".")
    if name not in PARAMETERS or not key:
        return issue
    value, bounds = tables[table][key], find_bounds(PARAMETERS[name])
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return issue
    if bounds.maximum is not None and value > bounds.maximum:
        word, bound = "at most", bounds.maximum
    elif bounds.minimum is not None and value < bounds.minimum:
        word, bound = "at least", bounds.minimum
    elif bounds.above is not None and value <= bounds.above:
        word, bound = "at least", bounds.above + 1e-6 * (bounds.maximum or 1.0)
    else:
        return issue
    others, unit = invalid - {name}, format_unit(find_unit(PARAMETERS[name]))
    if bounds.above is not None and word == "at least":  # the bound itself is no value to type in
        default = PARAMETERS[name].default
        if not any(name in one.reads for one in find_violations(RULES, valid.with_values({name: default}), others)):
            return issue  # which names it as an example
        issue = Issue(name, issue.message.partition(", such as")[0])
    at_bound = valid.with_values({name: bound})
    violations = list(find_violations(RULES, at_bound, others))
    broken = [one for one in violations if name in one.reads]
    if not broken:
        return issue
    # Rules that fail whatever this parameter is have issues of their own.
    unrelated = {one.rule for one in violations} - {one.rule for one in broken}
    rules = cheapest_first(rule for rule in RULES if rule not in unrelated)
    search = Search(rules, cheapest_first(one.rule for one in broken), others)
    passing = find_passing_value(search, at_bound, name, broken)
    if passing is None:
        return issue
    more = f", and {word} {format_value(name, passing)}{unit} with the other parameters as they are."
    return Issue(name, issue.message.removesuffix(".") + more)
