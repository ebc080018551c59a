"""Rules of a clevis: eyes, pin and tendon fit the base, and the finger bends as far as the joint's stops allow."""

from __future__ import annotations

import math

from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.features import SLIDING_MM, Joint, TendonAnchor
from fingertip.design.rules.bone import collar_carries_skin
from fingertip.design.rules.ruleset import SLACK, Limit, Ruleset, Violation, at_most
from fingertip.design.rules.skin import bone_left_at_sides, bone_left_dorsally
from fingertip.foundation.numerics import bisect

LENGTH_RULES, RULES = Ruleset(), Ruleset()

_MIN_SHOULDER = 0.1
"""Minimum distance of the hand's knuckle from the collar [mm]."""
_BELOW_SEAL_MM = 0.2
"""Gap between the anchor and the sealing part of the collar at a folded tail [mm]."""
_MIN_SLOPE = 0.05
"""Least sine or cosine by which a length is divided."""
_DIRECTIONS, _ANGLES = 16, 120
"""Directions in which walls are measured, and angles of the joint that are tried."""

_SOUND_BASE = (bone_left_at_sides, bone_left_dorsally)


@LENGTH_RULES.at_least("bone.base_length_mm")
def joint_clear_of_collar_and_tail(design: DesignTables) -> Limit | None:
    """The hand's knuckle is clear of the collar, and of a tail that is folded in the gap of a fork."""
    dims, bone = design.dimensions, design.bone
    joint, fold = dims.joint, dims.fold
    if joint is None:
        return None
    above, what = bone.collar_length_mm + _MIN_SHOULDER, "collar"
    if fold and dims.window_opens_into_gap:
        film = -fold.nose_z + fold.radius + dims.sensor.thickness_mm + SLIDING_MM
        above, what = max((above, what), (film, "folded tail"))
    below = joint.shoulder_z - joint.axis_z
    return Limit(above + below, f"brings the hand's knuckle into the {what} of the finger")


@RULES.rule("skin.length_mm")
def within_length_limit(design: DesignTables) -> Violation | None:
    limit, base = design.hand.length_limit_mm, design.bone.base_length_mm
    length = design.skin.length_mm
    if limit == 0.0 or length + base <= limit + SLACK:
        return None
    return Violation(
        f"{length:g} mm makes the fingertip {length + base:g} mm long, more than the {limit:g} mm of "
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
        f"{diameter:g} mm leaves no wall to the end of the eye", at_most(2 * (joint.eye_radius - design.bone.wall_mm))
    )


@RULES.rule("hand.axis_height_mm", *_SOUND_BASE)
def axis_within_base(design: DesignTables) -> Violation | None:
    dims, height = design.dimensions, design.hand.axis_height_mm
    joint = dims.joint
    if joint is None:
        return None
    around, palmar = joint.pin_radius + design.bone.wall_mm, dims.base_palmar_height
    low, high = palmar - dims.base_flat_depth + around, palmar + dims.bone_outline.section.dorsal - around
    if low - SLACK <= height <= high + SLACK:
        return None
    side = "palmar" if height < low else "dorsal"
    return Violation(
        f"{height:g} mm leaves no wall between the pin and the {side} side of the base",
        ((low, high),) if low <= high else (),
    )


@RULES.rule("hand.width_mm", *_SOUND_BASE, axis_within_base)
def cheeks_print(design: DesignTables) -> Violation | None:
    """The cheeks of a fork are a wall thick beside the pin, and a tongue is that thick and within the base."""
    dims, bone, width = design.dimensions, design.bone, design.hand.width_mm
    joint = dims.joint
    if joint is None:
        return None
    around = joint.pin_radius + bone.wall_mm
    room = min(dims.bone_outline.section.half_width_at(joint.axis_y + side * around) for side in (-1.0, 1.0))
    gap = 2 * bone.joint_clearance_mm
    if joint.is_fork:
        low, high, what = 0.0, 2 * (room - bone.wall_mm) - gap, "no wall beside the hand's tongue"
    else:
        low, high, what = 2 * bone.wall_mm + gap, 2 * room + gap, "no tongue of a wall within the base"
    if low - SLACK <= width <= high + SLACK:
        return None
    return Violation(f"{width:g} mm leaves {what}", ((low, high),) if low <= high else ())


@RULES.at_least("bone.collar_length_mm")
def collar_holds_anchor(design: DesignTables) -> Limit | None:
    dims, bone = design.dimensions, design.bone
    anchor = dims.anchor
    if anchor is None:
        return None
    highest = dims.fold.nose_z - _BELOW_SEAL_MM if dims.fold else -bone.wall_mm
    minimum = bone.collar_length_mm + anchor.z + anchor.radius - highest
    return Limit(minimum, "does not hold the anchor of the tendon", alternatives={"hand.tendon_distance_mm": 0.0})


