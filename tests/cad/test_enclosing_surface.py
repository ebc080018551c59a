"""Distance from an enclosing convex surface: against the mesh kernel's own search, and in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator, to_arrays
from fingertip.cad.shapes.insert import skin_interior
from fingertip.cad.verification.check import PLANE_OFFSET_MM, above_z, complement
from fingertip.cad.verification.skin import EnclosingSurface, min_thickness
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, SuperconicSolid


def test_distance_in_a_box_is_that_to_its_nearest_face() -> None:
    surface = EnclosingSurface(*to_arrays(MeshEvaluator(0.02).manifold(Box((0, 0, 0), (10, 20, 30)))))
    assert surface.distance_to(np.array([[5.0, 6.0, 7.0], [5.0, 17.0, 15.0]])) == pytest.approx(3.0)
    assert surface.distance_to(np.array([[5.0, 6.0, 7.0], [5.0, 21.0, 15.0]])) == pytest.approx(-1.0)


@pytest.mark.parametrize("changes", [[], ["mold.method=sleeve"], ["skin.width_mm=18"]], ids=str)
@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.0)])
def test_thickness_equals_the_gap_that_the_mesh_kernel_finds(
    changes: list[str], shift: tuple[float, float, float]
) -> None:
    design, evaluator = Design.load(changes=changes), MeshEvaluator(0.05)
    outer = SuperconicSolid(design.dimensions.outer)
    interior = above_z(evaluator.manifold(skin_interior(design)), PLANE_OFFSET_MM).translate(shift)
    exterior = above_z(complement(evaluator, outer), PLANE_OFFSET_MM)
    vertices, triangles = to_arrays(evaluator.manifold(outer))
    end = (vertices[triangles][:, :, 2] == 0.0).all(axis=1)
    distance = EnclosingSurface(vertices, triangles[~end]).distance_to(to_arrays(interior)[0])
    assert distance == pytest.approx(interior.min_gap(exterior, 5.0), abs=1e-9)
    if not any(shift):
        assert min_thickness(design, evaluator) == distance
