"""Checks of a skin that lies on the bone: each finds its defect, and the bundled first finger has none."""

from __future__ import annotations

import pytest

from fingertip.cad.verification.lying_skin import MAX_REST_N, check_lying_skin, pull_off_n, slide_mm
from fingertip.design import Design


def states(*changes: str) -> dict[str, str]:
    return {check.name: check.state for check in check_lying_skin(Design.load("first_finger", changes=changes))}


def test_the_first_finger_reaches_what_is_wanted() -> None:
    checks = {check.name: check for check in check_lying_skin(Design.load("first_finger"))}
    assert len(checks) == 8
    assert {check.state for check in checks.values()} == {"passed"}
    assert checks["pad.rest_force"].value < 0.5 * MAX_REST_N
    assert checks["pad.dead_zone.grasp"].value <= 0.30
    assert checks["pad.dead_zone.wide"].value <= 0.40
    assert checks["pad.loose_share.grasp"].value >= 0.60
    assert checks["pad.loose_share.wide"].value >= 0.52


@pytest.mark.parametrize(
    ("changes", "name", "state"),
    [
        (("skin.bump_radius_mm=2.54",), "pad.rest_force", "failed"),
        (("skin.bump_radius_mm=2.6",), "skin.slide", "warning"),
        (("skin.bump_height_mm=0",), "pad.dead_zone.grasp", "warning"),
        (("skin.bump_height_mm=0",), "pad.dead_zone.wide", "warning"),
        (("skin.crown_offset_mm=-1.5",), "pad.loose_share.wide", "warning"),
        (("skin.crown_radius_mm=20",), "pad.loose_share.grasp", "warning"),
        (("bone.groove_depth_mm=0",), "skin.pull_off", "warning"),
        (("strength.grip_force_n=40", "strength.min_grip_factor=1"), "skin.pull_off_glued", "warning"),
    ],
)
def test_each_check_finds_its_defect(changes: tuple[str, ...], name: str, state: str) -> None:
    assert states(*changes)[name] == state


def test_a_bonded_or_another_skin_is_not_checked_so() -> None:
    assert not [*check_lying_skin(Design.load("fsr400_compact"))]


def test_hold_and_slide_are_those_of_the_study() -> None:
    """Its rib of 0.8 mm, of 1.2 MPa, held 13 N at a friction of 0.3; a bead some 20 N more; it slid by 0.16 mm."""
    design = Design.load("first_finger", changes=["silicone.product=own", "silicone.modulus_mpa=1.2"])
    assert pull_off_n(design) == pytest.approx(13.0, rel=0.15)
    assert pull_off_n(design, is_glued=True) - pull_off_n(design) == pytest.approx(20.0, rel=0.05)
    assert slide_mm(design) == pytest.approx(0.16, abs=0.04)
    tight = Design.load("first_finger", changes=["mold.core_inset_mm=0.1"])
    assert 0.3 < pull_off_n(tight) - pull_off_n(Design.load("first_finger")) < 2.0
