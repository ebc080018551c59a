"""Rules between skin, bone and sensor: the sensor fits the bone, the bone fits the skin."""

from __future__ import annotations

import math
from collections.abc import Callable

from fingertip.design.geometry.dimensions import compute_dimensions
from fingertip.design.geometry.misalignment import inset_mm
from fingertip.design.geometry.skin_thickness import min_skin_thickness
from fingertip.design.parameters import DesignTables
from fingertip.design.rules.ruleset import SLACK, Ruleset, ceil2, floor2

RULES = Ruleset()

_WIDTHS = ("skin.width_mm", "skin.thickness_side_mm", "skin.taper_ratio")
_HEIGHTS = (
    "skin.semi_axis_palmar_mm",
    "skin.semi_axis_dorsal_mm",
    "skin.thickness_dorsal_mm",
    "skin.thickness_side_mm",
)
_LENGTHS = ("skin.length_mm", "skin.tip_length_mm")
_FLAT = (
    *_WIDTHS, *_HEIGHTS, *_LENGTHS, "skin.thickness_palmar_mm", "skin.thickness_tip_mm", "bone.squareness_palmar",
    "skin.squareness_tip", "sensor.model", "sensor.distance_from_tip_mm",
)  # fmt: skip
COVER = ("mold.method", "mold.sleeve_interference_mm", "skin.squareness_palmar", "skin.squareness_dorsal", *_FLAT)
"""What the silicone over the bone depends on."""
_EDGE_COVER = 0.5  # silicone beside the edges of the bone's flat [mm], along x: thinner, the edges cut through
_COVER_SLACK = 2e-3  # [mm] the cover is found to 1e-3 mm, and a nominal thickness must not fail by it
_MIN_THICKNESS = 0.2  # lower bound of skin.min_thickness_mm [mm]
_BONE_LEFT = 1.0  # half width and half height of bone [mm] below which no other rule makes sense


@RULES.rule("skin.tip_length_mm", "skin.length_mm")
def _tip_within_skin(d: DesignTables) -> str | None:
    maximum = d.skin.length_mm - 2.0
    if d.skin.tip_length_mm <= maximum + SLACK:
        return None
    return f"{d.skin.tip_length_mm:g} mm leaves no straight part in {d.skin.length_mm:g} mm of skin; at most {maximum:g} mm."


@RULES.rule("skin.thickness_side_mm", "skin.width_mm", "skin.semi_axis_palmar_mm", "skin.taper_ratio")
def _bone_left_at_sides(d: DesignTables) -> str | None:
    half = min(d.skin.width_mm / 2 * d.skin.taper_ratio, d.skin.semi_axis_palmar_mm)
    maximum = half - _BONE_LEFT
    if d.skin.thickness_side_mm <= maximum + SLACK:
        return None
    return f"{d.skin.thickness_side_mm:g} mm leaves less than {_BONE_LEFT:g} mm of bone; at most {floor2(maximum)} mm."


@RULES.rule("skin.thickness_dorsal_mm", "skin.semi_axis_dorsal_mm")
def _bone_left_dorsally(d: DesignTables) -> str | None:
    maximum = d.skin.semi_axis_dorsal_mm - _BONE_LEFT
    if d.skin.thickness_dorsal_mm <= maximum + SLACK:
        return None
    return (
        f"{d.skin.thickness_dorsal_mm:g} mm leaves less than {_BONE_LEFT:g} mm of bone; at most {floor2(maximum)} mm."
    )


@RULES.rule("skin.thickness_tip_mm", "skin.tip_length_mm")
def _bone_reaches_tip(d: DesignTables) -> str | None:
    maximum = d.skin.tip_length_mm - _BONE_LEFT
    if d.skin.thickness_tip_mm <= maximum + SLACK:
        return None
    return f"{d.skin.thickness_tip_mm:g} mm is more than the rounded tip holds; at most {floor2(maximum)} mm."


@RULES.rule("skin.squareness_tip", "skin.taper_ratio", *_LENGTHS)
def _tip_tangent(d: DesignTables) -> str | None:
    if min(compute_dimensions(d).outer.tip_control(), compute_dimensions(d).envelope.tip_control()) > 0.05:
        return None
    return "the taper closes the finger before its tip; raise skin.taper_ratio or shorten skin.tip_length_mm."


