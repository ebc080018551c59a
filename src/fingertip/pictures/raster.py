"""Orthographic rasteriser with a depth buffer, for meshes of some ten thousand triangles."""

from __future__ import annotations

import io
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from fingertip.cad.kernel.mesh import Mesh
from fingertip.foundation.numerics import Array

Colour = tuple[float, float, float]
Pen: TypeAlias = ImageDraw.ImageDraw
Font: TypeAlias = ImageFont.FreeTypeFont
_CREASE_COSINE = math.cos(math.radians(35.0))
"""Cosine of the angle between facets above which they are shaded as separate surfaces."""
_LEAST_TINT = 0.5
"""Brightness of a tinted pixel in the darkest shade."""
_DECIMALS = 6
"""Decimals of projected points [mm or pixels] and shades. The last digits of a product of matrices depend on the
processor, and pictures must not."""
_FROM_BELOW = -0.2
"""Dorsal component of the direction to the viewer below which the view is one from below."""


@dataclass(frozen=True)
class Camera:
    """Orthographic camera."""

    axes: Array
    """Directions to the right, upwards and towards the viewer, orthonormal rows of shape (3, 3)."""

    @classmethod
    def from_angles(cls, azimuth_deg: float, elevation_deg: float) -> Camera:
        """Create a camera with distal (z) to the right and dorsal (y) up, turned about y by the azimuth and tilted."""
        a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
        right = np.array([math.sin(a), 0.0, math.cos(a)])
        towards = np.array([-math.cos(a) * math.cos(e), math.sin(e), math.sin(a) * math.cos(e)])
        return cls(np.array([right, np.cross(towards, right), towards]))

    @classmethod
    def looking_from(cls, towards: tuple[float, float, float], up: tuple[float, float, float]) -> Camera:
        """Create a camera that looks from the direction `towards`, with `up` pointing upwards as far as it can."""
        back = np.array(towards) / math.hypot(*towards)
        right = np.cross(np.array(up), back)
        right /= np.linalg.norm(right)
        return cls(np.array([right, np.cross(back, right), back]))


