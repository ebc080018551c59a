"""Rules of the bone's base: room for cable channel, tie hole, collar, groove and interface."""

from __future__ import annotations

import math

from fingertip.catalogues.hardware import select_thread
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.features import SLIDING_MM
from fingertip.design.rules.ruleset import SLACK, Ruleset, Violation, at_least, at_most
from fingertip.design.rules.skin import bone_left_at_sides, bone_left_dorsally, tip_within_skin
from fingertip.foundation.numerics import bisect

RULES = Ruleset()

_MIN_COLLAR_HEIGHT = 0.1
"""Minimum height of the collar's face, on which the skin ends [mm]."""
_BEFORE_TIP = 0.1
"""Minimum distance of the groove from the rounded tip [mm]."""
_MIN_SHOULDER = 0.1
"""Minimum height of the shoulder above and below a post [mm]."""
_HEAD_CLEARANCE = 0.3
"""Clearance around the head of a flange's bolt [mm]."""
_CIRCLE_POINTS = 64
"""Intervals at which half a circle is sampled."""
_DEPTH_HALVINGS = 30
"""Halvings that find the maximum depth of the groove."""


@RULES.rule("bone.wall_mm")
def walls_print(design: DesignTables) -> Violation | None:
    """The bone's minimum wall is not below the printer's."""
    if design.bone.wall_mm >= design.printer.min_wall_mm - SLACK:
        return None
    return Violation(
        f"{design.bone.wall_mm:g} mm is thinner than the {design.printer.min_wall_mm:g} mm of printer.min_wall_mm",
        at_least(design.printer.min_wall_mm),
    )


@RULES.rule("bone.base_length_mm")
def base_holds_everything(design: DesignTables) -> Violation | None:
    """The base is long enough for the posterior hole, the tie hole and a socket."""
    dims, bone = design.dimensions, design.bone
    if dims.window_opens_into_gap:
        return None
    joint = dims.joint
    within = {
        "post": 0.0, "socket": bone.socket_depth_mm, "flange": bone.flange_thickness_mm,
        "clevis": joint.radius + joint.clearance if joint else 0.0,
    }[bone.interface]  # fmt: skip
    needed = -dims.tie_hole_z + bone.tie_hole_diameter_mm / 2
    minimum = (max(needed, -dims.cable_groove_end_z) if dims.fold else needed) + bone.wall_mm + within
    if bone.base_length_mm >= minimum - SLACK:
        return None
    hole = "cable groove" if dims.fold else "posterior hole"
    what = f"{hole}, tie hole and {bone.interface}" if within else f"{hole} and tie hole"
    return Violation(
        f"{bone.base_length_mm:g} mm does not hold {what} below the mold's recess (the {dims.sensor.label} is "
        f"{dims.sensor.length_mm:g} mm long)",
        at_least(minimum),
    )


@RULES.rule("bone.base_length_mm")
def joint_clear_of_collar_and_tail(design: DesignTables) -> Violation | None:
    """The hand's knuckle is clear of the collar, and of a tail that is folded in the gap of a fork."""
    dims, bone = design.dimensions, design.bone
    joint, fold = dims.joint, dims.fold
    if joint is None:
        return None
    above, what = bone.collar_length_mm + _MIN_SHOULDER, "collar"
    if fold and dims.window_opens_into_gap:
        film = -fold.nose_z + fold.radius + dims.sensor.thickness_mm + SLIDING_MM
        above, what = max((above, what), (film, "folded tail"))
    minimum = above + joint.radius + joint.clearance
    if bone.base_length_mm >= minimum - SLACK:
        return None
    return Violation(
        f"{bone.base_length_mm:g} mm brings the hand's knuckle into the {what} of the finger", at_least(minimum)
    )


@RULES.rule("bone.relief_length_mm")
def relief_clear_of_pocket(design: DesignTables) -> Violation | None:
    """The recess for the solder joints ends before the sensor's pocket."""
    dims = design.dimensions
    if dims.fold:
        return None
    pocket = dims.sensor_z - dims.sensor.head_diameter_mm / 2 - design.sensor.clearance_mm
    maximum = 2 * (pocket - dims.tail_end_z)
    if design.bone.relief_length_mm <= maximum + SLACK:
        return None
    return Violation(f"{design.bone.relief_length_mm:g} mm reaches under the sensor's head", at_most(maximum))


