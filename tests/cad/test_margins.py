"""Margins: the limits that they name are those at which rules and checks turn."""

from __future__ import annotations

import math

import pytest

from fingertip.cad.verification.check import Check
from fingertip.cad.verification.margins import list_margins
from fingertip.design import Design
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import RULES
from fingertip.foundation.validation import Comparison
from tests.conftest import DESIGNS


def test_the_margin_is_the_distance_relative_to_the_limit() -> None:
    assert Comparison("a", 2.1, 2.0, "", "at least").margin_percent == pytest.approx(5.0)
    assert Comparison("a", 3.0, 2.0, "mm", "below").margin_percent == pytest.approx(-50.0)
    assert Comparison("a", 0.0, 0.0, "", "exactly").margin_percent == math.inf


@pytest.mark.parametrize("name", DESIGNS)
def test_a_rule_turns_at_its_limit(name: str) -> None:
    design = Design.load(name)
    check = Check("x", 1.0, 0.97, "", "at least")
    listed = list_margins(design, [check, Check("edges", 0.0, 0.0, "", "exactly")])
    assert [one.margin_percent for one in listed] == sorted(one.margin_percent for one in listed)
    listed.remove(check)
    assert len(listed) >= 5
    # Bone.wall_mm of fsr400 is chosen at its limit.
    assert all(one.margin_percent > 1e-4 for one in listed)
    for one in listed:
        field = one.name.partition(":")[0]
        beyond = (-0.02 if one.relation == "at least" else 0.02) * one.limit
        label = one.name.partition(": ")[2].replace(" ", "_")

        def breaks(value: float, field: str = field, label: str = label) -> bool:
            found = find_violations(RULES, design.with_values({field: value}))
            return label in {broken.rule.check.__name__ for broken in found}

        assert breaks(one.limit + beyond), one
        assert not breaks(one.limit - beyond), one
