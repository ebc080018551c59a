"""Superconic bodies in closed form: the outer surface of the finger and the outline of the bone.

A cross-section consists of four rational quadratic arcs, one in each quadrant. The arc from (a, 0) to (0, b) has the
control point (a, b) with weight w. The weight w = sqrt(1/2) gives an ellipse, larger weights are squarer and smaller
ones flatter. Along z the whole section is scaled: linearly between stations, then by one more conic to the apex of the
tip, which continues the last straight line without a kink (G1 continuity). The palmar height may have a profile of its
own along z, the crown of a pad: conic arcs that share the parameter, and so the weights, of the scale. NURBS represent
all of these exactly, so that mesh and B-rep evaluate the same surface. Every section widens monotonically towards the
plane y = 0. That is why both halves of a mold parted there pull without an undercut.

Only the math module is used: its results are the same on every processor, while numpy's vector functions differ in the
last bit.

Reference: L. Piegl and W. Tiller, The NURBS Book, 2nd ed., section 7.3 (the quadratic rational Bezier arc).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from fingertip.design.geometry.profile import (
    Crown,
    Parameter,
    Span,
    Tip,
    lay_crown,
    lay_spans,
    palmar_scale,
    tip_control,
)
from fingertip.foundation.numerics import bisect

if TYPE_CHECKING:
    from fingertip.design.parameters.parts import Bone


ELLIPSE = math.sqrt(0.5)


def arc_point(t: Parameter, w: float) -> tuple[Parameter, Parameter]:
    """Return the point at t in [0, 1] of the unit arc from (1, 0) to (0, 1) with control point (1, 1) of weight `w`."""
    u = 1.0 - t
    side, middle, top = u * u, 2.0 * w * u * t, t * t
    d = side + middle + top
    return (side + middle) / d, (top + middle) / d


def arc_abscissa(y: float, w: float) -> float:
    """Return the x of the unit arc at height y in [0, 1], whose X = 1 - x satisfies (y - X)^2 = 4 w^2 X (1 - y)."""
    if y >= 1.0:
        return 0.0
    b = 2.0 * y + 4.0 * w * w * (1.0 - y)
    return 1.0 - 2.0 * y * y / (b + math.sqrt(b * b - 4.0 * y * y))  # the form of the root that does not cancel


def weight_of_fullness(fullness: float) -> float:
    """Return the weight of the arc with a width at y = 1/2, from (x + y - 1)^2 = 4 w^2 (1 - x) (1 - y)."""
    return (fullness - 0.5) / math.sqrt(2.0 * (1.0 - fullness))


class CrossSection(NamedTuple):
    """Cross-section by half width and two half heights [mm], each half with its own arc weight."""

    half_width: float
    palmar: float
    dorsal: float
    palmar_weight: float
    dorsal_weight: float

    def half_width_at(self, y: float, scale: float = 1.0, palmar_scale: float | None = None) -> float:
        """Return the half width [mm] of the section, scaled by `scale`, at height y [mm]; 0 outside it.

        The palmar height is scaled by `palmar_scale` if given.
        """
        return half_width_at(self, y, scale, palmar_scale)

    def dorsal_height_at(self, x: float, scale: float = 1.0) -> float:
        """Return the height y [mm] of the dorsal side, whose arc is symmetric, at x [mm]; 0 outside."""
        return dorsal_height_at(self, x, scale)


def half_width_at(section: CrossSection, y: float, scale: float = 1.0, palmar_scale: float | None = None) -> float:
    """Return the half width of a scaled section at height y [mm]; 0 outside it."""
    half_width, palmar, dorsal, palmar_weight, dorsal_weight = section
    below = scale if palmar_scale is None else palmar_scale
    height, weight = (dorsal * scale, dorsal_weight) if y >= 0 else (palmar * below, palmar_weight)
    if scale <= 0.0 or abs(y) >= height:
        return 0.0
    return scale * half_width * arc_abscissa(abs(y) / height, weight)


def dorsal_height_at(section: CrossSection, x: float, scale: float = 1.0) -> float:
    """Return the height y of the dorsal side of a scaled section at x [mm]; 0 outside it."""
    half_width, _, dorsal, _, weight = section
    if scale <= 0.0 or abs(x) >= half_width * scale:
        return 0.0
    return scale * dorsal * arc_abscissa(abs(x) / (half_width * scale), weight)


def depth_with_width(section: CrossSection, half_width: float) -> float:
    """Return the depth below y = 0 down to which a section has this half width [mm]."""
    return bisect(lambda y: half_width_at(section, -y) >= half_width, 0.0, section[1], halvings=40)[0]


def height_with_width(section: CrossSection, half_width: float, scale: float) -> float:
    """Return the height above y = 0 up to which a scaled section has this half width [mm]."""
    return bisect(lambda y: half_width_at(section, y, scale) >= half_width, 0.0, section[2], halvings=40)[0]


def depth_with_step(outer: CrossSection, inner: CrossSection, step: float, deepest: float) -> float:
    """Return the depth, `deepest` at most, down to which a section stands out of another by a step [mm]."""
    return bisect(lambda y: half_width_at(outer, -y) - half_width_at(inner, -y) >= step, 0.0, deepest, halvings=40)[0]


@dataclass(frozen=True)
class ConicBody:
    """Section that is scaled along z and then closed, flat or by a tip."""

    section: CrossSection
    stations: tuple[tuple[float, float], ...]
    """Heights [mm] and scales between which the section is scaled linearly."""
    tip: Tip | None = None
    crown: Crown | None = None

    @cached_property
    def spans(self) -> tuple[Span, ...]:
        """Pieces of the body along z, from its beginning to the tip's apex."""
        if self.crown and self.tip:
            return lay_crown(self.crown, self.stations, self.tip, self.section.palmar)
        return lay_spans(self.stations, self.tip)

    def palmar_scale_at(self, z: float) -> float:
        """Return the scale of the palmar height at height z [mm]; 0 outside the body."""
        if self.crown is None:
            return self.scale_at(z)
        return palmar_scale(self.spans, z)

    def palmar_height_at(self, x: float, z: float) -> float:
        """Return the height [mm] of the palmar side, positive towards the palm, at (x, z) [mm]; 0 outside it."""
        width = self.section.half_width * self.scale_at(z)
        if abs(x) >= width:
            return 0.0
        return self.palmar_scale_at(z) * self.section.palmar * arc_abscissa(abs(x) / width, self.section.palmar_weight)

    def tip_control(self) -> float:
        """Return the scale of the tip's control point."""
        assert self.tip is not None
        return tip_control(self.stations, self.tip)

    def scale_at(self, z: float) -> float:
        """Return the scale of the section at height z [mm]; 0 outside the body."""
        return scale_at(self.stations, self.tip, z)

    def half_width_at(self, y: float, z: float) -> float:
        """Return the half width [mm] of the body at (y, z) [mm]; 0 outside it."""
        return self.section.half_width_at(y, self.scale_at(z), self.palmar_scale_at(z))

    def dorsal_height_at(self, x: float, z: float) -> float:
        """Return the height y [mm] of the dorsal side at (x, z) [mm]; 0 outside it."""
        return self.section.dorsal_height_at(x, self.scale_at(z))


