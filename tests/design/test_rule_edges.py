"""Rules at their edges: at equality of parameters, at every bound, at bounds in pairs, and at the
last value that passes. Random numbers never meet these.
"""

from __future__ import annotations

import contextlib
import itertools
import math
import random
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from fingertip.design import Design
from fingertip.design.design_file import load_tables
from fingertip.design.geometry import DesignTables
from fingertip.design.interfaces import adapter
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.rules.ruleset import (
    BrokenRule,
    Rule,
    Violation,
    find_violations,
    record_reads,
)
from fingertip.design.search import RULES as ALL_RULES
from fingertip.foundation.errors import DesignError, Issue
from tests.approved import check_figures
from tests.conftest import design_file
from tests.design.edges import (
    DEFAULTS,
    NUMERIC,
    find_edge,
    find_ends,
    list_levels,
    make_covering_array,
)
from tests.design.test_rules import CASES
from tools.fuzz.remedies import as_changes, read_remedy

RULES = [rule for rule in ALL_RULES if rule not in adapter.RULES]
"""Rules that need no file; tests/cad/test_adapter.py breaks the others."""

ROUNDING = 1e-5
"""Twice the slack of the rules, and rounding errors beside."""
TIGHT = 1e-3
"""Largest relative distance of the bound that a rule states from the edge of the rule."""
LOOSE = {
    "skin_is_thick_enough": 0.002,  # leaves the slack of the section's measurement
    "travel_free": 0.03,  # whole degrees, found in steps of the travel
    "bent_stop_long_enough": 0.03,  # whole degrees
    "strands_beside_the_eyes": 0.05,  # allows 0.1 mm beyond what it recommends
    "filter_resistors_in_range": 0.2,  # preferred values
    "envelope_resistor_in_range": 0.2,  # preferred values
    "amplifier_drives_the_filter": 0.1,  # preferred values
    "amplifier_charges_the_envelope": 0.05,  # preferred values
    "threshold_within_supply": 0.011,  # recommends 99 % of what the supply allows
}
"""Rules that state another bound than their edge, and how far apart the two may be."""
WITHOUT_BOUND = {"taper_reaches_tip", "flat_edges_within_skin", "sensor_fits_flat"}
"""Rules whose edge has no closed form; their remedies are searched for."""
MAX_EDGES = 3
"""Parameters in which the edge of one rule is sought."""
BASES = {
    "": "fsr400",
    "bone.interface=socket bone.base_length_mm=32": "fsr402",
    "bone.foot_radius_mm=1.5": "article",
    "hand.tendon_diameter_mm=0.5": "adult_finger",
    "board.channels=3 detector.window_samples=100": "article",
    "board.variant=comparator": "child_thumb",
}
"""Changes -> bundled design; between them, most rules apply to one."""