class Canvas:
    """RGB picture with a depth buffer, rendered `oversample` times finer than the image it returns."""

    def __init__(self, width: int, height: int, pixels_per_mm: float, camera: Camera, oversample: int = 2) -> None:
        self._k = oversample
        self._camera, self._scale = camera, pixels_per_mm * oversample
        shape = (height * oversample, width * oversample)
        self._colour = np.ones((*shape, 3))
        self._depth = np.full(shape, -np.inf)

    def draw(self, mesh: Mesh, colour: Colour, centre: Array) -> None:
        """Draw a mesh; `centre` is the point [mm] shown in the middle of the picture."""
        height, width = self._depth.shape
        projected = np.round((mesh.vertices - centre) @ self._camera.axes.T * self._scale, _DECIMALS)
        projected[:, 0] += width / 2
        projected[:, 1] = height / 2 - projected[:, 1]
        corners = projected[mesh.triangles]
        shades = _shades(mesh, self._camera)
        facing = shades[:, 0, 1] > 0
        base = np.array(colour)
        for triangle, shade in zip(corners[facing], shades[facing, :, 0], strict=True):
            self._fill_triangle(triangle, shade, base)

    def _fill_triangle(self, p: Array, shade: Array, base: Array) -> None:
        """Fill a triangle where it is nearer to the viewer than what has been drawn, using barycentric coordinates."""
        height, width = self._depth.shape
        x0, x1 = max(math.ceil(p[:, 0].min()), 0), min(math.floor(p[:, 0].max()), width - 1)
        y0, y1 = max(math.ceil(p[:, 1].min()), 0), min(math.floor(p[:, 1].max()), height - 1)
        if x0 > x1 or y0 > y1:
            return
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = p.tolist()
        det = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if det == 0.0:
            return
        x = np.arange(x0, x1 + 1)[None, :]
        y = np.arange(y0, y1 + 1)[:, None]
        v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / det
        w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / det
        u = 1.0 - v - w
        depth = u * az + v * bz + w * cz
        window = self._depth[y0 : y1 + 1, x0 : x1 + 1]
        visible = (u >= -1e-9) & (v >= -1e-9) & (w >= -1e-9) & (depth > window)
        if visible.any():
            window[visible] = depth[visible]
            light = (u * shade[0] + v * shade[1] + w * shade[2])[visible]
            self._colour[y0 : y1 + 1, x0 : x1 + 1][visible] = light[:, None] * base

    @property
    def depth_mm(self) -> Array:
        """Depth of each fine pixel towards the viewer [mm]; minus infinity where nothing was drawn."""
        return self._depth / self._scale

    def tint(self, mask: NDArray[np.bool_], drawn: Colour, colour: Colour) -> None:
        """Give fine pixels that were drawn in one colour another one, even in the shade; empty ones become pale."""
        is_empty = ~np.isfinite(self._depth) & mask
        shade = self._colour[mask] / np.array(drawn)
        self._colour[mask] = (_LEAST_TINT + (1.0 - _LEAST_TINT) * shade) * np.array(colour)
        self._colour[is_empty] = 1.0 - 0.35 * (1.0 - np.array(colour))

    def cover(self) -> NDArray[np.uint8]:
        """Return how far each pixel of the picture is covered by what was drawn, from 0 to 255."""
        k = self._k
        fine = np.isfinite(self._depth).reshape(self._depth.shape[0] // k, k, -1, k)
        cover: NDArray[np.uint8] = (fine.mean(axis=(1, 3)) * 255.0 + 0.5).astype(np.uint8)
        return cover

    def image(self) -> NDArray[np.uint8]:
        """Return the picture (height, width, 3), outlined at steps in depth and averaged to its final resolution."""
        colour = self._colour.copy()
        colour[_outline(self._depth, self._scale)] *= 0.45
        k = self._k
        height, width = self._depth.shape
        small = colour.reshape(height // k, k, width // k, k, 3).mean(axis=(1, 3))
        picture: NDArray[np.uint8] = (np.clip(small, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
        return picture


def _outline(depth: Array, scale: float) -> NDArray[np.bool_]:
    """Find the pixels at which the depth drops by more than 1 mm to a neighbour, or the background begins."""
    step = np.zeros(depth.shape, dtype=bool)
    near = np.where(np.isfinite(depth), depth, -1e9)
    for away, steps in ((near, step), (near.T, step.T)):
        jump = np.diff(away, axis=0)
        steps[1:] |= jump > scale
        steps[:-1] |= jump < -scale
    return step


def _shades(mesh: Mesh, camera: Camera) -> Array:
    """Compute at each corner the brightness and the cosine between facet normal and view direction, shape (m, 3, 2)."""
    corners = mesh.vertices[mesh.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    facet = np.divide(cross, length, out=np.zeros_like(cross), where=length > 0)
    normal = _smooth_normals(mesh, cross, facet)
    # Directional light from behind the viewer's left shoulder, plus ambient light. Who looks from below holds the lamp
    # below, or the faces seen would lie in the shade, and what is engraved in them with them.
    up = 0.6 if camera.axes[2, 1] >= _FROM_BELOW else -0.6
    lamp = camera.axes.T @ (np.array([-0.45, up, 0.66]))
    light = 0.42 + 0.58 * np.clip(normal @ lamp, 0.0, 1.0)
    towards = np.repeat((facet @ camera.axes[2])[:, None], 3, axis=1)
    return np.round(np.stack((light, towards), axis=2), _DECIMALS)


def _smooth_normals(mesh: Mesh, weighted: Array, facet: Array) -> Array:
    """Compute at each corner the mean normal of the facets around its vertex that meet without a crease, (m, 3, 3)."""
    vertex = mesh.triangles.ravel()
    order = np.argsort(vertex, kind="stable")
    count = np.bincount(vertex, minlength=len(mesh.vertices))
    start = np.concatenate(([0], np.cumsum(count)[:-1]))
    each = count[vertex]  # each corner is paired with every corner at its vertex
    corner = np.repeat(np.arange(len(vertex)), each)
    within = np.arange(len(corner)) - np.repeat(np.cumsum(each) - each, each)
    other = order[np.repeat(start[vertex], each) + within] // 3
    smooth = np.einsum("ij,ij->i", facet[corner // 3], facet[other]) > _CREASE_COSINE
    total = np.zeros((len(vertex), 3))
    np.add.at(total, corner[smooth], weighted[other[smooth]])
    length = np.linalg.norm(total, axis=1, keepdims=True)
    unit: Array = np.divide(total, length, out=np.zeros_like(total), where=length > 0)
    return unit.reshape(-1, 3, 3)


def bounds(meshes: Iterable[Mesh], camera: Camera) -> tuple[Array, Array]:
    """Compute the centre [mm, in space] and the size [mm, right and up] of the meshes as the camera sees them."""
    projected = np.round(np.concatenate([mesh.vertices for mesh in meshes]) @ camera.axes.T, _DECIMALS)
    low, high = projected.min(axis=0), projected.max(axis=0)
    return np.round((low + high) / 2 @ camera.axes, _DECIMALS), (high - low)[:2]


def to_png(picture: Image.Image) -> bytes:
    file = io.BytesIO()
    picture.save(file, format="PNG", optimize=True)
    return file.getvalue()
