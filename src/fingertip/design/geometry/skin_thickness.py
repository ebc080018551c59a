"""Thickness of the silicone over the bone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from fingertip.foundation.numerics import bisect
from fingertip.models.conic import list_arc_points, quarter_outline

if TYPE_CHECKING:
    from fingertip.design.parameters import Tables
    from fingertip.models.dimensions import Dimensions

_OUTLINE_POINTS = 24
_OUTLINE_CHORDS = 48
"""Points and chords of a quarter of an outline. The sag of a chord is 1e-3 mm on a finger."""

_POINTS = 5
_SURFACE_CHORDS = 20
"""The same, where the slope of the surface counts too."""
_FLAT_SHARES = (0.7, 0.97, 0.99)
"""Sections of the tip, as shares of the way to the end of the flat."""
_STEP_MM = 1e-3
"""Step over which this slope is taken."""

Chord = tuple[float, float, float, float, float]
"""Start (x, y), direction (dx, dy) and squared length of a chord [mm, mm2]."""


@dataclass(frozen=True)
class ThicknessSample:
    """Thickness of the silicone at one point of the bone's outline, in a section across
    the finger.
    """

    thickness_mm: float
    support_mm: float
    """Distance of the surface's nearest chord from the middle of the finger, across the
    silicone.
    """
    is_palmar: bool


def min_skin_thickness(design: Tables, dims: Dimensions) -> float:
    """Compute the minimum skin thickness [mm] in sections.

    Up to the tip, only a crown and a platform bend the outlines, on the palmar side; they bring
    sections of their own. On the tip the skin is thinnest beside the rounded end of the flat.
    """
    inner = dims.bone_outline
    inset = design.mold.core_inset_mm
    join, _, apex = inner.spans[-1].z
    flat_end, _ = bisect(
        lambda z: inner.section.palmar * inner.scale_at(z) > dims.flat_depth,
        join,
        apex,
        halvings=16,
    )
    bends = (*_bends(dims), *(join + share * (flat_end - join) for share in _FLAT_SHARES))
    straight: dict[float, Sequence[bool]] = dict.fromkeys(
        (z for z in bends if z < dims.taper_end_z), (False,)
    )
    straight |= {z: (True, False) for z, _ in inner.stations if z >= 0.0}
    found = [
        sample.thickness_mm
        for z, s in straight.items()
        for sample in skin_thicknesses(dims, z, inset, sides=s)
    ]
    sections: dict[float, Sequence[bool]] = dict.fromkeys(bends, (False,))
    sections |= dict.fromkeys((0.0, join, (join + apex) / 2), (True, False))

    for z, sides in sections.items():
        if dims.outer.palmar_scale_at(z) == 0.0:
            continue  # a crown or a platform of a design that rules refuse may bend past the tip

        # The rates at which both sides of the outer surface narrow, relative to their size there
        # [1/mm].
        dorsal, palmar = (
            (1.0 - scale_at(z + _STEP_MM) / scale_at(z)) / _STEP_MM
            for scale_at in (dims.outer.scale_at, dims.outer.palmar_scale_at)
        )
        for sample in skin_thicknesses(
            dims,
            z=z,
            inset_mm=inset,
            points=_POINTS,
            chords=_SURFACE_CHORDS,
            sides=sides,
        ):
            slope = sample.support_mm * (palmar if sample.is_palmar else dorsal)
            found.append(sample.thickness_mm / math.hypot(1.0, slope))

    return min(*found, design.skin.thickness_tip_mm)


def _bends(dims: Dimensions) -> list[float]:
    """List the heights at which a crown, or the palmar side of the
    bone, bends over the skin's length [mm].
    """
    knots = [span.z[0] for span in dims.outer.spans if dims.crown]
    if dims.platform_half_width_at(dims.sensor_z):
        # Behind the sensor a ramp leads on; ahead of it the platform ends in a half circle,
        # steepest at its end.
        along_radius = (-0.7, 0.0, 0.4, 0.7, 0.9, 0.999)
        knots += [
            *dims.ramp,
            *(dims.sensor_z + share * dims.platform_radius for share in along_radius),
        ]

    return sorted({z for z in knots if 0.0 < z < dims.outer.spans[-1].z[2]})


def skin_thicknesses(
    dims: Dimensions,
    z: float,
    inset_mm: float,
    points: int = _OUTLINE_POINTS,
    chords: int = _OUTLINE_CHORDS,
    sides: Sequence[bool] = (True, False),
) -> Iterator[ThicknessSample]:
    """Sample the silicone over the bone's outline at height z [mm], cut at the palmar flat; one
    side, x >= 0.

    `sides` are those to sample: dorsal (True) and palmar (False).
    """
    outer, outer_scale, palmar_scale = (
        dims.outer.section,
        dims.outer.scale_at(z),
        dims.outer.palmar_scale_at(z),
    )
    inner = dims.bone_outline.section
    inner_scale = dims.bone_outline.scale_at(z)
    width = inner.half_width - inset_mm
    flat = dims.flat_depth - inset_mm

    for dorsal in sides:
        height = (inner.dorsal if dorsal else inner.palmar) - inset_mm
        weight = inner.dorsal_weight if dorsal else inner.palmar_weight
        rise = outer_scale if dorsal else palmar_scale
        surface = [(outer_scale * x, rise * y) for x, y in quarter_outline(outer, dorsal, chords)]
        bone = [
            (inner_scale * width * x, inner_scale * height * y)
            for x, y in list_arc_points(points, weight)
        ]

        if not dorsal:
            # The flat cuts the palmar arc: its edge replaces the points below it.
            edge = inner.half_width_at(-flat, inner_scale)
            bone = [(x, y) for x, y in bone if y < flat]
            bone += [(min(edge, width * inner_scale), flat)] if edge > 0.0 else []
            platform = dims.platform_half_width_at(z)
            if platform:
                bone.append((platform - inset_mm, dims.flat_depth_at(z) - inset_mm))

        polyline = [chord_between(a, b) for a, b in pairwise(surface)]
        for point in bone:
            thickness, (ax, ay, dx, dy, _) = nearest_chord(point, polyline)
            length = math.hypot(dx, dy) or 1.0
            yield ThicknessSample(thickness, (ax * dy - ay * dx) / length, not dorsal)


def chord_between(a: tuple[float, float], b: tuple[float, float]) -> Chord:
    dx = b[0] - a[0]
    dy = b[1] - a[1]
    return (*a, dx, dy, dx * dx + dy * dy)


def nearest_chord(point: tuple[float, float], polyline: list[Chord]) -> tuple[float, Chord]:
    """Distance [mm] to the nearest chord, and that chord: of equally
    near ones the first by its start (x, y).
    """
    px, py = point
    # the square of the distance, which takes less time
    nearest = polyline[0]
    closest = math.inf

    for chord in polyline:
        ax, ay, dx, dy, squared_length = chord
        # Foot of the perpendicular, clamped to the chord.
        t = ((px - ax) * dx + (py - ay) * dy) / squared_length if squared_length else 0.0
        if t < 0.0:
            t = 0.0
        elif t > 1.0:
            t = 1.0
        else:
            t = t

        x = ax + t * dx - px
        y = ay + t * dy - py
        squared = x * x + y * y

        if squared < closest or (squared == closest and chord < nearest):
            nearest = chord
            closest = squared

    return math.sqrt(closest), nearest
