"""Rules of the bone's base: posterior hole, tie hole, collar, groove and interface find room."""

from __future__ import annotations

import math

from fingertip.design.geometry.dimensions import compute_dimensions
from fingertip.design.parameters import DesignTables
from fingertip.design.rules.ruleset import SLACK, Ruleset, ceil2, floor2

RULES = Ruleset()

_LENGTHS = ("skin.length_mm", "skin.tip_length_mm")
_FLAT = (
    "skin.width_mm", "skin.thickness_side_mm", "skin.taper_ratio", "skin.semi_axis_palmar_mm",
    "skin.semi_axis_dorsal_mm", "skin.thickness_dorsal_mm", "skin.thickness_palmar_mm", "bone.squareness_palmar",
    "sensor.model", "sensor.distance_from_tip_mm", *_LENGTHS,
)  # fmt: skip


@RULES.rule("bone.wall_mm", "printer.min_wall_mm")
def _walls_print(d: DesignTables) -> str | None:
    if d.bone.wall_mm >= d.printer.min_wall_mm - SLACK:
        return None
    return f"{d.bone.wall_mm:g} mm does not print; at least {d.printer.min_wall_mm:g} mm (printer.min_wall_mm)."


@RULES.rule(
    "bone.base_length_mm", "bone.channel_diameter_mm", "bone.channel_bend_radius_mm", "bone.wall_mm",
    "bone.relief_length_mm", "bone.collar_length_mm", "bone.tie_hole_diameter_mm", "bone.interface",
    "bone.socket_depth_mm", "sensor.model", "sensor.distance_from_tip_mm", "mold.recess_length_mm", *_LENGTHS,
)  # fmt: skip
def _base_holds_everything(d: DesignTables) -> str | None:
    dims, bone = compute_dimensions(d), d.bone
    socket = bone.socket_depth_mm if bone.interface == "socket" else 0.0
    minimum = -dims.tie_hole_z + bone.tie_hole_diameter_mm / 2 + bone.wall_mm + socket
    if bone.base_length_mm >= minimum - SLACK:
        return None
    what = "posterior hole, tie hole and socket" if socket else "posterior hole and tie hole"
    return (
        f"{bone.base_length_mm:g} mm does not hold {what} below the mold's recess (the {dims.sensor.label} is "
        f"{dims.sensor.length_mm:g} mm long); at least {ceil2(minimum)} mm."
    )


@RULES.rule("bone.relief_length_mm", "sensor.model", "sensor.distance_from_tip_mm", *_LENGTHS)
def _relief_clear_of_pocket(d: DesignTables) -> str | None:
    dims = compute_dimensions(d)
    pocket = dims.sensor_z - dims.sensor.head_diameter_mm / 2 - d.sensor.clearance_mm
    maximum = 2 * (pocket - dims.tail_end_z)
    if d.bone.relief_length_mm <= maximum + SLACK:
        return None
    return f"{d.bone.relief_length_mm:g} mm reaches under the sensor's head; at most {floor2(max(0.0, maximum))} mm."


@RULES.rule(
    "sensor.distance_from_tip_mm", "bone.relief_length_mm", "bone.collar_length_mm", "sensor.model", *_LENGTHS,
)  # fmt: skip
def _relief_clear_of_collar(d: DesignTables) -> str | None:
    dims = compute_dimensions(d)
    low, high = dims.relief_proximal_z, dims.tail_end_z + dims.relief_half_length
    if high <= -d.bone.collar_length_mm + SLACK or low >= -SLACK:
        return None
    inwards, outwards = (
        d.sensor.distance_from_tip_mm + low,
        d.sensor.distance_from_tip_mm + high + d.bone.collar_length_mm,
    )
    return (
        f"{d.sensor.distance_from_tip_mm:g} mm ends the tail in the collar, where the solder joints have no room; "
        f"at least {ceil2(outwards)} mm, or at most {floor2(max(0.0, inwards))} mm."
    )


@RULES.rule(
    "bone.collar_inset_mm", "skin.thickness_side_mm", "skin.thickness_dorsal_mm", "bone.wall_mm", "mold.method",
    "mold.sleeve_interference_mm", "mold.silicone_shrinkage_percent", "sensor.clearance_mm",
    "sensor.adhesive_thickness_mm", *_FLAT,
)  # fmt: skip
def _collar_stands_proud(d: DesignTables) -> str | None:
    dims = compute_dimensions(d)
    sides = min(
        _min_cover_of_collar(d, half, thickness) - 0.1
        for half, thickness in (
            (d.skin.width_mm / 2, d.skin.thickness_side_mm),
            (d.skin.semi_axis_dorsal_mm, d.skin.thickness_dorsal_mm),
        )
    )
    passage = dims.flat_depth - dims.pocket_depth + dims.passage_height
    below = d.skin.semi_axis_palmar_mm - passage - d.bone.wall_mm
    maximum = min(sides, below) if dims.tail_passes_collar else sides
    if d.bone.collar_inset_mm <= maximum + SLACK:
        return None
    what = "the collar's height" if maximum == sides else "the collar below the tail's passage"
    return f"{d.bone.collar_inset_mm:g} mm leaves too little of {what}; at most {floor2(max(0.0, maximum))} mm."