def scale_at(stations: Sequence[tuple[float, float]], tip: Tip | None, z: float) -> float:
    """Return the scale at height z [mm] between stations, or on a tip after the last one; 0 outside."""
    for (z0, s0), (z1, s1) in pairwise(stations):
        if z0 <= z <= z1 and z0 < z1:
            return s0 + (s1 - s0) * (z - z0) / (z1 - z0)
    z1, s1 = stations[-1]
    if tip is None or not z1 < z < tip[0]:
        return 0.0
    # Barycentric coordinates of the conic satisfy l1^2 = 4 w^2 l0 l2. Here l2 = zeta - l1 and l0 = 1 - zeta.
    zeta = (z - z1) / (tip[0] - z1)
    b = 4.0 * tip[1] ** 2 * (1.0 - zeta)
    l1 = 2.0 * b * zeta / (b + math.sqrt(b * b + 4.0 * b * zeta))
    return (1.0 - zeta) * s1 + l1 * tip_control(stations, tip)


TANGENT_STEP_MM = 0.05
"""Step between a round surface and the flat ones beside it [mm]: tangent ones leave a stray edge in the B-rep solid."""


def offset_section(section: CrossSection, gap_mm: float) -> CrossSection:
    """Enlarge a section: half width and both half heights grow by `gap_mm` [mm]."""
    half_width, palmar, dorsal, *weights = section
    return CrossSection(half_width + gap_mm, palmar + gap_mm, dorsal + gap_mm, *weights)


