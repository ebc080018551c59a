"""Rules of a clevis: eyes, pin and tendon fit the base, and the
finger bends as far as the joint's stops allow.
"""

from __future__ import annotations

import math

from fingertip.design.geometry import DesignTables
from fingertip.design.rules.bone import collar_carries_skin
from fingertip.design.rules.ruleset import SLACK, Limit, Ruleset, Violation, at_most
from fingertip.design.rules.skin import bone_left_at_sides, bone_left_dorsally
from fingertip.models.dimensions import MAX_PROUD_MM
from fingertip.models.joint import Joint

LENGTH_RULES = Ruleset()
RULES = Ruleset()

_MIN_SHOULDER = 0.1
"""Minimum distance of the hand's knuckle from the collar [mm]."""
_MIN_SLOPE = 0.05
"""Least sine or cosine by which a length is divided."""
_HAND_SLACK_MM = 0.1
_HAND_SLACK_DEG = 0.5
"""Slack of the rules for sizes to which no hand is made or measured. Rules of walls have none."""
_ANGLES = 120
"""Angles of the joint that are tried."""

_SOUND_BASE = (bone_left_at_sides, bone_left_dorsally)


@LENGTH_RULES.at_least("bone.base_length_mm")
def joint_clear_of_collar_and_horns(design: DesignTables) -> Limit | None:
    """The hand's knuckle is clear of the collar, and of the horns over which the tendon turns."""
    joint = design.dimensions.joint
    anchor = design.dimensions.anchor
    if joint is None:
        return None

    above = -anchor.horn_low_z if anchor else design.bone.collar_length_mm + _MIN_SHOULDER
    what = "way of the tendon around" if anchor else "collar of"
    return Limit(
        above + joint.shoulder_z - joint.axis_z,
        f"brings the hand's knuckle into the {what} the finger",
    )


@RULES.rule("skin.length_mm")
def within_length_limit(design: DesignTables) -> Violation | None:
    limit = design.hand.length_limit_mm
    base = design.bone.base_length_mm
    length = design.skin.length_mm
    if limit == 0.0 or length + base <= limit + SLACK:
        return None

    return Violation(
        f"{length:g} mm makes the fingertip {length + base:g} mm long, more than the {limit:g} mm "
        "of "
        "hand.length_limit_mm",
        at_most(limit - base),
        alternatives={"bone.base_length_mm": limit - length},
    )


@RULES.rule("hand.pin_diameter_mm")
def eye_holds_pin(design: DesignTables) -> Violation | None:
    joint = design.dimensions.joint
    if joint is None or joint.pin_radius + design.bone.wall_mm <= joint.eye_radius + SLACK:
        return None

    diameter = design.hand.pin_diameter_mm
    return Violation(
        f"{diameter:g} mm leaves no wall to the end of the eye",
        at_most(2 * (joint.eye_radius - design.bone.wall_mm)),
    )


@RULES.rule("hand.axis_height_mm", *_SOUND_BASE)
def axis_within_base(design: DesignTables) -> Violation | None:
    dims = design.dimensions
    height = design.hand.axis_height_mm
    joint = dims.joint
    if joint is None:
        return None

    around = joint.pin_radius + design.bone.wall_mm
    palmar = dims.base_palmar_height
    low = palmar - dims.eyes.palmar + around
    high = palmar + dims.eyes.dorsal - around
    if low - SLACK <= height <= high + SLACK:
        return None

    side = "palmar" if height < low else "dorsal"
    return Violation(
        f"{height:g} mm leaves no wall between the pin and the {side} side of the base",
        ((low, high),) if low <= high else (),
    )


@RULES.rule("hand.width_mm", *_SOUND_BASE, axis_within_base)
def cheeks_print(design: DesignTables) -> Violation | None:
    """The cheeks of a fork are a wall thick beside the pin, and a
    tongue is that thick and within the base.
    """
    dims = design.dimensions
    bone = design.bone
    width = design.hand.width_mm
    joint = dims.joint
    if joint is None:
        return None

    around = joint.pin_radius + bone.wall_mm
    room = min(dims.eyes.half_width_at(joint.axis_y + side * around) for side in (-1.0, 1.0))
    gap = 2 * bone.joint_clearance_mm

    if joint.is_fork:
        low = 0.0
        high = 2 * (room - bone.wall_mm) - gap
        what = "no wall beside the hand's tongue"
    else:
        low = 2 * bone.wall_mm + gap
        high = 2 * room + gap
        what = "no tongue of a wall within the base"

    if low - SLACK <= width <= high + SLACK:
        return None

    return Violation(f"{width:g} mm leaves {what}", ((low, high),) if low <= high else ())


@RULES.at_most("hand.tendon_diameter_mm", *_SOUND_BASE, collar_carries_skin)
def base_between_the_strands(design: DesignTables) -> Limit | None:
    """The base between both strands of the tendon holds the trough
    and the gap, with a wall on either side.
    """
    dims = design.dimensions
    joint = design.dimensions.joint
    if joint is None or dims.anchor is None:
        return None

    inner = (
        max(dims.tail_half_width, joint.half_width if joint.is_fork else 0.0) + design.bone.wall_mm
    )
    widest = (dims.joint_base_half_width - inner) / 1.5
    what = "leaves no wall between the tendon's strands and the trough or the joint"
    return Limit(widest, what, alternatives={"hand.tendon_distance_mm": 0.0})


