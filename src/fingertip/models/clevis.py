"""Solids of a clevis: the base with eyes and hard stops, the space that the hand needs, and the way
of the tendon.

The base is as wide and high as the collar: the wider the cheeks and the longer the stop, the less
the pin pulls at its bore at a knock.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from .allowances import LEDGE_MM, TANGENT_STEP_MM
from .conic import ConicBody
from .feet import arc_foot, flat_foot
from .joint import Joint, TendonAnchor, joint_of
from .solids import (
    Axis,
    Box,
    Prism,
    Shapes,
    Solid,
    SuperconicSolid,
    cylinder,
)

if TYPE_CHECKING:
    from .program_types import Finger

_BACK_WAY_MM = 3.0
"""Half the width of the way of wires and rubber band on the back [mm]."""
_HORN_CHORDS = 12
"""Chords of a horn's quarter circle."""


def shapes(finger: Finger) -> Shapes:
    """Build the base, and what is removed: the joint's space, bore of the pin, way of the tendon.

    Seen from the side, back up, tip to the right:

                  | stop of the straight finger
                  |_______________   _______
              .-'                 | |       |   groove of the tendon, low_z to high_z
            .'     ____           |_|       |
           |      (    )                    |   base as wide and high as the collar
           |      (_pin)   axis_y, axis_z   |
            '.                     _________|
              '-._    stop, turned/   horn, horn_radius
                  `-._ by travel_deg
           |<---->|
            radius
    """
    joint = joint_of(finger)
    anchor = finger.dimensions.anchor
    top = finger.dimensions.stops_top_z
    assert top is not None
    added: list[Solid] = [joint_base(finger, joint, top)]
    across = 2 * finger.dimensions.collar.section.half_width
    removed = [space(finger, joint), pin_bore(joint, across)]

    if anchor:
        added.append(collar_slope(finger, anchor))
        removed += tendon_way(finger, anchor, joint)

    return tuple(added), tuple(removed)


def joint_base(finger: Finger, joint: Joint, top: float) -> Solid:
    """Build the base up to a height with its hard stops; palmar it is as wide down to the end of
    the bent stop.
    """
    dims = finger.dimensions
    collar = finger.dimensions.collar.section
    low = joint.low_z - joint.radius
    half = dims.joint_base_half_width
    outline = SuperconicSolid(ConicBody(collar, ((low, 1.0), (top, 1.0))))
    base = outline.union(
        Box((-half, -dims.joint_depth, joint.low_z - 1.0), (half, joint.axis_y, top))
    )
    if not joint.travel_deg:
        return base

    reach = 2 * (collar.half_width + collar.dorsal + collar.palmar)
    within = Box((-reach, stop_toe_y(finger, joint, top), -reach), (reach, reach, reach))
    return base.intersect(eye_profile(joint, reach), within)


def stop_toe_y(finger: Finger, joint: Joint, top: float) -> float:
    """Palmar end of the stop of the bent finger, which is a wall thick there."""
    angle = math.radians(joint.travel_deg)
    toe_z = top - finger.bone.wall_mm - joint.axis_z
    toe_at_wall = joint.axis_y - (joint.radius + toe_z * math.cos(angle)) / math.sin(angle)

    return max(-finger.dimensions.joint_depth, toe_at_wall)


def stop_top_y(finger: Finger, joint: Joint) -> float:
    """Dorsal end of the stop of the straight finger.

    Cheeks end beside the gap, or where they would be an edge.
    """
    collar = finger.dimensions.collar
    if not joint.is_fork:
        return collar.section.dorsal

    blunt = finger.dimensions.blunt_up_to_y(
        joint.half_width, -finger.bone.collar_length_mm / 2, collar
    )
    return collar.section.dorsal_height_at(joint.half_width) if blunt is None else blunt


def stop_height_mm(finger: Finger) -> float:
    """Height of the stop of the straight finger above the pin's axis; 0 without a joint."""
    joint = finger.dimensions.joint
    return stop_top_y(finger, joint) - joint.axis_y if joint else 0.0