@pytest.fixture(autouse=True)
def _without_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fit takes most of the time of a refusal, and `test_remedies` tests it."""
    monkeypatch.setattr("fingertip.design.design.list_moved", lambda tables, given: None)


def check_rules(tables: DesignTables) -> list[BrokenRule]:
    """Broken rules of a design.

    A rule that raises an exception is the fault these tests look for.
    """
    return list(find_violations(RULES, tables))


@cache
def find_broken() -> Mapping[Rule, BrokenRule]:
    """Each rule with a design that breaks it, and as little else as any that was tried."""
    designs = []
    for case in CASES:
        with contextlib.suppress(ValidationError):  # some cases break a bound, before any rule
            name, *changes = (
                case.split() if "=" not in case.split()[0] else ("fsr400", *case.split())
            )
            designs.append(DesignTables(**load_tables([design_file(name)], changes).tables))
    electronic = {
        name: levels
        for name, levels in list_levels().items()
        if name.startswith(("board.", "detector."))
    }
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
    """Yield parameters of a broken rule with the last value that
    breaks it and the first one that passes it.
    """
    names = [name for name in broken.own_reads if name in NUMERIC]
    count = 0
    for name in sorted(names, key=lambda each: (each != broken.rule.field, each)):
        value = broken.design.value(name)
        for target in dict.fromkeys((DEFAULTS.value(name), *find_ends(name))):
            end = broken.design.with_values({name: target})
            if any(one.check(end) for one in broken.rule.prerequisites) or broken.rule.check(end):
                continue
            edge = find_edge(broken.rule, broken.design, name, value, target)
            if edge:
                yield (name, *edge)
                count += 1
                break
        if count == MAX_EDGES:
            return


def list_broken(rule: Rule) -> Iterator[Violation]:
    """Yield how designs break a rule, in which all that it reads is
    another, and its field the lowest or highest.
    """
    rng = random.Random(rule.check.__name__)
    ends = find_ends(rule.field) if rule.field in NUMERIC else ()
    for words, name in BASES.items():
        base = DesignTables(**load_tables([design_file(name)], words.split()).tables)
        tables, reads = record_reads(base)
        rule.check(tables)
        for _ in range(3):
            changes: dict[str, float] = {}
            for path in sorted(reads & set(NUMERIC)):
                value = base.value(path)
                other = round(value * rng.uniform(0.5, 2.0), 0 if isinstance(value, int) else 3)
                if find_bounds(PARAMETERS[path]).contain(other):
                    changes[path] = type(value)(other)
            every = (
                base.with_values(changes | ({} if end is None else {rule.field: end}))
                for end in (None, *ends)
            )
            yield from itertools.islice(filter(None, map(rule.check, every)), 1)


def test_bounds_of_rules_are_the_approved_ones() -> None:
    """The first problem of each rule, and the bounds that all of them state."""
    lines = []
    for rule in RULES:
        found = list(list_broken(rule))
        bounds = {
            end
            for one in found
            for interval in one.passing
            for end in interval
            if math.isfinite(end)
        }
        others = [
            f"{path}={value}" for one in found[:1] for path, value in one.alternatives.items()
        ]
        said = "; ".join(text for one in found[:1] for text in (one.problem, one.note, *others))
        lines.append(
            f"{rule.check.__name__}: {said} {' '.join(f'{end:.5g}' for end in sorted(bounds))}"
        )
    check_figures(Path(__file__).parent / "approved" / "bounds.txt", lines, abs_=1e-6)


@pytest.mark.every_case
@pytest.mark.full
@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.check.__name__)
def test_the_edge_of_a_rule(rule: Rule) -> None:
    """Both neighbours of the edge are checked by all rules, and the
    bound that the rule states is the edge.
    """
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
            check_tightness(rule, passing, violation)


def check_tightness(rule: Rule, edge: float, violation: Violation) -> None:
    """Check that a rule states its own edge: a bound further in would refuse values that pass."""
    name = rule.check.__name__
    if edge in violation.alternatives.values():
        return
    ends = [end for interval in violation.passing for end in interval if math.isfinite(end)]
    assert bool(ends) == (name not in WITHOUT_BOUND), violation
    distance = min((abs(end - edge) for end in ends), default=0.0)
    assert distance <= LOOSE.get(name, TIGHT) * max(abs(edge), 1e-3) + 1e-6, (edge, violation)


def check_stated_values(rule: Rule, design: DesignTables, name: str, violation: Violation) -> None:
    """Check that the ends of the intervals that a rule states pass
    it, and that none holds the present value.
    """
    bounds = find_bounds(PARAMETERS[name])
    value = design.value(name)
    for low, high in violation.passing:
        assert not low + ROUNDING <= value <= high - ROUNDING, (name, value, violation)
        for end in (low, high):
            if bounds.contain(end) and not (
                PARAMETERS[name].annotation is int and end != round(end)
            ):
                assert rule.check(design.with_values({name: end})) is None, (name, end, violation)


@pytest.mark.full
def test_equal_parameters_raise_no_exception() -> None:
    """Each parameter that may have the default of another one has it: a quarter of the pairs."""
    for one, other in itertools.islice(itertools.permutations(NUMERIC, 2), 0, None, 4):
        value = DEFAULTS.value(other)
        if PARAMETERS[one].annotation is float and find_bounds(PARAMETERS[one]).contain(value):
            check_rules(DEFAULTS.with_values({one: float(value)}))


def list_rule_rows(rule: Rule) -> Iterator[dict[str, Any]]:
    """Yield rows with every pair of bounds and words of the parameters that a rule reads."""
    read = {
        name: levels
        for name, levels in list_levels().items()
        if name in find_broken()[rule].own_reads
    }
    if len(read) == 1:
        yield from ({name: level} for name, levels in read.items() for level in levels)
    else:
        yield from make_covering_array(read)


@pytest.mark.full
@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.check.__name__)
def test_bounds_in_pairs_have_remedies_that_pass(rule: Rule) -> None:
    """The rows begin from a design that reaches the rule, so that
    its prerequisites pass in many of them.
    """
    base = find_broken()[rule].design
    for row in itertools.islice(list_rule_rows(rule), 6):
        check_typed_remedies(base.with_values(row))


def check_typed_remedies(tables: DesignTables) -> None:
    """Type in what a refusal asks for until the design passes, at
    most three times: a rule may await others.
    """
    changes: list[str] = []
    for _ in range(3):
        issues = refuse(tables, changes)
        # No value mends a file.
        values = [issue for issue in issues if issue.field != "bone.adapter_file"]
        assert not values or read_remedy(values[0]), issues
        changes += (
            as_changes(values)
            if values == [*issues]
            else [*as_changes(values), "bone.interface=post"]
        )
    assert not refuse(tables, changes), changes


def refuse(tables: DesignTables, changes: list[str]) -> tuple[Issue, ...]:
    merged = tables.model_dump()
    for table, values in load_tables([], changes).tables.items():
        merged[table] = merged[table] | values if isinstance(values, Mapping) else values
    try:
        Design(**merged)
    except DesignError as error:
        return error.issues
    return ()
