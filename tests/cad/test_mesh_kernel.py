"""Meshes on the vertex grid: no two vertices share a position."""

from __future__ import annotations

import numpy as np

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import GRID_MM, MeshEvaluator, _find_flaps, find_degenerate_triangles
from fingertip.cad.shapes.mold import mold_palmar
from fingertip.cad.verification.printing import count_open_edges
from fingertip.design import Design
from tests.conftest import design_file

# In this design, found by a sweep, a boolean leaves an edge of 5e-6 mm that manifold3d does not collapse. Both its ends
# round to the same grid point.
SHORT_EDGE = [
    "skin.width_mm=15",
    "skin.semi_axis_palmar_mm=6.5",
    "skin.thickness_side_mm=1.2",
    "skin.min_thickness_mm=0.4",
    "printer.surface_error_mm=0",
]


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
        "bone.base_length_mm=11.30",
    ]  # fmt: skip
    design = Design.load(design_file("youth_thumb"), changes=changes)
    mesh = MeshEvaluator(0.02).mesh(mold_palmar(design))
    assert not len(find_degenerate_triangles(mesh.vertices, mesh.triangles))
    assert count_open_edges(mesh) == 0
