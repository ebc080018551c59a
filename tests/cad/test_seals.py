"""Seals of the mold: nothing leaks, each seal that is left out opens a path, and creep in closed form."""

from __future__ import annotations

import math

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.bone import seals
from fingertip.cad.verification import mold as verification
from fingertip.cad.verification.mold import flooded_mm3, leak_mm
from fingertip.design import Design
from fingertip.design.geometry.seat import creep_mm, tape_span_mm
from fingertip.design.new_design import PRESETS
from tests.conftest import design_file

TOLERANCE = 0.02
OTHER_PRODUCTS = ("smooth_sil_940", "dragon_skin_30", "elastosil_m4641")
"""Products that creep less far than Mold Star 30."""


def load(*changes: str) -> Design:
    return Design.load(design_file("fsr400"), changes=list(changes))


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


@pytest.mark.full
@pytest.mark.parametrize(
    ("name", "product"),
    [
        *((name, "mold_star_30") for name in ("fsr400", "fsr402", "fsr400_compact", *PRESETS)),
        *((name, product) for name in ("fsr400", "fsr402") for product in OTHER_PRODUCTS),
    ],
)
def test_tape_stops_products_on_sale_that_would_leak_without_it(name: str, product: str) -> None:
    # The recess of fsr402 is short: for silicones that stay liquid for an hour its tape begins after a shorter collar.
    fit = ["bone.collar_length_mm=1.5"] if name == "fsr402" else []
    design = Design.load(design_file(name), changes=fit).with_silicone(product)
    bare = Design.load(design_file(name), changes=[*fit, "mold.seat_tape_mm=0"]).with_silicone(product)
    limit = 0.5 * design.mold.recess_length_mm
    assert leak_mm(design) <= limit
    assert leak_mm(bare) > leak_mm(design)
    span = tape_span_mm(design)
    assert span is not None
    assert 0.0 < span[0] < limit < span[1] <= design.mold.recess_length_mm
    fold = design.dimensions.fold
    assert fold is None or span[0] < -fold.nose_z, "the tape begins before the window"


def test_creep_along_a_tape_equals_the_integrated_flow() -> None:
    """The front advances at q / h, q from the pressure drops of both gaps in series, in small steps of time."""
    gap, tape, begin = 0.05, 0.03, 1.5
    narrow, x, spent, step = gap - tape, 1e-6, 0.0, 2e-4
    while x < 3.0:
        inside, beyond = min(x, begin), max(0.0, x - begin)
        h = gap if x < begin else narrow
        spent += 12.0 * h * step * (inside / gap**3 + beyond / narrow**3)
        x += step
    assert creep_mm(spent, gap, tape, (begin, 9.0)) == pytest.approx(3.0, rel=1e-3)
    assert creep_mm(spent, gap, 0.0, (begin, 9.0)) == pytest.approx(creep_mm(spent, gap, tape, None), rel=1e-9)


def test_creep_at_a_constant_pressure_has_its_closed_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a filling: x = h sqrt(p t / (6 mu)), p the head of 34 mm of silicone, t the pot life of 20 min."""
    design = Design.load(design_file("fsr400"), changes=["mold.draft_deg=0", "mold.seat_tape_mm=0"])
    prediction = type("Prediction", (), {"cavity_integral": 0.0})
    monkeypatch.setattr(verification, "predict_mold_filling", lambda design: prediction)
    pressure = 1080 * 9.81 * 0.034
    assert leak_mm(design) == pytest.approx(0.05 * math.sqrt(pressure * 1200 / (6 * 20)), rel=1e-6)
