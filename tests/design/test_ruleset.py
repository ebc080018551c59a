"""Engine of the rules, on rules that are made up: order,
prerequisites, what was read, and what cannot be checked.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from fingertip.design.geometry import DesignTables
from fingertip.design.rules.ruleset import (
    SLACK,
    InvalidParameterError,
    Limit,
    Rule,
    RuleChecker,
    Ruleset,
    Violation,
    at_least,
    at_most,
    find_violations,
    record_reads,
)

TABLES = DesignTables()
ADC = ("detector.adc_range_v", "detector.adc_bits")


def passing(_: DesignTables) -> Violation | None:
    return None


def broken(_: DesignTables) -> Violation | None:
    return Violation("1 mm is too little")


def reads_wall(design: DesignTables) -> Violation | None:
    return Violation("is thin") if design.bone.wall_mm < 99.0 else None


def reads_width(design: DesignTables) -> Violation | None:
    return Violation("is wide") if design.skin.width_mm > 0.0 else None


def test_a_rule_is_checked_once_and_only_after_its_prerequisites_pass() -> None:
    calls = []

    def count(_: DesignTables) -> Violation | None:
        calls.append(1)
        return None

    good = Rule("a", passing)
    bad = Rule("b", broken)
    counted = Rule("c", count)
    checker = RuleChecker(TABLES)
    assert checker.passes(good)
    assert not checker.passes(bad)
    assert checker.violations == {bad: broken(TABLES)}
    assert not checker.passes(Rule("d", count, (good, bad)))
    assert not calls
    assert checker.passes(Rule("e", passing, (good, counted)))
    assert checker.passes(counted)
    assert len(calls) == 1
    assert list(checker.violations) == [bad], "a rule that was not checked has no violation"


def test_a_rule_that_reads_what_is_invalid_is_left_out_with_those_behind_it() -> None:
    wall = Rule("bone.wall_mm", reads_wall)
    width = Rule("skin.width_mm", reads_width)
    behind = Rule("mold.wall_mm", broken, (wall,))
    invalid = frozenset({"bone.wall_mm"})
    assert [item.rule for item in find_violations([wall, behind, width], TABLES, invalid)] == [
        width
    ]
    assert [item.rule for item in find_violations([wall, width], TABLES, frozenset({"bone"}))] == [
        width
    ]
    checker = RuleChecker(TABLES, invalid)
    assert not checker.passes(wall)
    assert checker.passes(Rule("a", passing, ()))
    assert checker.violations == {}


def test_what_decides_a_violation_is_recorded() -> None:
    """Of a rule with its prerequisites, and of itself alone: a
    repair must change one of the latter.
    """

    def reads_both(design: DesignTables) -> Violation | None:
        return (
            Violation("is thin")
            if design.bone.wall_mm < design.printer.min_wall_mm + 99.0
            else None
        )

    def reads_length(design: DesignTables) -> Violation | None:
        return None if design.skin.length_mm > 0.0 else Violation("is short")

    rule = Rule("bone.wall_mm", reads_both, (Rule("skin.length_mm", reads_length),))
    (item,) = find_violations([rule], TABLES)
    assert item.own_reads == {"bone.wall_mm", "printer.min_wall_mm"}
    assert item.reads == item.own_reads | {"skin.length_mm"}


def test_copy_has_the_values_of_the_tables_and_refuses_invalid_ones() -> None:
    tables, reads = record_reads(TABLES, frozenset({"skin.width_mm", "board", "name"}))
    assert tables.bone.wall_mm == TABLES.bone.wall_mm
    assert reads == {"bone.wall_mm"}
    for read in (lambda: tables.skin.width_mm, lambda: tables.board.variant, lambda: tables.name):
        with pytest.raises(InvalidParameterError):
            read()
    assert reads == {"bone.wall_mm", "skin.width_mm", "board.variant", "name"}
    free, reads = record_reads(TABLES)
    assert free.dimensions.sensor_z == TABLES.dimensions.sensor_z
    assert free.dimensions is free.dimensions
    assert free.mold_layout.half_width == TABLES.mold_layout.half_width
    assert {"skin.length_mm", "sensor.distance_from_tip_mm"} <= reads
    changed = free.with_values({"skin.width_mm": 10.0})
    assert changed.skin.width_mm == 10.0
    assert changed.bone.rim_mm == TABLES.bone.rim_mm
    assert "bone.rim_mm" in reads, "a copy records with its original"


@pytest.mark.parametrize(
    ("read", "names"),
    [
        (lambda tables: tables.value("skin.width_mm"), {"skin.width_mm"}),
        (lambda tables: tables.value("name"), {"name"}),
        (lambda tables: tables.detector.adc_low_v, {"detector.adc_polarity"}),
        (lambda tables: tables.detector.adc_step_v, {"detector.adc_polarity", *ADC}),
    ],
)
def test_what_a_method_or_property_reads_is_recorded(
    read: Callable[[DesignTables], object], names: set[str]
) -> None:
    tables, reads = record_reads(TABLES)
    assert read(tables) == read(TABLES)
    assert reads == names
    with pytest.raises(InvalidParameterError):
        read(record_reads(TABLES, frozenset(names))[0])


def test_a_bound_refuses_values_beyond_it_in_the_unit_of_its_field() -> None:
    ruleset = Ruleset()
    most = ruleset.at_most("mold.wall_mm")(
        lambda design: Limit(2.0, "are steep", "so far", {"bone.rim_mm": 1.0})
    )
    least = ruleset.at_least("bone.wall_mm", most, slack=0.0)(
        lambda design: Limit(0.8 + 1e-9, "is thin")
    )
    absent = ruleset.at_most("bone.wall_mm")(lambda design: None)
    assert list(ruleset) == [most, least, absent]
    assert least.prerequisites == (most,)
    assert at_least(2.0) == ((2.0, math.inf),)
    assert at_most(2.0) == ((-math.inf, 2.0),)
    assert most.check(TABLES) == Violation(
        "4 mm are steep", at_most(2.0), "so far", {"bone.rim_mm": 1.0}
    )
    assert most.check(TABLES.with_values({"mold.wall_mm": 2.0 + SLACK})) is None
    assert least.check(TABLES) == Violation("0.8 mm is thin", at_least(0.8 + 1e-9))
    assert absent.check(TABLES) is None


def test_a_rule_passes_where_it_does_not_apply_and_reads_what_that_depends_on() -> None:
    ruleset = Ruleset()
    bound = ruleset.at_least("mold.wall_mm", when=lambda design: design.bone.interface == "socket")
    rule = bound(lambda design: Limit(90.0, "are flat"))
    assert rule.check(TABLES) is None
    lowered = TABLES.with_values({"bone.interface": "socket"})
    (found,) = find_violations(ruleset, lowered)
    assert found.violation.problem == "4 mm are flat"
    assert found.own_reads == {"bone.interface", "mold.wall_mm"}
