"""The mesh that is written: vertices on the grid, each place one vertex."""

from __future__ import annotations

import numpy as np

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import GRID_MM, Evaluator
from fingertip.cad.shapes.mold import mold_palmar
from fingertip.cad.verification.checks import open_edges
from fingertip.design import Design

# Here a boolean leaves an edge of 5e-6 mm that the kernel does not collapse: both its ends round to one grid point. A
# sweep found it.
CLOSE = [
    "skin.width_mm=15",
    "skin.semi_axis_palmar_mm=6.5",
    "skin.thickness_side_mm=1.2",
    "skin.min_thickness_mm=0.4",
]


def test_ends_of_an_edge_on_one_grid_point_are_one_vertex() -> None:
    evaluator, solid = Evaluator(0.02), mold_palmar(Design.load(changes=CLOSE))
    mesh = evaluator.mesh(solid)
    assert len(np.unique(mesh.vertices, axis=0)) == len(mesh.vertices)
    assert (mesh.triangles != np.roll(mesh.triangles, 1, axis=1)).all()
    assert abs(mesh.volume() - evaluator.manifold(solid).volume()) <= 8 * GRID_MM * mesh.area()
    read = stl.from_bytes(stl.to_bytes(mesh, "mold_palmar"))
    assert open_edges(read) == 0
    assert len(read.triangles) == len(mesh.triangles)