def inset_body(body: ConicBody, inset: float) -> ConicBody:
    """Shrink section and tip of a body by `inset` [mm]."""
    assert body.tip is not None
    return replace(body, section=offset_section(body.section, -inset), tip=body.tip._replace(z=body.tip.z - inset))


def quarter_outline(section: CrossSection, dorsal: bool, count: int) -> list[tuple[float, float]]:
    """Return `count` + 1 points [mm] of the dorsal or palmar quarter of an outline, from its side; both with y >= 0."""
    height, weight = (section.dorsal, section.dorsal_weight) if dorsal else (section.palmar, section.palmar_weight)
    return [(section.half_width * x, height * y) for x, y in (arc_point(i / count, weight) for i in range(count + 1))]


def farthest_corner(half_width: float, height: float, weight: float, count: int, middle: float = 0.0) -> float:
    """Return the largest distance [mm] of a quarter of an outline, at `count` + 1 points, from (0, `middle`)."""
    points = (arc_point(i / count, weight) for i in range(count + 1))
    return max(math.hypot(half_width * x, height * y - middle) for x, y in points)


def farthest_side(half_width: float, height: float, weight: float, count: int) -> float:
    """Return the largest distance [mm] from the axis of a quarter of an outline, at `count` + 1 heights."""
    heights = (height * i / count for i in range(count + 1))
    return max(math.hypot(half_width * arc_abscissa(y / height, weight), y) for y in heights)


def add_groove(bone: Bone, body: ConicBody) -> ConicBody:
    """Add a groove around the bone; silicone fills it and keeps the skin from slipping off.

    The flanks rise at 45 degrees at the sides or at the back, whichever is wider. Flanks and floor are four more
    stations of the superconic body, so that no boolean is needed and both kernels represent the groove directly.
    """
    if bone.groove_depth_mm == 0.0:
        return body
    groove = bone.groove_distance_mm, bone.groove_depth_mm, bone.groove_width_mm
    radius = max(body.section.half_width, body.section.dorsal)
    stations = lay_groove(body.stations, body.tip, radius, groove)
    return replace(body, stations=stations)


def lay_groove(
    stations: Sequence[tuple[float, float]], tip: Tip | None, radius: float, groove: tuple[float, float, float]
) -> tuple[tuple[float, float], ...]:
    """Lay a groove, by its distance, depth and width, into the taper of a body; its flanks rise at 45 degrees [mm]."""
    (base, (z_a, s_a), (z_b, s_b)), (distance, depth, width) = stations, groove
    taper = (s_a - s_b) / (z_b - z_a)
    rise = 1.0 / radius  # slope of a flank: scale per mm
    z0 = distance + depth
    z1 = z0 + width
    floor = 1.0 - depth * rise
    s0, s1 = (scale_at(stations, tip, z) * floor for z in (z0, z1))
    # Heights at which the lines of the flanks meet the taper s = s_a - taper (z - z_a).
    low = (s0 + rise * z0 - s_a - taper * z_a) / (rise - taper)
    high = (s_a + taper * z_a - s1 + rise * z1) / (rise + taper)
    edges = ((low, s_a - taper * (low - z_a)), (z0, s0), (z1, s1), (high, s_a - taper * (high - z_a)))
    return base, (z_a, s_a), *edges, (z_b, s_b)
