"""Rules of skin and sensor: the sensor fits the bone, and the bone the skin; the force curve."""

from __future__ import annotations

from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.sections import half_widths_along
from fingertip.design.geometry.skin_thickness import min_skin_thickness
from fingertip.design.rules.ruleset import SLACK, Limit, Ruleset, Violation, at_most
from fingertip.models.dimensions import TAB_WIDTH_MM

RULES = Ruleset()


@RULES.at_most("custom_sensor.active_diameter_mm")
def active_area_within_head(design: DesignTables) -> Limit | None:
    if design.sensor.model != "custom":
        return None

    return Limit(design.custom_sensor.head_diameter_mm, "is wider than the sensor's head")


@RULES.at_least("custom_sensor.tail_width_mm", when=lambda design: design.sensor.model == "custom")
def tail_holds_its_tabs(design: DesignTables) -> Limit:
    pitch = design.dimensions.sensor.tab_pitch_mm
    return Limit(
        pitch + TAB_WIDTH_MM,
        f"does not hold two solder tabs of {TAB_WIDTH_MM:g} mm, {pitch:g} mm apart",
    )


_EDGE_THICKNESS = 0.5
"""Minimum silicone beside the edges of the bone's flat, along x [mm]: they cut through less."""
_EDGE_SECTIONS = 64
"""Intervals along the bone at which the silicone beside the edges is sampled."""
_THICKNESS_SLACK = 2e-3
"""Slack of the minimum skin thickness [mm], which is computed to 1e-3 mm.
The nominal thickness itself must pass.
"""
_MIN_BONE = 1.0
"""Half width and half height of bone [mm] below which no other rule makes sense."""
_MIN_STRAIGHT = 2.0
_MIN_FLAT_DEPTH = 0.5
"""Minimum depth of the bone's flat below the parting plane [mm]."""
_MIN_FLAT_CUT = 0.2
"""Minimum height that the flat cuts off the bone's palmar half [mm]."""
_BEHIND_SENSOR = 1.0
"""Minimum distance of the sensor's head from the skin's proximal end [mm]."""
_MIN_TIP_CONTROL = 0.05
"""Minimum scale of the tip's control point: below it the taper closes the finger before its tip."""


@RULES.at_most("skin.tip_length_mm")
def tip_within_skin(design: DesignTables) -> Limit | None:
    length = design.skin.length_mm
    return Limit(length - _MIN_STRAIGHT, f"leaves no straight part in {length:g} mm of skin")


@RULES.at_most("skin.thickness_side_mm")
def bone_left_at_sides(design: DesignTables) -> Limit | None:
    half = min(design.skin.width_mm / 2 * design.skin.taper_ratio, design.skin.semi_axis_palmar_mm)
    return Limit(half - _MIN_BONE, f"leaves less than {_MIN_BONE:g} mm of bone at the sides")


@RULES.at_most("skin.thickness_dorsal_mm")
def bone_left_dorsally(design: DesignTables) -> Limit | None:
    return Limit(
        design.skin.semi_axis_dorsal_mm - _MIN_BONE,
        f"leaves less than {_MIN_BONE:g} mm of bone at the back",
    )


@RULES.at_most("skin.thickness_tip_mm")
def bone_reaches_tip(design: DesignTables) -> Limit | None:
    return Limit(design.skin.tip_length_mm - _MIN_BONE, "is more than the rounded tip holds")


@RULES.rule("skin.taper_ratio", tip_within_skin, bone_left_at_sides, bone_reaches_tip)
def taper_reaches_tip(design: DesignTables) -> Violation | None:
    dims = design.dimensions
    if min(dims.outer.tip_control(), dims.bone_outline.tip_control()) > _MIN_TIP_CONTROL:
        return None

    return Violation(f"{design.skin.taper_ratio:g} closes the finger before its tip")


@RULES.at_most("sensor.distance_from_tip_mm")
def sensor_within_skin(design: DesignTables) -> Limit | None:
    length = design.skin.length_mm
    head = design.dimensions.sensor.head_diameter_mm
    return Limit(
        length - head / 2 - _BEHIND_SENSOR,
        f"puts the sensor's head outside the skin of {length:g} mm",
    )


@RULES.rule("skin.crown_offset_mm", tip_within_skin)
def crown_on_taper(design: DesignTables) -> Violation | None:
    dims = design.dimensions
    offset = design.skin.crown_offset_mm
    low = dims.sensor_z - dims.taper_end_z
    high = dims.sensor_z - _MIN_STRAIGHT
    if design.skin.crown_radius_mm == 0.0 or low - SLACK <= offset <= high + SLACK:
        return None

    where = "on the rounded tip" if offset < low else "outside the skin"
    return Violation(f"{offset:g} mm puts the apex of the crown {where}", ((low, high),))


@RULES.at_most(
    "skin.crown_drop_mm", crown_on_taper, when=lambda design: design.skin.crown_radius_mm
)
def crown_within_pad(design: DesignTables) -> Limit:
    return Limit(design.dimensions.max_crown_drop, "is more than fits proximal to the crown's apex")


@RULES.at_most(
    "skin.crown_radius_mm", crown_on_taper, when=lambda design: design.skin.crown_radius_mm
)
def crown_ends_before_tip(design: DesignTables) -> Limit:
    return Limit(design.dimensions.max_crown_radius, "runs past the tip")


