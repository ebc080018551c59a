"""Seals of the mold: nothing leaks, each seal that is left out opens a path, and creep in closed form."""

from __future__ import annotations

import math

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.seals import seals
from fingertip.cad.verification import seals as verification
from fingertip.cad.verification.seals import check_seals, flooded_mm3, leak_mm
from fingertip.design import Design
from fingertip.design.new_design import PRESETS
from tests.conftest import design_file

TOLERANCE = 0.02


@pytest.mark.slow
@pytest.mark.parametrize("name", ["fsr400", "fsr402", "fsr400_compact", *PRESETS])
@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_bundled_molds_are_sealed(name: str, method: str) -> None:
    design = Design.load(design_file(name), changes=[f"mold.method={method}"])
    checks = {check.name: check for check in check_seals(design, MeshEvaluator(TOLERANCE))}
    assert all(check.passed for check in checks.values()), checks
    assert ("mold.open_paths" in checks) == (method == "overmold")


@pytest.mark.parametrize(
    ("name", "left_out"),
    [("fsr400", "tape"), ("fsr400", "passage"), ("adult_finger", "passage"), ("adult_finger", "lid")],
)
def test_a_seal_that_is_left_out_opens_a_path(name: str, left_out: str, monkeypatch: pytest.MonkeyPatch) -> None:
    design, evaluator = Design.load(design_file(name)), MeshEvaluator(TOLERANCE)
    number = ["tape", "passage", "lid"].index(left_out)
    remaining = tuple(solid for i, solid in enumerate(seals(design)) if i != number)
    assert flooded_mm3(design, evaluator) == pytest.approx(0.0, abs=1e-3)
    monkeypatch.setattr(verification, "seals", lambda design: remaining)
    assert flooded_mm3(design, evaluator) > 10.0


def test_creep_grows_with_the_gap_and_with_the_time_to_set() -> None:
    plain, wide = (Design.load(design_file("fsr400"), changes=[f"mold.fit_clearance_mm={gap}"]) for gap in (0.05, 0.1))
    assert leak_mm(wide) > 1.5 * leak_mm(plain)
    own = ["silicone.product=own", "silicone.viscosity_pa_s=3", "silicone.pot_life_min=90"]
    thin = Design.load(design_file("fsr400"), changes=own)
    assert leak_mm(thin) > 4 * leak_mm(plain)
    assert {check.name for check in check_seals(thin, MeshEvaluator(TOLERANCE)) if not check.passed} == {
        "mold.leak_length"
    }


def test_creep_at_a_constant_pressure_has_its_closed_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a filling: x = h sqrt(p t / (6 mu)), p the head of 34 mm of silicone."""
    design = Design.load(design_file("fsr400"), changes=["mold.draft_deg=0"])
    prediction = type("Prediction", (), {"cavity_integral": 0.0})
    monkeypatch.setattr(verification, "predict_mold_filling", lambda design: prediction)
    pressure = 1080 * 9.81 * 0.034
    assert leak_mm(design) == pytest.approx(0.05 * math.sqrt(pressure * 300 / (6 * 20)), rel=1e-6)
