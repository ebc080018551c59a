"""Messages of a design that is refused: each problem, with a remedy that passes."""

from __future__ import annotations

import collections
import contextlib
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
"""Maximum number of parameters that differ from a design before and are taken for its changes, if
nobody names these. More of them are a design of its own, in which none stands out.
"""
_FILE = "bone.adapter_file"
"""Parameter whose rules say themselves what to do: no other value mends a file."""


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
    differing = [name for name in PARAMETERS if tables.value(name) != before.value(name)]
    changed = tuple(
        filter(
            PARAMETERS.__contains__,
            changed or (differing if len(differing) <= _MAX_CHANGED else ()),
        )
    )
    of_file = [
        one
        for one in broken
        if one.rule.field == _FILE and not any(map(is_number, one.own_reads & {*changed}))
    ]
    issues = [Issue(_FILE, f"{one.violation.problem}.") for one in of_file]

    if of_file:
        broken = [one for one in broken if one not in of_file]
        invalid = invalid | {_FILE}

    for of_parts in (True, False):  # printed parts and electronics read no table of each other
        own = tuple(one for one in broken if (one.rule not in ELECTRONIC_RULES) is of_parts)
        if own:
            checked = cheapest_first(
                rule for rule in rules if (rule not in ELECTRONIC_RULES) is of_parts
            )
            search = Search(checked, cheapest_first(one.rule for one in own), invalid, before)
            usable = of_parts and not invalid
            refusal = remedies.Refusal(
                tables=tables,
                broken=own,
                before=before,
                changed=changed,
                search=search,
                settled=usable and settle is not None,
            )
            fitted = fit(tables, changed) if usable and fit else None
            values = remedies.resolve(refusal, fitted is not None)
            if usable and settle:
                values = remedies.settle(refusal, values, settle)

            issues += _describe(refusal, values, fitted or ())

    return issues


def _describe(
    refusal: remedies.Refusal, values: remedies.Values, fitted: Sequence[str]
) -> Iterator[Issue]:
    """Yield an issue for the parameter whose change is the cause,
    then one for each other blamed or moved field.
    """
    blamed = refusal.blamed
    counts = collections.Counter(name for field in blamed for name in refusal.reads(field))
    causes = sorted(
        filter(counts.get, refusal.changed),
        key=lambda name: (name not in values, name not in blamed),
    )[:1]
    moved = [name for name in values if counts[name]] if causes or len(blamed) > 1 else []
    names = list(
        dict.fromkeys((*causes, *moved, *sorted(blamed, key=lambda name: name not in values)))
    )

    for name in names:
        if name in blamed:
            problem = blamed[name][0].violation.problem
        else:
            unit = format_unit(find_unit(PARAMETERS[name]))
            present = f"{format_value(name, refusal.tables.value(name))}{unit}"
            problem = (
                f"{present} breaks "
                f"{f'{counts[name]} rules' if counts[name] > 1 else 'a rule'}, listed below"
            )

        offers = [_format_bound(refusal, name, values)] if name in values else []
        if name == names[0]:
            rest = {other: value for other, value in values.items() if other not in names} or (
                {} if offers else values
            )
            if rest:
                offers = [f"{offers[0]}, together with " if offers else "set "]
                offers[0] += join_assignments(rest)

            offers += _list_alternatives(refusal, values)
            offers += [f"add --fit, which moves {join_words(fitted)}"] if fitted else []
        elif name == names[-1] and not offers:
            fixes = (
                f"{join_assignments(values) if values else '--fit'} "
                f"{'fix' if len(values) > 1 else 'fixes'}"
            )
            offers = [f"{fixes} {'all of ' * (len(blamed) > 1)}this"]

        yield Issue(name, f"{problem}{'; ' * bool(offers)}{', or '.join(offers)}.")


def _format_bound(refusal: remedies.Refusal, name: str, values: remedies.Values) -> str:
    """Write the value that a field needs as a bound.

    The only blamed field may have several bounds, all verified.
    """
    value = values[name]
    if not is_number(name):
        return f"set {join_assignments({name: value})}{_suggest_bundled_design(refusal, name)}"

    unit = format_unit(find_unit(PARAMETERS[name]))
    intervals = list[remedies.Ends]()
    if set(refusal.blamed) == {name}:
        intervals = remedies.find_intervals(name, refusal.broken)
        unit += next(
            (f" {broken.violation.note}" for broken in refusal.broken if broken.violation.note), ""
        )

    if value not in remedies.list_ends(refusal.tables, name, intervals):
        intervals = [(value, None) if value > refusal.tables.value(name) else (None, value)]

    def verify(end: float | None) -> float | None:
        may_hold = end is not None and not refusal.settled
        return end if end == value or (may_hold and refusal.resolves({name: end})) else None

    texts = (_format_interval(name, verify(low), verify(high)) for low, high in intervals)
    return " or ".join(filter(None, texts)) + unit


def _format_interval(name: str, low: float | None, high: float | None) -> str:
    texts = ["" if end is None else format_value(name, end) for end in (low, high)]
    if all(texts):
        return texts[0] if low == high else f"between {texts[0]} and {texts[1]}"
    if texts[0]:
        return f"at least {texts[0]}"
    if texts[1]:
        return f"at most {texts[1]}"

    return ""


def _suggest_bundled_design(refusal: remedies.Refusal, name: str) -> str:
    """Name the bundled design for a sensor that the present design does not fit."""
    present, before = (
        SENSORS.get(tables.value(name)) for tables in (refusal.tables, refusal.before)
    )
    if (
        name != "sensor.model"
        or present is None
        or (before and before.bundled_design == present.bundled_design)
    ):
        return ""

    return f", or start from the bundled design {present.bundled_design}"


def _list_alternatives(refusal: remedies.Refusal, values: remedies.Values) -> Iterator[str]:
    """Yield what resolves a refusal instead: the bound of the only
    blamed field, and values that its rules name.
    """
    if len(refusal.blamed) > 1 or refusal.settled:
        return

    ((name, broken),) = refusal.blamed.items()
    ends = remedies.list_ends(refusal.tables, name, remedies.find_intervals(name, broken))
    found: remedies.Values = {name: ends[0]} if ends and refusal.may_move(name) else {}
    for one in broken:
        found |= one.violation.alternatives

    for other, value in found.items():
        if values.get(other) != value and refusal.resolves({other: value}):
            yield join_assignments({other: value})


def describe_violations(tables: DesignTables, rules: Iterable[Rule] = RULES) -> Iterator[Issue]:
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
    """Describe what is wrong with tables of which some parameters are
    not valid; rules check the others at once.
    """
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
    """Add to a violated bound the value that the rules require,
    if the bound itself would break them.
    """
    name = issue.field
    others = invalid - {issue.field}
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
    # a bound that is not valid itself is no value to type in: the message names the default as an
    # example
    else:
        word = "at least"
        bound = field.default if bounds.minimum is None else bounds.minimum

    at_bound = valid.with_values({name: bound})
    violations = list(find_violations(RULES, at_bound, others))
    broken = [one for one in violations if name in one.reads]
    # Rules that fail whatever this parameter is have issues of their own.
    unrelated = {one.rule for one in violations} - {one.rule for one in broken}
    rules = cheapest_first(rule for rule in RULES if rule not in unrelated)
    search = Search(rules, cheapest_first(one.rule for one in broken), others)
    passing = remedies.find_passing_value(search, at_bound, name, broken) if broken else None
    if passing is None:
        return issue

    more = (
        f", and {word} {format_value(name, passing)}{unit} with the other parameters as they are."
    )
    return Issue(name, issue.message.partition(", such as")[0].removesuffix(".") + more)
