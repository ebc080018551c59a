"""Tessellation within the tolerance, and distances from the exact surface of the skin."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, _find_flaps
from fingertip.cad.kernel.tessellate import arc_segments, tessellate
from fingertip.cad.verification.deviation import (
    _nearby_distance,
    max_facet_deviation,
    surface_patches,
)
from fingertip.cad.verification.printing import count_open_edges
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.models.conic import ConicBody, CrossSection
from fingertip.models.profile import Tip, arc_point
from fingertip.models.solids import (
    Box,
    Cone,
    ElbowTube,
    Solid,
    SuperconicSolid,
    cylinder,
)
from tests.oracles.conic_area import section_area

SECTION = CrossSection(8.5, 6.0, 7.0, 0.8, 0.75)
PRISM = SuperconicSolid(ConicBody(SECTION, ((-3.0, 1.0), (24.0, 0.94))))
# A round tip on a straight elliptic body: half an ellipsoid on an elliptic cylinder, whose volume
# is known in closed form.
ELLIPSOID = SuperconicSolid(
    ConicBody(
        CrossSection(4.0, 3.0, 3.0, 0.5**0.5, 0.5**0.5),
        ((0.0, 1.0), (5.0, 1.0)),
        Tip(11.0, 0.5**0.5),
    )
)
ELBOW = ElbowTube(start_y=-1.0, start_z=5.0, exit_z=-4.0, end_y=6.0, bend_radius=3.0, radius=1.2)

EXACT: list[tuple[Solid, float]] = [
    (Box((-1.0, 0.0, 2.0), (3.0, 5.0, 4.0)), 40.0),
    (cylinder("x", (1.0, 2.0), -3.0, 4.0, 1.5), math.pi * 1.5**2 * 7),
    (Cone("y", (1.0, 2.0), 0.0, 3.0, 1.0, 2.0), math.pi * 3 * (1 + 2 + 4) / 3),
    (ELBOW, math.pi * 1.2**2 * (6.0 + math.pi / 2 * 3.0 + 4.0)),
    (PRISM, section_area(SECTION) * 27 * (1 + 0.94 + 0.94**2) / 3),
    (ELLIPSOID, math.pi * 12 * 5 + math.pi * 12 * 6 * 2 / 3),
]


def mesh(solid: Solid, tolerance_mm: float) -> Mesh:
    return Mesh(*tessellate(solid, tolerance_mm))


@pytest.mark.parametrize(("solid", "volume"), EXACT)
def test_mesh_is_closed_and_has_the_exact_volume(solid: Solid, volume: float) -> None:
    m = mesh(solid, 0.001)
    assert count_open_edges(m) == 0
    assert abs(m.volume() - volume) <= 0.001 * m.area()
    assert m.volume() > 0


@pytest.mark.parametrize(("solid", "volume"), EXACT[1:3] + EXACT[4:])
def test_volume_error_is_proportional_to_the_tolerance(solid: Solid, volume: float) -> None:
    """Chords shrink with the root of the tolerance, and the error
    is of second order in the chord length.
    """
    errors = [abs(mesh(solid, tolerance).volume() - volume) for tolerance in (0.04, 0.01, 0.0025)]
    for coarse, fine in itertools.pairwise(errors):
        assert 3.0 < coarse / fine < 5.4


@pytest.mark.every_case
@pytest.mark.parametrize("weight", [0.5, 0.7071, 1.3, 4.0])
@pytest.mark.parametrize("tolerance", [0.1, 0.01, 0.001])
def test_no_chord_deviates_by_more_than_the_tolerance(weight: float, tolerance: float) -> None:
    a = 8.5
    b = 6.0
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


def test_sheet_without_volume_is_removed() -> None:
    """A tetrahedron with a flap: two triangles on the same vertices, one the reverse of
    the other.
    """
    corners = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    assert not _find_flaps(np.array(corners)).any()
    flapped = np.array([*corners, (0, 1, 4), (0, 4, 1)])
    assert _find_flaps(flapped).tolist() == [False] * 4 + [True] * 2


@pytest.mark.parametrize("tolerance_mm", [0.1, 0.05, 0.03, 0.02])
def test_a_wall_between_two_cylinders_is_even(tolerance_mm: float) -> None:
    """The rim of a platform keeps its width: the facets of its pocket follow those around it."""
    pocket, platform = (cylinder("y", (0.0, 0.0), -size, size, size) for size in (9.29, 9.74))
    pocket = replace(pocket, around_radius=9.74)
    evaluator = MeshEvaluator(tolerance_mm)
    outside = evaluator.manifold(Box((-20.0, -5.0, -20.0), (20.0, 5.0, 20.0)).cut(platform))
    assert evaluator.manifold(pocket).min_gap(outside, 1.0) > 0.98 * 0.45


def distance_to_surface(body: ConicBody, points: Array, steps: int = 12) -> Array:
    """Measure the distance [mm] of points from the surface and its flat
    end, whose rim belongs to the side patches.
    """
    folded = points.copy()
    folded[:, 0] = np.abs(folded[:, 0])
    z, scale = body.stations[0]
    over = (
        np.array([body.section.half_width_at(y, scale) for y in folded[:, 1]])
        >= folded[:, 0] - 1e-12
    )
    best = np.where(over, np.abs(folded[:, 2] - z), np.inf)
    for patch in surface_patches(body):
        best = np.minimum(best, patch.distance(folded, steps))
    return best


@pytest.mark.full
def test_points_offset_from_the_surface_have_that_distance(design: Design) -> None:
    """Offsets along the normal, in and out.

    Points near the rim and the planes of symmetry are left out.

    Other patches are nearer to those.
    """
    body = design.dimensions.outer
    random = np.random.default_rng(1)
    for patch in surface_patches(body):
        t, v = random.uniform(0.0, 1.0, (2, 500))
        position, by_t, by_v = patch.evaluate(t, v)
        normal = np.cross(by_t, by_v)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        inner = (
            (position[:, 2] > body.stations[0][0] + 0.2)
            & (position[:, 0] > 0.2)
            & (np.abs(position[:, 1]) > 0.2)
        )
        for offset in (0.001, -0.001, 0.1, -0.1):
            found = distance_to_surface(body, (position + offset * normal)[inner])
            assert np.abs(found - abs(offset)).max() < 1e-9


def test_facets_stay_within_their_tolerance_without_wasting_it() -> None:
    """The deviation is of second order in the chord length, which
    falls with the root of the tolerance.
    """
    body = Design().dimensions.outer
    tolerances = (0.08, 0.02, 0.005)
    deviations = [
        max_facet_deviation(body, *tessellate(SuperconicSolid(body), tolerance))
        for tolerance in tolerances
    ]
    for tolerance, deviation in zip(tolerances, deviations, strict=True):
        assert tolerance / 5 < deviation <= tolerance
    for coarse, fine in itertools.pairwise(deviations):
        assert 2.8 < coarse / fine < 5.6


def test_nearby_distance_equals_the_full_distance_near_the_surface() -> None:
    """Centres of coarse facets have the same distance from the
    patches beside them as from all patches.
    """
    body = Design().dimensions.outer
    vertices, triangles = tessellate(SuperconicSolid(body), 0.5)
    centres = vertices[triangles].mean(axis=1)
    centres = centres[centres[:, 2] > 1.5]  # the flat end is left out of the nearby distance
    near = _nearby_distance(surface_patches(body), centres)
    assert 0.1 < near.max() < 0.5
    np.testing.assert_allclose(
        near, distance_to_surface(body, centres, steps=3), rtol=0, atol=1e-12
    )
