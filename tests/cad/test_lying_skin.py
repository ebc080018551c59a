"""Checks of a skin that lies on the bone: each finds its defect, and the bundled first finger has none."""

from __future__ import annotations

import pytest

from fingertip.cad.verification.skin import MAX_REST_N, check_rest_force, describe_lying_skin, pull_off_n, slide_mm
from fingertip.design import Design
from fingertip.pad.survey import GRASP_DEG, WIDE_DEG, survey_pad


def test_the_first_finger_reaches_what_is_wanted() -> None:
    design = Design.load("first_finger")
    loose = survey_pad(design, is_loose=True)
    assert check_rest_force(design).value < 0.5 * MAX_REST_N
    assert loose.dead_zone_n(*GRASP_DEG) <= 0.30
    assert loose.dead_zone_n(*WIDE_DEG) <= 0.40
    assert loose.least_share(*GRASP_DEG) >= 0.60
    assert loose.least_share(*WIDE_DEG) >= 0.52
    told = describe_lying_skin(design)
    assert told["pull_off_n"] < told["pull_off_glued_n"]
    assert told["loose"]["tilts"][0]["share"] == pytest.approx(loose.shares[0], abs=1e-4)


def test_bump_that_presses_on_the_sensor_at_rest_fails() -> None:
    assert not check_rest_force(Design.load("first_finger", changes=["skin.bump_radius_mm=2.54"])).passed


def test_hold_and_slide_are_those_of_the_study() -> None:
    """Its rib of 0.8 mm, of 1.2 MPa, held 13 N at a friction of 0.3; a bead some 20 N more; it slid by 0.16 mm."""
    design = Design.load("first_finger", changes=["silicone.product=own", "silicone.modulus_mpa=1.2"])
    assert pull_off_n(design) == pytest.approx(13.0, rel=0.15)
    assert pull_off_n(design, is_glued=True) - pull_off_n(design) == pytest.approx(20.0, rel=0.05)
    assert slide_mm(design) == pytest.approx(0.16, abs=0.04)
    tight = Design.load("first_finger", changes=["mold.core_inset_mm=0.1"])
    assert 0.3 < pull_off_n(tight) - pull_off_n(Design.load("first_finger")) < 2.0
