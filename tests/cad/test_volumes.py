"""Volumes of parts and cut-outs against figures by hand, and the balance of volumes on B-rep solids."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.mold import luer_cone, sprue
from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.cad.verification.assembly import brep_balance_solids, check_brep_assembly
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Solid, cylinder, difference, intersection

PLAIN = (
    "mold.engraving_depth_mm=0", "mold.chaplet_diameter_mm=0", "mold.fit_clearance_mm=0.01",
    "printer.surface_error_mm=0",
)  # fmt: skip
SOCKET = "bone.interface=socket bone.base_length_mm=32 bone.socket_depth_mm={}"
FLANGE = "bone.interface=flange bone.base_length_mm=27 bone.flange_{}"
POST = math.pi * 4.2**2 - 2 * (4.2**2 * math.acos(3.6 / 4.2) - 3.6 * math.sqrt(4.2**2 - 3.6**2))
"""Area of a circle of 8.4 mm with two flats 7.2 mm apart [mm2]."""
HEXAGON = math.sqrt(0.75) * 5.8**2
"""Area of a hexagon of 5.8 mm across flats [mm2]."""


def disc(diameter_mm: float) -> float:
    return math.pi / 4 * diameter_mm**2


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("part", "before", "after", "added_mm3"),
    [
        # Two pry slots, 8 mm wide, 2.5 mm deep, and 1.2 mm high in each half.
        ("mold_palmar", "", "mold.pry_height_mm=0.6", 2 * 8 * 2.5 * 0.6),
        ("mold_dorsal", "", "mold.pry_height_mm=0.6", 2 * 8 * 2.5 * 0.6),
        ("mold_dorsal", "", "mold.pry_depth_mm=1.5", 2 * 8 * 1.0 * 1.2),
        ("mold_palmar", "", "mold.pry_width_mm=6", 2 * 2 * 2.5 * 1.2),
        # Four nut traps around bolt holes of 3.4 mm, and the holes through a dorsal half of 7 / 0.998 + 4 mm.
        ("mold_palmar", "", "mold.nut_depth_mm=3.6", -4 * (HEXAGON - disc(3.4))),
        # And 0.1 mm more of the runner of 3 x 2.5 mm, whose gate keeps its land from the bolt.
        ("mold_dorsal", "", "mold.bolt_diameter_mm=3.2", 4 * (disc(3.4) - disc(3.2)) * 11.014 - 0.1 * 3 * 2.5),
        ("bone", "", "bone.post_length_mm=7", -POST),
        ("bone", SOCKET.format(8), SOCKET.format(7), disc(5.0)),
        ("bone", FLANGE.format("hole_diameter_mm=3.2"), FLANGE.format("hole_diameter_mm=2.2"),
         2 * (disc(3.2) - disc(2.2)) * 4.0),
    ],
)  # fmt: skip
def test_one_parameter_adds_its_volume(part: str, before: str, after: str, added_mm3: float) -> None:
    volumes = [
        MeshEvaluator(0.02).manifold(PARTS[part].solid(Design.load(changes=[*PLAIN, *changes.split()]))).volume()
        for changes in (before, after)
    ]
    assert volumes[1] - volumes[0] == pytest.approx(added_mm3, rel=0.015)


def test_cone_of_the_syringe_is_a_luer_cone() -> None:
    """A mouth of 4.3 mm and a taper of 6 %, as ISO 80369-7 has it: 3.85 mm at the end, 7.5 mm deep.

    The sprue below it has a draft of 3 % on either side.
    """
    design = Design()
    cone = MeshEvaluator(0.002).manifold(luer_cone(design)).rotate((90.0, 0.0, 0.0))  # y becomes the height
    face = design.mold_layout.dorsal_height
    diameters = [2 * math.sqrt(cone.slice(face - depth).area() / math.pi) for depth in (0.0, 5.0, 7.499)]
    assert diameters == pytest.approx([4.3, 4.0, 3.85], abs=0.005)
    assert cone.slice(face - 7.501).is_empty()
    below = MeshEvaluator(0.002).manifold(sprue(design, design.mold_layout.inlet)).rotate((90.0, 0.0, 0.0))
    diameters = [2 * math.sqrt(below.slice(height).area() / math.pi) for height in (1e-3, face - 7.5)]
    assert diameters == pytest.approx([3.85 + 2 * 0.03 * (face - 7.5), 3.85], abs=0.005)


def test_pocket_pilot_hole_and_nut_traps_are_as_deep_as_what_they_hold() -> None:
    """Bone and mold are probed beside the edge of each hollow and inside it."""
    design, evaluator = Design(), MeshEvaluator(0.02)
    bone, palmar = (evaluator.manifold(PARTS[name].solid(design)) for name in ("bone", "mold_palmar"))

    def probe(x: float, z: float) -> tuple[float, float]:
        box = (bone ^ evaluator.manifold(Box((x - 0.01, -50, z - 0.01), (x + 0.01, 50, z + 0.01)))).bounding_box()
        return box[1], box[4]

    # Head of an FSR 400, 7.62 mm wide with 0.15 mm of play all around, and 0.3 mm thick on a film of 0.13 mm.
    (floor, _), (flat, _) = (probe(radius, design.dimensions.sensor_z) for radius in (3.94, 3.98))
    assert floor - flat == pytest.approx(0.43, abs=1e-3)
    # A screw of M2 in a pilot hole of 1.6 mm, 4.7 mm below the facet.
    (_, end), (_, facet) = (probe(offset, 34.0 - 10.3) for offset in (0.78, 0.82))
    assert facet - end == pytest.approx(4.7, abs=1e-3)
    lying = palmar.rotate((90.0, 0.0, 0.0))  # its outer face becomes the lowest
    trap, ceiling = (lying.slice(lying.bounding_box()[2] + depth).area() for depth in (2.58, 2.62))
    assert ceiling - trap > 0.4 * 4 * (HEXAGON - disc(3.4)), "nuts lie 2.6 mm deep, below a stepped ceiling"
    # 3 mm are left between the corners of a trap and the side of the mold, and from its corners' circle to the end.
    outside, *traps = (np.asarray(ring) for ring in lying.slice(lying.bounding_box()[2] + 2.0).to_polygons())
    assert len(traps) == 4
    assert outside[:, 0].max() - max(trap[:, 0].max() for trap in traps) == pytest.approx(3.0, abs=1e-3)
    centre = min((trap[:, 1].min() + trap[:, 1].max()) / 2 for trap in traps)
    assert centre - outside[:, 1].min() == pytest.approx(3.0 + 5.8 / math.sqrt(3), abs=1e-3)


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
    for one, other in (("bone", "mold_palmar"), ("bone", "mold_dorsal"), ("skin", "bone")):
        assert abs(volume(intersection(volume.part[one], volume.part[other]))) < 1e-3


@pytest.mark.full
def test_dented_skin_breaks_the_cavity_balance(volume: BrepVolumes) -> None:
    dent = cylinder("y", (8.0, 0.0), 6.3, 20.0, 0.4)
    assert failed_balances(volume, skin=difference(volume.part["skin"], dent)) == {"step.volume_balance.cavity"}
    chip = Box((15.0, 9.0, 0.0), (30.0, 30.0, 0.1))
    chipped = difference(volume.part["mold_dorsal"], chip)
    assert failed_balances(volume, mold_dorsal=chipped) == {"step.volume_balance.mold"}


def test_only_solids_needed_for_the_built_parts_are_measured(volume: BrepVolumes) -> None:
    assert [name for name, _ in brep_balance_solids(volume.design, ["bone", "skin"])] == [
        "cavity", "core_in_cavity", "boss_in_skin", "boss_in_cavity",
    ]  # fmt: skip
    assert [name for name, _ in brep_balance_solids(volume.design, ["mold_palmar", "mold_dorsal"])] == ["hollow"]
    assert brep_balance_solids(volume.design, ["bone", "mold_palmar"]) == ()
