"""Each check of part files and of the assembly fails when the
geometry it verifies is broken; volumes by hand.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.verification.assembly import (
    brep_balance_solids,
    check_assembly,
    check_brep_assembly,
)
from fingertip.cad.verification.check import Solids
from fingertip.cad.verification.printing import (
    check_brep_solid,
    check_mesh_file,
    count_open_edges,
    part_genus,
)
from fingertip.design import Design
from fingertip.models.bone import bone, filled_bone
from fingertip.models.interfaces import shapes_of
from fingertip.models.parts import PARTS, Part, parts_by_name
from fingertip.models.sensor_pocket import sensor_recess
from fingertip.models.solids import (
    Box,
    Solid,
    SuperconicSolid,
    cylinder,
)
from tests.oracles.conic_area import section_area

TOLERANCE = 0.02
FINGER = Design()
HOLE = cylinder("x", (2.0, 5.0), -20.0, 20.0, 0.5)


@pytest.fixture(scope="module")
def evaluator() -> MeshEvaluator:
    return MeshEvaluator(TOLERANCE)


def mesh_failures(part: Part, mesh: Mesh) -> set[str]:
    return {
        check.name.rsplit(".", 1)[1]
        for check in check_mesh_file(Design(), part, mesh, "stl")
        if not check.passed
    }


def assembly_failures(design: Design, evaluator: MeshEvaluator, **changed: Solid) -> set[str]:
    parts = {
        name: changed.get(name, part.solid(design)) for name, part in parts_by_name(design).items()
    }
    return {
        check.name
        for check in check_assembly(design, Solids(design, evaluator, parts))
        if not check.passed
    }


def brep_failures(
    design: Design, part: Part, mesh: Mesh, exact: BrepMeasurements, tolerance_mm: float
) -> set[str]:
    found = check_brep_solid(design, part, mesh, exact, 1.0, tolerance_mm)
    return {check.name.rsplit(".", 1)[1] for check in found if not check.passed}


def test_missing_doubled_or_inverted_triangles_fail(evaluator: MeshEvaluator) -> None:
    whole = evaluator.mesh(bone(FINGER))
    assert count_open_edges(whole) == 0
    assert count_open_edges(replace(whole, triangles=np.delete(whole.triangles, 100, axis=0))) == 3
    assert (
        count_open_edges(
            replace(whole, triangles=np.vstack((whole.triangles, whole.triangles[:1])))
        )
        > 0
    )
    assert "inverted" in mesh_failures(
        PARTS["bone"], replace(whole, triangles=whole.triangles[:, ::-1].copy())
    )


def test_vertex_on_an_edge_leaves_a_degenerate_triangle(evaluator: MeshEvaluator) -> None:
    """Every edge is matched and the volume is unchanged, but many
    programs drop the triangle that closes the mesh.
    """
    whole = evaluator.mesh(PARTS["bone"].solid(FINGER))
    a, b, c = whole.triangles[0]
    midpoint = len(whole.vertices)
    vertices = np.concatenate((whole.vertices, (whole.vertices[a] + whole.vertices[b])[None] / 2))
    fan = np.array([[a, midpoint, c], [midpoint, b, c], [a, b, midpoint]])
    sliver = Mesh(vertices, np.concatenate((whole.triangles[1:], fan)))
    assert count_open_edges(sliver) == 0
    assert mesh_failures(PARTS["bone"], sliver) == {"degenerate_triangles"}


def test_ledge_in_the_cavity_prevents_demolding(evaluator: MeshEvaluator) -> None:
    """A ledge in the cavity above the widest section of the skin, with
    a matching notch in the skin as it is cast.
    """
    ledge = Box((7.4, 2.0, 8.0), (12.0, 2.6, 12.0))
    lower = (
        PARTS["mold_palmar"]
        .solid(FINGER)
        .union(ledge.cut(Box((7.4, 2.0, 0.0), (7.4001, 2.6, 1.0))))
    )
    notched = PARTS["skin"].solid(FINGER).cut(ledge.scaled(1.0 / FINGER.dimensions.shrinkage))
    upper = PARTS["mold_dorsal"].solid(FINGER).cut(ledge)
    found = assembly_failures(FINGER, evaluator, mold_palmar=lower, skin=notched, mold_dorsal=upper)
    assert "demolding_overlap.mold_palmar" in found
    assert not any(name.startswith("overlap") for name in found)
    into_core = PARTS["mold_palmar"].solid(FINGER).union(Box((-1.0, -1.0, -3.0), (1.0, 1.0, -2.0)))
    found = assembly_failures(FINGER, evaluator, mold_palmar=into_core)
    assert {name for name in found if name.startswith("overlap")} == {"overlap.core.mold_palmar"}


@pytest.mark.full
def test_mesh_too_coarse_for_its_stated_tolerance_fails() -> None:
    part = PARTS["skin"]
    coarse = MeshEvaluator(0.5).mesh(PARTS["skin"].solid(FINGER))
    exact = MeshEvaluator(0.0005).mesh(PARTS["skin"].solid(FINGER)).volume()
    assert brep_failures(FINGER, part, coarse, BrepMeasurements(exact, 0), 0.5) == set()
    assert brep_failures(FINGER, part, coarse, BrepMeasurements(exact, 0), 0.001) == {
        "volume_difference_to_mesh"
    }


@pytest.mark.full
def test_brep_solid_with_an_extra_hole_fails(evaluator: MeshEvaluator) -> None:
    """The genus follows from the B-rep solid itself by the
    Euler-Poincare formula, not from its mesh.
    """
    from fingertip.cad.kernel import brep

    pierced = brep.BrepEvaluator().solid(bone(FINGER).cut(HOLE))
    exact = BrepMeasurements(brep.volume(pierced), brep.genus(pierced))
    mesh = evaluator.mesh(bone(FINGER).cut(HOLE))
    assert exact.genus == part_genus(FINGER, "bone") + 1
    assert brep_failures(FINGER, PARTS["bone"], mesh, exact, TOLERANCE) == {"genus"}


def test_mesh_kernel_rejects_an_inverted_primitive(evaluator: MeshEvaluator) -> None:
    from fingertip.foundation.errors import GeometryError

    with pytest.raises(GeometryError, match="inverted mesh"):
        evaluator.manifold(Box((0.0, 0.0, 1.0), (1.0, 1.0, 0.0)))


@pytest.mark.full
def test_kernels_agree_on_volume_and_place_of_every_primitive(design: Design) -> None:
    """The kernels share no geometry code, so an error in either one shows as a difference."""
    from fingertip.cad.kernel import brep, occ

    exact = brep.BrepEvaluator()
    meshes = MeshEvaluator(0.001)
    for solid in sorted(
        {s for part in parts_by_name(design).values() for s in primitives(part.solid(design))},
        key=repr,
    ):
        mesh = meshes.manifold(solid)
        shape = exact.shape(solid)
        assert abs(brep.volume(shape) - mesh.volume()) <= 0.001 * mesh.surface_area(), solid
        low, high = occ.bounds(shape)
        assert (*low, *high) == pytest.approx(mesh.bounding_box(), abs=0.01), solid


@pytest.mark.full
def test_brep_volume_equals_the_closed_form() -> None:
    """On arcs of weight 4 other quadratures of the kernel are off by 0.3 to 11 mm3."""
    from fingertip.cad.kernel import brep
    from fingertip.models.conic import ConicBody, CrossSection

    section = CrossSection(10.55, 5.35, 7.15, 4.0, 0.75)
    shape = brep.BrepEvaluator().shape(
        SuperconicSolid(ConicBody(section, ((-18.4, 1.0), (0.25, 1.0))))
    )
    assert brep.volume(shape) == pytest.approx(section_area(section) * 18.65, abs=1e-6)


def primitives(solid: Solid) -> set[Solid]:
    from fingertip.models.solids import Difference, Intersection, Scaled, Union

    match solid:
        case Scaled(inner):
            return primitives(inner)
        case Union(solids) | Intersection(solids):
            return {p for s in solids for p in primitives(s)}
        case Difference(first, without):
            return {p for s in (first, *without) for p in primitives(s)}
    return {solid}


def test_part_of_another_topology_fails(evaluator: MeshEvaluator) -> None:
    whole = bone(FINGER)
    added, removed = shapes_of(FINGER)
    hollows = (sensor_recess(FINGER), *removed)
    without_channel = filled_bone(FINGER).union(*added).cut(*hollows)
    second_body = whole.union(Box((30.0, 30.0, 30.0), (31.0, 31.0, 31.0)))
    assert "bodies" in mesh_failures(PARTS["bone"], evaluator.mesh(second_body))
    for solid in (whole.cut(HOLE), without_channel):
        assert mesh_failures(PARTS["bone"], evaluator.mesh(solid)) == {"genus"}


@pytest.mark.parametrize(
    ("part", "change", "failed"),
    [
        (
            "skin",
            lambda skin: skin.cut(cylinder("y", (20.0, 0.0), 0.0, 20.0, 1.0)),
            "volume_balance.cavity",
        ),
        (
            "core",
            lambda core: core.union(
                Box((-1.0, 3.0, 15.0), (1.0, FINGER.skin.semi_axis_dorsal_mm - 0.8, 17.0))
            ),
            "overlap.skin.core",
        ),
        (
            "mold_dorsal",
            lambda half: half.cut(Box((15.0, 9.0, 0.0), (30.0, 30.0, 5.0))),
            "volume_balance.mold",
        ),
    ],
)
def test_part_that_does_not_fit_the_others_fails(
    evaluator: MeshEvaluator, part: str, change: Callable[[Solid], Solid], failed: str
) -> None:
    assert assembly_failures(FINGER, evaluator, **{part: change(PARTS[part].solid(FINGER))}) == {
        failed
    }


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
        (
            "bone",
            FLANGE.format("hole_diameter_mm=3.2"),
            FLANGE.format("hole_diameter_mm=2.2"),
            2 * (disc(3.2) - disc(2.2)) * 4.0,
        ),
    ],
)
def test_one_parameter_adds_its_volume(
    part: str, before: str, after: str, added_mm3: float
) -> None:
    volumes = [
        MeshEvaluator(0.02)
        .manifold(PARTS[part].solid(Design.load("fsr400", changes=changes.split())))
        .volume()
        for changes in (before, after)
    ]
    assert volumes[1] - volumes[0] == pytest.approx(added_mm3, rel=0.015)


class BrepVolumes:
    """Volumes of solids of one design, each evaluated once."""

    def __init__(self, design: Design) -> None:
        from fingertip.cad.kernel import brep

        self.design = design
        self._brep = brep.BrepEvaluator()
        self._volume = brep.volume
        self.part = {name: part.solid(design) for name, part in parts_by_name(design).items()}

    def __call__(self, solid: Solid) -> float:
        return self._volume(self._brep.shape(solid))


@pytest.fixture(scope="module")
def volume(design: Design) -> BrepVolumes:
    return BrepVolumes(design)


def failed_balances(volume: BrepVolumes, **changed: Solid) -> set[str]:
    """Return the names of the balances that fail when some parts are replaced by other solids."""
    design = volume.design
    parts = {
        name: BrepMeasurements(volume(changed.get(name, solid)), 0)
        for name, solid in volume.part.items()
    }
    volumes = {name: volume(solid) for name, solid in brep_balance_solids(design, parts)}
    return {check.name for check in check_brep_assembly(design, parts, volumes) if not check.passed}


@pytest.mark.full
def test_volume_balances_hold_on_brep_solids_that_do_not_overlap(volume: BrepVolumes) -> None:
    assert len(list(brep_balance_solids(volume.design, volume.part))) == 3
    assert failed_balances(volume) == set()
    for one, other in (
        ("core", "mold_palmar"),
        ("core", "mold_dorsal"),
        ("mold_palmar", "mold_dorsal"),
    ):
        assert abs(volume(volume.part[one].intersect(volume.part[other]))) < 1e-3


@pytest.mark.full
def test_dented_skin_breaks_the_cavity_balance(volume: BrepVolumes) -> None:
    dent = cylinder("y", (8.0, 0.0), 6.3, 20.0, 0.4)
    assert failed_balances(volume, skin=volume.part["skin"].cut(dent)) == {
        "step.volume_balance.cavity"
    }
    chip = Box((10.0, 9.0, 0.0), (30.0, 30.0, 5.0))
    chipped = volume.part["mold_dorsal"].cut(chip)
    assert failed_balances(volume, mold_dorsal=chipped) == {"step.volume_balance.mold"}


def test_only_solids_needed_for_the_built_parts_are_measured(design: Design) -> None:
    names = [name for name, _ in brep_balance_solids(design, ["bone", "skin"])]
    assert names == ["cavity", "core_in_cavity"]
    assert [name for name, _ in brep_balance_solids(design, ["mold_palmar", "mold_dorsal"])] == [
        "hollow"
    ]
    assert brep_balance_solids(design, ["bone", "mold_palmar"]) == ()
