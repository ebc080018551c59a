"""Sections across the finger at many heights z at once: outlines of skin and core, and the distance
between both.

An array of points holds x and the distance from the parting plane |y| [mm], then a row for each
section. The formulas are those of `fingertip.models.profile`, over arrays.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from fingertip.models.profile import arc_point

if TYPE_CHECKING:
    from fingertip.design.parameters import Tables
    from fingertip.foundation.numerics import Array
    from fingertip.models.conic import ConicBody, CrossSection
    from fingertip.models.dimensions import Dimensions

_LEAST = 1e-300
"""Least divisor: it stands for the size of a section that is a point."""
_RIM_ANGLES = [math.pi * (i / 64 - 0.5) for i in range(65)]
_RIM = [(math.cos(angle), math.sin(angle)) for angle in _RIM_ANGLES]
"""Points (x, z) of a half circle at which the flat's margin around the sensor is sampled."""


@dataclass(frozen=True)
class Quarters:
    """Quarters of sections through skin and core, x >= 0: the dorsal ones at some heights z [mm],
    then the palmar ones at others.
    """

    dims: Dimensions
    inset: float
    """Distance of the core's outline from the bone's [mm]."""
    dorsal: Sequence[float]
    palmar: Sequence[float]

    @cached_property
    def heights(self) -> Sequence[float]:
        return (*self.dorsal, *self.palmar)

    @cached_property
    def sides(self) -> list[int]:
        """0 for each dorsal quarter, 1 for each palmar one."""
        return [0] * len(self.dorsal) + [1] * len(self.palmar)

    @cached_property
    def surface_rises(self) -> Array:
        """Scales of the height of the skin's outer surface."""
        import numpy as np  # noqa: PLC0415

        outer = self.dims.outer
        dorsal = map(outer.scale_at, self.dorsal)
        return np.array([*dorsal, *map(outer.palmar_scale_at, self.palmar)])

    @cached_property
    def surface_half_axes(self) -> Array:
        """Half width and height of the skin's outer surface [mm]."""
        import numpy as np  # noqa: PLC0415

        outer = self.dims.outer
        scales = np.array((scales_at(outer, self.heights), self.surface_rises))
        return self._half_axes(outer.section) * scales

    def surface(self, chords: int) -> Array:
        """Return points of the skin's outer surface, from its side: the ends of chords."""
        return self._list_arcs(self.dims.outer.section, self.surface_half_axes, chords)

    @cached_property
    def core_scales(self) -> Array:
        return scales_at(self.dims.bone_outline, self.heights)

    @cached_property
    def core_half_axes(self) -> Array:
        """Half width and height of the core without its flat [mm]."""
        return (self._half_axes(self.dims.bone_outline.section) - self.inset) * self.core_scales

    @cached_property
    def flat_edges(self) -> Array:
        """Edge of the core's flat, a point for each section; the end of the outline without one."""
        import numpy as np  # noqa: PLC0415

        flat = self.dims.flat_depth - self.inset
        half_width, height = self.core_half_axes
        scales = self.core_scales
        cut = half_widths_at(self.dims.bone_outline.section, -flat, scales, scales)
        is_cut = (cut > 0.0) & np.array(self.sides, dtype=bool)
        x = np.where(is_cut, np.minimum(cut, half_width), 0.0)

        return np.array((x, np.where(is_cut, flat, height)))

    @cached_property
    def platform_edges(self) -> Array:
        """Edge of the bone's platform or ramp, a point for each section; x = 0 without one."""
        import numpy as np  # noqa: PLC0415

        dims = self.dims
        half_widths = [dims.platform_half_width_at(z) for z in self.palmar]
        depths = [dims.flat_depth_at(z) for z in self.palmar]
        without = [0.0] * len(self.dorsal)
        return np.array(([*without, *half_widths], [*without, *depths]))

    def core(self, points: int) -> Array:
        """Return points of the core's outline, from its side: the edge of the flat replaces those
        below it.
        """
        import numpy as np  # noqa: PLC0415

        arc = self._list_arcs(self.dims.bone_outline.section, self.core_half_axes, points)
        edge = self.flat_edges[..., None]
        return np.where(arc[1] < edge[1], arc, edge)

    def _half_axes(self, section: CrossSection) -> Array:
        """Return half width and height of a section for each quarter [mm]."""
        import numpy as np  # noqa: PLC0415

        widths = (section.half_width, section.half_width)
        return np.array((widths, (section.dorsal, section.palmar)))[:, self.sides]

    def _list_arcs(self, section: CrossSection, half_axes: Array, count: int) -> Array:
        """Return `count` + 1 points of an arc for each quarter, at equal steps of its parameter."""
        import numpy as np  # noqa: PLC0415

        weights = np.array((section.dorsal_weight, section.palmar_weight))
        arcs = arc_point(np.arange(count + 1) / count, weights[:, None])
        return half_axes[..., None] * np.array(arcs)[:, self.sides]


