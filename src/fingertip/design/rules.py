"""Rules between parameters: what cannot be made is refused here, with the bound and a value that would pass.

A rule reads certain fields. If one of those is faulty by itself the rule is not asked, so that one mistake gives one
sentence, and every other rule still speaks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fingertip.design.dimensions import derive
from fingertip.design.mold_layout import lay_out
from fingertip.errors import Fault

if TYPE_CHECKING:
    from fingertip.design.model import Design

Check = Callable[["Design"], str | None]


@dataclass(frozen=True)
class Rule:
    """A check on a design: the field it blames, the fields it reads, and the sentence it finds (None: passed)."""

    field: str
    reads: frozenset[str]
    check: Check


_RULES: list[Rule] = []


def _rule(field: str, *reads: str) -> Callable[[Check], Check]:
    def enlist(check: Check) -> Check:
        _RULES.append(Rule(field, frozenset((field, *reads)), check))
        return check

    return enlist


def broken(design: Design) -> Iterator[tuple[Fault, frozenset[str]]]:
    """Each broken rule's fault, with the fields the rule reads; the first that breaks for a field speaks for it."""
    blamed: set[str] = set()
    for rule in _RULES:
        if rule.field not in blamed and (sentence := rule.check(design)):
            blamed.add(rule.field)
            yield Fault(rule.field, sentence), rule.reads


_WIDTHS = ("skin.width_mm", "skin.thickness_side_mm", "skin.taper_ratio")
_HEIGHTS = ("skin.semi_axis_palmar_mm", "skin.semi_axis_dorsal_mm", "skin.thickness_dorsal_mm", "skin.thickness_side_mm")
_LENGTHS = ("skin.length_mm", "skin.tip_length_mm")
_FLAT = (
    *_WIDTHS, *_HEIGHTS, *_LENGTHS, "skin.thickness_palmar_mm", "skin.thickness_tip_mm", "bone.squareness_palmar",
    "skin.squareness_tip", "sensor.model", "sensor.distance_from_tip_mm",
)  # fmt: skip
_BONE_LEFT = 1.0  # half width and half height of bone [mm] below which no other rule makes sense


@_rule("skin.tip_length_mm", "skin.length_mm")
def _tip_within_skin(d: Design) -> str | None:
    most = d.skin.length_mm - 2.0
    if d.skin.tip_length_mm <= most:
        return None
    return f"{d.skin.tip_length_mm:g} mm leaves no straight part in a skin of {d.skin.length_mm:g} mm; at most {most:g}."


@_rule("skin.thickness_side_mm", "skin.width_mm", "skin.semi_axis_palmar_mm", "skin.taper_ratio")
def _bone_left_at_sides(d: Design) -> str | None:
    half = min(d.skin.width_mm / 2 * d.skin.taper_ratio, d.skin.semi_axis_palmar_mm)
    most = half - _BONE_LEFT
    if d.skin.thickness_side_mm <= most:
        return None
    return f"{d.skin.thickness_side_mm:g} mm leaves less than {_BONE_LEFT:g} mm of bone inside; at most {_floor(most)} mm."


@_rule("skin.thickness_dorsal_mm", "skin.semi_axis_dorsal_mm")
def _bone_left_dorsally(d: Design) -> str | None:
    most = d.skin.semi_axis_dorsal_mm - _BONE_LEFT
    if d.skin.thickness_dorsal_mm <= most:
        return None
    return f"{d.skin.thickness_dorsal_mm:g} mm leaves less than {_BONE_LEFT:g} mm of bone; at most {_floor(most)} mm."


@_rule("skin.thickness_tip_mm", "skin.tip_length_mm")
def _bone_reaches_tip(d: Design) -> str | None:
    most = d.skin.tip_length_mm - _BONE_LEFT
    if d.skin.thickness_tip_mm <= most:
        return None
    return f"{d.skin.thickness_tip_mm:g} mm is more than the rounded tip holds; at most {_floor(most)} mm."