@RULES.rule("sensor.distance_from_tip_mm", "skin.length_mm", "sensor.model")
def _sensor_within_skin(d: DesignTables) -> str | None:
    maximum = d.skin.length_mm - compute_dimensions(d).sensor.head_diameter_mm / 2 - 1.0
    if d.sensor.distance_from_tip_mm <= maximum + SLACK:
        return None
    return (
        f"{d.sensor.distance_from_tip_mm:g} mm puts the sensor's head outside the skin of {d.skin.length_mm:g} mm; "
        f"at most {floor2(maximum)} mm."
    )


@RULES.rule("skin.thickness_palmar_mm", "skin.semi_axis_palmar_mm", *_FLAT)
def _flat_within_bone(d: DesignTables) -> str | None:
    dims = compute_dimensions(d)
    height = d.skin.semi_axis_palmar_mm * dims.outer.scale_at(dims.sensor_z)
    bone = dims.envelope.section.palmar * dims.envelope.scale_at(dims.sensor_z)
    maximum, minimum = height - 0.5, height - bone + 0.2
    if minimum <= d.skin.thickness_palmar_mm <= maximum + SLACK:
        return None
    return (
        f"{d.skin.thickness_palmar_mm:g} mm puts the palmar flat outside the bone's palmar half; "
        f"between {ceil2(minimum)} and {floor2(maximum)} mm with this pad and position of the sensor."
    )


@RULES.rule("skin.width_mm", "bone.rim_mm", "sensor.clearance_mm", *_FLAT)
def _sensor_fits_flat(d: DesignTables) -> str | None:
    if _flat_within_bone(d) or _bone_left_at_sides(d) or _tip_within_skin(d) or _sensor_within_skin(d):
        return None  # those rules say it
    if _sensor_margin(d) >= 0:
        return None
    sensor = compute_dimensions(d).sensor
    needed = sensor.head_diameter_mm + 2 * (d.sensor.clearance_mm + d.bone.rim_mm)
    wider = _min_passing(d.skin.width_mm, 60.0, lambda width: _sensor_margin(d, width) >= 0)
    remedy = (
        f"needs at least {wider:g} mm with this skin and rim"
        if wider
        else "no width up to 60 mm passes: raise sensor.distance_from_tip_mm or bone.squareness_palmar"
    )
    return (
        f"an {sensor.label} and its rim take a flat {needed:.2f} mm across, which a finger of "
        f"{d.skin.width_mm:g} mm does not have; {remedy}."
    )


def _sensor_margin(d: DesignTables, width_mm: float | None = None) -> float:
    if width_mm is not None:
        d = d.model_copy(update={"skin": d.skin.model_copy(update={"width_mm": width_mm})})
    return compute_dimensions(d).sensor_rim_margin(d.bone.rim_mm, d.sensor.clearance_mm)


@RULES.rule("bone.squareness_palmar", *_FLAT)
def _edges_within_skin(d: DesignTables) -> str | None:
    if _sensor_fits_flat(d) or _flat_within_bone(d) or _edge_cover(d) >= _EDGE_COVER:
        return None
    rounder = _min_passing(
        -d.bone.squareness_palmar, -0.5, lambda w: _edge_cover(d, -w) >= _EDGE_COVER
    )  # bisection runs upwards: the negative of the weight does
    remedy = f"at most {floor2(-rounder)}" if rounder else "raise skin.thickness_side_mm or skin.squareness_palmar"
    return (
        f"{d.bone.squareness_palmar:g} brings the edges of the bone's flat to {_edge_cover(d):.2f} mm "
        f"(sideways) from the skin's surface, and {_EDGE_COVER:g} mm are needed; {remedy}."
    )


def cover_is_sound(d: DesignTables) -> bool:
    """Whether bone and skin are such that the silicone between them can be measured; if not, their rules say why."""
    forms = (_tip_within_skin, _bone_left_at_sides, _bone_left_dorsally, _bone_reaches_tip, _tip_tangent)
    return not any(rule(d) for rule in (*forms, _sensor_fits_flat, _flat_within_bone, _edges_within_skin))