def space(finger: Finger, joint: Joint) -> Solid:
    """Build the space that the hand needs: all but the eyes proximal to the base, and the gap
    between them.
    """
    section = finger.dimensions.collar.section
    reach = 2 * (section.half_width + section.dorsal + section.palmar)
    low = joint.low_z - reach
    high = joint.shoulder_z
    beyond = Box((-reach, -reach, low), (reach, reach, high))
    half = joint.half_width
    end = high + section.half_width
    eyes = [eye_profile(joint, reach)]

    if not joint.travel_deg:
        eyes.append(
            _eye_foot(
                joint,
                "x",
                middle=joint.axis_y,
                half=joint.eye_radius,
                end=end,
                reach=reach,
            )
        )

    beside_eyes = beyond.cut(*eyes)
    if not joint.is_fork:
        tongue = Box((-half, -2 * reach, low - reach), (half, 2 * reach, end))
        foot = _eye_foot(joint, "y", middle=0.0, half=half, end=end, reach=2 * reach)
        return beside_eyes.union(beyond.cut(tongue, foot))

    gap = Box((-half, -reach, low), (half, reach, high))
    above_stop = Box((-reach, stop_top_y(finger, joint), low), (reach, reach, high))
    return beside_eyes.union(gap, above_stop)


def _eye_foot(
    joint: Joint, axis: Axis, middle: float, half: float, end: float, reach: float
) -> Solid:
    """Build the fillets at the root of the eyes, on two flats along an axis; they end at z =
    `end`.
    """
    return flat_foot(
        axis,
        low_side=middle - half,
        high_side=middle + half,
        foot=arc_foot(joint.foot, root_z=joint.shoulder_z, way=1.0),
        end=end,
        reach=reach,
    )


def eye_profile(joint: Joint, reach: float) -> Solid:
    """Build an eye of any width: round about the pin, and with the hard stops or narrower than the
    base.
    """
    y = joint.axis_y
    z = joint.axis_z
    round_eye = cylinder(
        "x",
        centre=(y, z),
        low=-reach,
        high=reach,
        radius=joint.eye_radius,
    )

    if joint.travel_deg:
        return Prism("x", eye_corners(joint, reach), -reach, reach).union(round_eye)

    half = joint.eye_radius - TANGENT_STEP_MM
    return Box((-reach, y - half, z), (reach, y + half, z + reach)).union(round_eye)


def eye_corners(joint: Joint, reach: float) -> tuple[tuple[float, float], ...]:
    """Return the corners (y, z) of an eye between its stops, counter-clockwise, without the arc
    about the pin [mm].

    In the frame of the bone the hand's shoulder turns about the pin towards the palmar side while
    the finger bends. The dorsal edge is the shoulder of the straight finger, the palmar one that at
    the end of the travel. What lies between them never meets the shoulder on the way: the outline
    is convex at the stops, and nearer to the pin on the ramps.
    """
    radius = joint.radius
    angle = math.radians(joint.travel_deg)
    ramp = math.radians(ramp_angle_deg(joint))
    foot = (-radius * math.sin(angle), -radius * math.cos(angle))
    along = min(reach, reach / math.sin(angle))
    far = (foot[0] - along * math.cos(angle), foot[1] + along * math.sin(angle))
    inside = joint.eye_radius - TANGENT_STEP_MM
    ramps = [(-inside * math.sin(at), -inside * math.cos(at)) for at in (angle - ramp, ramp)]
    dorsal = ((0.0, -radius), (reach, -radius), (reach, reach))
    corners = (*dorsal, (far[0], reach), far, foot, ramps[0], (0.0, 0.0), ramps[1])

    return tuple((joint.axis_y + y, joint.axis_z + z) for y, z in corners)


def ramp_angle_deg(joint: Joint) -> float:
    """Return the angle about the pin along which an eye rises from its own radius to that of a
    stop.
    """
    return min(math.degrees(math.acos(joint.eye_radius / joint.radius)), joint.travel_deg) / 2


def pin_bore(joint: Joint, half_length: float) -> Solid:
    return cylinder(
        "x",
        centre=(joint.axis_y, joint.axis_z),
        low=-half_length,
        high=half_length,
        radius=joint.pin_radius,
    )


def collar_slope(finger: Finger, anchor: TendonAnchor) -> Solid:
    """Build the slope of 45 degrees between the tendon's groove and the collar, which prints
    without supports.
    """
    section = finger.dimensions.collar.section
    foot = -finger.bone.collar_length_mm
    share = min(1.0 - TANGENT_STEP_MM, (anchor.half_width + LEDGE_MM) / section.half_width)

    return SuperconicSolid(
        ConicBody(section, ((anchor.high_z, share), (foot, 1.0), (foot / 2, 1.0)))
    )