@RULES.rule("skin.crown_radius_mm", crown_within_pad, crown_ends_before_tip)
def crown_reaches_tip(design: DesignTables) -> Violation | None:
    dims = design.dimensions
    radius = design.skin.crown_radius_mm
    if radius == 0.0 or dims.outer.spans[-1].palmar[1] > _MIN_TIP_CONTROL:
        return None

    # A larger radius slopes down later.
    return Violation(
        f"{radius:g} mm slopes the pad down to the parting plane before the tip",
        ((0.0, 0.0), (radius, dims.max_crown_radius)),
    )


@RULES.rule("skin.thickness_palmar_mm", tip_within_skin, crown_reaches_tip)
def flat_within_bone(design: DesignTables) -> Violation | None:
    dims = design.dimensions
    platform = design.bone.platform_mm
    height = design.skin.semi_axis_palmar_mm * dims.outer.palmar_scale_at(dims.sensor_z)
    bone = dims.bone_outline.section.palmar * dims.bone_outline.scale_at(dims.sensor_z)
    maximum = height - platform - _MIN_FLAT_DEPTH
    minimum = height - bone + _MIN_FLAT_CUT
    if minimum <= design.skin.thickness_palmar_mm <= maximum + SLACK:
        return None

    if design.skin.thickness_palmar_mm < minimum:
        where = "beyond the bone's palmar surface"
    else:
        where = f"less than {_MIN_FLAT_DEPTH:g} mm below the parting plane"

    return Violation(
        f"{design.skin.thickness_palmar_mm:g} mm puts the bone's flat {where}",
        ((minimum, maximum),),
        "with this pad and sensor position",
    )


@RULES.at_most("bone.platform_mm", tip_within_skin)
def ramp_on_flat(design: DesignTables) -> Limit | None:
    """The ramp of the platform begins on the flat, where nothing else is cut into the bone."""
    return Limit(
        design.dimensions.max_platform,
        "leaves no room for the ramp between platform and collar, groove or tail's end",
    )


@RULES.rule(
    "skin.width_mm", flat_within_bone, bone_left_at_sides, tip_within_skin, sensor_within_skin
)
def sensor_fits_flat(design: DesignTables) -> Violation | None:
    rim = design.bone.rim_mm
    clearance = design.sensor.clearance_mm
    sensor = design.dimensions.sensor
    margin = design.sensor_rim_margin
    if margin >= 0:
        return None

    needed = sensor.head_diameter_mm + 2 * (clearance + rim)
    return Violation(
        f"the {sensor.label} and its rim need a flat {needed:.2f} mm across, which a finger of "
        f"{design.skin.width_mm:g} mm does not have",
        note="with this skin and rim",
        lack=-margin,
    )


@RULES.rule("bone.palmar_fullness", sensor_fits_flat, flat_within_bone)
def flat_edges_within_skin(design: DesignTables) -> Violation | None:
    dims = design.dimensions
    bone = dims.bone_outline
    end = bone.tip.z if bone.tip else 0.0
    heights = [end * i / _EDGE_SECTIONS for i in range(_EDGE_SECTIONS + 1)]
    widths = half_widths_along(dims.outer, -dims.flat_depth, heights)
    thickness = float((widths - half_widths_along(bone, -dims.flat_depth, heights)).min())
    if thickness >= _EDGE_THICKNESS:
        return None

    return Violation(
        f"{design.bone.palmar_fullness:g} brings the edges of the bone's flat to "
        f"{max(0.0, thickness):.2f} mm from "
        f"the skin's surface (measured sideways), less than {_EDGE_THICKNESS:g} mm",
        lack=_EDGE_THICKNESS - thickness,
    )


SOUND_SECTIONS = (
    tip_within_skin,
    bone_left_at_sides,
    bone_left_dorsally,
    bone_reaches_tip,
    taper_reaches_tip,
    sensor_fits_flat,
    flat_within_bone,
    flat_edges_within_skin,
)
"""Prerequisites of every rule that measures the silicone between bone and surface."""


@RULES.at_most("skin.min_thickness_mm", *SOUND_SECTIONS, slack=_THICKNESS_SLACK)
def skin_is_thick_enough(design: DesignTables) -> Limit | None:
    thinnest = min_skin_thickness(design, design.dimensions)
    return Limit(thinnest, f"is more than the {thinnest:.2f} mm at the skin's thinnest place")


@RULES.rule("bone.wall_mm", sensor_fits_flat)
def slot_fits_flat(design: DesignTables) -> Violation | None:
    dims = design.dimensions
    half = dims.tail_half_width
    room = min(
        dims.bone_outline.half_width_at(-dims.flat_depth_at(z), z)
        for z in (0.0, max(0.0, dims.sensor_z))
    )
    if half + design.bone.wall_mm <= room or room == 0.0:
        return None

    return Violation(
        f"{design.bone.wall_mm:g} mm on each side of the tail's slot ({2 * half:.2f} mm wide) do "
        "not fit the flat "
        f"({2 * room:.2f} mm wide)",
        at_most(room - half),
    )


FORCE_CURVE_RULES = Ruleset()


@FORCE_CURVE_RULES.at_most("force_curve.turn_on_n")
def turn_on_below_calibration(design: DesignTables) -> Limit | None:
    return Limit(design.force_curve.min_force_n, "is above the smallest force of the calibration")


@FORCE_CURVE_RULES.at_least("force_curve.max_force_n")
def calibration_spans_forces(design: DesignTables) -> Limit | None:
    return Limit(design.force_curve.min_force_n, "is below the smallest force of the calibration")
