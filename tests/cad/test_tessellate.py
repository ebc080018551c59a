"""Tessellation of primitives within the tolerance, and canonical meshes of the mesh kernel."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import GRID_MM, Mesh, MeshEvaluator, _find_flaps, find_degenerate_triangles
from fingertip.cad.kernel.tessellate import arc_segments, tessellate
from fingertip.cad.shapes.mold import mold_palmar
from fingertip.cad.verification.printing import count_open_edges
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, CrossSection, Tip, add_draft, arc_point
from fingertip.design.geometry.solids import (
    Box,
    Cone,
    DraftedExtrusion,
    ElbowTube,
    Primitive,
    SuperconicSolid,
    cylinder,
    difference,
    hexagon,
)
from tests.conftest import design_file

SECTION = CrossSection(8.5, 6.0, 7.0, 0.8, 0.75)
PRISM = SuperconicSolid(ConicBody(SECTION, ((-3.0, 1.0), (24.0, 0.94))))
# A round tip on a straight elliptic body: half an ellipsoid on an elliptic cylinder, whose volume is known in closed
# form.
ELLIPSOID = SuperconicSolid(
    ConicBody(CrossSection(4.0, 3.0, 3.0, 0.5**0.5, 0.5**0.5), ((0.0, 1.0), (5.0, 1.0)), Tip(11.0, 0.5**0.5))
)
ELBOW = ElbowTube(start_y=-1.0, start_z=5.0, exit_z=-4.0, end_y=6.0, bend_radius=3.0, radius=1.2)

DRAFTED = add_draft(SECTION, 0.05, flat=2.0)


def drafted_area() -> float:
    """Compute the area [mm2] of the drafted section: straight walls, and arcs divided into 20 000 chords."""
    area = 0.0
    for height, weight, start in (
        (SECTION.dorsal, SECTION.dorsal_weight, DRAFTED.dorsal_start),
        (SECTION.palmar, SECTION.palmar_weight, DRAFTED.palmar_start),
    ):
        arc = [arc_point(start + (1.0 - start) * i / 20_000, weight) for i in range(20_001)]
        outline = [(DRAFTED.half_width / SECTION.half_width, 0.0), *arc]
        strips = ((a[0] + b[0]) * (b[1] - a[1]) for a, b in itertools.pairwise(outline))
        area += SECTION.half_width * height * sum(strips)
    return area


EXACT: list[tuple[Primitive, float]] = [
    (Box((-1.0, 0.0, 2.0), (3.0, 5.0, 4.0)), 40.0),
    (cylinder("x", (1.0, 2.0), -3.0, 4.0, 1.5), math.pi * 1.5**2 * 7),
    (Cone("y", (1.0, 2.0), 0.0, 3.0, 1.0, 2.0), math.pi * 3 * (1 + 2 + 4) / 3),
    (hexagon(2.0, 3.0, 5.5, -1.0, 1.0), 2 * math.sqrt(3) / 2 * 5.5**2),
    (ELBOW, math.pi * 1.2**2 * (6.0 + math.pi / 2 * 3.0 + 4.0)),
    (DraftedExtrusion(DRAFTED, -2.0, 5.0), 7.0 * drafted_area()),
    (PRISM, SECTION.area() * 27 * (1 + 0.94 + 0.94**2) / 3),
    (ELLIPSOID, math.pi * 12 * 5 + math.pi * 12 * 6 * 2 / 3),
]


def mesh(solid: Primitive, tolerance_mm: float) -> Mesh:
    return Mesh(*tessellate(solid, tolerance_mm))


@pytest.mark.parametrize(("solid", "volume"), EXACT)
def test_mesh_is_closed_and_has_the_exact_volume(solid: Primitive, volume: float) -> None:
    m = mesh(solid, 0.001)
    assert count_open_edges(m) == 0
    assert abs(m.volume() - volume) <= 0.001 * m.area()
    assert m.volume() > 0


@pytest.mark.parametrize(("solid", "volume"), EXACT[1:3] + EXACT[4:])
def test_volume_error_is_proportional_to_the_tolerance(solid: Primitive, volume: float) -> None:
    """Chords shrink with the root of the tolerance, and the error is of second order in the chord length."""
    errors = [abs(mesh(solid, tolerance).volume() - volume) for tolerance in (0.04, 0.01, 0.0025)]
    for coarse, fine in itertools.pairwise(errors):
        assert 3.0 < coarse / fine < 5.4


@pytest.mark.every_case
@pytest.mark.parametrize("weight", [0.5, 0.7071, 1.3, 4.0])
@pytest.mark.parametrize("tolerance", [0.1, 0.01, 0.001])
def test_no_chord_deviates_by_more_than_the_tolerance(weight: float, tolerance: float) -> None:
    a, b = 8.5, 6.0
    n = arc_segments(a, b, weight, tolerance)
    ends = [np.array(arc_point(i / n, weight)) * (a, b) for i in range(n + 1)]
    worst = 0.0
    for i in range(n):
        chord = ends[i + 1] - ends[i]
        for f in np.linspace(0.02, 0.98, 49):
            off = np.array(arc_point((i + f) / n, weight)) * (a, b) - ends[i]
            worst = max(worst, abs(off[0] * chord[1] - off[1] * chord[0]) / np.hypot(*chord))
    assert worst <= tolerance * 1.02
    assert n == 2 or worst >= tolerance / 4, "finer than necessary"


# In this design, found by a sweep, a boolean leaves an edge of 5e-6 mm that manifold3d does not collapse. Both its ends
# round to the same grid point.
SHORT_EDGE = [
    "skin.width_mm=15", "skin.semi_axis_palmar_mm=6.5", "skin.thickness_side_mm=1.2", "skin.min_thickness_mm=0.4",
    "printer.surface_error_mm=0", "skin.crown_radius_mm=0", "bone.platform_mm=0", "skin.pulp_fullness=0.8845",
    "bone.palmar_fullness=0.9422", "skin.thickness_tip_mm=2.5", "mold.chaplet_from_tip_mm=10",
]  # fmt: skip


def test_vertices_on_the_same_grid_point_are_merged() -> None:
    evaluator, solid = MeshEvaluator(0.02), mold_palmar(Design.load(changes=SHORT_EDGE))
    mesh = evaluator.mesh(solid)
    assert len(np.unique(mesh.vertices, axis=0)) == len(mesh.vertices)
    assert (mesh.triangles != np.roll(mesh.triangles, 1, axis=1)).all()
    assert abs(mesh.volume() - evaluator.manifold(solid).volume()) <= 8 * GRID_MM * mesh.area()
    read = stl.from_bytes(stl.to_bytes(mesh, "mold_palmar"))
    assert count_open_edges(read) == 0
    assert len(read.triangles) == len(mesh.triangles)


def test_sheet_without_volume_is_removed() -> None:
    """A tetrahedron with a flap: two triangles on the same vertices, one the reverse of the other."""
    corners = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    assert not _find_flaps(np.array(corners)).any()
    flapped = np.array([*corners, (0, 1, 4), (0, 4, 1)])
    assert _find_flaps(flapped).tolist() == [False] * 4 + [True] * 2


def test_triangle_without_area_is_removed_with_its_short_edge() -> None:
    """A design on which manifold3d leaves an edge of 15 nm that it does not collapse."""
    changes = [
        "bone.interface=post", "skin.tip_fullness=0.920", "skin.pulp_fullness=0.980", "skin.semi_axis_palmar_mm=6.700",
        "bone.base_length_mm=11.30", "skin.crown_radius_mm=0", "bone.platform_mm=0",
        "sensor.distance_from_tip_mm=9.5", "bone.palmar_fullness=0.96", "skin.thickness_side_mm=2.0",
        "skin.thickness_palmar_mm=3.45", "skin.thickness_tip_mm=2.5", "mold.chaplet_from_tip_mm=8.0",
        "hand.tendon_distance_mm=4.7",
    ]  # fmt: skip
    design = Design.load(design_file("youth_thumb"), changes=changes)
    mesh = MeshEvaluator(0.02).mesh(mold_palmar(design))
    assert not len(find_degenerate_triangles(mesh.vertices, mesh.triangles))
    assert count_open_edges(mesh) == 0


@pytest.mark.parametrize("tolerance_mm", [0.1, 0.05, 0.03, 0.02])
def test_a_wall_between_two_cylinders_is_even(tolerance_mm: float) -> None:
    """The rim of a platform keeps its width: the facets of its pocket follow those around it."""
    pocket, platform = (cylinder("y", (0.0, 0.0), -size, size, size) for size in (9.29, 9.74))
    pocket, evaluator = replace(pocket, around_radius=9.74), MeshEvaluator(tolerance_mm)
    outside = evaluator.manifold(difference(Box((-20.0, -5.0, -20.0), (20.0, 5.0, 20.0)), platform))
    assert evaluator.manifold(pocket).min_gap(outside, 1.0) > 0.98 * 0.45
