"""Rasteriser against closed forms: depth and brightness of a sphere
from several sides, and what hides what.
"""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold

from fingertip.cad.kernel.mesh import to_canonical_mesh
from fingertip.foundation.numerics import Array
from fingertip.pictures.raster import Camera, Canvas

RADIUS_MM = 10.0
PIXELS_PER_MM = 5.0
SIZE = 120
LAMP = np.array([-0.45, 0.6, 0.66])
WHITE = (1.0, 1.0, 1.0)


def draw_sphere(camera: Camera, segments: int = 64) -> Canvas:
    canvas = Canvas(SIZE, SIZE, PIXELS_PER_MM, camera, oversample=1)
    canvas.draw(to_canonical_mesh(Manifold.sphere(RADIUS_MM, segments)), WHITE, np.zeros(3))
    return canvas


def expected_height_mm() -> np.ndarray:
    """Height of the sphere above the plane of the picture, NaN near its edge and outside."""
    x = (np.arange(SIZE) - SIZE / 2) / PIXELS_PER_MM
    square = x[None, :] ** 2 + x[:, None] ** 2
    return np.sqrt(np.where(square < (0.85 * RADIUS_MM) ** 2, RADIUS_MM**2 - square, np.nan))


CAMERAS = {
    "from angles": (Camera.from_angles(30.0, 20.0), 1.0),
    "from above": (Camera.looking_from((0.0, 3.0, 0.0), (0.0, 0.0, 1.0)), 1.0),
    "from below": (Camera.looking_from((1.0, -4.0, 2.0), (0.0, 0.0, 1.0)), -1.0),
}


@pytest.mark.parametrize("name", CAMERAS)
def test_sphere_has_the_depth_and_the_shade_of_its_closed_form(name: str) -> None:
    camera, lamp_up = CAMERAS[name]
    assert camera.axes @ camera.axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(camera.axes) == pytest.approx(1.0)
    canvas = draw_sphere(camera)
    height = expected_height_mm()
    inside = np.isfinite(height)
    assert canvas._depth[inside] / PIXELS_PER_MM == pytest.approx(height[inside], abs=0.07)
    x = (np.arange(SIZE) - SIZE / 2) / PIXELS_PER_MM
    normal = (
        np.stack(
            [np.broadcast_to(x, height.shape), np.broadcast_to(-x[:, None], height.shape), height]
        )
        / RADIUS_MM
    )
    light = 0.42 + 0.58 * np.clip(np.tensordot(LAMP * [1.0, lamp_up, 1.0], normal, 1), 0.0, 1.0)
    drawn = canvas.image()[..., 0] / 255.0
    assert np.abs(drawn - light)[inside].max() < 0.02


def test_camera_looks_along_its_direction() -> None:
    towards = np.array([1.0, -4.0, 2.0])
    camera = Camera.looking_from((1.0, -4.0, 2.0), (0.0, 0.0, 1.0))
    assert camera.axes[2] == pytest.approx(towards / np.linalg.norm(towards))
    assert camera.axes[0, 2] == pytest.approx(0.0), "up is in the plane of the picture's vertical"
    assert camera.axes[1, 2] > 0.0


def test_the_nearer_surface_hides_the_other_in_any_order() -> None:
    camera = Camera.from_angles(0.0, 0.0)
    near, far = (
        to_canonical_mesh(
            Manifold.cube((4.0, 4.0, 4.0), center=True).translate(tuple(x * camera.axes[2]))
        )
        for x in (20.0, -20.0)
    )
    pictures = []
    for order in ((near, far), (far, near)):
        canvas = Canvas(40, 40, PIXELS_PER_MM, camera, oversample=1)
        for mesh in order:
            canvas.draw(mesh, (1.0, 0.0, 0.0) if mesh is near else (0.0, 1.0, 0.0), np.zeros(3))
        pictures.append(canvas.image())
    assert np.array_equal(*pictures)
    red, green = pictures[0][20, 20, :2]
    assert red > 100
    assert green == 0


def fill_one_by_one(corners: Array, shades: Array, shape: tuple[int, int]) -> tuple[Array, Array]:
    """Depth and brightness of triangles [fine pixels], each drawn
    over those before it where it is nearer.
    """
    depth = np.full(shape, -np.inf)
    light = np.ones(shape)
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    for (a, b, c), shade in zip(corners, shades, strict=True):
        det = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if det == 0.0:
            continue
        v = ((columns - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (rows - a[1])) / det
        w = ((b[0] - a[0]) * (rows - a[1]) - (columns - a[0]) * (b[1] - a[1])) / det
        u = 1.0 - v - w
        z = u * a[2] + v * b[2] + w * c[2]
        seen = (u >= -1e-9) & (v >= -1e-9) & (w >= -1e-9) & (z > depth)
        depth[seen] = z[seen]
        light[seen] = (u * shade[0] + v * shade[1] + w * shade[2])[seen]
    return depth, light


@pytest.mark.parametrize("seed", range(3))
def test_triangles_drawn_together_are_those_drawn_one_by_one(seed: int) -> None:
    """Large and small ones, at corners of pixels, at one depth,
    seen from their edge, and beyond the canvas.
    """
    random = np.random.default_rng(seed)
    width = 40
    height = 30
    size = random.choice([2.0, 15.0, 90.0], (300, 1, 1))
    corners = (
        random.uniform(-15.0, 50.0, (300, 1, 3)) + random.uniform(-1.0, 1.0, (300, 3, 3)) * size
    )
    corners[::2, :, :2] = np.round(corners[::2, :, :2])
    corners[::3, :, 2] = np.round(corners[::3, :1, 2] / 20.0)
    corners[::25, 2] = corners[::25, 1]
    shades = random.uniform(0.2, 1.0, (300, 3))
    canvas = Canvas(width, height, 1.0, Camera.from_angles(0, 0), oversample=1)
    corners_2d = corners[:, :, :2]
    low = np.maximum(np.ceil(corners_2d.min(axis=1)), 0).astype(int)
    high = np.minimum(np.floor(corners_2d.max(axis=1)), (width - 1, height - 1)).astype(int)
    a, b, c = np.moveaxis(corners_2d, 1, 0)
    det = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])
    some = (low <= high).all(axis=1) & (det != 0.0)
    canvas._fill_triangles(corners[some], shades[some], low[some], high[some], 0)
    depth, light = fill_one_by_one(corners, shades, (height, width))
    np.testing.assert_allclose(canvas._depth, depth, atol=1e-9)
    np.testing.assert_allclose(canvas._light, light, atol=1e-9)