@RULES.rule("hand.tendon_distance_mm", *_SOUND_BASE, collar_carries_skin, collar_holds_anchor)
def anchor_within_collar(design: DesignTables) -> Violation | None:
    """The collar keeps a wall palmar of the tendon's anchor, which lies clear of the sensor's tail."""
    dims, distance = design.dimensions, design.hand.tendon_distance_mm
    joint, anchor = dims.joint, dims.anchor
    if joint is None or anchor is None:
        return None
    highest = _find_highest_anchor(design, anchor)
    palmar = dims.collar.section.palmar
    lowest = bisect(lambda y: not _keeps_wall(design, anchor, y), -palmar, max(highest, -palmar), halvings=40)[1]
    if lowest - SLACK <= anchor.y <= highest + SLACK:
        return None
    what = "no wall of the collar around its anchor" if anchor.y < lowest else "its anchor no room beside the tail"
    low, high = joint.axis_y - highest, joint.axis_y - lowest
    fits = low <= high and _keeps_wall(design, anchor, highest)
    return Violation(
        f"{distance:g} mm leaves {what}", ((low, high),) if fits else (), alternatives={"hand.tendon_distance_mm": 0.0}
    )


@RULES.rule("hand.travel_deg")
def travel_free(design: DesignTables) -> Violation | None:
    joint, travel = design.dimensions.joint, design.hand.travel_deg
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
    """The stop of the bent finger has a length of half the pin's diameter within the finger's outline."""
    joint, travel = design.dimensions.joint, design.hand.travel_deg
    if joint is None or travel == 0.0:
        return None

    def holds(angle_deg: float) -> bool:
        return _stop_length(design, joint, angle_deg) >= joint.pin_radius - SLACK

    if holds(travel):
        return None
    passing = [angle / 10 for angle in range(10, 1101) if holds(angle / 10)]
    nearest = min(passing, key=lambda angle: abs(angle - travel), default=None)
    return Violation(
        f"{travel:g} degrees leave no hard stop for the bent finger within its outline",
        ((nearest, nearest),) if nearest else (),
    )


def _stop_length(design: DesignTables, joint: Joint, angle_deg: float) -> float:
    """Length [mm] of the palmar stop that lies within the base, or in the chin below it, outside the mold."""
    dims, angle = design.dimensions, math.radians(angle_deg)
    palmar, proximal = joint.radius * math.sin(angle), joint.radius * math.cos(angle)
    across, along = max(math.cos(angle), _MIN_SLOPE), max(math.sin(angle), _MIN_SLOPE)
    assert dims.stops_top_z is not None
    top = dims.stops_top_z - design.bone.wall_mm - joint.axis_z  # of the blunt toe
    in_base = (dims.base_flat_depth + joint.axis_y - palmar) / across
    in_chin = min((dims.collar.section.palmar + joint.axis_y - palmar) / across, (top + proximal) / along)
    return max(in_base, in_chin)


def _find_highest_anchor(design: DesignTables, anchor: TendonAnchor) -> float:
    """Find the height y up to which the anchor is clear of the film, or of the tail's passage."""
    dims, fold = design.dimensions, design.dimensions.fold
    if fold:
        line = design.hand.tendon_diameter_mm
        reach = fold.radius + dims.sensor.thickness_mm + SLIDING_MM + line + anchor.radius
        return fold.nose_y - math.sqrt(max(0.0, reach**2 - (fold.nose_z - anchor.z) ** 2))
    if dims.tail_passes_collar:
        floor = dims.pocket_depth - dims.flat_depth
        return floor - dims.passage_height - design.bone.wall_mm - anchor.radius
    return -dims.flat_depth - anchor.radius


def _keeps_wall(design: DesignTables, anchor: TendonAnchor, y: float) -> bool:
    """Return whether the collar is a wall thick around an anchor at the height `y`, along its first millimetres."""
    dims, wall = design.dimensions, design.bone.wall_mm
    section = dims.collar.section
    x = anchor.inner_half_width
    for i in range(_DIRECTIONS + 1):
        angle = math.pi / 2 * i / _DIRECTIONS
        low = y - anchor.radius - wall * math.sin(angle)
        if low < -section.palmar or section.half_width_at(low) < x + wall + wall * math.cos(angle):
            return False
    return True


def _is_clear(design: DesignTables, joint: Joint, angle_deg: float) -> bool:
    """Return whether the hand's shoulder touches neither base, collar nor skin at an angle, in the middle plane."""
    dims = design.dimensions
    angle = math.radians(angle_deg)
    sine, cosine = math.sin(angle), math.cos(angle)
    # The finger as nested outlines, each from one height on: the palmar edge of base, collar and skin.
    foot = dims.draft_slope * dims.collar.section.palmar - design.bone.collar_length_mm
    outline = (
        (joint.shoulder_z, -dims.base_flat_depth),
        (foot, -dims.collar.section.palmar),
        (0.0, -dims.base_palmar_height),
        *([(dims.crown.z, -design.skin.semi_axis_palmar_mm)] if dims.crown else []),
    )
    palmar = -design.hand.axis_height_mm  # of the hand, from its axis
    # The shoulder's palmar corner in the frame of the bone.
    y = joint.axis_y + palmar * cosine - joint.radius * sine
    z = joint.axis_z - palmar * sine - joint.radius * cosine
    if any(z > low + SLACK and y > edge + SLACK for low, edge in outline):
        return False
    # Corners of the finger in the frame of the hand: palmar of it, or distal to its shoulder.
    for low, edge in outline:
        dy, dz = edge - joint.axis_y, low - joint.axis_z
        across, along = dy * cosine - dz * sine, dy * sine + dz * cosine
        if across > palmar + SLACK and along < -joint.radius - SLACK:
            return False
    return True
