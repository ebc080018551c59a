"""Arcs of sections and profiles along z, the curves of superconic bodies, by plain numbers.

All quantities of a body along z, its scale and the scale of its palmar height, share the parameter
and the weight of a piece. That is why NURBS represent the surface exactly.

Reference: L. Piegl and W. Tiller, The NURBS Book, 2nd ed., section 7.3 (the quadratic rational
Bezier arc).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple, TypeVar

if TYPE_CHECKING:
    from .program_types import Array

_HALVINGS = 40
"""Halvings of a bisection: 1e-12 of its range."""
Parameter = TypeVar("Parameter", float, "Array")
"""Parameter of a curve, or many of them."""

Control = tuple[float, float, float]
"""One coordinate of the three control points of a curve."""

Section = tuple[float, float, float, float, float]
"""Half width, palmar and dorsal height [mm] of a section, and the
weights of its palmar and dorsal arcs.
"""


def arc_point(t: Parameter, w: Parameter | float) -> tuple[Parameter, Parameter]:
    """Return the point at t in [0, 1] of the unit arc from (1, 0) to
    (0, 1) with control point (1, 1) of weight `w`.
    """
    u = 1.0 - t
    side = u * u
    middle = 2.0 * w * u * t
    top = t * t
    d = side + middle + top

    return (side + middle) / d, (top + middle) / d


def arc_abscissa(y: float, w: float) -> float:
    """Return the x of the unit arc at height y in [0, 1], whose X = 1
    - x satisfies (y - X)^2 = 4 w^2 X (1 - y).
    """
    if y >= 1.0:
        return 0.0

    b = 2.0 * y + 4.0 * w * w * (1.0 - y)
    # The form of the root that does not cancel.
    return 1.0 - 2.0 * y * y / (b + math.sqrt(b * b - 4.0 * y * y))


def weight_of_fullness(fullness: float) -> float:
    """Return the weight of the arc with a width at y = 1/2, from
    (x + y - 1)^2 = 4 w^2 (1 - x) (1 - y).
    """
    return (fullness - 0.5) / math.sqrt(2.0 * (1.0 - fullness))


def half_width_at(
    section: Section, y: float, scale: float = 1.0, palmar_scale: float | None = None
) -> float:
    """Return the half width of a scaled section at height y [mm]; 0 outside it."""
    half_width, palmar, dorsal, palmar_weight, dorsal_weight = section
    below = scale if palmar_scale is None else palmar_scale
    height, weight = (dorsal * scale, dorsal_weight) if y >= 0 else (palmar * below, palmar_weight)
    if scale <= 0.0 or abs(y) >= height:
        return 0.0

    return scale * half_width * arc_abscissa(abs(y) / height, weight)


def dorsal_height_at(section: Section, x: float, scale: float = 1.0) -> float:
    """Return the height y of the dorsal side of a scaled section at x [mm]; 0 outside it."""
    half_width, _, dorsal, _, weight = section
    if scale <= 0.0 or abs(x) >= half_width * scale:
        return 0.0

    return scale * dorsal * arc_abscissa(abs(x) / (half_width * scale), weight)


def depth_with_width(section: Section, half_width: float) -> float:
    """Return the depth below y = 0 down to which a section has this half width [mm]."""
    return _last_that_holds(lambda y: half_width_at(section, -y) >= half_width, section[1])


def height_with_width(section: Section, half_width: float, scale: float) -> float:
    """Return the height above y = 0 up to which a scaled section has this half width [mm]."""
    return _last_that_holds(lambda y: half_width_at(section, y, scale) >= half_width, section[2])


def depth_with_step(outer: Section, inner: Section, step: float, deepest: float) -> float:
    """Return the depth, `deepest` at most, down to which a
    section stands out of another by a step [mm].
    """
    return _last_that_holds(
        lambda y: half_width_at(outer, -y) - half_width_at(inner, -y) >= step, deepest
    )


def _last_that_holds(holds: Callable[[float], bool], high: float) -> float:
    """Find by bisection up to where a condition holds, from 0 to `high` at most."""
    low = 0.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:  # the ends are neighbouring floats
            break

        if holds(middle):
            low = middle
        else:
            high = middle

    return low


def farthest_corner(
    half_width: float,
    height: float,
    weight: float,
    count: int,
    middle: float = 0.0,
) -> float:
    """Return the largest distance [mm] of a quarter of an outline,
    at `count` + 1 points, from (0, `middle`).
    """
    points = (arc_point(i / count, weight) for i in range(count + 1))
    return max(math.hypot(half_width * x, height * y - middle) for x, y in points)


def farthest_side(half_width: float, height: float, weight: float, count: int) -> float:
    """Return the largest distance [mm] from the axis of a quarter
    of an outline, at `count` + 1 heights.
    """
    heights = (height * i / count for i in range(count + 1))
    return max(math.hypot(half_width * arc_abscissa(y / height, weight), y) for y in heights)


def scale_at(stations: Sequence[tuple[float, float]], tip: Tip | None, z: float) -> float:
    """Return the scale at height z [mm] between stations, or on
    a tip after the last one; 0 outside.
    """
    z1, s1 = stations[-1]
    if z <= z1:
        for (z0, s0), (z1, s1) in pairwise(stations):
            if z0 <= z <= z1 and z0 < z1:
                return s0 + (s1 - s0) * (z - z0) / (z1 - z0)

        return 0.0

    if tip is None or z >= tip[0]:
        return 0.0

    # Barycentric coordinates of the conic satisfy l1^2 = 4 w^2 l0 l2. Here l2 = zeta - l1 and l0 =
    # 1 - zeta.
    zeta = (z - z1) / (tip[0] - z1)
    b = 4.0 * tip[1] ** 2 * (1.0 - zeta)
    l1 = 2.0 * b * zeta / (b + math.sqrt(b * b + 4.0 * b * zeta))
    return (1.0 - zeta) * s1 + l1 * tip_control(stations, tip)


def lay_groove(
    stations: Sequence[tuple[float, float]],
    tip: Tip | None,
    radius: float,
    groove: tuple[float, float, float],
) -> tuple[tuple[float, float], ...]:
    """Lay a groove, by its distance, depth and width, into the taper of
    a body; its flanks rise at 45 degrees [mm].
    """
    (base, (z_a, s_a), (z_b, s_b)) = stations
    distance, depth, width = groove
    taper = (s_a - s_b) / (z_b - z_a)
    rise = 1.0 / radius  # slope of a flank: scale per mm
    z0 = distance + depth
    z1 = z0 + width
    floor = 1.0 - depth * rise
    s0, s1 = (scale_at(stations, tip, z) * floor for z in (z0, z1))
    # Heights at which the lines of the flanks meet the taper s = s_a - taper (z - z_a).
    low = (s0 + rise * z0 - s_a - taper * z_a) / (rise - taper)
    high = (s_a + taper * z_a - s1 + rise * z1) / (rise + taper)
    edges = (
        (low, s_a - taper * (low - z_a)),
        (z0, s0),
        (z1, s1),
        (high, s_a - taper * (high - z_a)),
    )

    return base, (z_a, s_a), *edges, (z_b, s_b)


def conic_point(t: Parameter, weight: float, *coordinates: Control) -> tuple[Parameter, ...]:
    """Return the point at t in [0, 1] of a rational quadratic curve whose ends have the
    weight one.
    """
    u = 1.0 - t
    side = u * u
    middle = 2.0 * weight * u * t
    top = t * t
    d = side + middle + top

    return tuple([(side * p[0] + middle * p[1] + top * p[2]) / d for p in coordinates])


class Span(NamedTuple):
    """Piece of a body along z: a rational quadratic curve of height z, scale and palmar scale, with
    one weight.

    The weights of both ends are one. A straight piece has its control point in the middle, and the
    weight one.
    """

    z: Control
    scale: Control
    palmar: Control
    weight: float

    @property
    def is_straight(self) -> bool:
        return self.weight == 1.0 and self.z[1] == 0.5 * (self.z[0] + self.z[2])

    def evaluate(self, t: Parameter) -> tuple[Parameter, Parameter, Parameter]:
        """Return height, scale and palmar scale at t in [0, 1]."""
        z, scale, palmar = conic_point(t, self.weight, self.z, self.scale, self.palmar)
        return z, scale, palmar

    def parameter_at(self, z: float) -> float:
        """Return t at a height in the span; r = t / (1 - t) solves
        (z2 - z) r^2 + 2 w (z1 - z) r = z - z0.
        """
        low = z - self.z[0]
        middle = self.weight * (self.z[1] - z)
        high = self.z[2] - z
        root = math.sqrt(middle * middle + low * high)
        if middle >= 0.0:
            return low / (low + middle + root) if low > 0.0 else 0.0

        return (root - middle) / (root - middle + high)


class Tip(NamedTuple):
    z: float
    weight: float


class Crown(NamedTuple):
    """Profile of a pad along z: an arc about its apex, and another one that leads on to a lower,
    straight base.

    Both arcs have the same radius. Towards the tip the arc ends where it has turned by `flank`.
    """

    z: float
    """Height z of the apex [mm], where the palmar scale is 1."""
    radius: float
    drop: float
    """Drop from the apex to the base, relative to the palmar height of the section."""
    flank: float
    """Slope at which the arc ends towards the tip [mm per mm]."""


def lay_spans(stations: Sequence[tuple[float, float]], tip: Tip | None = None) -> tuple[Span, ...]:
    """Lay straight spans between stations (z, scale), and from the last one the conic of a tip."""
    spans = tuple(
        Span((z0, 0.5 * (z0 + z1), z1), (s0, 0.5 * (s0 + s1), s1), (s0, 0.5 * (s0 + s1), s1), 1.0)
        for (z0, s0), (z1, s1) in pairwise(stations)
    )
    if not tip:
        return spans

    z, scale = stations[-1]
    apex, weight = tip
    control = tip_control(stations, tip)
    return (*spans, Span((z, apex, apex), (scale, control, 0.0), (scale, control, 0.0), weight))


def tip_control(stations: Sequence[tuple[float, float]], tip: Tip) -> float:
    """Return the scale of the tip's control point, where the last
    taper line meets the height of the apex.
    """
    (z0, s0), (z1, s1) = stations[-2:]
    return s1 + (s1 - s0) / (z1 - z0) * (tip[0] - z1) if z1 != z0 else s1


def palmar_scale(spans: Sequence[Span], z: float) -> float:
    """Return the scale of the palmar height at height z [mm]; 0 outside the body."""
    for span in spans:
        if span.z[0] <= z <= span.z[2] and z < spans[-1].z[2]:
            (scale,) = conic_point(span.parameter_at(z), span.weight, span.palmar)
            return scale

    return 0.0


_LEAST_SPAN_MM = 1e-3
"""Length below which a piece of a crown is left out, and its neighbour takes its place [mm]."""


def lay_crown(
    crown: Crown, stations: Sequence[tuple[float, float]], tip_at: Tip, height: float
) -> tuple[Span, ...]:
    """Lay the palmar profile of a crown over the scale of a body with one taper and a tip, of a
    palmar height.

    On the taper the arcs are circles: height and palmar scale meet at the tangents' intersection,
    and the weight is the cosine of half the angle. On the tip the weights are those of the scale's
    conic, cut at the end of the crown, so the profile there only continues the tangents.
    """
    apex, radius, drop, slope_at_end = crown
    taper, tip = lay_spans(stations, tip_at)
    begin, _, join = taper.z
    cosine = 1.0 - drop * height / (2.0 * radius)
    # Of the steepest slope between the crown and its base.
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    flank = slope_at_end / math.hypot(1.0, slope_at_end)
    # Knots on the taper: position, and sine of the profile's slope there (rising towards the apex
    # is positive).
    end = apex + radius * flank
    last = end if end < join - _LEAST_SPAN_MM else join
    turned = (apex - last) / radius
    base = max(begin, apex - 2.0 * radius * sine)
    knots = [
        (begin, 0.0),
        (base, 0.0),
        (apex - radius * sine, sine),
        (last, turned),
        (join, turned),
    ]
    low = 1.0 - drop
    spans = []
    z0, sine0 = knots[0]

    for z1, sine1 in knots[1:]:
        if z1 - z0 < _LEAST_SPAN_MM:
            continue

        spans.append(
            _taper_span(
                taper,
                z0=z0,
                z1=z1,
                palmar=low,
                sine0=sine0,
                sine1=sine1,
                height=height,
            )
        )
        z0 = z1
        sine0 = sine1
        low = spans[-1].palmar[2]

    slope = turned / math.sqrt(1.0 - turned**2) / height
    if end > join + _LEAST_SPAN_MM:
        near, tip = _cut(tip, tip.parameter_at(end))
        middle = low + slope * (near.z[1] - near.z[0])
        slope = -slope_at_end / height
        high = middle + slope * (near.z[2] - near.z[1])
        spans.append(near._replace(palmar=(low, middle, high)))
        low = high

    spans.append(tip._replace(palmar=(low, low + slope * (tip.z[1] - tip.z[0]), 0.0)))
    return tuple(spans)


def _taper_span(
    taper: Span,
    z0: float,
    z1: float,
    palmar: float,
    sine0: float,
    sine1: float,
    height: float,
) -> Span:
    """Lay a straight line or an arc of a circle over the taper, from a
    palmar scale and the sines of both slopes.
    """
    cosines = [math.sqrt(1.0 - sine * sine) for sine in (sine0, sine1)]
    slopes = [sine / cosine / height for sine, cosine in zip((sine0, sine1), cosines, strict=True)]

    if sine0 == sine1:
        middle = 0.5 * (z0 + z1)
        weight = 1.0
    else:
        # Tangents from both ends are equally long, r tan(angle / 2), and meet there.
        turn = cosines[0] * cosines[1] + sine0 * sine1  # cosine of the angle
        weight = math.sqrt(0.5 * (1.0 + turn))
        length = (z1 - z0) / (cosines[0] + cosines[1])
        middle = z0 + length * cosines[0]

    begin, _, end = taper.z
    low, _, high = taper.scale
    scale = tuple(low + (high - low) * (z - begin) / (end - begin) for z in (z0, middle, z1))
    rise = slopes[0] * (middle - z0), slopes[1] * (z1 - middle)

    return Span(
        (z0, middle, z1),
        (scale[0], scale[1], scale[2]),
        (palmar, palmar + rise[0], palmar + rise[0] + rise[1]),
        weight,
    )


def _cut(span: Span, t: float) -> tuple[Span, Span]:
    """Cut a span at parameter t (de Casteljau's algorithm in
    homogeneous coordinates); palmar scales are left out.
    """
    w = span.weight
    # weights of the control points of both pieces
    first = 1.0 - t + t * w
    last = (1.0 - t) * w + t
    middle = (1.0 - t) * first + t * last
    pieces: list[list[Control]] = [[], []]

    for a, b, c in (span.z, span.scale):
        left = ((1.0 - t) * a + t * w * b) / first
        right = ((1.0 - t) * w * b + t * c) / last
        point = ((1.0 - t) * first * left + t * last * right) / middle
        pieces[0].append((a, left, point))
        pieces[1].append((point, right, c))

    none = (0.0, 0.0, 0.0)
    root = math.sqrt(middle)
    return (
        Span(pieces[0][0], pieces[0][1], none, first / root),
        Span(pieces[1][0], pieces[1][1], none, last / root),
    )


_MAX_CROWN_SINE = 0.7
"""Sine of the steepest slope between a crown and its base."""
_MIN_BASE_HEIGHT_MM = 1.0
"""Minimum palmar height of the pad at its base, below a crown [mm]."""


def largest_drop(radius: float, apex_z: float, height: float) -> float:
    """Return the largest drop of a crown, by its radius, the height
    z of its apex, and that of the pad [mm].
    """
    reach = 2.0 * radius
    sine = min(_MAX_CROWN_SINE, max(0.0, apex_z / reach)) if reach else 0.0
    return min(reach * (1.0 - math.sqrt(1.0 - sine * sine)), height - _MIN_BASE_HEIGHT_MM)
