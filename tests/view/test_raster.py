"""Rasteriser against closed forms: depth and brightness of a sphere from several sides, and what hides what."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold

from fingertip.cad.kernel.mesh import to_canonical_mesh
from fingertip.pictures.raster import Camera, Canvas

RADIUS_MM, PIXELS_PER_MM, SIZE = 10.0, 5.0, 120
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
    canvas, height = draw_sphere(camera), expected_height_mm()
    inside = np.isfinite(height)
    assert canvas.depth_mm[inside] == pytest.approx(height[inside], abs=0.07)
    x = (np.arange(SIZE) - SIZE / 2) / PIXELS_PER_MM
    normal = (
        np.stack([np.broadcast_to(x, height.shape), np.broadcast_to(-x[:, None], height.shape), height]) / RADIUS_MM
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
        to_canonical_mesh(Manifold.cube((4.0, 4.0, 4.0), center=True).translate(tuple(x * camera.axes[2])))
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
