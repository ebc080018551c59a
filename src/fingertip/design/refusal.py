"""Messages of a design that is refused: each problem, with a remedy that passes."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from fingertip.catalogues.electronics import SENSORS
from fingertip.design import remedies
from fingertip.design.design_file import flatten
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import (
    find_bounds,
    find_unit,
    format_unit,
    issues_from_pydantic,
)
from fingertip.design.rules.ruleset import BrokenRule, Rule, find_violations
from fingertip.design.search import (
    ELECTRONIC_RULES,
    RULES,
    Search,
    cheapest_first,
    format_value,
    is_number,
    join_assignments,
)
from fingertip.foundation.errors import Issue, join_words

_MAX_CHANGED = 3
"""Largest number of parameters that differ from the design before and are taken for its changes, if
nobody names these. With more, it is a design of its own.
"""
_FILE = "bone.adapter_file"
"""Parameter whose rules state their remedies: no other value repairs a file."""


def find_remedies(
    tables: DesignTables,
    broken: Sequence[BrokenRule],
    before: DesignTables | None = None,
    changed: Sequence[str] = (),
    invalid: frozenset[str] = frozenset(),
    rules: Iterable[Rule] = RULES,
    *,
    fit: remedies.FitFunction | None = None,
    settle: remedies.SettleFunction | None = None,
) -> list[Issue]:
    """Describe what is wrong with a design, each problem with a remedy.

    `before` is the design that was changed (the defaults if None), and `changed` names its changes,
    among which the cause is sought. `fit` is tried on the design. Where it has failed, `settle`
    adds to values what makes a fit follow.
    """
    before = before or DesignTables()
    if not changed:
        differing = [name for name in PARAMETERS if tables.value(name) != before.value(name)]
        changed = differing if len(differing) <= _MAX_CHANGED else ()

    changed = tuple(name for name in changed if name in PARAMETERS)
    of_file = [
        violated
        for violated in broken
        if violated.rule.field == _FILE and not any(map(is_number, violated.own_reads & {*changed}))
    ]
    issues = [Issue(_FILE, f"{violated.violation.problem}.") for violated in of_file]
    if of_file:
        broken = [violated for violated in broken if violated not in of_file]
        invalid = invalid | {_FILE}

    for of_parts in (True, False):  # printed parts and electronics read no table of each other
        own = tuple(
            violated for violated in broken if (violated.rule not in ELECTRONIC_RULES) is of_parts
        )
        if not own:
            continue

        checked = (rule for rule in rules if (rule not in ELECTRONIC_RULES) is of_parts)
        suspects = (violated.rule for violated in own)
        may_fit = of_parts and not invalid
        refusal = remedies.Refusal(
            tables=tables,
            broken=own,
            before=before,
            changed=changed,
            search=Search(cheapest_first(checked), cheapest_first(suspects), invalid, before),
            settled=may_fit and settle is not None,
        )
        moved = fit(tables, changed) if may_fit and fit else None
        values = remedies.resolve(refusal, moved is not None)
        if may_fit and settle:
            values = remedies.settle(refusal, values, settle)

        issues += _describe(refusal, values, moved or ())

    return issues


def _describe(
    refusal: remedies.Refusal, values: remedies.Values, fitted: Sequence[str]
) -> Iterator[Issue]:
    """Yield an issue for the parameter whose change is the cause, then for all other fields.

    These are the fields that rules blame or remedies move. `fitted` names what a fit moves.
    """
    blamed = refusal.blamed
    counts: Counter[str] = Counter()
    for field in blamed:
        counts.update(refusal.reads(field))

    names = _order_fields(refusal, values, counts)
    for name in names:
        if name in blamed:
            problem = blamed[name][0].violation.problem
        else:
            unit = format_unit(find_unit(PARAMETERS[name]))
            present = f"{format_value(name, refusal.tables.value(name))}{unit}"
            rules = f"{counts[name]} rules" if counts[name] > 1 else "a rule"
            problem = f"{present} breaks {rules}, listed below"

        offers = [_format_bound(refusal, name, values)] if name in values else []
        if name == names[0]:
            rest = {moved: value for moved, value in values.items() if moved not in names}
            if not rest and not offers:
                rest = values
            if rest:
                begin = f"{offers[0]}, together with" if offers else "set"
                offers = [f"{begin} {join_assignments(rest)}"]

            offers += _list_alternatives(refusal, values)
            if fitted:
                offers.append(f"add --fit, which moves {join_words(fitted)}")
        elif name == names[-1] and not offers:
            offers = [_format_consequence(refusal, values)]

        yield Issue(name, f"{problem}{'; ' * bool(offers)}{', or '.join(offers)}.")


def _order_fields(
    refusal: remedies.Refusal, values: remedies.Values, counts: Mapping[str, int]
) -> list[str]:
    """List the fields to describe: the change that is the cause, what moves, what rules blame."""
    blamed = refusal.blamed
    causes = sorted(
        (name for name in refusal.changed if name in counts),
        key=lambda name: (name not in values, name not in blamed),
    )[:1]
    moved = []
    if causes or len(blamed) > 1:
        moved = [name for name in values if name in counts]

    in_order = (*causes, *moved, *sorted(blamed, key=lambda name: name not in values))
    return list(dict.fromkeys(in_order))


def _format_consequence(refusal: remedies.Refusal, values: remedies.Values) -> str:
    """Format what fixes all of a refusal, for its last field."""
    remedy = join_assignments(values) if values else "--fit"
    verb = "fix" if len(values) > 1 else "fixes"
    return f"{remedy} {verb} {'all of ' * (len(refusal.blamed) > 1)}this"


def _format_bound(refusal: remedies.Refusal, name: str, values: remedies.Values) -> str:
    """Format the value that a field needs as a bound.

    If it is the only field that is blamed, it may have several bounds, all verified.
    """
    value = values[name]
    if not is_number(name):
        return f"set {join_assignments({name: value})}{_suggest_bundled_design(refusal, name)}"

    unit = format_unit(find_unit(PARAMETERS[name]))
    intervals = list[remedies.Ends]()
    if set(refusal.blamed) == {name}:
        intervals = remedies.find_intervals(name, refusal.broken)
        notes = (broken.violation.note for broken in refusal.broken if broken.violation.note)
        unit += next((f" {note}" for note in notes), "")

    if value not in remedies.list_ends(refusal.tables, name, intervals):
        intervals = [(value, None) if value > refusal.tables.value(name) else (None, value)]

    def verify(end: float | None) -> float | None:
        may_hold = end is not None and not refusal.settled
        return end if end == value or (may_hold and refusal.resolves({name: end})) else None

    texts = (_format_interval(name, verify(low), verify(high)) for low, high in intervals)
    return " or ".join(filter(None, texts)) + unit


def _format_interval(name: str, low: float | None, high: float | None) -> str:
    """Format an interval of values; empty without ends."""
    if low is None:
        return "" if high is None else f"at most {format_value(name, high)}"
    if high is None:
        return f"at least {format_value(name, low)}"
    if low == high:
        return format_value(name, low)

    return f"between {format_value(name, low)} and {format_value(name, high)}"


def _suggest_bundled_design(refusal: remedies.Refusal, name: str) -> str:
    """Name the bundled design for a sensor that the present design does not fit."""
    if name != "sensor.model":
        return ""

    sensor = SENSORS.get(refusal.tables.value(name))
    before = SENSORS.get(refusal.before.value(name))
    if sensor is None or (before and before.bundled_design == sensor.bundled_design):
        return ""

    return f", or start from the bundled design {sensor.bundled_design}"


def _list_alternatives(refusal: remedies.Refusal, values: remedies.Values) -> Iterator[str]:
    """Yield what resolves a refusal instead: the bound of its field, and values that rules name.

    There is none if several fields are blamed.
    """
    if len(refusal.blamed) > 1 or refusal.settled:
        return

    ((name, broken),) = refusal.blamed.items()
    ends = remedies.list_ends(refusal.tables, name, remedies.find_intervals(name, broken))
    alternatives: remedies.Values = {name: ends[0]} if ends and refusal.may_move(name) else {}
    for violated in broken:
        alternatives |= violated.violation.alternatives

    for parameter, value in alternatives.items():
        if values.get(parameter) != value and refusal.resolves({parameter: value}):
            yield join_assignments({parameter: value})


def describe_violations(tables: DesignTables, rules: Iterable[Rule] = RULES) -> Iterator[Issue]:
    """Yield an issue without remedy for each field that a broken rule blames."""
    blamed: set[str] = set()
    for broken in find_violations(rules, tables):
        if broken.rule.field not in blamed:
            blamed.add(broken.rule.field)
            yield Issue(broken.rule.field, f"{broken.violation.problem}.")


def read_valid(tables: Mapping[str, Any] | None) -> DesignTables | None:
    """Read tables that may be valid with changes only; None if they are not."""
    with contextlib.suppress(ValidationError):
        return DesignTables(**tables) if tables is not None else None

    return None


def explain_invalid(
    tables: Mapping[str, Any], error: ValidationError, changed: Sequence[str]
) -> list[Issue]:
    """Describe the parameters that are not valid, and the rules that the others break."""
    issues = issues_from_pydantic(error, DesignTables)
    invalid = frozenset(issue.field for issue in issues)
    # The values of parameters that stand in another table, as below a heading that was lost, are
    # not known.
    known = {name for name, _ in flatten(tables)}
    keys = {name.rpartition(".")[2] for name in invalid - set(PARAMETERS)}
    invalid |= {
        name for name in PARAMETERS if name.rpartition(".")[2] in keys and name not in known
    }
    values = {
        name: value for name, value in flatten(tables) if name in PARAMETERS and name not in invalid
    }
    valid = DesignTables().with_values(values)  # with the defaults in place of the others
    broken = list(find_violations(RULES, valid, invalid))
    issues = [_extend_bound(issue, tables, valid, invalid) for issue in issues]

    return issues + find_remedies(
        valid,
        broken=broken,
        before=None,
        changed=changed,
        invalid=invalid,
    )


def _extend_bound(
    issue: Issue, tables: Mapping[str, Any], valid: DesignTables, invalid: frozenset[str]
) -> Issue:
    """Add to a violated bound the value that rules require, if the bound itself breaks them."""
    name = issue.field
    value = dict(flatten(tables)).get(name)
    if name not in PARAMETERS or isinstance(value, bool) or not isinstance(value, int | float):
        return issue

    field = PARAMETERS[name]
    bounds = find_bounds(field)
    unit = format_unit(find_unit(field))
    if bounds.contain(value) or not -1e308 < value < 1e308:
        return issue

    if bounds.maximum is not None and value > bounds.maximum:
        word = "at most"
        bound = bounds.maximum
    else:
        # A value that must be above a bound has no least one: the message names the default.
        word = "at least"
        bound = field.default if bounds.minimum is None else bounds.minimum

    at_bound = valid.with_values({name: bound})
    still_invalid = invalid - {name}
    violations = list(find_violations(RULES, at_bound, still_invalid))
    broken = [violated for violated in violations if name in violated.reads]
    # Rules that fail whatever this parameter is have issues of their own.
    unrelated = {violated.rule for violated in violations if name not in violated.reads}
    rules = cheapest_first(rule for rule in RULES if rule not in unrelated)
    suspects = cheapest_first(violated.rule for violated in broken)
    search = Search(rules, suspects, still_invalid)
    passing = remedies.find_passing_value(search, at_bound, name, broken) if broken else None
    if passing is None:
        return issue

    more = (
        f", and {word} {format_value(name, passing)}{unit} with the other parameters as they are."
    )
    return Issue(name, issue.message.partition(", such as")[0].removesuffix(".") + more)
