"""Parts that hold a finger, printed without supports: the stand of a post, the pin of a joint and
the stub of a hand.

The stand is a bar with a socket, in which the cross bolt holds the post. Either of its flat sides
lies on the table: the pad looks up. So it lies on the printer's bed, unless its socket is too wide
for a bridge.

A printed pin prints standing. It stands out of the eyes, to be pushed out.

The stub is the counterpart of a clevis on a bar. Its knuckle is that of the hand, with a ramp
behind the pin: it prints lying on its back. The strands of the tendon run in slots to a guide with
a rounded mouth, and on to the end of the bar. A rubber band from the back of the bone lies around
the bar, in one of its pairs of notches, and straightens the finger.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from fingertip.design import Design
from fingertip.design.geometry.joint import Joint
from fingertip.design.geometry.outlines import TANGENT_STEP_MM
from fingertip.design.geometry.solids import (
    Box,
    Cone,
    Prism,
    Solid,
    cylinder,
    difference,
    intersection,
    union,
)
from fingertip.design.interfaces.clevis_solids import knuckle, stop_top_y
from fingertip.design.interfaces.interface import MATING_PLAY_MM, middle_y
from fingertip.design.interfaces.rigid import Post

_WALL_MM = 2.4
_ABOVE_FLOOR_MM = 0.5
_BELOW_FILLET_MM = 0.3
_HANDLE_MM = 26.0
"""Wall beside the post, room below it, gap below the fillet at its
root, and length below its socket [mm].
"""


def post_gap_mm(design: Design) -> float:
    """Return the gap beside the post in the design: what the print's
    errors leave of it is half the mating play.
    """
    return MATING_PLAY_MM / 2 + design.printer.surface_error_mm + max(0.0, design.printer.offset_mm)


def stand_outline(design: Design) -> Box:
    bone = design.bone
    around = post_gap_mm(design) + _WALL_MM
    x = bone.post_width_mm / 2 + around
    half = bone.post_height_mm / 2 + around
    y = middle_y(design.dimensions)
    high = -bone.base_length_mm - Post().foot_length(design) - _BELOW_FILLET_MM

    return Box(
        (-x, y - half, Post().low_z(design) - _ABOVE_FLOOR_MM - _HANDLE_MM), (x, y + half, high)
    )


def stand(design: Design) -> Solid:
    """Build the stand, with a blind socket and the hole of the cross
    bolt, which opens into it on both sides.
    """
    bone = design.bone
    wider = 2 * post_gap_mm(design)
    sizes = {
        "post_width_mm": bone.post_width_mm + wider,
        "post_height_mm": bone.post_height_mm + wider,
        "post_length_mm": bone.post_length_mm + _ABOVE_FLOOR_MM,
    }
    (socket, _), _ = Post().shapes(
        design.model_copy(update={"bone": bone.model_copy(update=sizes)})
    )

    return difference(stand_outline(design), socket, Post().bolt_hole(design))


def socket_ceiling_mm(design: Design) -> float:
    """Measure what overhangs in the socket of a lying stand [mm]: its
    flat, or the round side above 45 degrees.
    """
    gap = post_gap_mm(design)
    radius = design.bone.post_width_mm / 2 + gap
    half = design.bone.post_height_mm / 2 + gap

    return 2 * max(radius * math.sqrt(0.5), math.sqrt(max(0.0, radius**2 - half**2)))


LOOSE_MM = 0.1
_PIN_CHAMFER_MM = 0.4
"""Difference in radius by which a tongue's bore is wider than the
bone's, and the chamfer at the pin's end [mm].
"""
_PIN_HEAD_MM = 1.0
_WEDGE_MM = 4.0
_WEDGED_MM = 0.1
"""Height and overhang of the pin's head, length of the taper below it,
and its radius over the bore's there [mm].
"""
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


def joint_of(design: Design) -> Joint:
    joint = design.dimensions.joint
    assert joint, "only a clevis has a stub"
    return joint


def pin(design: Design) -> Solid:
    """Build the pin as it stands on its head on the bed, along z;
    below the head it wedges in a cheek of the bone.
    """
    joint = joint_of(design)
    length = design.dimensions.pin_length
    at = (0.0, 0.0)
    bore = joint.pin_radius
    radius = joint.printed_pin_radius

    return union(
        cylinder(
            "z",
            centre=at,
            low=0.0,
            high=_PIN_HEAD_MM,
            radius=bore + _PIN_HEAD_MM,
        ),
        Cone(
            axis="z",
            centre=at,
            low=_PIN_HEAD_MM,
            high=_PIN_HEAD_MM + _WEDGE_MM,
            low_radius=bore + _WEDGED_MM,
            high_radius=radius,
        ),
        cylinder(
            "z",
            centre=at,
            low=_PIN_HEAD_MM + _WEDGE_MM,
            high=length - _PIN_CHAMFER_MM,
            radius=radius,
        ),
        Cone(
            axis="z",
            centre=at,
            low=length - _PIN_CHAMFER_MM,
            high=length,
            low_radius=radius,
            high_radius=radius - _PIN_CHAMFER_MM,
        ),
    )


def guide(design: Design) -> Guide | None:
    """Place the guide behind the shoulder, whose palmar side may lie
    beside the tendon; None without a tendon.
    """
    anchor = design.dimensions.anchor
    if not anchor:
        return None

    strands = (-anchor.strand_x, anchor.strand_x)
    return Guide(strands, anchor.y, anchor.line / 2 + _SLACK_MM, joint_of(design).low_z - _BACK_MM)


def bars(design: Design) -> tuple[Box, Box]:
    """Build shoulder and bar: as wide and high as the eyes, and as the walls of the guide need."""
    joint = joint_of(design)
    way = guide(design)
    wall = design.printer.min_wall_mm
    half = max(design.dimensions.collar.section.half_width, design.hand.width_mm / 2 + _CHEEK_MM)
    palmar = joint.axis_y - design.hand.axis_height_mm
    dorsal = stop_top_y(design, joint)
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


def without_ways(design: Design) -> Solid:
    joint = joint_of(design)
    (shoulder, bar) = bars(design)
    (half, dorsal, root) = shoulder.high
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
    whole = union(bar, shoulder, intersection(knuckle(design, joint, ramp), near))
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

    return difference(whole, bore, *notches)


def stub_bore_radius(joint: Joint) -> float:
    """Radius of the stub's bore: the pin wedges in a cheek, and
    turns in the tongue between both [mm].
    """
    return joint.pin_radius + (LOOSE_MM if joint.is_fork else 0.0)


def hand_stub(design: Design) -> Solid:
    return difference(without_ways(design), *_ways(design))


def _ways(design: Design) -> Iterator[Solid]:
    """Build what the strands pass: the guide with its mouth, and
    slots open to the palm on both sides of it.
    """
    way = guide(design)
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


def stub_genus(design: Design) -> int:
    """Count the bore, in each cheek of a fork, and the guides."""
    way = guide(design)
    return (1 if joint_of(design).is_fork else 2) + (len(way.x) if way else 0)
