"""Orthographic rasteriser with a depth buffer, for meshes of some ten thousand triangles."""

from __future__ import annotations

import io
import itertools
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
Whole: TypeAlias = NDArray[np.int_]
Pen: TypeAlias = ImageDraw.ImageDraw
Font: TypeAlias = ImageFont.FreeTypeFont
_CREASE_COSINE = math.cos(math.radians(35.0))
"""Cosine of the angle between facets above which they are shaded as separate surfaces."""
_DECIMALS = 6
"""Decimals of projected points [mm or pixels] and shades. The last digits of a product of matrices
depend on the processor, and pictures must not.
"""
_PIXELS_AT_ONCE = 100_000
_ROUNDING_PX = 1e-6
"""Distance beyond its edges to which a triangle is drawn, to leave no gap to the next."""
_FROM_BELOW = -0.2
"""Dorsal component of the direction to the viewer below which the view is one from below."""


@dataclass(frozen=True)
class Camera:
    """Direction of an orthographic view."""

    axes: Array
    """Directions to the right, upwards and towards the viewer, orthonormal rows of shape (3, 3)."""

    @classmethod
    def from_angles(cls, azimuth_deg: float, elevation_deg: float) -> Camera:
        """Create a camera, distal (z) to the right, turned about y and tilted."""
        a = math.radians(azimuth_deg)
        e = math.radians(elevation_deg)
        right = np.array([math.sin(a), 0.0, math.cos(a)])
        towards = np.array([-math.cos(a) * math.cos(e), math.sin(e), math.sin(a) * math.cos(e)])

        return cls(np.array([right, np.cross(towards, right), towards]))

    @classmethod
    def looking_from(
        cls, towards: tuple[float, float, float], up: tuple[float, float, float]
    ) -> Camera:
        """Create a camera that looks from `towards`, with `up` pointing upwards."""
        back = np.array(towards) / math.hypot(*towards)
        right = np.cross(np.array(up), back)
        right /= np.linalg.norm(right)

        return cls(np.array([right, np.cross(back, right), back]))


