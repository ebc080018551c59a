"""Distances from the exact surface of the skin, and its thickness."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import KDTree

from fingertip.cad.kernel.mesh import MeshEvaluator, to_arrays
from fingertip.cad.kernel.tessellate import tessellate
from fingertip.cad.shapes.finger import skin_interior
from fingertip.cad.verification import deviation as surface_deviation
from fingertip.cad.verification.check import PLANE_OFFSET_MM, above_z
from fingertip.cad.verification.deviation import max_facet_deviation, surface_patches
from fingertip.cad.verification.skin import min_thickness
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody
from fingertip.design.geometry.solids import SuperconicSolid
from fingertip.foundation.numerics import Array


def distance_to_surface(body: ConicBody, points: Array, steps: int = 12) -> Array:
    """Measure the distance [mm] of points from the surface and its flat end, whose rim belongs to the side patches."""
    folded = points.copy()
    folded[:, 0] = np.abs(folded[:, 0])
    z, scale = body.stations[0]
    over = np.array([body.section.half_width_at(y, scale) for y in folded[:, 1]]) >= folded[:, 0] - 1e-12
    best = np.where(over, np.abs(folded[:, 2] - z), np.inf)
    for patch in surface_patches(body):
        best = np.minimum(best, patch.distance(folded, steps))
    return best


@pytest.mark.full
def test_points_offset_from_the_surface_have_that_distance(design: Design) -> None:
    """Offsets along the normal, in and out. Points near the rim and the planes of symmetry are left out.

    Other patches are nearer to those.
    """
    body, random = design.dimensions.outer, np.random.default_rng(1)
    for patch in surface_patches(body):
        t, v = random.uniform(0.0, 1.0, (2, 500))
        position, by_t, by_v = patch.evaluate(t, v)
        normal = np.cross(by_t, by_v)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        inner = (position[:, 2] > body.stations[0][0] + 0.2) & (position[:, 0] > 0.2) & (np.abs(position[:, 1]) > 0.2)
        for offset in (0.001, -0.001, 0.1, -0.1):
            found = distance_to_surface(body, (position + offset * normal)[inner])
            assert np.abs(found - abs(offset)).max() < 1e-9


def test_facets_stay_within_their_tolerance_without_wasting_it() -> None:
    """The deviation is of second order in the chord length, which falls with the root of the tolerance."""
    body, tolerances = Design().dimensions.outer, (0.08, 0.02, 0.005)
    deviations = [max_facet_deviation(body, *tessellate(SuperconicSolid(body), tolerance)) for tolerance in tolerances]
    for tolerance, deviation in zip(tolerances, deviations, strict=True):
        assert tolerance / 5 < deviation <= tolerance
    for coarse, fine in pairwise(deviations):
        assert 2.8 < coarse / fine < 5.6


def test_nearby_distance_equals_the_full_distance_near_the_surface() -> None:
    """Centres of coarse facets have the same distance from the patches beside them as from all patches."""
    body = Design().dimensions.outer
    vertices, triangles = tessellate(SuperconicSolid(body), 0.5)
    centres = vertices[triangles].mean(axis=1)
    centres = centres[centres[:, 2] > 1.5]  # the flat end is left out of the nearby distance
    near = surface_deviation._nearby_distance(surface_patches(body), centres)
    assert 0.1 < near.max() < 0.5
    np.testing.assert_allclose(near, distance_to_surface(body, centres, steps=3), rtol=0, atol=1e-12)


@pytest.mark.full
@pytest.mark.parametrize("changes", [[], ["skin.width_mm=18"]], ids=str)
def test_thickness_equals_the_distance_between_points_of_both_surfaces(changes: list[str]) -> None:
    """Points on facets no longer than h are at most h^2 / (4 d) farther apart than the surfaces, d apart."""
    design, evaluator = Design.load(changes=changes), MeshEvaluator(0.05)
    interior = above_z(evaluator.manifold(skin_interior(design)), PLANE_OFFSET_MM)
    outer = above_z(evaluator.manifold(SuperconicSolid(design.dimensions.outer)), PLANE_OFFSET_MM)
    inside, outside = (to_arrays(body.refine_to_length(0.2))[0] for body in (interior, outer))
    found = min_thickness(design, evaluator)
    apart = KDTree(outside[outside[:, 2] > 2 * PLANE_OFFSET_MM]).query(inside)[0].min()
    assert found <= apart < found + 0.2**2 / (4 * found)
