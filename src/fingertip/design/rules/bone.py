"""Rules of the bone, its wire hole, trough, collar and groove, and of mold and core."""

from __future__ import annotations

from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.casting_layout import MAX_BENDING_MM
from fingertip.design.rules.ruleset import SLACK, Limit, Ruleset, Violation, at_most
from fingertip.design.rules.skin import (
    SOUND_SECTIONS,
    bone_left_at_sides,
    bone_left_dorsally,
    tip_within_skin,
)
from fingertip.foundation.numerics import bisect
from fingertip.models.dimensions import HEAD_MM, KNOT_WIRES, TAIL_MM
from fingertip.models.mold_layout import BELT_MM

WALL_RULES = Ruleset()
RULES = Ruleset()
MOLD_RULES = Ruleset()

_BESIDE_WIRE_MM = 0.1
"""Gap between the wires and their hole [mm]."""
_BEND_MARGIN = 0.3
"""Minimum radius of the channel's inner wall at its bend [mm]."""
_MIN_COLLAR_HEIGHT = 0.1
"""Minimum height of the collar's face, on which the skin ends [mm]."""
_BEFORE_TIP = 0.1
_DEPTH_HALVINGS = 30
_DEPTHS = 16
"""Intervals of the base's palmar height at which its step to the collar is sampled."""


@WALL_RULES.at_least("bone.wall_mm")
def walls_print(design: DesignTables) -> Limit | None:
    minimum = design.printer.min_wall_mm
    return Limit(minimum, f"is thinner than the {minimum:g} mm of printer.min_wall_mm")


@RULES.at_least("bone.channel_diameter_mm")
def hole_takes_both_wires(design: DesignTables) -> Limit:
    """Two wires side by side leave half of the hole free for the air of the sensor's vent."""
    wires = 2 * design.sensor.wire_diameter_mm
    return Limit(
        wires + 2 * _BESIDE_WIRE_MM,
        f"does not take two wires of {design.sensor.wire_diameter_mm:g} mm",
    )


@RULES.at_most("bone.channel_diameter_mm", hole_takes_both_wires)
def hole_stops_the_knot(design: DesignTables) -> Limit:
    knot = KNOT_WIRES * design.sensor.wire_diameter_mm
    return Limit(
        knot, f"lets a knot in both wires of {design.sensor.wire_diameter_mm:g} mm through"
    )


@RULES.at_most("bone.channel_diameter_mm", bone_left_at_sides, bone_left_dorsally)
def channel_within_base(design: DesignTables) -> Limit | None:
    section = design.dimensions.bone_outline.section
    flat = design.dimensions.flat_depth
    height = flat + section.dorsal
    wall = design.bone.wall_mm
    width = 2 * min(section.half_width_at(-flat), section.half_width_at(section.dorsal / 2))
    size = ""
    # The flat of a bone that another rule refuses can lie outside the bone, which has no size then.
    if min(width, height) > 0.0:
        size = f", which is {width:.2f} mm wide and {height:.2f} mm high"

    return Limit(min(width, height) - 2 * wall, f"leaves no walls of {wall:g} mm in the base{size}")


@RULES.at_least("bone.channel_bend_radius_mm")
def bend_wider_than_channel(design: DesignTables) -> Limit | None:
    diameter = design.bone.channel_diameter_mm
    return Limit(diameter / 2 + _BEND_MARGIN, f"folds a channel of {diameter:g} mm into itself")


@RULES.at_most("bone.channel_bend_radius_mm", channel_within_base)
def bend_within_base(design: DesignTables) -> Limit | None:
    dims = design.dimensions
    room = dims.bone_outline.section.dorsal + dims.flat_depth - dims.pocket_depth
    return Limit(
        room,
        f"ends the channel's bend behind the back of the base, which is {room:.2f} mm from its "
        "trough",
    )


@RULES.at_least("sensor.clearance_mm")
def trough_takes_measured_sensors(design: DesignTables) -> Limit:
    return Limit(
        max(HEAD_MM, TAIL_MM) / 2,
        f"does not take a tail {TAIL_MM:g} mm wider than stated: "
        f"{design.dimensions.sensor.label}s differ",
    )


