"""The ruler for meshes: distances from the exact surface, and facets held against the tolerance they were made for."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import Evaluator
from fingertip.cad.kernel.tessellate import tessellate
from fingertip.cad.solids import Form
from fingertip.cad.verification import deviation
from fingertip.cad.verification.deviation import distance, of_facets, patches
from fingertip.design import Design


def test_points_put_off_the_surface_measure_so(design: Design) -> None:
    """Along the normal, in and outwards; places near the rim and the planes of symmetry have nearer patches."""
    body, random = design.dimensions.outer, np.random.default_rng(1)
    for patch in patches(body):
        t, v = random.uniform(0.0, 1.0, (2, 500))
        here, by_t, by_v = patch.at(t, v)
        normal = np.cross(by_t, by_v)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        inner = (here[:, 2] > body.stations[0][0] + 0.2) & (here[:, 0] > 0.2) & (np.abs(here[:, 1]) > 0.2)
        for offset in (0.001, -0.001, 0.1, -0.1):
            found = distance(body, (here + offset * normal)[inner])
            assert np.abs(found - abs(offset)).max() < 1e-9


@pytest.mark.parametrize("tolerance", [0.1, 0.02, 0.005])
def test_facets_stay_within_their_tolerance_and_use_it(design: Design, tolerance: float) -> None:
    body = design.dimensions.outer
    deviation = of_facets(body, *tessellate(Form(body), tolerance))
    assert tolerance / 5 < deviation <= tolerance


def test_deviation_falls_in_proportion_to_the_tolerance() -> None:
    """Order two in the chord's length: four times the facets along both directions, a sixteenth of the deviation."""
    body = Design().dimensions.outer
    deviations = [of_facets(body, *tessellate(Form(body), tolerance)) for tolerance in (0.08, 0.02, 0.005)]
    for coarse, fine in pairwise(deviations):
        assert 2.8 < coarse / fine < 5.6


def test_a_dent_is_seen() -> None:
    body = Design().dimensions.outer
    vertices, triangles = tessellate(Form(body), 0.02)
    coarse, faces = tessellate(Form(body), 0.5)
    assert of_facets(body, vertices, triangles) < 0.02 < of_facets(body, coarse, faces)


def test_only_facets_on_the_form_count() -> None:
    """The skin's inside and its cut end are no part of its outer form."""
    from fingertip.cad.shapes.skin import skin

    design = Design()
    mesh = Evaluator(0.02).mesh(skin(design))
    assert 0.002 < of_facets(design.dimensions.outer, mesh.vertices, mesh.triangles) <= 0.02


def test_near_the_surface_the_patches_over_a_point_are_enough() -> None:
    """Middles of coarse facets: held against the patches beside them, or against all, they are as far away."""
    body = Design().dimensions.outer
    vertices, triangles = tessellate(Form(body), 0.5)
    middles = vertices[triangles].mean(axis=1)
    middles = middles[middles[:, 2] > 1.5]  # the flat end is no part of what is near
    near, whole = deviation._near(body, middles), deviation.distance(body, middles, steps=3)
    assert 0.1 < near.max() < 0.5
    np.testing.assert_allclose(near, whole, rtol=0, atol=1e-12)