@_rule("skin.squareness_tip", "skin.taper_ratio", *_LENGTHS)
def _tip_tangent(d: Design) -> str | None:
    if min(derive(d).outer.tip_control(), derive(d).envelope.tip_control()) > 0.05:
        return None
    return "the taper closes the finger before its tip; raise skin.taper_ratio or shorten skin.tip_length_mm."


@_rule("sensor.distance_from_tip_mm", "skin.length_mm", "sensor.model")
def _sensor_within_skin(d: Design) -> str | None:
    most = d.skin.length_mm - derive(d).sensor.head_diameter_mm / 2 - 1.0
    if d.sensor.distance_from_tip_mm <= most:
        return None
    return (
        f"{d.sensor.distance_from_tip_mm:g} mm puts the sensor's head outside the skin of {d.skin.length_mm:g} mm; "
        f"at most {_floor(most)} mm."
    )


@_rule("skin.thickness_palmar_mm", "skin.semi_axis_palmar_mm", *_FLAT)
def _flat_within_bone(d: Design) -> str | None:
    dims = derive(d)
    height = d.skin.semi_axis_palmar_mm * dims.outer.scale_at(dims.sensor_z)
    bone = dims.envelope.section.palmar * dims.envelope.scale_at(dims.sensor_z)
    most, least = height - 0.5, height - bone + 0.2
    if least <= d.skin.thickness_palmar_mm <= most:
        return None
    return (
        f"{d.skin.thickness_palmar_mm:g} mm puts the palmar flat outside the bone's palmar half; "
        f"between {_ceil(least)} and {_floor(most)} mm with this pad and position of the sensor."
    )


@_rule("skin.width_mm", "bone.rim_mm", "sensor.clearance_mm", *_FLAT)
def _sensor_fits_flat(d: Design) -> str | None:
    if _flat_within_bone(d) or _bone_left_at_sides(d) or _tip_within_skin(d) or _sensor_within_skin(d):
        return None  # those rules say it
    if _sensor_margin(d) >= 0:
        return None
    sensor = derive(d).sensor
    needed = sensor.head_diameter_mm + 2 * (d.sensor.clearance_mm + d.bone.rim_mm)
    wider = _least_passing(d.skin.width_mm, 60.0, lambda width: _sensor_margin(d, width) >= 0)
    remedy = (
        f"needs at least {wider:g} mm with this skin and rim"
        if wider
        else "no width up to 60 mm passes: raise sensor.distance_from_tip_mm or bone.squareness_palmar"
    )
    return (
        f"an {sensor.label} and its rim take a flat {needed:.2f} mm across, which a finger of "
        f"{d.skin.width_mm:g} mm does not have; {remedy}."
    )


def _sensor_margin(d: Design, width_mm: float | None = None) -> float:
    if width_mm is not None:
        d = d.model_copy(update={"skin": d.skin.model_copy(update={"width_mm": width_mm})})
    return derive(d).sensor_rim(d.bone.rim_mm, d.sensor.clearance_mm)


@_rule("bone.wall_mm", "sensor.clearance_mm", *_FLAT)
def _slot_fits_flat(d: Design) -> str | None:
    if _sensor_fits_flat(d):
        return None
    dims = derive(d)
    half = dims.sensor.tail_width_mm / 2 + d.sensor.clearance_mm
    room = min(dims.envelope.half_width_at(-dims.flat_depth, z) for z in (0.0, max(0.0, dims.sensor_z)))
    if half + d.bone.wall_mm <= room or room == 0.0:
        return None
    return (
        f"{d.bone.wall_mm:g} mm beside the tail's slot ({2 * half:.2f} mm wide) do not fit the flat "
        f"({2 * room:.2f} mm); at most {_floor(max(0.0, room - half))} mm, or widen the finger."
    )


