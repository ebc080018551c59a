"""Rules of the mold: everything around the cavity finds room, and the halves can be made."""

from __future__ import annotations

import math

from fingertip.design.dimensions import derive
from fingertip.design.draft import drafted
from fingertip.design.mold_layout import lay_out
from fingertip.design.ruleset import SLACK, Ruleset, ceil2, floor2
from fingertip.design.tables import Tables

RULES = Ruleset()
_WIDTHS = ("skin.width_mm", "skin.taper_ratio")
_COLLAR_LEFT = 0.6  # length of the collar [mm] where its draft has taken most of it


@RULES.rule("mold.recess_length_mm", "bone.base_length_mm")
def _recess_within_base(d: Tables) -> str | None:
    if d.mold.recess_length_mm <= d.bone.base_length_mm:
        return None
    return (
        f"{d.mold.recess_length_mm:g} mm is longer than the bone's base; "
        f"at most {d.bone.base_length_mm:g} mm (bone.base_length_mm)."
    )


@RULES.rule(
    "mold.fit_clearance_mm", "bone.collar_inset_mm", "mold.draft_deg", "skin.width_mm", "skin.semi_axis_palmar_mm",
    "skin.semi_axis_dorsal_mm", "skin.squareness_palmar", "skin.squareness_dorsal",
)  # fmt: skip
def _recess_within_cavity(d: Tables) -> str | None:
    dims = derive(d)
    section, slope = dims.collar.section, dims.draft_slope
    wider = drafted(section, slope).half_width - section.half_width if slope else 0.0
    most = d.bone.collar_inset_mm - wider - 0.05
    if d.mold.fit_clearance_mm <= most + SLACK:
        return None
    return (
        f"{d.mold.fit_clearance_mm:g} mm opens the collar's recess past the skin's edge; at most "
        f"{floor2(max(0.0, most))} mm (bone.collar_inset_mm)."
    )


@RULES.rule("mold.recess_length_mm", "bone.collar_length_mm", "mold.fit_clearance_mm", "mold.draft_deg")
def _recess_holds_collar(d: Tables) -> str | None:
    gap = d.mold.fit_clearance_mm * math.hypot(1.0, derive(d).draft_slope)
    least = d.bone.collar_length_mm + gap + 1.0
    if d.mold.recess_length_mm >= least - SLACK:
        return None
    return f"{d.mold.recess_length_mm:g} mm does not hold the collar and a wall behind it; at least {ceil2(least)} mm."


@RULES.rule(
    "bone.collar_length_mm", "mold.draft_deg", "bone.collar_inset_mm", "skin.semi_axis_palmar_mm",
    "skin.semi_axis_dorsal_mm",
)  # fmt: skip
def _collar_outlasts_its_draft(d: Tables) -> str | None:
    section, slope = derive(d).collar.section, derive(d).draft_slope
    least = _COLLAR_LEFT + slope * max(section.palmar, section.dorsal)
    if d.bone.collar_length_mm >= least - SLACK:
        return None
    return (
        f"{d.bone.collar_length_mm:g} mm is used up by a draft of {d.mold.draft_deg:g} degrees before the collar's "
        f"palmar or dorsal end; at least {ceil2(least)} mm, or less mold.draft_deg."
    )


@RULES.rule("mold.pry_depth_mm", "mold.land_mm")
def _pry_slot_clear_of_bolts(d: Tables) -> str | None:
    most = d.mold.land_mm - 0.4
    if d.mold.pry_depth_mm <= most + SLACK:
        return None
    return f"{d.mold.pry_depth_mm:g} mm reaches the keys; at most {floor2(most)} mm (mold.land_mm)."


@RULES.rule("mold.pry_width_mm", "skin.length_mm", "mold.recess_length_mm")
def _pry_slot_within_side(d: Tables) -> str | None:
    layout = lay_out(d, derive(d))
    most = layout.distal_z - layout.proximal_z - 2.0
    if d.mold.pry_width_mm <= most + SLACK:
        return None
    return f"{d.mold.pry_width_mm:g} mm is longer than the mold's side; at most {floor2(most)} mm."


