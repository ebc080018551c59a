"""Outlines of extruded solids and corners of prisms, by plain numbers: feet, ramps, eyes, horns and
belts.

Feet are the fillets where a thin part of the bone stands on a wider one, drawn as chords of an arc.
The chords run on into the solids on both sides, so that no faces coincide.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from .solids import Axis, Box, Cone, Prism, Solid, union

_CHORDS = 6
"""Chords of a quarter of a circle: the surface bends by 15 degrees at most."""
LEDGE_MM = 0.7
"""Ledge that prints over air without supports [mm]."""
_INTO_MM = 0.1
"""Length by which a foot reaches into the thin part [mm]."""
TANGENT_STEP_MM = 0.05
"""Step between a round surface and the flat ones beside it [mm]:
tangent ones leave a stray edge in the B-rep solid.
"""
PAST_MM = 1.0
"""Length by which cuts reach past the face in which they open, and
solids into those on which they stand [mm].
"""
MATING_PLAY_MM = 0.2
"""Play between an interface and a printed mating part [mm]. A recommendation."""
RAMP_SLOPE = 0.4
"""Slope of the ramp from the platform down to the flat [mm per mm],
which the sensor's film follows. An assumption.
"""
_HORN_CHORDS = 12
"""Chords of a horn's quarter circle."""


def signed_area(ring: Sequence[tuple[float, float]]) -> float:
    """Compute the signed area of a ring by the shoelace formula;
    positive if it runs counter-clockwise.
    """
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise([*ring, ring[0]])) / 2


