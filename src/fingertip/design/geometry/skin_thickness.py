"""Thickness of the silicone over the bone in a cross-section: the distance between the two outlines."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from fingertip.design.geometry.conic import CrossSection, arc_point

if TYPE_CHECKING:
    from fingertip.design.geometry.dimensions import Dimensions

_POINTS, _CHORDS = 24, 48
"""Points and chords of a quarter of an outline. The sag of a chord is 1e-3 mm on a finger."""

Chord = tuple[float, float, float, float, float]
"""Start (x, y), direction (dx, dy) and squared length of a chord [mm, mm2]."""


@dataclass(frozen=True)
class ThicknessSample:
    """Thickness of the silicone at one point of the bone's outline, in a section across the finger."""

    thickness_mm: float
    x: float
    """First component of the unit vector from the bone to the nearest point of the surface."""
    y: float
    """Second component of that vector."""
    support_mm: float
    """Distance of the surface's nearest chord from the middle of the finger, along that vector."""
    bone_x: float
    bone_y: float
    """The point of the bone's outline."""


def min_skin_thickness(dims: Dimensions, inset_mm: float) -> float:
    """Compute the minimum skin thickness [mm] over the straight part of the finger.

    Both outlines shrink linearly between the section where the skin begins and the one where its tip begins, so that no
    section in between is thinner. The tip is left to the check of the solids, which covers all three dimensions.
    """
    heights = (z for z, _ in dims.bone_outline.stations if z >= 0.0)
    return min(sample.thickness_mm for z in heights for sample in skin_thicknesses(dims, z, inset_mm))


def skin_thicknesses(
    dims: Dimensions, z: float, inset_mm: float, points: int = _POINTS, chords: int = _CHORDS
) -> Iterator[ThicknessSample]:
    """Sample the silicone over the bone's outline at height z [mm], cut at the palmar flat; one side, x >= 0."""
    outer, outer_scale = dims.outer.section, dims.outer.scale_at(z)
    inner, inner_scale = dims.bone_outline.section, dims.bone_outline.scale_at(z)
    width, flat = inner.half_width - inset_mm, dims.flat_depth - inset_mm
    for dorsal in (True, False):
        height = (inner.dorsal if dorsal else inner.palmar) - inset_mm
        weight = inner.dorsal_weight if dorsal else inner.palmar_weight
        surface = [(outer_scale * x, outer_scale * y) for x, y in quarter_outline(outer, dorsal, chords)]
        bone = [
            (inner_scale * width * x, inner_scale * height * y)
            for x, y in (arc_point(i / points, weight) for i in range(points + 1))
        ]
        if not dorsal:
            # The flat cuts the palmar arc: its edge replaces the points below it.
            edge = inner.half_width_at(-flat, inner_scale)
            bone = [(x, y) for x, y in bone if y < flat]
            bone += [(min(edge, width * inner_scale), flat)] if edge > 0.0 else []
        polyline = [_chord(a, b) for a, b in pairwise(surface)]
        for point in bone:
            thickness, (ax, ay, dx, dy, _) = _nearest_chord(point, polyline)
            length = math.hypot(dx, dy) or 1.0
            x, y = dy / length, -dx / length
            side = 1.0 if dorsal else -1.0
            yield ThicknessSample(thickness, x, side * y, ax * x + ay * y, point[0], side * point[1])


def quarter_outline(section: CrossSection, dorsal: bool, count: int) -> list[tuple[float, float]]:
    """Return `count` + 1 points [mm] of the dorsal or palmar quarter of an outline, from its side; both with y >= 0."""
    height, weight = (section.dorsal, section.dorsal_weight) if dorsal else (section.palmar, section.palmar_weight)
    return [(section.half_width * x, height * y) for x, y in (arc_point(i / count, weight) for i in range(count + 1))]


def _chord(a: tuple[float, float], b: tuple[float, float]) -> Chord:
    dx, dy = b[0] - a[0], b[1] - a[1]
    return (*a, dx, dy, dx * dx + dy * dy)


def _nearest_chord(point: tuple[float, float], polyline: list[Chord]) -> tuple[float, Chord]:
    """Distance [mm] to the nearest chord, and that chord: of equally near ones the first by its start (x, y)."""
    px, py = point
    nearest, closest = polyline[0], math.inf
    for chord in polyline:
        ax, ay, dx, dy, squared_length = chord
        # Foot of the perpendicular, clamped to the chord.
        t = ((px - ax) * dx + (py - ay) * dy) / squared_length if squared_length else 0.0
        t = 0.0 if t < 0.0 else 1.0 if t > 1.0 else t
        distance = math.hypot(ax + t * dx - px, ay + t * dy - py)
        if distance < closest or (distance == closest and chord < nearest):
            nearest, closest = chord, distance
    return closest, nearest
