"""Hardware in the assembly: it fits the parts, and overlaps none but for a thread."""

from __future__ import annotations

from itertools import combinations

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.insert import cavity
from fingertip.cad.shapes.parts import hardware, parts_by_name
from fingertip.casting.hardware import bill_of_materials
from fingertip.design import Design
from fingertip.design.geometry.solids import Solid
from tests.conftest import ROOT, design_file

FILES = sorted(path.stem for path in (ROOT / "params").glob("*.toml"))
TOLERANCE_MM = 0.005
"""Tolerance of the meshes [mm]: facets of two round walls at the same radius may overlap by it."""


def overlap_mm3(one: Solid, other: Solid, evaluator: MeshEvaluator | None = None) -> float:
    kernel = evaluator or MeshEvaluator(TOLERANCE_MM)
    return float((kernel.manifold(one) ^ kernel.manifold(other)).volume())


@pytest.mark.full
@pytest.mark.parametrize("name", FILES)
def test_hardware_overlaps_nothing_but_its_thread(name: str) -> None:
    design = Design.load(design_file(name))
    parts = parts_by_name(design)
    solids = {part: entry.solid(design) for part, entry in parts.items()}
    bought, evaluator = hardware(design, parts), MeshEvaluator(TOLERANCE_MM)
    for item in bought:
        for part, solid in solids.items():
            if design.is_cast_apart and part in ("core", "skin"):
                continue  # the core stands in the place of the bone, over which the narrower skin is stretched
            shared = overlap_mm3(item.solid, solid, evaluator)
            if part in item.thread_in:
                assert shared > 1.0, (item.name, part)
            else:
                assert shared < 0.02, (item.name, part)
        if item.name.startswith("mold_"):
            assert overlap_mm3(item.solid, cavity(design), evaluator) == 0.0
    for one, other in combinations(bought, 2):
        assert overlap_mm3(one.solid, other.solid, evaluator) < 0.02, (one.name, other.name)


@pytest.mark.every_case
@pytest.mark.parametrize("name", sorted({*FILES} - {"first_finger"}))  # whose list to buy is counted with its sheet
def test_hardware_agrees_with_the_bill_of_materials(name: str) -> None:
    design = Design.load(design_file(name))
    bill = {entry["item"].partition(" (")[0]: entry["count"] for entry in bill_of_materials(design)}
    found = [item.name.rstrip("_0123456789") for item in hardware(design, parts_by_name(design))]
    assert found.count("mold_bolt") == bill["mold bolt"]
    assert found.count("mold_nut") == bill["mold nut"]
    assert found.count("chaplet_screw") == ("chaplet screw" in bill)
    assert found.count("joint_pin") == ("joint pin" in bill)
    assert found.count("sensor") == 1


def test_parts_that_are_not_built_bring_no_hardware() -> None:
    design = Design.load(design_file("adult_finger"))
    assert [item.name for item in hardware(design, ("bone",))] == ["sensor", "joint_pin"]
    assert [item.name for item in hardware(design, ("mold_palmar",))] == []
