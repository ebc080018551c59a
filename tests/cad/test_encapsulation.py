"""Bone that is encapsulated: what silicone must not reach stays free, and each check finds its
defect.
"""

from __future__ import annotations

import math

import pytest
from scipy.integrate import quad

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification import assembly, encapsulation, mold
from fingertip.cad.verification.check import Check, Solids
from fingertip.design import Design
from fingertip.models import encapsulation as shapes
from fingertip.models.bone import bone
from fingertip.models.making import making_of
from fingertip.models.mold import cavity
from fingertip.models.parts import parts_by_name
from fingertip.models.sensor_pocket import film_column, sensor_body, sensor_recess
from fingertip.models.skin import skin
from fingertip.models.solids import Box
from tests.cad.part_checks import TOLERANCE

EVALUATOR = MeshEvaluator(TOLERANCE)
ARTICLE = Design.load("article")


def encapsulated(name: str) -> Design:
    return Design.load(name, changes=["skin.made=encapsulated"])


FINGERS = [
    "article",
    pytest.param("fsr402", marks=pytest.mark.full),
    pytest.param("first_finger", marks=pytest.mark.full),
]


def volume_mm3(solid: object) -> float:
    return float(EVALUATOR.manifold(solid).volume())


def find_failed(design: Design) -> set[str]:
    solids = Solids.of(design, EVALUATOR, parts_by_name(design))
    checks: list[Check] = [
        *mold.check_mold(design, solids),
        *encapsulation.check_encapsulation(design, solids),
        *assembly.check_assembly(design, solids),
    ]
    return {check.name for check in checks if not check.passed}


@pytest.mark.parametrize("name", FINGERS)
def test_silicone_fills_the_cup_around_bone_film_and_plug_and_nothing_else(name: str) -> None:
    """What the cavity holds beside the bone, the film, its adhesive and the plug is silicone."""
    design = encapsulated(name)
    silicone = EVALUATOR.manifold(making_of(design).silicone(design, skin(design)))
    parts = [bone(design), sensor_body(design), shapes.plug(design)]
    held = [EVALUATOR.manifold(part) for part in parts]
    for part in held:
        assert float((silicone ^ part).volume()) == pytest.approx(0.0, abs=1e-3)

    adhesive = EVALUATOR.manifold(film_column(design).intersect(sensor_recess(design)))
    left = EVALUATOR.manifold(cavity(design)) - silicone
    for part in (*held, adhesive):
        left -= part
    distal = left.trim_by_plane((0.0, 0.0, 1.0), shapes.roof_end_z(design) + 0.01)
    assert float(distal.volume()) == pytest.approx(0.0, abs=1e-3)
    assert find_failed(design) == set()


@pytest.mark.parametrize("name", FINGERS)
def test_channel_knot_and_wires_stay_free(name: str) -> None:
    """The way of the wires, from the legs to the top of the tower, meets no silicone."""
    design = encapsulated(name)
    silicone = EVALUATOR.manifold(making_of(design).silicone(design, skin(design)))
    far = 2 * design.skin.length_mm
    behind = Box((-far, -far, -far), (far, far, 0.0))
    assert volume_mm3(shapes.wires(design)) > 1.0
    assert float((silicone ^ EVALUATOR.manifold(shapes.wires(design))).volume()) == 0.0
    assert float((silicone ^ EVALUATOR.manifold(behind)).volume()) == 0.0, "it ends at the collar"


def test_silicone_that_fills_the_tail_s_end_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plug that ends before the film does leaves the wires in silicone."""
    design = encapsulated("fsr402")
    monkeypatch.setattr(shapes, "LAP_MM", -3.0)
    assert {"overlap.wires.skin", "encapsulation.creep_to_vent"} <= find_failed(design)


@pytest.mark.parametrize(
    ("change", "wanted"),
    [
        ({"bone.groove_depth_mm": 0.4}, {"encapsulation.pull_off"}),
        (
            {"printer.surface_error_mm": 0.3},
            {"encapsulation.bone_play", "mold.palmar_error", "mold.creep"},
        ),
    ],
)
def test_checks_find_their_defects(change: dict[str, float], wanted: set[str]) -> None:
    assert find_failed(ARTICLE.with_values(change)) == wanted


def test_a_wide_gap_around_the_collar_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Silicone creeps to the hole of the wires past a collar with a gap of half a millimetre."""
    monkeypatch.setattr(encapsulation, "post_gap_mm", lambda design: 0.5)
    design = encapsulated("fsr402")
    solids = Solids.of(design, EVALUATOR, parts_by_name(design))
    found = encapsulation.check_encapsulation(design, solids)
    assert "encapsulation.creep_to_hole" in {check.name for check in found if not check.passed}


def test_creep_is_that_of_the_integral_of_the_pressure() -> None:
    """Against adaptive quadrature of the same flow. The speed of lowering that silicone allows
    falls with its viscosity, so how far it creeps does not depend on it.
    """
    layout = ARTICLE.mold_layout
    section = ARTICLE.dimensions.outer.section
    height = section.dorsal + ARTICLE.dimensions.base_palmar_height
    area = math.pi / 4 * 2 * section.half_width * height
    around = math.pi * (section.half_width + height / 2)
    rim = layout.half_width - layout.cavity_half_width - encapsulation.LIP_WIDTH_MM
    width, depth = encapsulation.NOTCH_MM

    def slot(wide: float, high: float) -> float:
        return wide * high**3 / 12 * (1 - 0.63 * high / wide)

    def pressure(x: float) -> float:
        lip = slot(around, x + encapsulation.LIP_GAP_MM) / encapsulation.LIP_WIDTH_MM
        land = slot(around, x + encapsulation.GAP_MM) / rim
        high = min(depth + encapsulation.GAP_MM + x, width)
        notches = 4 * slot(width, high) / (rim + encapsulation.LIP_WIDTH_MM)
        return area / (notches + 1 / (1 / lip + 1 / land))

    exact, _ = quad(pressure, 0.0, 5.0, epsrel=1e-9, limit=200)
    assert encapsulation.closing_integral(ARTICLE) == pytest.approx(exact, rel=2e-3)

    thin, thick = (
        encapsulation.creep_beside_film_mm(
            ARTICLE.with_values({"silicone.product": "own", "silicone.viscosity_pa_s": pa_s})
        )
        for pa_s in (10.0, 40.0)
    )
    assert thick == pytest.approx(thin)