def tendon_way(finger: Finger, anchor: TendonAnchor, joint: Joint) -> tuple[Solid, ...]:
    """Build what is removed for the tendon: sides of its groove, corners below its horns, and a way
    on the back.

    On the back wires and rubber band run to the joint at the height of the groove's floor.
    """
    section = finger.dimensions.collar.section
    foot = -finger.bone.collar_length_mm
    reach = 2 * (section.half_width + section.dorsal + section.palmar)
    inner = anchor.half_width
    low = joint.low_z - reach
    up = anchor.low_z + anchor.line / 2
    corners = horn_corners(anchor, low_z=low, high_z=up, reach=reach)
    slope = collar_slope(finger, anchor)
    sides = ((inner, reach), (-reach, -inner))
    right_groove, left_groove = (
        Box((low_x, -reach, anchor.low_z), (high_x, reach, foot)).cut(slope)
        for low_x, high_x in sides
    )
    right_horn, left_horn = (Prism("x", corners, *side) for side in sides)

    return _back_way(finger, anchor, joint), right_groove, right_horn, left_groove, left_horn


def horn_corners(
    anchor: TendonAnchor, low_z: float, high_z: float, reach: float
) -> tuple[tuple[float, float], ...]:
    """List the corners (y, z) of what is removed below a horn, the quarter of a circle on which the
    tendon turns [mm].
    """
    begin_y = anchor.horn_y
    radius = anchor.horn_radius
    middle_y = begin_y + radius
    angles = [math.pi / 2 * i / _HORN_CHORDS for i in range(_HORN_CHORDS + 1)]
    arc = [
        (middle_y - radius * math.cos(angle), anchor.horn_low_z + radius * math.sin(angle))
        for angle in angles
    ]

    return (-reach, low_z), (begin_y, low_z), *arc, (middle_y, high_z), (-reach, high_z)


def _back_way(finger: Finger, anchor: TendonAnchor, joint: Joint) -> Solid:
    section = finger.dimensions.bone_outline.section
    half = _BACK_WAY_MM
    low = joint.shoulder_z
    high = anchor.low_z + anchor.line / 2

    if joint.is_fork:  # it opens into the gap
        half = min(half, joint.half_width - TANGENT_STEP_MM)
        low = low - TANGENT_STEP_MM

    scale = 1.0 - TANGENT_STEP_MM / section.half_width
    floor = SuperconicSolid(ConicBody(section, ((low - 1.0, scale), (high + 1.0, scale))))
    return Box((-half, 0.0, low), (half, 4 * section.dorsal, high)).cut(floor)


def strands(finger: Finger, anchor: TendonAnchor, low_z: float) -> Iterator[Solid]:
    """Build both strands of the tendon beside the base, and straight from their horns to `low_z`,
    for checks.
    """
    radius = anchor.line / 2
    back = finger.dimensions.bone_outline.section.dorsal_height_at(anchor.half_width)
    horn_end = anchor.horn_y + anchor.horn_radius
    for x in (-anchor.strand_x, anchor.strand_x):
        yield cylinder("y", centre=(anchor.z, x), low=horn_end, high=back, radius=radius)
        yield cylinder("z", centre=(x, anchor.y), low=low_z, high=anchor.horn_low_z, radius=radius)


def knuckle(finger: Finger, joint: Joint, *added: Solid) -> Solid:
    """Build the hand's part of the joint as `[hand]` describes it: shoulder and knuckle, with what
    is added to that.
    """
    hand = finger.hand
    reach = 4 * joint.radius
    y = joint.axis_y
    z = joint.axis_z
    half = hand.width_mm / 2
    # The hand ends on its palmar side at the height from which its axis is measured.
    palmar = y - hand.axis_height_mm
    shoulder = Box((-reach, palmar, z - joint.radius - reach), (reach, y + reach, z - joint.radius))
    flat = joint.radius - TANGENT_STEP_MM
    neck = Box((-reach, y - flat, z - joint.radius - TANGENT_STEP_MM), (reach, y + flat, z)).union(
        cylinder(
            "x",
            centre=(y, z),
            low=-reach,
            high=reach,
            radius=joint.radius,
        ),
        *added,
    )
    inner = Box((-half, y - reach, z - reach), (half, y + reach, z + reach))

    return shoulder.union(neck.intersect(inner) if joint.is_fork else neck.cut(inner))