class Canvas:
    """RGB picture with a depth buffer, rendered `oversample` times finer than its image."""

    def __init__(
        self,
        width: int,
        height: int,
        pixels_per_mm: float,
        camera: Camera,
        oversample: int = 2,
    ) -> None:
        self._k = oversample
        self._camera = camera
        self._scale = pixels_per_mm * oversample
        shape = (height * oversample, width * oversample)
        # Brightness and colour of each pixel apart: a third of the memory of their product.
        self._light = np.ones(shape)
        self._paint = np.zeros(shape, dtype=np.uint8)
        self._colours: list[Colour] = [(1.0, 1.0, 1.0)]
        self._depth = np.full(shape, -np.inf)
        self._first = np.array(shape)
        self._last = np.zeros(2, dtype=int)

    def draw(self, mesh: Mesh, colour: Colour, centre: Array) -> None:
        """Draw a mesh; `centre` is the point [mm] shown in the middle of the picture."""
        height, width = self._depth.shape
        projected = np.round(
            (mesh.vertices - centre) @ self._camera.axes.T * self._scale, _DECIMALS
        )
        projected[:, 0] += width / 2
        projected[:, 1] = height / 2 - projected[:, 1]
        corners = projected[mesh.triangles]
        shades = _shades(mesh, self._camera)
        facing = shades[:, 0, 1] > 0
        corners = corners[facing]
        shade = shades[facing, :, 0]
        low = np.maximum(np.ceil(corners[:, :, :2].min(axis=1)), 0).astype(int)
        largest = np.floor(corners[:, :, :2].max(axis=1))
        high = np.minimum(largest, (width - 1, height - 1)).astype(int)
        (ax, ay, _), (bx, by, _), (cx, cy, _) = np.moveaxis(corners, 0, 2)
        self._first = np.minimum(self._first, low.min(axis=0, initial=max(width, height))[::-1])
        self._last = np.maximum(self._last, high.max(axis=0, initial=0)[::-1])
        has_area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay) != 0.0
        visible = np.flatnonzero(has_area & (low <= high).all(axis=1))
        # Some triangles at a time, so that the pixels of their boxes fit into the memory that is
        # near the processor.
        part = np.cumsum((high - low + 1)[visible].prod(axis=1)) // _PIXELS_AT_ONCE

        for batch in np.split(visible, np.flatnonzero(np.diff(part)) + 1):
            self._fill_triangles(
                corners[batch],
                shade=shade[batch],
                low=low[batch],
                high=high[batch],
                paint=self._find_paint(colour),
            )

    def _find_paint(self, colour: Colour) -> int:
        if colour not in self._colours:
            self._colours.append(colour)

        return self._colours.index(colour)

    def _fill_triangles(
        self,
        corners: Array,
        shade: Array,
        low: Whole,
        high: Whole,
        paint: int,
    ) -> None:
        """Fill triangles, row by row, where they are nearer than what has been drawn.

        `low` and `high` are the corners of their boxes [fine pixels]. Of triangles at one depth the
        first is drawn.
        """
        triangle, y = _expand(low[:, 1], high[:, 1])
        (ax, ay), (bx, by), (cx, cy) = np.moveaxis(corners[:, :, :2], 0, 2)
        det = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        # Barycentric coordinates v and w of corners b and c, linear in the distance to the right of
        # corner a.
        v_slope = ((cy - ay) / det)[triangle]
        w_slope = ((ay - by) / det)[triangle]
        left = ax[triangle]
        down = y - ay[triangle]
        v_left = down * ((ax - cx) / det)[triangle]
        w_left = down * ((bx - ax) / det)[triangle]
        # In a row, each of u, v and w is 0 at an end of the triangle.
        begins = [low[triangle, 0]]
        ends = [high[triangle, 0]]
        coordinates = (
            (v_slope, v_left),
            (w_slope, w_left),
            (-v_slope - w_slope, 1.0 - v_left - w_left),
        )
        for slope, value in coordinates:
            with np.errstate(divide="ignore", invalid="ignore"):
                zero = np.clip(left - value / slope, -1.0, self._depth.shape[1])

            begins.append(np.where(slope > 0.0, np.ceil(zero - _ROUNDING_PX), -np.inf))
            ends.append(np.where(slope < 0.0, np.floor(zero + _ROUNDING_PX), np.inf))

        first = np.max(begins, axis=0).astype(int)
        count = np.maximum(np.min(ends, axis=0).astype(int) - first + 1, 0)
        # A sliver's depth changes by all of its length within its width: its first pixel must not
        # lie outside.
        v = np.clip(v_left + v_slope * (first - left), 0.0, 1.0)
        w = np.clip(w_left + w_slope * (first - left), 0.0, 1.0 - v)

        def at_start(values: Array) -> tuple[Array, Array]:
            """Return what corners have at each row's first pixel, and its change to the next."""
            a, to_b, to_c = (values.T - [[0.0], [1.0], [1.0]] * values[:, 0])[:, triangle]
            return a + v * to_b + w * to_c, v_slope * to_b + w_slope * to_c

        start = np.cumsum(count) - count
        number = np.arange(int(count.sum()))
        across = number - np.repeat(start, count)
        pixel = number + np.repeat(y * self._depth.shape[1] + first - start, count)
        depth, change = (np.repeat(values, count) for values in at_start(corners[:, :, 2]))
        depth += across * change
        buffer = self._depth.reshape(-1)
        nearer = np.flatnonzero(depth > buffer[pixel])
        pixel = pixel[nearer]
        depth = depth[nearer]
        np.maximum.at(buffer, pixel, depth)
        # The last that is assigned to a pixel counts, so the first triangle comes last.
        visible = np.flatnonzero(depth == buffer[pixel])[::-1]
        row = np.repeat(np.arange(len(count)), count)[nearer[visible]]
        pixel = pixel[visible]
        light, change = at_start(shade)
        self._light.reshape(-1)[pixel] = light[row] + across[nearer[visible]] * change[row]
        self._paint.reshape(-1)[pixel] = paint

    def cover(self) -> NDArray[np.uint8]:
        """Return how far each pixel of the picture is covered by what was drawn, from 0 to 255."""
        k = self._k
        fine = np.isfinite(self._depth).reshape(self._depth.shape[0] // k, k, -1, k)
        cover: NDArray[np.uint8] = (fine.mean(axis=(1, 3)) * 255.0 + 0.5).astype(np.uint8)

        return cover

    def image(self) -> NDArray[np.uint8]:
        """Return the picture (height, width, 3), with outlines, in its final resolution."""
        k = self._k
        height, width = self._depth.shape
        picture = np.full((height // k, width // k, 3), 255, dtype=np.uint8)
        # What was drawn, with room for its outline: the rest stays white.
        top, left = np.maximum(self._first // k - 1, 0)
        bottom, right = self._last // k + 2
        window = np.s_[top * k : bottom * k, left * k : right * k]
        light = self._light[window].astype(np.float32)
        light[_outline(self._depth[window], self._scale)] *= 0.45
        colour = np.array(self._colours, dtype=np.float32)[self._paint[window]]
        colour *= light[:, :, None]
        offsets = itertools.product(range(k), repeat=2)
        small = sum(colour[row::k, column::k] for row, column in offsets) / (k * k)
        picture[top:bottom, left:right] = (np.clip(small, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)

        return picture


def _expand(first: Whole, last: Whole) -> tuple[Whole, Whole]:
    """List the whole numbers of consecutive ranges, each with the index of its range."""
    count = np.maximum(last - first + 1, 0)
    index = np.repeat(np.arange(len(count)), count)
    return index, np.arange(len(index)) + (first - np.cumsum(count) + count)[index]


def _outline(depth: Array, scale: float) -> NDArray[np.bool_]:
    """Find the pixels next to the background or a neighbour more than 1 mm deeper."""
    step = np.zeros(depth.shape, dtype=bool)
    for pixels, neighbours in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        with np.errstate(invalid="ignore"):  # two pixels of the background are no step
            jump = depth[pixels] - depth[neighbours]

        step[pixels] |= jump > scale
        step[neighbours] |= jump < -scale

    return step


def _shades(mesh: Mesh, camera: Camera) -> Array:
    """Compute each corner's brightness and cosine between facet normal and view, (m, 3, 2)."""
    corners = mesh.vertices[mesh.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    facet = np.divide(cross, length, out=np.zeros_like(cross), where=length > 0)
    normal = _smooth_normals(mesh, cross, facet)
    # Directional light from behind the viewer's left shoulder, plus ambient light. Who looks from
    # below holds the lamp below, or the faces seen would lie in the shade, and what is engraved in
    # them with them.
    up = 0.6 if camera.axes[2, 1] >= _FROM_BELOW else -0.6
    lamp = camera.axes.T @ (np.array([-0.45, up, 0.66]))
    light = 0.42 + 0.58 * np.clip(normal @ lamp, 0.0, 1.0)
    towards = np.repeat((facet @ camera.axes[2])[:, None], 3, axis=1)

    return np.round(np.stack((light, towards), axis=2), _DECIMALS)


def _smooth_normals(mesh: Mesh, weighted: Array, facet: Array) -> Array:
    """Compute each corner's mean normal of the facets that meet without a crease, (m, 3, 3)."""
    vertex = mesh.triangles.ravel()
    order = np.argsort(vertex, kind="stable")
    count = np.bincount(vertex, minlength=len(mesh.vertices))
    start = np.concatenate(([0], np.cumsum(count)[:-1]))[vertex]
    # Each corner, with every facet at its vertex.
    corner, place = _expand(start, start + count[vertex] - 1)
    neighbour = order[place] // 3
    smooth = np.einsum("ij,ij->i", facet[corner // 3], facet[neighbour]) > _CREASE_COSINE
    total = np.zeros((len(vertex), 3))
    np.add.at(total, corner[smooth], weighted[neighbour[smooth]])
    length = np.linalg.norm(total, axis=1, keepdims=True)
    unit: Array = np.divide(total, length, out=np.zeros_like(total), where=length > 0)

    return unit.reshape(-1, 3, 3)


def bounds(meshes: Iterable[Mesh], camera: Camera) -> tuple[Array, Array]:
    """Compute centre [mm, in space] and size [mm, right and up] of meshes in a camera's view."""
    projected = np.round(
        np.concatenate([mesh.vertices for mesh in meshes]) @ camera.axes.T, _DECIMALS
    )
    low = projected.min(axis=0)
    high = projected.max(axis=0)

    return np.round((low + high) / 2 @ camera.axes, _DECIMALS), (high - low)[:2]


def to_png(picture: Image.Image) -> bytes:
    file = io.BytesIO()
    # The highest level takes four times as long for a tenth less.
    picture.save(file, format="PNG", compress_level=6)
    return file.getvalue()
