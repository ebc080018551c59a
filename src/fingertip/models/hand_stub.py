"""Stub of a hand: the counterpart of a clevis on a bar, printed without supports.

Its knuckle is that of the hand, with a ramp behind the pin: it prints lying on its back. The
strands of the tendon run in slots to a guide with a rounded mouth, and on to the end of the bar. A
rubber band from the back of the bone lies around the bar, in one of its pairs of notches, and
straightens the finger.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from .allowances import TANGENT_STEP_MM
from .clevis import knuckle, stop_top_y
from .joint import Joint, joint_of
from .solids import Box, Cone, Prism, Solid, cylinder

if TYPE_CHECKING:
    from .program_types import Finger

LOOSE_MM = 0.1
"""Difference in radius by which a tongue's bore is wider than the bone's [mm]."""
BAR_MM = 50.0
_CHEEK_MM = 2.5
"""Length of the bar, and least thickness of the cheeks of its fork [mm]."""
GUIDE_MM = 10.0
_BACK_MM = 3.0
_SLACK_MM = 0.7
"""Length of the guide, its distance behind the shoulder, and its gap around the tendon [mm]."""
MOUTH_MM = 1.2
_CHORDS = 4
"""Radius at which the mouth of the guide is rounded [mm], and chords of its arc."""
NOTCHES_MM = (26.0, 34.0)
BAND_NOTCH_MM = 3.0
NOTCH_DEPTH_MM = 1.5
"""Distances of the notches from the shoulder, their width and depth [mm]."""


@dataclass(frozen=True)
class Guide:
    """Way of the tendon's strands through the stub [mm]."""

    x: tuple[float, ...]
    y: float
    radius: float
    mouth_z: float


def guide(finger: Finger) -> Guide | None:
    """Place the guide behind the shoulder, whose palmar side may lie beside the tendon; None
    without a tendon.
    """
    anchor = finger.dimensions.anchor
    if not anchor:
        return None

    strands = (-anchor.strand_x, anchor.strand_x)
    return Guide(strands, anchor.y, anchor.line / 2 + _SLACK_MM, joint_of(finger).low_z - _BACK_MM)


def bars(finger: Finger) -> tuple[Box, Box]:
    """Build shoulder and bar: as wide and high as the eyes, and as the walls of the guide need."""
    joint = joint_of(finger)
    way = guide(finger)
    wall = finger.printer.min_wall_mm
    half = max(finger.dimensions.collar.section.half_width, finger.hand.width_mm / 2 + _CHEEK_MM)
    palmar = joint.axis_y - finger.hand.axis_height_mm
    dorsal = stop_top_y(finger, joint)
    root = joint.low_z
    low = joint.low_z - BAR_MM
    behind = palmar
    begin = joint.low_z

    if way:
        half = max(half, way.x[-1] + way.radius + MOUTH_MM + wall)
        begin = way.mouth_z
        behind = min(palmar, way.y - way.radius - MOUTH_MM - wall)

    return Box((-half, palmar, begin - 1.0), (half, dorsal, root)), Box(
        (-half, behind, low), (half, dorsal, begin)
    )


def without_ways(finger: Finger) -> Solid:
    joint = joint_of(finger)
    shoulder, bar = bars(finger)
    half, dorsal, root = shoulder.high
    y = joint.axis_y
    z = joint.axis_z
    reach = 4 * joint.radius
    # The ramp touches the round of the knuckle at 45 degrees, above the bed on which its back lies.
    at = (joint.radius - TANGENT_STEP_MM) * math.sqrt(0.5)
    run = min(dorsal - y - at, at + joint.radius - TANGENT_STEP_MM)
    corners = (
        (y, root),
        (y + at + run, root),
        (y + at + run, z + at - run),
        (y + at, z + at),
        (y, z),
    )
    ramp = Prism("x", corners, -reach, reach)
    near = Box((-half, shoulder.low[1], root - TANGENT_STEP_MM), (half, dorsal, z + reach))
    whole = bar.union(shoulder, knuckle(finger, joint, ramp).intersect(near))
    notches = [
        Box(
            (x, y, root - far - BAND_NOTCH_MM), (x + NOTCH_DEPTH_MM + 1.0, dorsal + 1.0, root - far)
        )
        for far in NOTCHES_MM
        for x in (half - NOTCH_DEPTH_MM, -half - 1.0)
    ]
    bore = cylinder(
        "x",
        centre=(joint.axis_y, joint.axis_z),
        low=-half - 1.0,
        high=half + 1.0,
        radius=stub_bore_radius(joint),
    )

    return whole.cut(bore, *notches)


def stub_bore_radius(joint: Joint) -> float:
    """Radius of the stub's bore: the pin wedges in a cheek, and turns in the tongue between both
    [mm].
    """
    return joint.pin_radius + (LOOSE_MM if joint.is_fork else 0.0)


def hand_stub(finger: Finger) -> Solid:
    r"""Build the stub of the hand.

    Seen from the side, back up, tip of the finger to the right:

           ____    ______________________
          |    |__|                      |\
          |   notches of the band        |  \ .---.
          |                              |   ( pin )   knuckle
          |    ________                  |    '---'
          |===|  guide |=================|             slots of the strands, way.y
          |____________|_________________|
          |<--------- BAR_MM ----------->|
    """
    return without_ways(finger).cut(*_ways(finger))


def _ways(finger: Finger) -> Iterator[Solid]:
    """Build what the strands pass: the guide with its mouth, and slots open to the palm on both
    sides of it.
    """
    way = guide(finger)
    if not way:
        return

    y = way.y
    z = way.mouth_z
    radius = way.radius
    low = z - BAR_MM - 1.0
    high = z + BAR_MM
    palmar = y - BAR_MM
    angles = [math.pi / 2 * i / _CHORDS for i in range(_CHORDS + 1)]
    arc = [
        (z - MOUTH_MM * (1.0 - math.cos(a)), radius + MOUTH_MM * (1.0 - math.sin(a)))
        for a in angles
    ]

    for x in way.x:
        yield cylinder(
            "z",
            centre=(x, y),
            low=low,
            high=high,
            radius=radius,
        )
        for (top, wide), (bottom, narrow) in pairwise(arc):
            yield Cone(
                axis="z",
                centre=(x, y),
                low=bottom,
                high=top,
                low_radius=narrow,
                high_radius=wide,
            )

        for begin, end in ((low, z - GUIDE_MM), (z, high)):
            yield Box((x - radius, palmar, begin), (x + radius, y, end))