def foot_line(
    radius_mm: float, root: float, way: float, reach: float = 0.0
) -> list[tuple[float, float]]:
    """List points (z, outward) of the arc, from the thin part to the root; the wide part lies
    towards `way` [mm].

    With a `reach`, half of the arc and 45 degrees from there on up to it, which prints without
    supports.
    """
    angles = [math.pi / 2 * i / _CHORDS for i in range((_CHORDS // 2 if reach else _CHORDS) + 1)]
    below = foot_length(radius_mm, reach) - radius_mm
    arc = [
        (root - way * (below + radius_mm * (1.0 - math.sin(a))), radius_mm * (1.0 - math.cos(a)))
        for a in angles
    ]
    (z0, out0), (z1, out1) = arc[:2]
    top = [(root, reach)] if reach else []

    return [(z0 - way * _INTO_MM, out0 - _INTO_MM * (out1 - out0) / abs(z1 - z0)), *arc[1:], *top]


def foot_length(radius_mm: float, reach: float) -> float:
    return reach + radius_mm * (math.sqrt(2.0) - 1.0) if reach else radius_mm


def round_foot(
    centre: tuple[float, float], thin_radius: float, line: list[tuple[float, float]], top: float
) -> Solid:
    """Build the foot of a round post along z, whose wide part
    lies distal to it; it ends at `top` [mm].
    """
    cones = []
    for (low, inner), (high, outer) in pairwise(line):
        slope = (outer - inner) / (high - low)
        begin = low - _INTO_MM / 2
        radii = (thin_radius + inner + slope * (z - low) for z in (begin, top))
        cones.append(Cone("z", centre, begin, top, *radii))

    return union(*cones)


def flat_foot(
    axis: Axis,
    low_side: float,
    high_side: float,
    foot: list[tuple[float, float]],
    end: float,
    reach: float,
) -> Solid:
    """Build the foot of flats along an axis across the finger,
    between two sides [mm]; it ends at z = `end`.
    """
    outline = [*foot, (end, foot[-1][1])]
    ring = [(z, low_side - out) for z, out in outline] + [
        (z, high_side + out) for z, out in reversed(outline)
    ]
    return extrude(axis, ring, -reach, reach)


def ramp_depth(z: float, flat: float, platform: float, end: float) -> float:
    """Return the depth at z of a flat, of the ramp that rises from it
    up to a height `end`, or of a platform [mm].
    """
    return max(flat, platform - RAMP_SLOPE * max(0.0, end - z))


def ramp_slab(
    y: tuple[float, float],
    half_width: float,
    z: tuple[float, float],
    depths: tuple[float, float],
    ramp: tuple[float, float],
) -> Solid:
    """Build a slab between two distances y from a flat and from
    the platform to which a ramp leads [mm].
    """
    low, high = y
    begin, end = z
    flat, platform = depths
    knots = [each for each in ramp if platform > flat and begin < each < end]
    line = [(-ramp_depth(each, flat, platform, ramp[1]), each) for each in (begin, *knots, end)]
    if not knots:
        return Box((-half_width, line[0][0] + low, begin), (half_width, line[0][0] + high, end))

    corners = [(at + high, each) for at, each in line] + [
        (at + low, each) for at, each in reversed(line)
    ]
    return Prism("x", tuple(corners), -half_width, half_width)


def ramp_angle_deg(radius: float, eye_radius: float, travel_deg: float) -> float:
    """Return the angle about the pin along which an eye rises
    from its own radius to that of a stop.
    """
    return min(math.degrees(math.acos(eye_radius / radius)), travel_deg) / 2


def eye_corners(
    axis: tuple[float, float],
    radius: float,
    eye_radius: float,
    travel_deg: float,
    reach: float,
) -> tuple[tuple[float, float], ...]:
    """Return the corners (y, z) of an eye between its stops, counter-clockwise, without the arc
    about the pin [mm].

    In the frame of the bone the hand's shoulder turns about the pin towards the palmar side while
    the finger bends. The dorsal edge is the shoulder of the straight finger, the palmar one that at
    the end of the travel. What lies between them never meets the shoulder on the way: the outline
    is convex at the stops, and nearer to the pin on the ramps.
    """
    angle = math.radians(travel_deg)
    ramp = math.radians(ramp_angle_deg(radius, eye_radius, travel_deg))
    foot = (-radius * math.sin(angle), -radius * math.cos(angle))
    along = min(reach, reach / math.sin(angle))
    far = (foot[0] - along * math.cos(angle), foot[1] + along * math.sin(angle))
    inside = eye_radius - TANGENT_STEP_MM
    ramps = [(-inside * math.sin(at), -inside * math.cos(at)) for at in (angle - ramp, ramp)]
    dorsal = ((0.0, -radius), (reach, -radius), (reach, reach))
    corners = (*dorsal, (far[0], reach), far, foot, ramps[0], (0.0, 0.0), ramps[1])

    return tuple((axis[0] + y, axis[1] + z) for y, z in corners)


def horn_corners(
    begin: tuple[float, float], radius: float, z: tuple[float, float], reach: float
) -> tuple[tuple[float, float], ...]:
    """List corners (y, z) below a horn, the quarter of a circle on
    which the tendon turns from `begin` on [mm].
    """
    y = begin[0] + radius
    angles = [math.pi / 2 * i / _HORN_CHORDS for i in range(_HORN_CHORDS + 1)]
    arc = [(y - radius * math.cos(a), begin[1] + radius * math.sin(a)) for a in angles]

    return (-reach, z[0]), (begin[0], z[0]), *arc, (y, z[1]), (-reach, z[1])


def extrude(axis: Axis, outline: Sequence[tuple[float, float]], low: float, high: float) -> Prism:
    """Extrude an outline, given by heights z and distances
    across in either direction, along x or y.
    """
    ring = tuple(outline) if axis == "y" else tuple((across, z) for z, across in outline)
    return Prism(axis, ring if signed_area(ring) > 0.0 else ring[::-1], low, high)


def belt_seat(
    axis: Axis,
    face: float,
    z: float,
    size: tuple[float, float],
    far: float,
) -> Prism:
    """Build the seat of a band in a face of the cup, by its height and depth."""
    inner = face - math.copysign(size[1], face)
    outer = face + math.copysign(PAST_MM, face)
    low = size[0] / 2
    high = size[0] / 2 + size[1] + PAST_MM

    return extrude(
        axis, ((z - high, outer), (z - low, inner), (z + low, inner), (z + high, outer)), -far, far
    )