@RULES.rule("sensor.distance_from_tip_mm")
def relief_clear_of_collar(design: DesignTables) -> Violation | None:
    """The solder joints lie above or below the collar."""
    dims, distance = design.dimensions, design.sensor.distance_from_tip_mm
    if dims.fold:
        return None
    low, high = dims.relief_proximal_z, dims.tail_end_z + dims.relief_half_length
    if high <= -design.bone.collar_length_mm + SLACK or low >= -SLACK:
        return None
    # The solder joints lie either above the collar, under the skin, or below it.
    above, below = distance + low, distance + high + design.bone.collar_length_mm
    return Violation(
        f"{distance:g} mm ends the tail in the collar, where there is no room for the solder joints",
        (*at_least(below), *at_most(above)),
    )


@RULES.rule("bone.collar_inset_mm", bone_left_at_sides, bone_left_dorsally)
def collar_carries_skin(design: DesignTables) -> Violation | None:
    """The collar's face is high enough to carry the end of the skin."""
    dims = design.dimensions
    sides = min(
        _thickness_at_collar(design, half, thickness) - _MIN_COLLAR_HEIGHT
        for half, thickness in (
            (design.skin.width_mm / 2, design.skin.thickness_side_mm),
            (design.skin.semi_axis_dorsal_mm, design.skin.thickness_dorsal_mm),
        )
    )
    passage = dims.flat_depth - dims.pocket_depth + dims.passage_height
    below = design.skin.semi_axis_palmar_mm - passage - design.bone.wall_mm
    maximum = min(sides, below) if dims.tail_passes_collar else sides
    if design.bone.collar_inset_mm <= maximum + SLACK:
        return None
    what = "the collar's height" if maximum == sides else "the collar below the tail's passage"
    return Violation(f"{design.bone.collar_inset_mm:g} mm leaves too little of {what}", at_most(maximum))


def _thickness_at_collar(design: DesignTables, half_mm: float, thickness_mm: float) -> float:
    """Compute the silicone [mm] that ends on the collar, around the bone or around a sleeve's enlarged core."""
    if design.mold.method == "overmold":
        return thickness_mm
    core = (half_mm - thickness_mm - design.mold.sleeve_interference_mm) * design.dimensions.shrinkage
    return min(thickness_mm, half_mm - core)


@RULES.rule("bone.groove_depth_mm", tip_within_skin, bone_left_at_sides)
def groove_clear_of_sensor(design: DesignTables) -> Violation | None:
    """The groove ends before the sensor's head and keeps the wall beside its slot."""
    dims = design.dimensions
    depth, width, low = design.bone.groove_depth_mm, design.bone.groove_width_mm, design.bone.groove_distance_mm
    if depth == 0.0:
        return None
    z = low + depth + width
    head = dims.sensor_z - dims.sensor.head_diameter_mm / 2 - design.sensor.clearance_mm - design.bone.rim_mm
    join = dims.taper_end_z
    limit = min(head, join - _BEFORE_TIP)
    if z + depth > limit + SLACK:
        obstacle = "the rim of the sensor's head" if head < join else "the rounded tip"
        # A short finger leaves no space at all, for which the limit is negative.
        begins = f", which begins {limit:.2f} mm from the collar" if limit > 0.0 else ""
        return Violation(
            f"{depth:g} mm deep and {width:g} mm wide, {low:g} mm from the collar, the groove runs into "
            f"{obstacle}{begins}",
            at_most(max(0.0, (limit - low - width) / 2)),
        )
    section = dims.bone_outline.section
    slot = dims.tail_half_width + design.bone.wall_mm

    def keeps_wall(depth: float) -> bool:
        scale = dims.bone_outline.scale_at(min(low + depth + width, head)) * (1 - depth / section.half_width)
        return section.half_width_at(-dims.flat_depth, scale) >= slot - SLACK

    if keeps_wall(depth):
        return None
    # The flat narrows faster than the groove deepens, so the bound has no closed form.
    maximum = bisect(keeps_wall, 0.0, depth, halvings=_DEPTH_HALVINGS)[0] if keeps_wall(0.0) else 0.0
    return Violation(f"{depth:g} mm cuts into the wall beside the tail's slot", at_most(maximum))