@RULES.rule("mold.engraving_depth_mm", "mold.wall_mm")
def _engraving_keeps_a_wall(d: Tables) -> str | None:
    most = d.mold.wall_mm - 1.0
    if d.mold.engraving_depth_mm <= most + SLACK:
        return None
    return f"{d.mold.engraving_depth_mm:g} mm leaves less than 1 mm of mold.wall_mm; at most {floor2(most)} mm."


@RULES.rule("mold.gate_diameter_mm", "mold.funnel_diameter_mm")
def _gate_within_funnel(d: Tables) -> str | None:
    if d.mold.gate_diameter_mm <= d.mold.funnel_diameter_mm:
        return None
    return f"{d.mold.gate_diameter_mm:g} mm is wider than its funnel; at most {d.mold.funnel_diameter_mm:g} mm."


@RULES.rule("mold.funnel_diameter_mm", "mold.gate_diameter_mm", "mold.vent_diameter_mm", *_WIDTHS)
def _gate_within_cavity(d: Tables) -> str | None:
    reach = -lay_out(d, derive(d)).gate_x + d.mold.gate_diameter_mm / 2
    room = d.skin.width_mm / 2 * d.skin.taper_ratio - 0.2
    if reach <= room + SLACK:
        return None
    return (
        f"{d.mold.funnel_diameter_mm:g} mm pushes the gate {reach:.2f} mm to the side, past the cavity's "
        f"{room:.2f} mm; at most {floor2(max(0.0, d.mold.funnel_diameter_mm - 2 * (reach - room)))} mm."
    )


@RULES.rule("mold.draft_deg", "mold.key_diameter_mm", "mold.key_height_mm")
def _keys_keep_a_top(d: Tables) -> str | None:
    radius = 0.4 * d.mold.key_diameter_mm  # the smaller of the two keys
    most = math.degrees(math.atan((radius - 0.4) / d.mold.key_height_mm)) if radius > 0.4 else 0.0
    if d.mold.draft_deg <= most + SLACK:
        return None
    return f"{d.mold.draft_deg:g} degrees bring the registration keys to a point; at most {floor2(most)} degrees."


@RULES.rule("mold.key_diameter_mm", "mold.land_mm", "mold.nut_width_mm", "mold.recess_length_mm", "skin.length_mm")
def _keys_between_bolts(d: Tables) -> str | None:
    layout = lay_out(d, derive(d))
    most = layout.key_space - 2 * d.mold.land_mm
    if d.mold.key_diameter_mm <= most + SLACK:
        return None
    return f"{d.mold.key_diameter_mm:g} mm does not fit between the bolts; at most {floor2(max(0.0, most))} mm."


@RULES.rule("mold.key_height_mm", "mold.key_clearance_mm", "skin.semi_axis_palmar_mm", "mold.wall_mm")
def _key_socket_keeps_a_floor(d: Tables) -> str | None:
    most = d.skin.semi_axis_palmar_mm + d.mold.wall_mm - d.mold.key_clearance_mm - 1.0
    if d.mold.key_height_mm <= most + SLACK:
        return None
    return f"{d.mold.key_height_mm:g} mm goes through the palmar half; at most {floor2(max(0.0, most))} mm."


@RULES.rule("mold.nut_depth_mm", "skin.semi_axis_palmar_mm", "mold.wall_mm")
def _nut_trap_keeps_a_floor(d: Tables) -> str | None:
    most = d.skin.semi_axis_palmar_mm + d.mold.wall_mm - 2.0
    if d.mold.nut_depth_mm <= most + SLACK:
        return None
    return f"{d.mold.nut_depth_mm:g} mm leaves less than 2 mm under the nut; at most {floor2(max(0.0, most))} mm."


@RULES.rule("mold.nut_width_mm", "mold.bolt_diameter_mm")
def _nut_wider_than_bolt(d: Tables) -> str | None:
    least = d.mold.bolt_diameter_mm + 1.0
    if d.mold.nut_width_mm >= least - SLACK:
        return None
    return f"{d.mold.nut_width_mm:g} mm holds no nut of a {d.mold.bolt_diameter_mm:g} mm bolt; at least {least:g} mm."
