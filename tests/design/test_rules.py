"""Every rule between parameters can be broken, and its refusal is
the approved one, with a remedy that passes.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from fingertip.design import Design
from fingertip.design.formulas import filter as formulas
from fingertip.foundation.errors import DesignError, Issue
from tests.approved import check_text, read_text
from tools.fuzz.remedies import as_changes, read_alternatives, read_remedy

APPROVED = Path(__file__).parent / "approved" / "refusals.txt"
CASES = re.findall("^# (.*)", APPROVED.read_text(encoding="utf-8"), re.MULTILINE)
"""Changes of the default design, or of the bundled one that is named first.
To add one, write its heading there.
"""
FEW = [case for case in CASES if not case.startswith(("board.", "detector."))][::12]
"""Cases of solids that stand for all in the first set: most remedies
of theirs take a tenth of a second or more.
"""


def find_issues(words: list[str]) -> tuple[Issue, ...]:
    """Issues of a design; none if it passes."""
    files, changes = (
        [word for word in words if ("=" in word) == is_change] for is_change in (False, True)
    )
    try:
        Design.load(*files, changes=changes)
    except DesignError as error:
        return error.issues
    return ()


@pytest.mark.every_case
@pytest.mark.parametrize(
    "case",
    [
        case
        if case in FEW or case.startswith(("board.", "detector."))
        else pytest.param(case, marks=pytest.mark.full)
        for case in CASES
    ],
)
def test_a_refusal_is_the_approved_one_and_its_remedies_pass(case: str) -> None:
    issues = find_issues(case.split())
    text = "".join([f"# {case}\n", *(f"{issue}\n" for issue in issues)])
    section = rf"^# {re.escape(case)}\n(?:[^#].*\n)*"
    check_text(APPROVED, re.sub(section, lambda _: text, read_text(APPROVED), flags=re.MULTILINE))
    assert not issues or read_remedy(issues[0])
    for remedy in (
        [*as_changes(issues)],
        *([one] for issue in issues[:1] for one in read_alternatives(issue)),
    ):
        assert not find_issues([*case.split(), *remedy]), remedy


def test_dimensions_follow_a_copy_with_other_parameters() -> None:
    design = Design()
    assert design.dimensions.shrinkage > 1.0
    assert design.mold_layout.half_width > 0.0
    wider = design.with_values({"skin.width_mm": 20.0, "board.cutoff_hz": 70.0})
    assert wider.dimensions.outer.section.half_width == 10.0
    assert wider.mold_layout.half_width > design.mold_layout.half_width
    assert design.with_values({"board.cutoff_hz": 70.0}).dimensions is design.dimensions


def test_figures_of_the_comparator_are_those_of_its_data_sheet() -> None:
    """The LMV331's supply, input bias current, offset and drift, entered a second time."""
    currents_a = formulas.BIAS_A, formulas.MAX_BIAS_A, formulas.HOT_BIAS_A
    assert [1e9 * current_a for current_a in currents_a] == pytest.approx([25, 250, 400])
    assert pytest.approx((1.7, 7)) == (
        1e3 * formulas.COMPARATOR_OFFSET_V,
        1e3 * formulas.MAX_COMPARATOR_OFFSET_V,
    )
    assert pytest.approx(5) == 1e6 * formulas.COMPARATOR_DRIFT_V_PER_K
    # Both ends are equally far from the data sheet's temperature, so that one drift holds for both.
    assert (formulas.MIN_TEMPERATURE_C, formulas.DATA_SHEET_C, formulas.MAX_TEMPERATURE_C) == (
        0.0,
        25.0,
        50.0,
    )