@_rule("bone.channel_diameter_mm", "bone.wall_mm", *_FLAT)
def _channel_within_base(d: Design) -> str | None:
    section, flat = derive(d).envelope.section, derive(d).flat_depth
    height, wall = flat + section.dorsal, d.bone.wall_mm
    width = 2 * min(section.half_width_at(-flat), section.half_width_at(section.dorsal / 2))
    most = min(width, height) - 2 * wall
    if d.bone.channel_diameter_mm <= most:
        return None
    return (
        f"{d.bone.channel_diameter_mm:g} mm is wider than the base allows ({width:.2f} x {height:.2f} mm with "
        f"{wall:g} mm walls); at most {_floor(max(0.0, most))} mm."
    )


@_rule("bone.channel_bend_radius_mm", "bone.channel_diameter_mm")
def _bend_wider_than_channel(d: Design) -> str | None:
    least = d.bone.channel_diameter_mm / 2 + 0.3
    if d.bone.channel_bend_radius_mm >= least:
        return None
    return (
        f"{d.bone.channel_bend_radius_mm:g} mm folds a channel of {d.bone.channel_diameter_mm:g} mm into itself; "
        f"at least {_ceil(least)} mm."
    )


@_rule(
    "bone.base_length_mm", "bone.channel_diameter_mm", "bone.channel_bend_radius_mm", "bone.wall_mm",
    "bone.relief_length_mm", "sensor.model", "sensor.distance_from_tip_mm", *_LENGTHS,
)  # fmt: skip
def _base_holds_exit(d: Design) -> str | None:
    dims = derive(d)
    least = -dims.channel_exit_z + d.bone.channel_diameter_mm / 2 + d.bone.wall_mm
    if d.bone.base_length_mm >= least:
        return None
    return (
        f"{d.bone.base_length_mm:g} mm ends before the posterior hole (the {dims.sensor.label} is "
        f"{dims.sensor.length_mm:g} mm long); at least {_ceil(least)} mm."
    )


@_rule("bone.relief_length_mm", "sensor.model", "sensor.distance_from_tip_mm", *_LENGTHS)
def _relief_clear_of_pocket(d: Design) -> str | None:
    dims = derive(d)
    pocket = dims.sensor_z - dims.sensor.head_diameter_mm / 2 - d.sensor.clearance_mm
    most = 2 * (pocket - dims.tail_end_z)
    if d.bone.relief_length_mm <= most:
        return None
    return f"{d.bone.relief_length_mm:g} mm reaches under the sensor's head; at most {_floor(max(0.0, most))} mm."


@_rule("bone.post_diameter_mm", *_FLAT)
def _post_within_base(d: Design) -> str | None:
    section, flat = derive(d).envelope.section, derive(d).flat_depth
    most = min(flat + section.dorsal, 2 * section.half_width_at(-flat))
    if d.bone.post_diameter_mm <= most:
        return None
    return f"{d.bone.post_diameter_mm:g} mm is wider than the base; at most {_floor(max(0.0, most))} mm."


@_rule("bone.cross_bolt_diameter_mm", "bone.post_diameter_mm", "bone.post_length_mm", "bone.wall_mm")
def _bolt_within_post(d: Design) -> str | None:
    most = min(d.bone.post_diameter_mm, d.bone.post_length_mm) - 2 * d.bone.wall_mm
    if d.bone.cross_bolt_diameter_mm <= most:
        return None
    return (
        f"{d.bone.cross_bolt_diameter_mm:g} mm leaves less than {d.bone.wall_mm:g} mm of post around it; "
        f"at most {_floor(max(0.0, most))} mm."
    )


@_rule("mold.recess_length_mm", "bone.base_length_mm")
def _recess_within_base(d: Design) -> str | None:
    if d.mold.recess_length_mm <= d.bone.base_length_mm:
        return None
    return (
        f"{d.mold.recess_length_mm:g} mm is longer than the bone's base; "
        f"at most {d.bone.base_length_mm:g} mm (bone.base_length_mm)."
    )


@_rule("mold.gate_diameter_mm", "mold.funnel_diameter_mm")
def _gate_within_funnel(d: Design) -> str | None:
    if d.mold.gate_diameter_mm <= d.mold.funnel_diameter_mm:
        return None
    return f"{d.mold.gate_diameter_mm:g} mm is wider than its funnel; at most {d.mold.funnel_diameter_mm:g} mm."