@RULES.rule("bone.tie_hole_diameter_mm")
def tie_hole_within_back(design: DesignTables) -> Violation | None:
    """The tie hole fits the back of the base."""
    dims, wall = design.dimensions, design.bone.wall_mm
    if dims.window_opens_into_gap:
        return None
    dorsal = design.skin.semi_axis_dorsal_mm - design.skin.thickness_dorsal_mm
    maximum = dorsal + dims.base_flat_depth - dims.cable_groove_depth - 2 * wall if dims.fold else dorsal / 2 - wall
    if design.bone.tie_hole_diameter_mm <= maximum + SLACK:
        return None
    return Violation(f"{design.bone.tie_hole_diameter_mm:g} mm does not fit the back of the base", at_most(maximum))


@RULES.rule("bone.post_height_mm", bone_left_at_sides, bone_left_dorsally)
def post_not_higher_than_base(design: DesignTables) -> Violation | None:
    """The base is higher than the post, so that it ends in a shoulder."""
    dims, height = design.dimensions, min(design.bone.post_height_mm, design.bone.post_width_mm)
    maximum = dims.bone_outline.section.dorsal + dims.base_flat_depth - 2 * _MIN_SHOULDER
    if design.bone.interface != "post" or height <= maximum + SLACK:
        return None
    return Violation(f"{height:g} mm is higher than the base with its shoulder", at_most(maximum))


@RULES.rule("bone.post_width_mm", bone_left_at_sides, bone_left_dorsally, post_not_higher_than_base)
def post_within_base(design: DesignTables) -> Violation | None:
    """The post is not wider than the base."""
    height = design.bone.post_height_mm

    def holds(width: float) -> bool:
        return _base_holds_circle(design, (width - SLACK) / 2, height / 2)

    if design.bone.interface != "post" or holds(design.bone.post_width_mm):
        return None
    highest = 2 * design.dimensions.bone_outline.section.half_width
    return Violation(
        f"{design.bone.post_width_mm:g} mm is wider than the base", at_most(bisect(holds, 0.0, highest, halvings=30)[0])
    )


@RULES.rule("bone.socket_diameter_mm", bone_left_at_sides, bone_left_dorsally)
def socket_within_base(design: DesignTables) -> Violation | None:
    """The base keeps a wall around the socket."""
    wall, diameter = design.bone.wall_mm, design.bone.socket_diameter_mm
    if design.bone.interface != "socket" or _base_holds_circle(design, (diameter - SLACK) / 2 + wall):
        return None
    return Violation(
        f"{diameter:g} mm leaves less than {wall:g} mm of base around it", at_most(_base_room(design) - 2 * wall)
    )


def _base_holds_circle(design: DesignTables, radius: float, half_height: float = math.inf) -> bool:
    """Return whether a circle [mm] about the middle of the base's height stays inside the base's section.

    The circle may have two flats, which leave `half_height` [mm] on either side of the middle.
    """
    section, flat = design.dimensions.bone_outline.section, design.dimensions.base_flat_depth
    middle = (section.dorsal - flat) / 2
    half_height = min(radius, half_height)
    if half_height >= (section.dorsal + flat) / 2:
        return False
    last = math.asin(half_height / radius) if radius > 0.0 else 0.0
    angles = (last * (2 * i / _CIRCLE_POINTS - 1) for i in range(_CIRCLE_POINTS + 1))
    return all(
        radius * math.cos(angle) <= section.half_width_at(max(middle + radius * math.sin(angle), -flat)) + SLACK
        for angle in angles
    )


def _base_room(design: DesignTables) -> float:
    """Find the diameter [mm] of the largest circle that the base's section holds, by bisection."""
    highest = (design.dimensions.bone_outline.section.dorsal + design.dimensions.base_flat_depth) / 2
    return 2 * bisect(lambda radius: _base_holds_circle(design, radius), 0.0, highest, halvings=30)[0]


