"""Walls measured by rays: bodies of known thickness, and a second ray caster on the printed file."""

from __future__ import annotations

import io
import itertools
import math
import os
from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification.walls import find_thin_walls, measure_walls
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from tests.cad.test_random_designs import generate_accepted
from tests.conftest import DESIGNS, design_file

MANY = int(os.environ.get("FINGERTIP_RANDOM_DESIGNS", "12"))
RAYS, DENSE, OPPOSITE, NEAR_MM, NEGLIGIBLE_MM2 = 1500, 200_000, -0.75, 2.0, 0.5


def test_thickness_and_area_of_a_plate() -> None:
    found = measure_walls(Manifold.cube((20.0, 10.0, 0.5)), 0.8)
    assert found.thickness_mm == pytest.approx(0.5, abs=1e-9)
    assert found.area_mm2 == pytest.approx(2 * 20 * 10, rel=0.01)
    assert measure_walls(Manifold.cube((20.0, 10.0, 0.5)), 0.49).area_mm2 == 0.0


def test_edge_of_a_wedge_is_thin_as_far_as_its_angle_says() -> None:
    """A ray across a wedge of the angle a meets the other face after x tan(a); its edge of 90 degrees is no wall."""
    tangent = math.tan(math.radians(20.0))
    wedge = Manifold.hull_points([(x, y, z) for y in (0, 30) for x, z in ((0, 0), (9, 0), (9, 9 * tangent))])
    found = measure_walls(wedge, 0.8)
    along = found.points[np.abs(found.points[:, 2]) < 1e-9]
    assert along[:, 0].max() == pytest.approx(0.8 / tangent, abs=0.1)
    assert found.area_mm2 == pytest.approx(30 * 0.8 / tangent * (1 + math.cos(math.radians(20.0))), rel=0.1)


def test_cavity_is_measured_to_the_outside() -> None:
    shell = Manifold.sphere(5.0, 256) - Manifold.sphere(4.5, 256)
    found = measure_walls(shell, 0.8)
    assert found.thickness_mm == pytest.approx(0.5, abs=0.01)
    assert found.area_mm2 == pytest.approx(4 * math.pi * (5.0**2 + 4.5**2), rel=0.01)


def cast(mesh: Any, limit_mm: float, rays: int, near: Array | None = None) -> Array:
    """Cast rays against every triangle (T. Moeller and B. Trumbore, 1997); return where they meet a wall.

    The rays start all over the surface, or those of them that start within `NEAR_MM` of a point.
    """
    import trimesh

    points, faces = trimesh.sample.sample_surface(mesh, rays, seed=1)
    if near is not None:
        chosen = np.linalg.norm(points - near, axis=1) < NEAR_MM
        points, faces = points[chosen], faces[chosen]
    normals, corners = mesh.face_normals[faces], mesh.triangles
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    hit = np.zeros(len(points), dtype=bool)
    for i, (point, normal) in enumerate(zip(points - 1e-4 * normals, normals, strict=True)):
        p = np.cross(-normal, v)
        det = np.einsum("ij,ij->i", u, p)
        with np.errstate(divide="ignore", invalid="ignore"):  # parallel triangles
            t = point - corners[:, 0]
            q = np.cross(t, u)
            a, b = np.einsum("ij,ij->i", t, p) / det, q @ -normal / det
            length = np.einsum("ij,ij->i", v, q) / det
            inside = (a >= 0) & (b >= 0) & (a + b <= 1) & (length > 0) & (length < limit_mm)
        if inside.any():
            first = np.flatnonzero(inside)[np.argmin(length[inside])]
            hit[i] = mesh.face_normals[first] @ normal < OPPOSITE
    return np.asarray(points[hit])


def check_against_second_caster(design: Design) -> None:
    """Each thin place that a ray finds on the STL file is near one that the check has found, or is the rim.

    A place whose area the check does not report either, a lip of some hundredths of a millimetre, counts as found.
    """
    import trimesh

    evaluator, dims = MeshEvaluator(0.02), design.dimensions
    for name, part in parts_by_name(design).items():
        if name not in ("bone", "skin"):
            continue
        limit = design.skin.min_thickness_mm if name == "skin" else design.printer.min_wall_mm
        written = stl.to_bytes(evaluator.mesh(part.solid(design)), name, "")
        mesh = trimesh.load_mesh(io.BytesIO(written), file_type="stl")
        reported = find_thin_walls(design, evaluator, name).points
        missed = [
            point
            for point in cast(mesh, limit - 0.06, RAYS)
            if not len(reported) or np.linalg.norm(reported - point, axis=1).min() > NEAR_MM
        ]
        if name in ("bone", "core"):  # the rim is as thin as bone.rim_mm says
            missed = [p for p in missed if not (p[2] > 0 and p[1] < dims.pocket_depth - dims.flat_depth)]
        for point in missed:
            area_mm2 = mesh.area / DENSE * len(cast(mesh, limit - 0.06, DENSE, point))
            assert area_mm2 < NEGLIGIBLE_MM2, (name, point)


@pytest.mark.full
@pytest.mark.parametrize("name", DESIGNS)
def test_second_ray_caster_finds_no_other_thin_walls(name: str) -> None:
    check_against_second_caster(Design.load(design_file(name)))


@pytest.mark.full
@pytest.mark.parametrize("seed", range(MANY))
def test_second_ray_caster_finds_no_other_thin_walls_in_a_random_design(seed: int) -> None:
    check_against_second_caster(next(itertools.islice(generate_accepted(7000 + seed), 1)))


@pytest.mark.parametrize("name", ["adult_finger", "fsr400"])
def test_bundled_fingers_have_no_thin_walls(name: str) -> None:
    design, evaluator = Design.load(design_file(name)), MeshEvaluator(0.05)
    assert not any(find_thin_walls(design, evaluator, part).matters for part in ("bone", "skin"))