@_rule("mold.funnel_diameter_mm", "mold.gate_diameter_mm", "mold.vent_diameter_mm", *_WIDTHS)
def _gate_within_cavity(d: Design) -> str | None:
    reach = -lay_out(d, derive(d)).gate_x + d.mold.gate_diameter_mm / 2
    room = d.skin.width_mm / 2 * d.skin.taper_ratio - 0.2
    if reach <= room:
        return None
    return (
        f"{d.mold.funnel_diameter_mm:g} mm pushes the gate {reach:.2f} mm to the side, past the cavity's "
        f"{room:.2f} mm; at most {_floor(max(0.0, d.mold.funnel_diameter_mm - 2 * (reach - room)))} mm."
    )


@_rule("mold.draft_deg", "mold.key_diameter_mm", "mold.key_height_mm")
def _keys_keep_a_top(d: Design) -> str | None:
    radius = 0.4 * d.mold.key_diameter_mm  # the smaller of the two keys
    most = math.degrees(math.atan((radius - 0.4) / d.mold.key_height_mm)) if radius > 0.4 else 0.0
    if d.mold.draft_deg <= most:
        return None
    return f"{d.mold.draft_deg:g} degrees bring the registration keys to a point; at most {_floor(most)} degrees."


@_rule("mold.key_diameter_mm", "mold.land_mm", "mold.nut_width_mm", "mold.recess_length_mm", "skin.length_mm")
def _keys_between_bolts(d: Design) -> str | None:
    layout = lay_out(d, derive(d))
    most = layout.key_space - 2 * d.mold.land_mm
    if d.mold.key_diameter_mm <= most:
        return None
    return f"{d.mold.key_diameter_mm:g} mm does not fit between the bolts; at most {_floor(max(0.0, most))} mm."


@_rule("mold.key_height_mm", "mold.key_clearance_mm", "skin.semi_axis_palmar_mm", "mold.wall_mm")
def _key_socket_keeps_a_floor(d: Design) -> str | None:
    most = d.skin.semi_axis_palmar_mm + d.mold.wall_mm - d.mold.key_clearance_mm - 1.0
    if d.mold.key_height_mm <= most:
        return None
    return f"{d.mold.key_height_mm:g} mm goes through the palmar half; at most {_floor(max(0.0, most))} mm."


@_rule("mold.nut_depth_mm", "skin.semi_axis_palmar_mm", "mold.wall_mm")
def _nut_trap_keeps_a_floor(d: Design) -> str | None:
    most = d.skin.semi_axis_palmar_mm + d.mold.wall_mm - 2.0
    if d.mold.nut_depth_mm <= most:
        return None
    return f"{d.mold.nut_depth_mm:g} mm leaves less than 2 mm under the nut; at most {_floor(max(0.0, most))} mm."


@_rule("mold.nut_width_mm", "mold.bolt_diameter_mm")
def _nut_wider_than_bolt(d: Design) -> str | None:
    least = d.mold.bolt_diameter_mm + 1.0
    if d.mold.nut_width_mm >= least:
        return None
    return f"{d.mold.nut_width_mm:g} mm does not hold a nut on a {d.mold.bolt_diameter_mm:g} mm bolt; at least {least:g} mm."


def _least_passing(low: float, high: float, passes: Callable[[float], bool]) -> float | None:
    """Least value in [low, high] that passes, rounded up to 0.1, by bisection; None if `high` does not pass."""
    if not passes(high):
        return None
    while high - low > 0.01:
        middle = (low + high) / 2
        low, high = (low, middle) if passes(middle) else (middle, high)
    return math.ceil(high * 10 - 1e-9) / 10


def _floor(value: float) -> str:
    """`value` rounded down to two decimals: a bound that is printed must pass when it is typed back in."""
    return f"{math.floor(value * 100 + 1e-9) / 100:g}"


def _ceil(value: float) -> str:
    return f"{math.ceil(value * 100 - 1e-9) / 100:g}"
