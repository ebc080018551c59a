"""Rules of the mold: everything around the cavity finds room, and the halves can be made."""

from __future__ import annotations

import math

from fingertip.design.geometry.dimensions import compute_dimensions
from fingertip.design.geometry.mold_layout import lay_out
from fingertip.design.parameters import DesignTables
from fingertip.design.rules.ruleset import SLACK, Ruleset, ceil2, floor2
from fingertip.design.threads import TRAP_CLEARANCE_MM, TRAP_TURNS, select_thread

RULES = Ruleset()
_BESIDE_PRY_SLOT = 0.4  # mold left between a pry slot and what lies behind it [mm]
_WIDTHS = ("skin.width_mm", "skin.taper_ratio")


@RULES.rule(
    "mold.pry_depth_mm", "mold.land_mm", "mold.nut_width_mm", "mold.key_diameter_mm", "mold.key_clearance_mm",
    "mold.draft_deg",
)  # fmt: skip
def _pry_slot_clear_of_bolts(d: DesignTables) -> str | None:
    layout, slope = lay_out(d, compute_dimensions(d)), compute_dimensions(d).draft_slope
    socket = d.mold.key_diameter_mm / 2 + d.mold.key_clearance_mm * math.hypot(1.0, slope)
    column = layout.bolts[-1][0]
    maximum = layout.half_width - column - max(layout.nut_circumradius, socket) - _BESIDE_PRY_SLOT
    if d.mold.pry_depth_mm <= maximum + SLACK:
        return None
    return f"{d.mold.pry_depth_mm:g} mm reaches the keys; at most {floor2(max(0.0, maximum))} mm (mold.land_mm)."


@RULES.rule("mold.pry_width_mm", "skin.length_mm", "mold.recess_length_mm")
def _pry_slot_within_side(d: DesignTables) -> str | None:
    layout = lay_out(d, compute_dimensions(d))
    maximum = layout.distal_z - layout.proximal_z - 2.0
    if d.mold.pry_width_mm <= maximum + SLACK:
        return None
    return f"{d.mold.pry_width_mm:g} mm is longer than the mold's side; at most {floor2(maximum)} mm."


@RULES.rule("mold.engraving_depth_mm", "mold.wall_mm")
def _engraving_keeps_a_wall(d: DesignTables) -> str | None:
    maximum = d.mold.wall_mm - 1.0
    if d.mold.engraving_depth_mm <= maximum + SLACK:
        return None
    return f"{d.mold.engraving_depth_mm:g} mm leaves less than 1 mm of mold.wall_mm; at most {floor2(maximum)} mm."


@RULES.rule("mold.gate_diameter_mm", "mold.funnel_diameter_mm")
def _gate_within_funnel(d: DesignTables) -> str | None:
    if d.mold.gate_diameter_mm <= d.mold.funnel_diameter_mm:
        return None
    return f"{d.mold.gate_diameter_mm:g} mm is wider than its funnel; at most {d.mold.funnel_diameter_mm:g} mm."


@RULES.rule("mold.funnel_diameter_mm", "mold.gate_diameter_mm", "mold.vent_diameter_mm", *_WIDTHS)
def _gate_within_cavity(d: DesignTables) -> str | None:
    reach = -lay_out(d, compute_dimensions(d)).gate_x + d.mold.gate_diameter_mm / 2
    room = d.skin.width_mm / 2 * d.skin.taper_ratio - 0.2
    if reach <= room + SLACK:
        return None
    return (
        f"{d.mold.funnel_diameter_mm:g} mm pushes the gate {reach:.2f} mm to the side, past the cavity's "
        f"{room:.2f} mm; at most {floor2(max(0.0, d.mold.funnel_diameter_mm - 2 * (reach - room)))} mm."
    )


@RULES.rule("mold.draft_deg", "mold.key_diameter_mm", "mold.key_height_mm")
def _keys_keep_a_top(d: DesignTables) -> str | None:
    radius = 0.4 * d.mold.key_diameter_mm  # the smaller of the two keys
    maximum = math.degrees(math.atan((radius - 0.4) / d.mold.key_height_mm)) if radius > 0.4 else 0.0
    if d.mold.draft_deg <= maximum + SLACK:
        return None
    return f"{d.mold.draft_deg:g} degrees bring the registration keys to a point; at most {floor2(maximum)} degrees."


@RULES.rule("mold.key_diameter_mm", "mold.land_mm", "mold.nut_width_mm", "mold.recess_length_mm", "skin.length_mm")
def _keys_between_bolts(d: DesignTables) -> str | None:
    layout = lay_out(d, compute_dimensions(d))
    maximum = layout.key_space - 2 * d.mold.land_mm
    if d.mold.key_diameter_mm <= maximum + SLACK:
        return None
    return f"{d.mold.key_diameter_mm:g} mm does not fit between the bolts; at most {floor2(max(0.0, maximum))} mm."


@RULES.rule("mold.key_height_mm", "mold.key_clearance_mm", "skin.semi_axis_palmar_mm", "mold.wall_mm")
def _key_socket_keeps_a_floor(d: DesignTables) -> str | None:
    maximum = d.skin.semi_axis_palmar_mm + d.mold.wall_mm - d.mold.key_clearance_mm - 1.0
    if d.mold.key_height_mm <= maximum + SLACK:
        return None
    return f"{d.mold.key_height_mm:g} mm goes through the palmar half; at most {floor2(max(0.0, maximum))} mm."


@RULES.rule("mold.nut_depth_mm", "skin.semi_axis_palmar_mm", "mold.wall_mm")
def _nut_trap_keeps_a_floor(d: DesignTables) -> str | None:
    maximum = d.skin.semi_axis_palmar_mm + d.mold.wall_mm - 2.0
    if d.mold.nut_depth_mm <= maximum + SLACK:
        return None
    return f"{d.mold.nut_depth_mm:g} mm leaves less than 2 mm under the nut; at most {floor2(max(0.0, maximum))} mm."


@RULES.rule("mold.nut_width_mm", "mold.bolt_diameter_mm")
def _trap_fits_its_nut(d: DesignTables) -> str | None:
    bolt = select_thread(d.mold.bolt_diameter_mm)
    minimum, maximum = bolt.nut_flats_mm + TRAP_CLEARANCE_MM, bolt.nut_flats_mm * TRAP_TURNS
    width = d.mold.nut_width_mm
    if minimum - SLACK <= width <= maximum + SLACK:
        return None
    nut = f"an {bolt.label} nut, {bolt.nut_flats_mm:g} mm across flats"
    what = f"does not take {nut}" if width < minimum else f"lets {nut} turn"
    return (
        f"{width:g} mm {what}, which a hole of {d.mold.bolt_diameter_mm:g} mm asks for; between {ceil2(minimum)} and "
        f"{floor2(maximum)} mm."
    )
