"""Rules at their edges: at equality of parameters, at every bound, at bounds in pairs, and at the last value that
passes. Random numbers never meet these."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import pytest

from fingertip.design import Design
from fingertip.design.load import load_tables
from fingertip.design.parameters import DesignTables
from fingertip.design.parameters.declaration import find_bounds, find_unit
from fingertip.design.parameters.design_tables import PARAMETERS
from fingertip.design.rules import ELECTRONIC_RULES, RULES
from fingertip.design.rules.ruleset import BrokenRule, Rule, Violation, find_violations
from fingertip.errors import DesignError
from tests.design.edges import DEFAULTS, NUMERIC, find_edge, find_ends, list_levels, make_covering_array
from tests.design.remedies import as_changes, read_remedy
from tests.design.test_rules import CASES

ROUNDING = 1e-5
"""Twice the slack of the rules, and rounding errors beside."""
MAX_EDGES = 3
"""Parameters in which the edge of one rule is sought."""


def check_rules(tables: DesignTables) -> list[BrokenRule]:
    """Broken rules of a design. A rule that raises an exception is the fault these tests look for."""
    return list(find_violations(RULES, tables))


@cache
def find_broken() -> Mapping[Rule, BrokenRule]:
    """Each rule with a design that breaks it, and as little else as any that was tried."""
    designs = [DesignTables(**load_tables([], changes).tables) for _, changes in CASES]
    electronic = {name: levels for name, levels in list_levels().items() if name.startswith(("board.", "detector."))}
    designs += (DEFAULTS.with_values({name: end}) for name in NUMERIC for end in find_ends(name))
    designs += (DEFAULTS.with_values(row) for row in make_covering_array(electronic))
    found: dict[Rule, tuple[int, BrokenRule]] = {}
    for tables in designs:
        broken = check_rules(tables)
        for one in broken:
            if one.rule not in found or len(broken) < found[one.rule][0]:
                found[one.rule] = (len(broken), one)
    return {rule: one for rule, (_, one) in found.items()}


def list_edges(broken: BrokenRule) -> Iterator[tuple[str, float, float]]:
    """Yield parameters of a broken rule with the last value that breaks it and the first one that passes it."""
    names = [name for name in broken.own_reads if name in NUMERIC]
    count = 0
    for name in sorted(names, key=lambda each: (each != broken.rule.field, each)):
        value = broken.design.value(name)
        for target in dict.fromkeys((DEFAULTS.value(name), *find_ends(name))):
            end = broken.design.with_values({name: target})
            if any(one.check(end) for one in broken.rule.prerequisites) or broken.rule.check(end):
                continue
            if edge := find_edge(broken.rule, broken.design, name, value, target):
                yield (name, *edge)
                count += 1
                break
        if count == MAX_EDGES:
            return


RULES_BROKEN_BY_NO_CASE: set[str] = set()


def test_every_rule_is_broken_by_a_design() -> None:
    names = {rule.check.__name__ for rule in RULES if rule not in find_broken()}
    assert names == RULES_BROKEN_BY_NO_CASE


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.check.__name__)
def test_the_edge_of_a_rule(rule: Rule) -> None:
    """Both neighbours of the edge are checked by all rules, and the bound that the rule states is the edge."""
    if rule not in find_broken():
        pytest.skip("no design breaks it")
    edges = list(list_edges(find_broken()[rule]))
    tables = find_broken()[rule].design
    for name, broken, passing in edges:
        for value in (broken, passing):
            check_rules(tables.with_values({name: value}))
        violation = rule.check(tables.with_values({name: broken}))
        assert violation is not None
        assert rule.check(tables.with_values({name: passing})) is None
        if name == rule.field:
            design = tables.with_values({name: broken})
            check_stated_values(rule, design, name, violation)


def check_stated_values(rule: Rule, design: DesignTables, name: str, violation: Violation) -> None:
    """Check that the ends of the intervals that a rule states pass it, and that the present value is not within them."""
    bounds, value = find_bounds(PARAMETERS[name]), design.value(name)
    for low, high in violation.passing:
        assert not low + ROUNDING <= value <= high - ROUNDING, (name, value, violation)
        for end in (low, high):
            if bounds.contain(end) and not (PARAMETERS[name].annotation is int and end != round(end)):
                assert rule.check(design.with_values({name: end})) is None, (name, end, violation)
