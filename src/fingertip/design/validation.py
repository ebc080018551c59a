"""Explanation of why a design is refused: parameters that are not valid by themselves, and broken rules between them.

`fingertip.design.rules.remedies` is imported only for a refusal, which keeps the loading of designs fast.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from fingertip.design.issues import issues_from_pydantic
from fingertip.design.parameters import DesignTables, ParameterTable
from fingertip.design.parameters.declaration import find_bounds, find_unit, format_unit
from fingertip.design.parameters.design_tables import PARAMETERS
from fingertip.design.rules import RULES
from fingertip.design.rules.ruleset import BrokenRule, Rule, find_violations
from fingertip.errors import Issue


def describe_violations(tables: DesignTables, rules: Iterable[Rule] = RULES) -> Iterator[Issue]:
    """Yield the first problem of each field that a broken rule blames, without a remedy."""
    blamed: set[str] = set()
    for broken in find_violations(rules, tables):
        if broken.rule.field not in blamed:
            blamed.add(broken.rule.field)
            yield Issue(broken.rule.field, f"{broken.violation.problem}.")


def explain_violations(
    tables: DesignTables, broken: Sequence[BrokenRule], before: Mapping[str, Any] | None, changed: Sequence[str]
) -> list[Issue]:
    """Describe the rules that a design breaks, with remedies; the parameters are those of `find_remedies`."""
    from fingertip.design.rules.remedies import find_remedies

    try:
        valid_before = None if before is None else DesignTables(**before)
    except ValidationError:
        valid_before = None
    return find_remedies(tables, broken, valid_before, changed)


def explain_invalid(tables: Mapping[str, Any], error: ValidationError, changed: Sequence[str]) -> list[Issue]:
    """Describe all that is wrong with tables of which some parameters are not valid by themselves.

    The rules between the other parameters are checked too, so that one run reports everything.
    """
    from fingertip.design.rules.remedies import find_remedies

    issues = issues_from_pydantic(error, DesignTables)
    invalid = frozenset(issue.field for issue in issues)
    valid = _keep_valid(tables, invalid)
    broken = list(find_violations(RULES, valid, invalid))
    issues = [_extend_bound(issue, tables, valid, invalid) for issue in issues]
    known = [name for name in changed if name in PARAMETERS]  # an unknown name is one of the issues
    return issues + (find_remedies(valid, broken, None, known, invalid) if broken else [])


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
    from fingertip.design.rules.remedies import find_passing_value
    from fingertip.design.rules.search import Search, cheapest_first, format_value, round_digits

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
        default = round_digits(PARAMETERS[name].default, 3, up=True)
        if not any(name in one.reads for one in find_violations(RULES, valid.with_values({name: default}), others)):
            more = f", such as {format_value(name, default)}{unit}."
            return Issue(name, issue.message.removesuffix(".") + more)
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