@RULES.rule("skin.min_thickness_mm", *COVER)
def _thinnest_place(d: DesignTables) -> str | None:
    if not cover_is_sound(d):
        return None
    cover = min_skin_thickness(compute_dimensions(d), inset_mm(d))
    thinnest = min(cover, d.skin.thickness_tip_mm)
    if d.skin.min_thickness_mm <= thinnest + _COVER_SLACK:
        return None
    bound = f"at most {floor2(thinnest)} mm, or " if thinnest >= _MIN_THICKNESS else ""
    return (
        f"{d.skin.min_thickness_mm:g} mm is more than the {thinnest:.2f} mm at the skin's thinnest place; {bound}"
        "lower bone.squareness_palmar or raise the skin's thickness."
    )


def _edge_cover(d: DesignTables, weight: float | None = None) -> float:
    """Least silicone [mm] beside the edges of the flat, along x, over the length of the bone in the skin."""
    if weight is not None:
        d = d.model_copy(update={"bone": d.bone.model_copy(update={"squareness_palmar": weight})})
    dims = compute_dimensions(d)
    end = dims.envelope.tip.z if dims.envelope.tip else 0.0
    heights = (end * i / 64 for i in range(65))
    return min(
        dims.outer.half_width_at(-dims.flat_depth, z) - dims.envelope.half_width_at(-dims.flat_depth, z)
        for z in heights
    )


@RULES.rule("bone.wall_mm", "sensor.clearance_mm", *_FLAT)
def _slot_fits_flat(d: DesignTables) -> str | None:
    if _sensor_fits_flat(d):
        return None
    dims = compute_dimensions(d)
    half = dims.sensor.tail_width_mm / 2 + d.sensor.clearance_mm
    room = min(dims.envelope.half_width_at(-dims.flat_depth, z) for z in (0.0, max(0.0, dims.sensor_z)))
    if half + d.bone.wall_mm <= room or room == 0.0:
        return None
    return (
        f"{d.bone.wall_mm:g} mm beside the tail's slot ({2 * half:.2f} mm wide) do not fit the flat "
        f"({2 * room:.2f} mm); at most {floor2(max(0.0, room - half))} mm, or widen the finger."
    )


@RULES.rule("bone.channel_diameter_mm", "bone.wall_mm", *_FLAT)
def _channel_within_base(d: DesignTables) -> str | None:
    section, flat = compute_dimensions(d).envelope.section, compute_dimensions(d).flat_depth
    height, wall = flat + section.dorsal, d.bone.wall_mm
    width = 2 * min(section.half_width_at(-flat), section.half_width_at(section.dorsal / 2))
    maximum = min(width, height) - 2 * wall
    if d.bone.channel_diameter_mm <= maximum + SLACK:
        return None
    return (
        f"{d.bone.channel_diameter_mm:g} mm is wider than the base allows ({width:.2f} x {height:.2f} mm with "
        f"{wall:g} mm walls); at most {floor2(max(0.0, maximum))} mm."
    )


@RULES.rule("bone.channel_bend_radius_mm", "bone.channel_diameter_mm")
def _bend_wider_than_channel(d: DesignTables) -> str | None:
    minimum = d.bone.channel_diameter_mm / 2 + 0.3
    if d.bone.channel_bend_radius_mm >= minimum - SLACK:
        return None
    return (
        f"{d.bone.channel_bend_radius_mm:g} mm folds a channel of {d.bone.channel_diameter_mm:g} mm into itself; "
        f"at least {ceil2(minimum)} mm."
    )


def _min_passing(low: float, high: float, passes: Callable[[float], bool]) -> float | None:
    """Least value in [low, high] that passes, rounded up to 0.1, by bisection; None if `high` does not pass."""
    if not passes(high):
        return None
    while high - low > 0.01:
        middle = (low + high) / 2
        low, high = (low, middle) if passes(middle) else (middle, high)
    return math.ceil(high * 10 - 1e-9) / 10