@RULES.at_most("bone.collar_inset_mm", bone_left_at_sides, bone_left_dorsally)
def collar_carries_skin(design: DesignTables) -> Limit | None:
    dims = design.dimensions
    sides = min(
        # The silicone that ends on the collar, around the enlarged core.
        min(thickness, half - (half - thickness - design.mold.core_inset_mm) * dims.shrinkage)
        - _MIN_COLLAR_HEIGHT
        for half, thickness in (
            (design.skin.width_mm / 2, design.skin.thickness_side_mm),
            (design.skin.semi_axis_dorsal_mm, design.skin.thickness_dorsal_mm),
        )
    )
    if dims.crown:  # the pad's base is lower than the bone's outline
        steps = (
            dims.collar_step_at(dims.base_flat_depth * i / _DEPTHS) for i in range(_DEPTHS + 1)
        )
        sides = min(sides, design.bone.collar_inset_mm + min(steps) - _MIN_COLLAR_HEIGHT)

    return Limit(sides, "leaves too little of the collar's height")


@RULES.rule("bone.groove_depth_mm", tip_within_skin, bone_left_at_sides)
def groove_clear_of_sensor(design: DesignTables) -> Violation | None:
    """The groove ends before the sensor's head and keeps the wall beside its slot."""
    dims = design.dimensions
    depth = design.bone.groove_depth_mm
    width = design.bone.groove_width_mm
    low = design.bone.groove_distance_mm
    if depth == 0.0:
        return None

    z = low + depth + width
    head = (
        dims.sensor_z
        - dims.sensor.head_diameter_mm / 2
        - design.sensor.clearance_mm
        - design.bone.rim_mm
    )
    join = dims.taper_end_z
    limit = min(head, join - _BEFORE_TIP)

    if z + depth > limit + SLACK:
        obstacle = "the rim of the sensor's head" if head < join else "the rounded tip"
        # A short finger leaves no space at all, for which the limit is negative.
        begins = f", which begins {limit:.2f} mm from the collar" if limit > 0.0 else ""
        return Violation(
            f"{depth:g} mm deep and {width:g} mm wide, {low:g} mm from the collar, the groove "
            "runs into "
            f"{obstacle}{begins}",
            at_most(max(0.0, (limit - low - width) / 2)),
        )

    section = dims.bone_outline.section
    slot = dims.tail_half_width + design.bone.wall_mm

    def keeps_wall(depth: float) -> bool:
        scale = dims.bone_outline.scale_at(min(low + depth + width, head))
        scale *= 1 - depth / section.half_width
        return section.half_width_at(-dims.flat_depth, scale) >= slot - SLACK

    if keeps_wall(depth):
        return None

    # The flat narrows faster than the groove deepens, so the bound has no closed form.
    maximum = 0.0
    if keeps_wall(0.0):
        maximum, _ = bisect(keeps_wall, 0.0, depth, halvings=_DEPTH_HALVINGS)

    return Violation(f"{depth:g} mm cuts into the wall beside the tail's slot", at_most(maximum))


@MOLD_RULES.at_least("mold.wall_mm")
def mold_wall_holds_cuts(design: DesignTables) -> Limit:
    depth = max(BELT_MM[1], design.mold.engraving_depth_mm)
    wall = design.printer.min_wall_mm
    return Limit(
        depth + wall, f"leaves less than printer.min_wall_mm={wall:g} behind belts and letters"
    )


@MOLD_RULES.rule("skin.thickness_dorsal_mm", *SOUND_SECTIONS)
def cup_stays_closed(design: DesignTables) -> Violation | None:
    pressure = design.mold_layout.plunge_kpa
    most = design.mold_layout.held_kpa
    if pressure <= most:
        return None

    return Violation(
        f"{design.skin.thickness_dorsal_mm:g} mm lets {design.silicone.material.label} past the "
        "core so slowly that "
        f"{pressure:.2f} kPa part the halves of the mold, whose bands hold {most:.2f} kPa",
        lack=pressure / most - 1.0,
    )


@MOLD_RULES.rule("skin.semi_axis_dorsal_mm", *SOUND_SECTIONS)
def core_stays_straight(design: DesignTables) -> Violation | None:
    bending = design.mold_layout.core_bending_mm(design.mold_layout.plunge_kpa)
    if bending <= MAX_BENDING_MM:
        return None

    return Violation(
        f"{design.skin.semi_axis_dorsal_mm:g} mm leaves a core that "
        f"{design.silicone.material.label} bends by "
        f"{bending:.4f} mm while it is lowered, more than {MAX_BENDING_MM:g} mm",
        lack=bending / MAX_BENDING_MM - 1.0,
    )
