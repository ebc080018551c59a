"""Stub of a hand: the counterpart of a clevis on a bar, on which a finished finger is pinned, bent and held on a bench.

Its knuckle is that of the hand, with a ramp behind the pin: it prints lying on its back, without supports. The strands
of the tendon pass the shoulder in a guide with a rounded mouth, and run in open slots to the end of the bar. A rubber
band from the back of the bone lies around the bar, in one of its pairs of notches, and straightens the finger.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from fingertip.design import Design
from fingertip.design.geometry.conic import TANGENT_STEP_MM
from fingertip.design.geometry.features import Joint
from fingertip.design.geometry.solids import Box, Cone, Prism, Solid, cylinder, difference, intersection, union
from fingertip.design.interfaces.clevis_solids import knuckle, pin_bore, stop_top_y

_BAR_MM, _CHEEK_MM = 60.0, 2.5
"""Length of the bar, and least thickness of the cheeks of its fork [mm]."""
GUIDE_MM, _BACK_MM, _SLACK_MM = 10.0, 3.0, 0.4
"""Length of the guide, its distance behind a shoulder that ends beside the tendon, and its gap around that [mm]."""
_MAX_MOUTH_MM, _MIN_MOUTH_MM, _CHORDS = 1.2, 0.4, 4
"""Radius at which the mouth of the guide is rounded [mm], and chords of its arc."""
_NOTCHES_MM, _NOTCH_MM, _NOTCH_DEPTH_MM = (20.0, 28.0, 36.0), 3.0, 1.5
"""Distances of the notches from the shoulder, their width and depth [mm]."""


@dataclass(frozen=True)
class Guide:
    """Way of the tendon's strands through the stub [mm]."""

    x: tuple[float, ...]
    y: float
    radius: float
    mouth_z: float
    mouth_radius: float


def joint_of(design: Design) -> Joint:
    joint = design.dimensions.joint
    assert joint, "only a clevis has a stub"
    return joint


def guide(design: Design) -> Guide | None:
    """Place the guide in the shoulder, or behind it where no wall is left to its palmar side; None without a tendon."""
    hand, joint = design.hand, joint_of(design)
    if not design.dimensions.anchor:
        return None
    radius = hand.tendon_diameter_mm / 2 + _SLACK_MM
    mouth = min(_MAX_MOUTH_MM, hand.axis_height_mm - hand.tendon_distance_mm - radius - design.printer.min_wall_mm)
    back = 0.0 if mouth >= _MIN_MOUTH_MM else _BACK_MM
    y, z = joint.axis_y - hand.tendon_distance_mm, joint.low_z - back
    return Guide((0.0,), y, radius, z, max(mouth, _MIN_MOUTH_MM))


def bars(design: Design) -> tuple[Box, ...]:
    """Build shoulder and bar, as wide and high as the eyes; the bar is higher behind a shoulder too low for a guide."""
    joint, way, width = joint_of(design), guide(design), design.hand.width_mm
    x = design.dimensions.collar.section.half_width
    half = x if joint.is_fork else max(x, width / 2 + _CHEEK_MM)
    y, low = joint.axis_y - design.hand.axis_height_mm, joint.low_z - _BAR_MM
    shoulder = Box((-half, y, low), (half, stop_top_y(design, joint), joint.low_z))
    if way is None or way.mouth_z == joint.low_z:
        return (shoulder,)
    behind = way.y - way.radius - way.mouth_radius - design.printer.min_wall_mm
    return shoulder, Box((-half, behind, low), (half, joint.axis_y, way.mouth_z))


def without_ways(design: Design) -> Solid:
    joint, (bar, *higher) = joint_of(design), bars(design)
    (half, dorsal, root), y, z, reach = bar.high, joint.axis_y, joint.axis_z, 4 * joint.radius
    # The ramp touches the round of the knuckle at 45 degrees, above the bed on which its back lies.
    at = (joint.radius - TANGENT_STEP_MM) * math.sqrt(0.5)
    run = min(dorsal - y - at, at + joint.radius - TANGENT_STEP_MM)
    corners = ((y, root), (y + at + run, root), (y + at + run, z + at - run), (y + at, z + at), (y, z))
    ramp = Prism("x", corners, -reach, reach)
    near = Box((-half, bar.low[1], root - TANGENT_STEP_MM), (half, dorsal, z + reach))
    whole = union(bar, *higher, intersection(knuckle(design, joint, ramp), near))
    notches = [
        Box((x, y, root - far - _NOTCH_MM), (x + _NOTCH_DEPTH_MM + 1.0, dorsal + 1.0, root - far))
        for far in _NOTCHES_MM
        for x in (half - _NOTCH_DEPTH_MM, -half - 1.0)
    ]
    return difference(whole, pin_bore(joint, half + 1.0), *notches)


def hand_stub(design: Design) -> Solid:
    return difference(without_ways(design), *_ways(design))


def _ways(design: Design) -> Iterator[Solid]:
    """Build what the strands pass: the guide with its mouth, and slots open to the palm on both sides of it."""
    if not (way := guide(design)):
        return
    y, z, radius, mouth = way.y, way.mouth_z, way.radius, way.mouth_radius
    low, high, palmar = z - _BAR_MM - 1.0, z + _BAR_MM, y - _BAR_MM
    angles = [math.pi / 2 * i / _CHORDS for i in range(_CHORDS + 1)]
    arc = [(z - mouth * (1.0 - math.cos(a)), radius + mouth * (1.0 - math.sin(a))) for a in angles]
    for x in way.x:
        yield cylinder("z", (x, y), low, high, radius)
        for (top, wide), (bottom, narrow) in pairwise(arc):
            yield Cone("z", (x, y), bottom, top, narrow, wide)
        for begin, end in ((low, z - GUIDE_MM), (z, high)):
            yield Box((x - radius, palmar, begin), (x + radius, y, end))


def genus(design: Design) -> int:
    """Count the bore, in each cheek of a fork, and the guides."""
    way = guide(design)
    return (1 if joint_of(design).is_fork else 2) + (len(way.x) if way else 0)