@RULES.rule("hand.tendon_distance_mm", *_SOUND_BASE, collar_carries_skin)
def strands_beside_the_eyes(design: DesignTables) -> Violation | None:
    """The strands leave a wall palmar of the pin, pass the hand's
    fork, and lie on horns within the base's height.
    """
    dims = design.dimensions
    distance = design.hand.tendon_distance_mm
    hand = design.hand
    joint = dims.joint
    anchor = dims.anchor
    if joint is None or anchor is None:
        return None

    back_y = dims.bone_outline.section.dorsal_height_at(anchor.half_width) - anchor.line
    low = (
        max(joint.pin_radius + design.bone.wall_mm, joint.axis_y + anchor.horn_radius - back_y)
        + anchor.line / 2
    )
    if not joint.is_fork and anchor.half_width + anchor.line > joint.half_width - joint.clearance:
        low = max(low, hand.clearance_radius_mm + anchor.line)

    high = joint.axis_y + dims.collar.section.palmar + MAX_PROUD_MM
    if low - _HAND_SLACK_MM <= distance <= high + _HAND_SLACK_MM:
        return None

    what = (
        "no room for its strands beside pin and hand"
        if distance < low
        else "its strands no horn to turn over"
    )
    return Violation(
        f"{distance:g} mm leaves {what}",
        ((low, high),) if low <= high else (),
        alternatives={"hand.tendon_distance_mm": 0.0},
    )


@RULES.rule("hand.travel_deg")
def travel_free(design: DesignTables) -> Violation | None:
    joint = design.dimensions.joint
    travel = design.hand.travel_deg
    if joint is None or travel == 0.0:
        return None

    for i in range(_ANGLES + 1):
        if not _is_clear(design, joint, travel * i / _ANGLES):
            free = max(0.0, math.floor(travel * (i - 1) / _ANGLES))
            return Violation(
                f"{travel:g} degrees press the base or the pulp against the hand's shoulder",
                at_most(free) if free else (),
            )

    return None


@RULES.rule("hand.travel_deg", *_SOUND_BASE, collar_carries_skin)
def bent_stop_long_enough(design: DesignTables) -> Violation | None:
    """The stop of the bent finger has a length of half the pin's
    diameter within the finger's outline.
    """
    joint = design.dimensions.joint
    travel = design.hand.travel_deg
    if joint is None or travel == 0.0:
        return None

    def holds(angle_deg: float) -> bool:
        is_long = _stop_length(design, joint, angle_deg) >= joint.pin_radius - SLACK
        return is_long and _leaves_horns(design, joint, angle_deg)

    if any(holds(travel + slack) for slack in (0.0, -_HAND_SLACK_DEG, _HAND_SLACK_DEG)):
        return None

    passing = [angle / 10 for angle in range(10, 1101) if holds(angle / 10)]
    nearest = min(passing, key=lambda angle: abs(angle - travel), default=None)
    return Violation(
        f"{travel:g} degrees leave no hard stop for the bent finger within its outline",
        ((nearest, nearest),) if nearest else (),
    )


def _stop_length(design: DesignTables, joint: Joint, angle_deg: float) -> float:
    """Length [mm] of the palmar stop that lies within the base."""
    dims = design.dimensions
    angle = math.radians(angle_deg)
    palmar = joint.radius * math.sin(angle)
    proximal = joint.radius * math.cos(angle)
    across = max(math.cos(angle), _MIN_SLOPE)
    along = max(math.sin(angle), _MIN_SLOPE)
    assert dims.stops_top_z is not None
    top = dims.stops_top_z - design.bone.wall_mm - joint.axis_z  # of the blunt toe

    return min((dims.joint_depth + joint.axis_y - palmar) / across, (top + proximal) / along)


def _leaves_horns(design: DesignTables, joint: Joint, angle_deg: float) -> bool:
    """Return whether the hand's shoulder, turned by an angle, is clear of the horns of
    the tendon.
    """
    anchor = design.dimensions.anchor
    angle = math.radians(angle_deg)
    if anchor is None:
        return True

    y = anchor.horn_y - joint.axis_y
    z = anchor.horn_low_z - joint.axis_z
    return -y * math.sin(angle) - z * math.cos(angle) <= joint.radius + SLACK


def _is_clear(design: DesignTables, joint: Joint, angle_deg: float) -> bool:
    """Return whether the hand's shoulder touches neither base nor collar at an angle, in the middle
    plane.

    The skin lies distal to both, where the shoulder does not come without them.
    """
    dims = design.dimensions
    angle = math.radians(angle_deg)
    sine = math.sin(angle)
    cosine = math.cos(angle)
    # The knuckle is round on its distal side alone: the corner of its root rises above it beyond a
    # right angle.
    if joint.radius * (sine - cosine) > joint.shoulder_z - joint.axis_z + SLACK:
        return False

    # The finger as nested outlines, each from one height on: the palmar edges of base and collar.
    foot = -design.bone.collar_length_mm
    outline = ((joint.shoulder_z, -dims.base_flat_depth), (foot, -dims.collar.section.palmar))
    palmar = -design.hand.axis_height_mm  # of the hand, from its axis
    # The shoulder's palmar corner in the frame of the bone.
    y = joint.axis_y + palmar * cosine - joint.radius * sine
    z = joint.axis_z - palmar * sine - joint.radius * cosine
    if any(z > low + SLACK and y > edge + SLACK for low, edge in outline):
        return False

    # Corners of the finger in the frame of the hand: palmar of it, or distal to its shoulder.
    for low, edge in outline:
        dy = edge - joint.axis_y
        dz = low - joint.axis_z
        across = dy * cosine - dz * sine
        along = dy * sine + dz * cosine
        if across > palmar + SLACK and along < -joint.radius - SLACK:
            return False

    return True
