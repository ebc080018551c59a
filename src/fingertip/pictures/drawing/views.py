"""Views of a part: how each looks at it, and what projection and section give.

First-angle projection (ISO 5456-2). The front view looks at the finger from its side at -x, with distal to the right
and dorsal up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from fingertip.design.geometry.sizes import ViewName
from fingertip.design.geometry.solids import Point3
from fingertip.pictures.drawing.primitives import Point

Line2: TypeAlias = tuple[Point, ...]


@dataclass(frozen=True)
class Projection:
    """Directions of a view in the frame of the part: to the right and up on paper."""

    right: Point3
    up: Point3

    @property
    def towards(self) -> Point3:
        """Direction to the observer."""
        (a, b, c), (d, e, f) = self.right, self.up
        return b * f - c * e, c * d - a * f, a * e - b * d

    def flatten(self, point: Point3) -> Point:
        """Project a point [mm]."""
        return _dot(point, self.right), _dot(point, self.up)


def _dot(a: Point3, b: Point3) -> float:
    return sum(p * q for p, q in zip(a, b, strict=True))


PROJECTIONS: dict[ViewName, Projection] = {
    "front": Projection((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "dorsal": Projection((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
    "palmar": Projection((0.0, 0.0, 1.0), (-1.0, 0.0, 0.0)),
    "end": Projection((-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    "section": Projection((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
}
"""Views by name. `end` looks at the proximal end; `section` is the half at x > 0 behind the middle plane."""


@dataclass(frozen=True)
class ProjectedView:
    """Edges of a part in a view [mm], without hidden ones in a section, and the outline of what a section cuts."""

    visible: tuple[Line2, ...]
    hidden: tuple[Line2, ...]
    cut: tuple[Line2, ...] = ()
    """Closed outlines of the cut faces."""

    def bounds(self) -> tuple[float, float, float, float]:
        """Return left, bottom, right and top."""
        xs, ys = zip(*(point for edge in self.visible for point in edge), strict=True)
        return min(xs), min(ys), max(xs), max(ys)
