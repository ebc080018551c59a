"""Raster of a sheet that tells what is drawn where, so that no text covers anything else."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from fingertip.arrays import Array
from fingertip.drawing.primitives import Arc, Arrow, Hatch, Point, Polyline, Primitive, Text

Box = tuple[float, float, float, float]
_CELL_MM = 0.25


class Occupancy:
    """Raster of a sheet with three layers: lines of views, lines of dimensions, and text."""

    def __init__(self, width: float, height: float) -> None:
        shape = (math.ceil(height / _CELL_MM) + 1, math.ceil(width / _CELL_MM) + 1)
        self.edges, self.lines, self.texts = (np.zeros(shape, dtype=bool) for _ in range(3))

    def add(self, primitives: Iterable[Primitive], *, is_view: bool = False) -> None:
        """Add primitives; those of views count as edges."""
        layer = self.edges if is_view else self.lines
        for primitive in primitives:
            match primitive:
                case Polyline(points):
                    self._mark(layer, points)
                case Arc():
                    self._mark(layer, primitive.points())
                case Arrow():
                    corners = primitive.corners()
                    self._mark(layer, (*corners, corners[0]))
                case Hatch():
                    for hatched in primitive.lines():
                        self._mark(layer, hatched.points)
                case Text():
                    rows, columns = self._cells(primitive.box(), 0.0)
                    self.texts[rows, columns] = True

    def block(self, box: Box) -> None:
        """Keep everything out of a box."""
        rows, columns = self._cells(box, 0.0)
        self.texts[rows, columns] = True

    def is_free(self, box: Box, margin: float) -> bool:
        """Tell whether nothing lies in a box and within a margin of it, and the box within the sheet."""
        left, bottom, right, top = box
        height, width = ((n - 1) * _CELL_MM for n in self.texts.shape)
        if left < margin or bottom < margin or right > width - margin or top > height - margin:
            return False
        rows, columns = self._cells(box, margin)
        return not any(layer[rows, columns].any() for layer in (self.edges, self.lines, self.texts))

    def crosses_text(self, points: Iterable[Point]) -> bool:
        """Tell whether a polyline crosses a text."""
        return self._count(self.texts, points) > 0

    def crossings(self, points: Iterable[Point]) -> tuple[int, int]:
        """Count the cells of edges and of other lines that a polyline crosses."""
        points = tuple(points)
        return self._count(self.edges, points), self._count(self.lines, points)

    def _cells(self, box: Box, margin: float) -> tuple[slice, slice]:
        left, bottom, right, top = box
        return (
            slice(max(0, int((bottom - margin) / _CELL_MM)), max(0, math.ceil((top + margin) / _CELL_MM)) + 1),
            slice(max(0, int((left - margin) / _CELL_MM)), max(0, math.ceil((right + margin) / _CELL_MM)) + 1),
        )

    def _mark(self, layer: np.ndarray, points: Iterable[Point]) -> None:
        rows, columns = self._indices(layer, points)
        layer[rows, columns] = True

    def _count(self, layer: np.ndarray, points: Iterable[Point]) -> int:
        rows, columns = self._indices(layer, points)
        return int(layer[rows, columns].sum())

    def _indices(self, layer: np.ndarray, points: Iterable[Point]) -> tuple[np.ndarray, np.ndarray]:
        """Return the cells under a polyline, without those outside the sheet."""
        sampled: list[Array] = []
        for a, b in pairwise(points):
            count = max(2, math.ceil(math.dist(a, b) / (0.7 * _CELL_MM)) + 1)
            sampled.append(np.linspace(a, b, count))
        cells = (np.concatenate(sampled) / _CELL_MM).astype(int) if sampled else np.zeros((0, 2), int)
        columns, rows = cells[:, 0], cells[:, 1]
        inside = (rows >= 0) & (rows < layer.shape[0]) & (columns >= 0) & (columns < layer.shape[1])
        return rows[inside], columns[inside]
