"""Volumes of parts and cut-outs against figures by hand, and the balance of volumes on B-rep solids."""

from __future__ import annotations

import math

import pytest

from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.cad.verification.assembly import brep_balance_solids, check_brep_assembly
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Solid, cylinder, difference, intersection

SOCKET = "bone.interface=socket bone.base_length_mm=32 bone.socket_depth_mm={}"
FLANGE = "bone.interface=flange bone.base_length_mm=27 bone.foot_radius_mm=1.65 bone.flange_{}"
POST = math.pi * 5.4**2 - 2 * (5.4**2 * math.acos(4.0 / 5.4) - 4.0 * math.sqrt(5.4**2 - 4.0**2))
"""Area of a circle of 10.8 mm with two flats 8 mm apart [mm2]."""


def disc(diameter_mm: float) -> float:
    return math.pi / 4 * diameter_mm**2


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("part", "before", "after", "added_mm3"),
    [
        ("bone", "", "bone.post_length_mm=13.5", -POST),
        ("bone", SOCKET.format(8), SOCKET.format(7), disc(5.0)),
        ("bone", FLANGE.format("hole_diameter_mm=3.2"), FLANGE.format("hole_diameter_mm=2.2"),
         2 * (disc(3.2) - disc(2.2)) * 4.0),
    ],
)  # fmt: skip
def test_one_parameter_adds_its_volume(part: str, before: str, after: str, added_mm3: float) -> None:
    volumes = [
        MeshEvaluator(0.02).manifold(PARTS[part].solid(Design.load("fsr400", changes=changes.split()))).volume()
        for changes in (before, after)
    ]
    assert volumes[1] - volumes[0] == pytest.approx(added_mm3, rel=0.015)


class BrepVolumes:
    """Volumes of solids of one design, each evaluated once."""

    def __init__(self, design: Design) -> None:
        from fingertip.cad.kernel import brep

        self.design, self._brep, self._volume = design, brep.BrepEvaluator(), brep.volume
        self.part = {name: part.solid(design) for name, part in parts_by_name(design).items()}

    def __call__(self, solid: Solid) -> float:
        return self._volume(self._brep.shape(solid))


@pytest.fixture(scope="module")
def volume(design: Design) -> BrepVolumes:
    return BrepVolumes(design)


def failed_balances(volume: BrepVolumes, **changed: Solid) -> set[str]:
    """Return the names of the balances that fail when some parts are replaced by other solids."""
    design = volume.design
    parts = {name: BrepMeasurements(volume(changed.get(name, solid)), 0) for name, solid in volume.part.items()}
    volumes = {name: volume(solid) for name, solid in brep_balance_solids(design, parts)}
    return {check.name for check in check_brep_assembly(design, parts, volumes) if not check.passed}


@pytest.mark.full
def test_volume_balances_hold_on_brep_solids_that_do_not_overlap(volume: BrepVolumes) -> None:
    assert len(list(brep_balance_solids(volume.design, volume.part))) == 5
    assert failed_balances(volume) == set()
    for one, other in (("core", "mold_palmar"), ("core", "mold_dorsal"), ("mold_palmar", "mold_dorsal")):
        assert abs(volume(intersection(volume.part[one], volume.part[other]))) < 1e-3


@pytest.mark.full
def test_dented_skin_breaks_the_cavity_balance(volume: BrepVolumes) -> None:
    dent = cylinder("y", (8.0, 0.0), 6.3, 20.0, 0.4)
    assert failed_balances(volume, skin=difference(volume.part["skin"], dent)) == {"step.volume_balance.cavity"}
    chip = Box((15.0, 9.0, 0.0), (30.0, 30.0, 0.1))
    chipped = difference(volume.part["mold_dorsal"], chip)
    assert failed_balances(volume, mold_dorsal=chipped) == {"step.volume_balance.mold"}


def test_only_solids_needed_for_the_built_parts_are_measured(volume: BrepVolumes) -> None:
    names = [name for name, _ in brep_balance_solids(volume.design, ["bone", "skin"])]
    assert names == ["cavity", "core_in_cavity"]
    assert [name for name, _ in brep_balance_solids(volume.design, ["mold_palmar", "mold_dorsal"])] == ["hollow"]
    assert brep_balance_solids(volume.design, ["bone", "mold_palmar"]) == ()
