"""Finite elements of the pad on bodies with a known answer: patch
test, bonded blocks in compression, locking.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.pad.fem_elastic import Body, Surface, stiffness
from fingertip.pad.fem_mesh import RIM_MM, MeshSize, WedgeMesh, extrude, mesh_skin, quadratic_plan
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import PALM, X, Z


def block(x: Array, z: Array, height: float, layers: int) -> WedgeMesh:
    """Block over a grid of x and z whose squares are cut along both diagonals in turn."""
    corners = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)
    i, j = (
        axis.ravel()
        for axis in np.meshgrid(np.arange(len(x) - 1), np.arange(len(z) - 1), indexing="ij")
    )
    a, b, c, d = (p * len(z) + q for p, q in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
    even = ((i + j) % 2 == 0)[:, None]
    first = np.where(even, np.stack([a, b, c], axis=1), np.stack([a, b, d], axis=1))
    second = np.where(even, np.stack([a, c, d], axis=1), np.stack([b, c, d], axis=1))
    points, triangles = quadratic_plan(corners, np.concatenate([first, second]))
    return extrude(
        points, triangles, np.linspace(0.0, height, layers + 1)[:, None] * np.ones(len(points))
    )


def unmoved(mesh: WedgeMesh) -> Array:
    return np.zeros((*mesh.nodes.shape, 1))


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
def test_body_with_linear_displacements_at_its_border_has_them_inside(poisson: float) -> None:
    """Patch test on skew elements. Also the strains are those of the displacements."""
    random = np.random.default_rng(5)
    mesh = block(np.linspace(0, 3, 4), np.linspace(0, 2, 4), 1.4, 2)
    x, z, y = mesh.nodes.T
    border = (x % 3 == 0) | (z % 2 == 0) | (y % 1.4 == 0)
    slope = random.uniform(-0.1, 0.1, (3, 3))
    nodes = mesh.nodes.copy()
    nodes[:, X] += 0.1 * z + 0.2 * y
    nodes[:, Z] += 0.15 * x
    skew = WedgeMesh(nodes, mesh.triangles, mesh.wedges, mesh.count)
    exact = nodes @ slope.T
    body = Body(skew, 1.3, poisson, np.repeat(border[:, None], 3, axis=1))
    moved = body.move(unmoved(skew), exact[:, :, None])[:, :, 0]
    np.testing.assert_allclose(moved, exact, atol=1e-12)
    np.testing.assert_allclose(
        body.strains(moved),
        [np.linalg.eigvalsh(0.5 * (slope + slope.T))] * len(mesh.wedges),
        atol=1e-12,
    )


def neo_hookean(stretch: Array, young: float, poisson: float) -> float:
    """Energy of a volume of 1, as in the textbook."""
    shear = young / (2 + 2 * poisson)
    bulk = young / (3 - 6 * poisson)
    j = np.linalg.det(stretch)
    return float(
        0.5 * shear * (j ** (-2 / 3) * np.trace(stretch @ stretch.T) - 3)
        + 0.5 * bulk * (j - 1) ** 2
    )


def test_forces_of_a_stretched_block_are_the_slope_of_its_energy_and_stiffness_is_theirs() -> None:
    mesh = block(np.array([0.0, 0.4, 1.0]), np.array([0.0, 1.0]), 1.0, 2)
    stretch = np.array([[1.2, 0.3, -0.1], [0.05, 0.8, 0.2], [0.0, 0.1, 1.1]])
    step = 1e-6
    _, held = stiffness(mesh, 1.3, 0.49, mesh.nodes @ (stretch - np.eye(3)).T)
    slope = np.zeros((3, 3))
    for i, j in np.ndindex(3, 3):
        change = np.zeros((3, 3))
        change[i, j] = step
        slope[i, j] = neo_hookean(stretch + change, 1.3, 0.49) - neo_hookean(
            stretch - change, 1.3, 0.49
        )
    assert held.T @ mesh.nodes == pytest.approx(slope / (2 * step), abs=1e-8)
    moved, way = 0.05 * np.random.default_rng(1).standard_normal((2, *mesh.nodes.shape))
    before, after = (stiffness(mesh, 1.3, 0.49, moved + sign * 1e-4 * way)[1] for sign in (-1, 1))
    tangent, _ = stiffness(mesh, 1.3, 0.49, moved)
    assert abs(tangent - tangent.T).max() < 1e-12
    assert tangent @ way.ravel() == pytest.approx((after - before).ravel() / 2e-4, abs=1e-7)


@pytest.mark.parametrize("poisson", [0.3, 0.4999])
def test_confined_block_is_as_stiff_as_the_closed_form(poisson: float) -> None:
    """Uniform pressure p on a block between smooth walls:
    displacement p h / M with the confined modulus M.
    """
    mesh = block(np.linspace(0, 2, 3), np.linspace(0, 2, 3), 1.5, 2)
    is_fixed = np.zeros(mesh.nodes.shape, bool)
    for axis, ends in ((X, (0.0, 2.0)), (Z, (0.0, 2.0)), (PALM, (0.0,))):
        is_fixed[:, axis] = np.isin(mesh.nodes[:, axis], ends)
    surface = Surface.of_nodes(mesh.nodes[-mesh.count :], mesh.triangles)
    loads = unmoved(mesh)
    loads[-mesh.count :, PALM, 0] = -0.01 * np.asarray(surface.trace.sum(axis=1)).ravel()
    body = Body(mesh, 2.0, poisson, is_fixed)
    moved = body.move(loads)[:, :, 0]
    confined = 2.0 * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
    np.testing.assert_allclose(moved[-mesh.count :, PALM], -0.01 * 1.5 / confined, rtol=1e-7)
    assert body.support(moved)[:, PALM].sum() == pytest.approx(0.01 * 4.0, rel=1e-9)


def test_bonded_strip_in_compression_follows_its_closed_form() -> None:
    """Long incompressible strip bonded to two rigid plates, plane strain: force per length E' (1 +
    S^2) w d / h.

    Gent and Lindley (1959): E' = 4 E / 3, with the shape factor S = w / (2 h) of a strip of width w
    and height h.
    """
    width = 8.0
    height = 2.0
    travel = 0.01
    # Half of it, closer towards the free side.
    grid = 0.5 * width * np.sin(np.linspace(0, 0.5 * math.pi, 13))
    mesh = block(grid, np.array([0.0, 0.5]), height, 4)
    rigid = np.isin(mesh.nodes[:, PALM], (0.0, height))
    is_fixed = np.repeat(rigid[:, None], 3, axis=1)
    is_fixed[:, Z] = True
    is_fixed[mesh.nodes[:, X] == 0.0, X] = True
    given = unmoved(mesh)
    given[mesh.nodes[:, PALM] == height, PALM] = -travel
    body = Body(mesh, 1.0, 0.4999, is_fixed)
    moved = body.move(unmoved(mesh), given)
    # Energy of the body is half of force times travel.
    force = (
        2.0
        * float(moved.ravel() @ (stiffness(mesh, 1.0, 0.4999)[0] @ moved.ravel()))
        / travel
        / 0.5
    )
    closed = 4.0 / 3.0 * (1.0 + (0.5 * width / height) ** 2) * width * travel / height
    assert force == pytest.approx(closed, rel=0.04)


def outline_x_mm(form: PadForm, z: float) -> float:
    """Half width of the skin at the height of the rim, from the arc's
    equation (X + Y - 1)^2 = 4 w^2 (1 - X)(1 - Y).
    """
    body = form.outer
    w = form.outer.section.palmar_weight
    q = 1.0 - RIM_MM / (body.section.palmar * body.palmar_scale_at(z))
    c = 1.0 - 2.0 * w * w
    return (
        body.section.half_width
        * body.scale_at(z)
        * (q * c + math.sqrt(q * q * c * c - q * q + 4.0 * w * w * q))
    )


@pytest.mark.parametrize("name", ["fsr400", "first_finger"])
def test_border_of_the_mesh_is_the_outline_at_the_height_of_the_rim(name: str) -> None:
    form = PadForm.of_design(Design.load(name))
    mesh, _ = mesh_skin(form, MeshSize(1.5), is_half=True)
    corners = mesh.triangles[:, :3]
    plan = mesh.nodes[: mesh.count, :2]
    edges, times = np.unique(
        np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)), axis=0, return_counts=True
    )
    border = plan[np.unique(edges[times == 1])]
    side = border[(border[:, 0] > 1.0) & (border[:, 1] > 0.0)]
    assert len(side) > 10
    assert side[:, 0] == pytest.approx([outline_x_mm(form, z) for z in side[:, 1]], abs=0.02)
    tip_mm = form.outer.section.palmar * form.outer.palmar_scale_at(border[:, 1].max())
    assert tip_mm == pytest.approx(RIM_MM, abs=1e-6)
    sums = np.zeros_like(plan)
    counts = np.zeros(len(plan))
    for i, j in np.concatenate([edges, edges[:, ::-1]]):
        sums[i], counts[i] = sums[i] + plan[j], counts[i] + 1
    away_mm = np.hypot(*(sums[counts > 0] / counts[counts > 0, None] - plan[counts > 0]).T)
    assert np.mean(away_mm < 0.02 * 1.5) > 0.5, "free points are in the middle of their neighbours"