def scales_at(body: ConicBody, heights: Sequence[float]) -> Array:
    """Return the scales of a body's sections at heights z [mm]; 0 outside it."""
    import numpy as np  # noqa: PLC0415

    scales = {z: body.scale_at(z) for z in set(heights)}
    return np.array([scales[z] for z in heights])


def half_widths_at(section: CrossSection, y: float, scales: Array, palmar_scales: Array) -> Array:
    """Return the half widths of a scaled section at height y [mm]; 0 outside it.

    It is the counterpart of `CrossSection.half_width_at` and of `arc_abscissa`.
    """
    import numpy as np  # noqa: PLC0415

    if y >= 0.0:
        height = section.dorsal * scales
        w = section.dorsal_weight
    else:
        height = section.palmar * palmar_scales
        w = section.palmar_weight

    share: Array = abs(y) / np.maximum(height, abs(y) or _LEAST)
    b = 2.0 * share + 4.0 * w * w * (1.0 - share)
    x = 1.0 - 2.0 * share * share / (b + np.sqrt(b * b - 4.0 * share * share))
    return scales * section.half_width * x


def half_widths_along(body: ConicBody, y: float, heights: Sequence[float]) -> Array:
    """Return the half widths of a body at height y and heights z [mm]; 0 outside it."""
    import numpy as np  # noqa: PLC0415

    scales = scales_at(body, heights)
    palmar = np.array([body.palmar_scale_at(z) for z in heights]) if body.crown else scales
    return half_widths_at(body.section, y, scales, palmar)


def sensor_rim_margin(design: Tables, dims: Dimensions) -> float:
    """Compute the least margin along x [mm] between the flat's edge and the circle of sensor head
    and rim.
    """

    r = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm + design.bone.rim_mm
    heights = [dims.sensor_z + r * z for _, z in _RIM]
    flat = half_widths_along(dims.bone_outline, -dims.platform_depth, heights)

    return float((flat - [r * x for x, _ in _RIM]).min())


def measure_gaps(points: Array, surface: Array) -> tuple[Array, Array]:
    """Measure the distance of each point from its section's surface, and that of the nearest chord
    from the middle of the finger, across the gap [mm].

    A convex outline bounds the half planes x n_x + y n_y <= h, one for each chord in
    counter-clockwise order. A point within it is h - x n_x - y n_y from each. Bones that rules
    refuse reach beyond it.
    """
    import numpy as np  # noqa: PLC0415

    ax, ay = surface[..., :-1]
    dx, dy = surface[..., 1:] - surface[..., :-1]
    length = np.maximum(np.sqrt(dx * dx + dy * dy), _LEAST)
    nx = dy / length
    ny = -dx / length
    h = ax * nx + ay * ny
    px, py = points[..., None]
    distances = h[:, None] - px * nx[:, None] - py * ny[:, None]
    if distances.min() < 0.0 or np.any(points.min(axis=2) < surface.min(axis=2)):
        distances = _measure_to_chords(points, surface)

    nearest = distances.argmin(axis=2)
    row = np.arange(len(nearest))[:, None]
    column = np.arange(nearest.shape[1])
    return distances[row, column, nearest], h[row, nearest]


def _measure_to_chords(points: Array, surface: Array) -> Array:
    """Measure the distance of each point from each chord, between its ends [mm]."""
    import numpy as np  # noqa: PLC0415

    px, py = points[..., None]
    ax, ay = starts = surface[:, :, None, :-1]
    dx, dy = surface[:, :, None, 1:] - starts
    # Foot of the perpendicular, clamped to the chord.
    t = ((px - ax) * dx + (py - ay) * dy) / np.maximum(dx * dx + dy * dy, _LEAST)
    t = t.clip(0.0, 1.0)
    x = ax + t * dx - px
    y = ay + t * dy - py

    distances: Array = np.sqrt(x * x + y * y)
    return distances