def _min_cover_of_collar(d: DesignTables, half_mm: float, thickness_mm: float) -> float:
    """Silicone [mm] that ends on the collar, around the bone or a sleeve's core, which shrinkage makes larger."""
    if d.mold.method == "overmold":
        return thickness_mm
    core = (half_mm - thickness_mm - d.mold.sleeve_interference_mm) * compute_dimensions(d).shrinkage
    return min(thickness_mm, half_mm - core)


@RULES.rule(
    "bone.groove_depth_mm", "bone.groove_width_mm", "bone.groove_distance_mm", "bone.wall_mm", "sensor.clearance_mm",
    *_FLAT,
)  # fmt: skip
def _groove_beside_slot(d: DesignTables) -> str | None:
    dims = compute_dimensions(d)
    depth, section = d.bone.groove_depth_mm, dims.envelope.section
    low = d.bone.groove_distance_mm
    z = low + depth + d.bone.groove_width_mm
    head = dims.sensor_z - dims.sensor.head_diameter_mm / 2 - d.sensor.clearance_mm - d.bone.rim_mm
    if depth == 0.0:
        return None
    join = d.skin.length_mm - d.skin.tip_length_mm
    if z + depth > min(head, join - 0.1) + SLACK:
        where = "into the sensor's head at" if head < join else "into the rounded tip, which begins at"
        return (
            f"{depth:g} mm deep and {d.bone.groove_width_mm:g} mm wide, {low:g} mm from the collar, the groove runs "
            f"{where} {min(head, join):.2f} mm; shorten bone.groove_distance_mm or bone.groove_width_mm, or "
            "leave the groove out with at most 0 mm."
        )
    scale = dims.envelope.scale_at(min(z, head)) * (1 - depth / section.half_width)
    room = section.half_width_at(-dims.flat_depth, scale)
    slot = dims.sensor.tail_width_mm / 2 + d.sensor.clearance_mm + d.bone.wall_mm
    if room >= slot - SLACK:
        return None
    return f"{depth:g} mm cuts the wall beside the tail's slot; at most {floor2(max(0.0, depth - slot + room))} mm."


@RULES.rule("bone.tie_hole_diameter_mm", "bone.wall_mm", "skin.semi_axis_dorsal_mm", "skin.thickness_dorsal_mm")
def _tie_hole_within_back(d: DesignTables) -> str | None:
    maximum = (d.skin.semi_axis_dorsal_mm - d.skin.thickness_dorsal_mm) / 2 - d.bone.wall_mm
    if d.bone.tie_hole_diameter_mm <= maximum + SLACK:
        return None
    return (
        f"{d.bone.tie_hole_diameter_mm:g} mm does not fit the back of the base; at most {floor2(max(0.0, maximum))} mm."
    )


@RULES.rule("bone.post_diameter_mm", "bone.interface", *_FLAT)
def _post_within_base(d: DesignTables) -> str | None:
    if d.bone.interface != "plain":
        return None
    maximum = _base_room(d)
    if d.bone.post_diameter_mm <= maximum + SLACK:
        return None
    return f"{d.bone.post_diameter_mm:g} mm is wider than the base; at most {floor2(max(0.0, maximum))} mm."


@RULES.rule("bone.socket_diameter_mm", "bone.interface", "bone.wall_mm", *_FLAT)
def _socket_within_base(d: DesignTables) -> str | None:
    if d.bone.interface != "socket":
        return None
    maximum = _base_room(d) - 2 * d.bone.wall_mm
    if d.bone.socket_diameter_mm <= maximum + SLACK:
        return None
    return (
        f"{d.bone.socket_diameter_mm:g} mm leaves less than {d.bone.wall_mm:g} mm of base around it; "
        f"at most {floor2(max(0.0, maximum))} mm."
    )


def _base_room(d: DesignTables) -> float:
    """Diameter [mm] of the largest circle about the middle of the base's height that stays inside its section.

    Sampled at 64 places of the circle and found by bisection.
    """
    dims = compute_dimensions(d)
    section, flat = dims.envelope.section, dims.flat_depth
    middle, low, high = (section.dorsal - flat) / 2, 0.0, (section.dorsal + flat) / 2
    if high <= 0.0:
        return 0.0
    around = [(math.cos(a), math.sin(a)) for a in (math.pi * (i / 64 - 0.5) for i in range(65))]
    for _ in range(30):
        r = (low + high) / 2
        inside = all(r * c <= section.half_width_at(max(middle + r * s, -flat)) + SLACK for c, s in around)
        low, high = (r, high) if inside else (low, r)
    return 2 * low


@RULES.rule(
    "bone.cross_bolt_diameter_mm", "bone.post_diameter_mm", "bone.post_length_mm", "bone.wall_mm", "bone.interface",
    "bone.socket_depth_mm", "bone.socket_diameter_mm",
)  # fmt: skip
def _bolt_within_interface(d: DesignTables) -> str | None:
    bone = d.bone
    socket = bone.interface == "socket"
    across, along = (bone.socket_diameter_mm + bone.wall_mm, bone.socket_depth_mm) if socket else (
        bone.post_diameter_mm, bone.post_length_mm
    )  # fmt: skip
    maximum = min(across, along) - 2 * bone.wall_mm
    if bone.cross_bolt_diameter_mm <= maximum + SLACK:
        return None
    return (
        f"{bone.cross_bolt_diameter_mm:g} mm leaves less than {bone.wall_mm:g} mm around it in "
        f"{'the socket' if socket else 'the post'}; at most {floor2(max(0.0, maximum))} mm."
    )
