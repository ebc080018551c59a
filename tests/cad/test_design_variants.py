"""Every option of a design is built with both kernels and checked."""

from __future__ import annotations

from pathlib import Path

import pytest

from fingertip.design import Design
from fingertip.tasks.build import build
from tests.conftest import some_of

UNLIMITED = ["strength.min_grip_factor=0", "strength.min_shock_factor=0"]
VARIANTS = {
    "sleeve": ["mold.method=sleeve", "mold.silicone_shrinkage_percent=1.2"],
    "socket": ["bone.interface=socket", "bone.base_length_mm=31"],
    "round post": ["bone.post_width_mm=7", "bone.post_height_mm=7", *UNLIMITED],
    "flange": ["bone.interface=flange", "bone.base_length_mm=26"],
    "flange with four bolts": [
        "bone.interface=flange", "bone.base_length_mm=26", "bone.flange_spacing_y_mm=12", "bone.flange_height_mm=18",
    ],
    "short tail": ["sensor.model=fsr400_short", "bone.base_length_mm=15"],
    "plain": ["bone.groove_depth_mm=0", "mold.engraving_depth_mm=0", "mold.silicone_shrinkage_percent=0"],
    "custom sensor": ["sensor.model=custom", "custom_sensor.head_diameter_mm=6", "custom_sensor.length_mm=30"],
    "no draft": ["mold.draft_deg=0"],
    "compensated": ["printer.scale_percent=100.4"],
    "long name": ["name=A_very-long_name_with-forty_characters_1"],
}  # fmt: skip


@pytest.mark.full
@pytest.mark.parametrize("name", some_of(VARIANTS, "sleeve", "flange with four bolts", "short tail", "custom sensor"))
def test_variant_builds_and_passes_all_checks(name: str, tmp_path: Path) -> None:
    result = build(Design.load(changes=VARIANTS[name]), tmp_path, formats=["stl", "step"], tolerance_mm=0.02)
    assert [check for check in result.checks if not check.passed] == []
    assert any(check.name.endswith("step.genus") for check in result.checks)


def test_only_a_sleeve_has_a_core(tmp_path: Path) -> None:
    from fingertip.foundation.errors import DesignError

    with pytest.raises(DesignError, match=r"this design has no 'core'.*mold\.method=sleeve"):
        build(Design(), tmp_path, parts=["core"], formats=["stl"])
    build(Design.load(changes=["mold.method=sleeve"]), tmp_path, parts=["core"], formats=["stl"])
    assert (tmp_path / "core.stl").exists()


@pytest.mark.full
def test_printer_compensation_scales_printed_parts_only(tmp_path: Path) -> None:
    nominal = build(Design(), tmp_path / "a", formats=["stl"])
    scaled = build(Design.load(changes=["printer.scale_percent=101"]), tmp_path / "b", formats=["stl"])
    for before, after in zip(nominal.parts, scaled.parts, strict=True):
        growth = 1.01**3 if before.part.is_printed else 1.0
        assert after.mesh.volume() == pytest.approx(growth * before.mesh.volume(), rel=1e-3)


@pytest.mark.full
def test_shrinkage_enlarges_the_cavity_but_not_the_skin(tmp_path: Path) -> None:
    """At 1 % linear shrinkage the cavity has 1 / 0.99^3 times the volume of the design; the skin keeps its size."""
    from fingertip.cad.kernel.mesh import MeshEvaluator
    from fingertip.cad.shapes.insert import cavity_outline
    from fingertip.design.geometry.solids import SuperconicSolid

    plain = Design.load(changes=["mold.silicone_shrinkage_percent=0"])
    shrinking = Design.load(changes=["mold.silicone_shrinkage_percent=1"])
    evaluator = MeshEvaluator(0.02)
    outer = evaluator.manifold(SuperconicSolid(plain.dimensions.outer)).volume()
    assert evaluator.manifold(cavity_outline(shrinking)).volume() == pytest.approx(outer / 0.99**3, rel=1e-9)
    a = build(plain, tmp_path / "a", parts=["skin"], formats=["stl"]).parts[0]
    b = build(shrinking, tmp_path / "b", parts=["skin"], formats=["stl"]).parts[0]
    assert a.mesh.volume() == b.mesh.volume()