@RULES.rule("bone.cross_bolt_diameter_mm")
def cross_bolt_within_interface(design: DesignTables) -> Violation | None:
    """Post or socket keeps a wall around the hole of the cross bolt."""
    bone = design.bone
    if bone.interface in ("flange", "clevis"):
        return None
    if bone.interface == "socket":
        what, across, along = "socket", bone.socket_diameter_mm + bone.wall_mm, bone.socket_depth_mm
    else:
        what, across, along = "post", min(bone.post_height_mm, bone.post_width_mm), bone.post_length_mm
    maximum = min(across, along) - 2 * bone.wall_mm
    if bone.cross_bolt_diameter_mm <= maximum + SLACK:
        return None
    return Violation(
        f"{bone.cross_bolt_diameter_mm:g} mm leaves less than {bone.wall_mm:g} mm around it in the {what}",
        at_most(maximum),
    )


@RULES.rule("bone.flange_spacing_x_mm")
def flange_bolts_clear_of_base(design: DesignTables) -> Violation | None:
    """The heads of the flange's bolts lie beside the base, or above and below it."""
    dims, bone = design.dimensions, design.bone
    section = dims.bone_outline.section
    # The heads of machine screws are as wide as the nuts across flats (ISO 4762).
    head = select_thread(bone.flange_hole_diameter_mm).nut_flats_mm / 2 + _HEAD_CLEARANCE
    minimum = 2 * (section.half_width + head)
    above = section.dorsal + dims.base_flat_depth + 2 * head
    if bone.interface != "flange" or bone.flange_spacing_x_mm >= minimum - SLACK or bone.flange_spacing_y_mm >= above:
        return None
    return Violation(
        f"{bone.flange_spacing_x_mm:g} mm leaves no room for bolt heads beside the base", at_least(minimum)
    )


@RULES.rule("bone.flange_width_mm")
def flange_wide_enough(design: DesignTables) -> Violation | None:
    """The flange keeps a wall beside its bolt holes, and covers the base."""
    bone = design.bone
    minimum = bone.flange_spacing_x_mm + bone.flange_hole_diameter_mm + 2 * bone.wall_mm
    base = 2 * (design.dimensions.bone_outline.section.half_width + _MIN_SHOULDER)
    if bone.interface != "flange" or bone.flange_width_mm >= max(minimum, base) - SLACK:
        return None
    what = (
        f"leaves less than {bone.wall_mm:g} mm beside the bolt holes" if minimum > base else "is less than the base's"
    )
    return Violation(f"{bone.flange_width_mm:g} mm {what}", at_least(max(minimum, base)))


@RULES.rule("bone.flange_height_mm")
def flange_high_enough(design: DesignTables) -> Violation | None:
    """The flange keeps a wall above and below its bolt holes, and covers the base."""
    dims, bone = design.dimensions, design.bone
    minimum = bone.flange_spacing_y_mm + bone.flange_hole_diameter_mm + 2 * bone.wall_mm
    base = dims.bone_outline.section.dorsal + dims.base_flat_depth + 2 * _MIN_SHOULDER
    if bone.interface != "flange" or bone.flange_height_mm >= max(minimum, base) - SLACK:
        return None
    what = "leaves too little above and below the bolt holes" if minimum > base else "is less than the base's height"
    return Violation(f"{bone.flange_height_mm:g} mm {what}", at_least(max(minimum, base)))


@RULES.rule("bone.flange_spacing_y_mm")
def flange_rows_keep_a_wall(design: DesignTables) -> Violation | None:
    """Two rows of the flange's bolt holes keep a wall between them."""
    bone = design.bone
    minimum = bone.flange_hole_diameter_mm + bone.wall_mm
    if bone.interface != "flange" or not 0.0 < bone.flange_spacing_y_mm < minimum - SLACK:
        return None
    return Violation(
        f"{bone.flange_spacing_y_mm:g} mm leaves less than {bone.wall_mm:g} mm between the rows of bolt holes",
        ((0.0, 0.0), *at_least(minimum)),
    )


@RULES.rule("bone.flange_thickness_mm")
def flange_prints(design: DesignTables) -> Violation | None:
    """The flange is not thinner than a wall."""
    bone = design.bone
    if bone.interface != "flange" or bone.flange_thickness_mm >= bone.wall_mm - SLACK:
        return None
    return Violation(f"{bone.flange_thickness_mm:g} mm is thinner than a wall", at_least(bone.wall_mm))
