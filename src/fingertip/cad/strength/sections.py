"""Properties of a cross-section, from the polygons that bound it.

Areas, first and second moments of polygons follow from Green's theorem (C. Steger, On the calculation of arbitrary
moments of polygons, TU Munich FGBV-96-05, 1996).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fingertip.arrays import Array


@dataclass(frozen=True, eq=False)
class Section:
    """Cross-section of a beam along z; second moments are about its centroid."""

    area_mm2: float
    centroid_mm: tuple[float, float]
    """x and y of the centroid [mm]."""
    second_xx_mm4: float
    """Integral of y^2 [mm4], which resists bending about x."""
    second_yy_mm4: float
    """Integral of x^2 [mm4], which resists bending about y."""
    second_xy_mm4: float
    """Integral of x y [mm4]; 0 for a section that is symmetric to an axis."""
    edge_mm: Array
    """Corners of the outline, (corners, 2), from the centroid [mm]. Bending stress is largest at one of them."""

    @cached_property
    def inverse_second_per_mm4(self) -> Array:
        """Inverse of the matrix of second moments, (2, 2) [1/mm4]."""
        xx, yy, xy = self.second_xx_mm4, self.second_yy_mm4, self.second_xy_mm4
        return np.array([[xx, -xy], [-xy, yy]]) / (xx * yy - xy * xy)


def measure_section(polygons: Sequence[Array]) -> Section | None:
    """Measure a section bounded by polygons: outlines counter-clockwise, holes clockwise. None if it has no area."""
    area = sx = sy = xx = yy = xy = 0.0
    for polygon in polygons:
        x, y = polygon[:, 0], polygon[:, 1]
        u, v = np.roll(x, -1), np.roll(y, -1)
        cross = x * v - u * y
        area += float(cross.sum()) / 2
        sx += float(((x + u) * cross).sum()) / 6
        sy += float(((y + v) * cross).sum()) / 6
        xx += float(((y * y + y * v + v * v) * cross).sum()) / 12
        yy += float(((x * x + x * u + u * u) * cross).sum()) / 12
        xy += float(((x * v + 2 * x * y + 2 * u * v + u * y) * cross).sum()) / 24
    if area <= 0.0:
        return None
    cx, cy = sx / area, sy / area
    corners = np.concatenate([np.asarray(polygon, dtype=np.float64) for polygon in polygons]) - [cx, cy]
    return Section(area, (cx, cy), xx - area * cy * cy, yy - area * cx * cx, xy - area * cx * cy, corners)
