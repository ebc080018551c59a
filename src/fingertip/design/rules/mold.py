"""Rules of the mold: room for everything around the cavity, and halves that can be made."""

from __future__ import annotations

import math

from fingertip.design.parameters import DesignTables
from fingertip.design.rules.ruleset import SLACK, Ruleset, Violation, at_most
from fingertip.design.threads import MAX_TRAP_RATIO, NUT_TRAP_CLEARANCE_MM, select_thread

RULES = Ruleset()
_BESIDE_PRY_SLOT = 0.4
"""Minimum wall between a pry slot and what lies behind it [mm]."""
_PRY_SLOT_ENDS = 2.0
"""Length of the mold's side that a pry slot leaves, both ends together [mm]."""
_BEHIND_ENGRAVING = 1.0
"""Minimum wall behind the engraving [mm]."""
_SOCKET_FLOOR = 1.0
"""Minimum floor of a key's socket [mm]."""
_NUT_FLOOR = 2.0
"""Minimum floor under a nut [mm]."""
_KEY_TOP = 0.4
"""Minimum radius of a key's top [mm]."""
_BESIDE_GATE = 0.2
"""Minimum distance of the gate from the cavity's side [mm]."""


@RULES.rule("mold.pry_depth_mm")
def pry_slot_clear_of_bolts(d: DesignTables) -> Violation | None:
    """The pry slots end before the nut traps and the keys' sockets."""
    layout, slope = d.mold_layout, d.dimensions.draft_slope
    socket = d.mold.key_diameter_mm / 2 + d.mold.key_clearance_mm * math.hypot(1.0, slope)
    column = layout.bolts[-1][0]
    maximum = layout.half_width - column - max(layout.nut_circumradius, socket) - _BESIDE_PRY_SLOT
    if d.mold.pry_depth_mm <= maximum + SLACK:
        return None
    return Violation(f"{d.mold.pry_depth_mm:g} mm reaches the keys", at_most(maximum), "(mold.land_mm)")


@RULES.rule("mold.pry_width_mm")
def pry_slot_within_side(d: DesignTables) -> Violation | None:
    """The pry slots are shorter than the mold's side."""
    maximum = d.mold_layout.distal_z - d.mold_layout.proximal_z - _PRY_SLOT_ENDS
    if d.mold.pry_width_mm <= maximum + SLACK:
        return None
    return Violation(f"{d.mold.pry_width_mm:g} mm is longer than the mold's side", at_most(maximum))


@RULES.rule("mold.engraving_depth_mm")
def engraving_keeps_a_wall(d: DesignTables) -> Violation | None:
    """The engraving leaves enough of the mold's wall."""
    maximum = d.mold.wall_mm - _BEHIND_ENGRAVING
    if d.mold.engraving_depth_mm <= maximum + SLACK:
        return None
    return Violation(
        f"{d.mold.engraving_depth_mm:g} mm leaves less than {_BEHIND_ENGRAVING:g} mm of mold.wall_mm", at_most(maximum)
    )


@RULES.rule("mold.gate_diameter_mm")
def gate_within_funnel(d: DesignTables) -> Violation | None:
    """The gate is not wider than its funnel."""
    if d.mold.gate_diameter_mm <= d.mold.funnel_diameter_mm:
        return None
    return Violation(f"{d.mold.gate_diameter_mm:g} mm is wider than its funnel", at_most(d.mold.funnel_diameter_mm))


@RULES.rule("mold.funnel_diameter_mm")
def gate_within_cavity(d: DesignTables) -> Violation | None:
    """The gate, beside the funnel, meets the cavity."""
    reach = -d.mold_layout.gate_x + d.mold.gate_diameter_mm / 2
    room = d.skin.width_mm / 2 * d.skin.taper_ratio - _BESIDE_GATE
    if reach <= room + SLACK:
        return None
    return Violation(
        f"{d.mold.funnel_diameter_mm:g} mm pushes the gate {reach:.2f} mm to the side, past the cavity's {room:.2f} mm",
        at_most(d.mold.funnel_diameter_mm - 2 * (reach - room)),
    )


@RULES.rule("mold.draft_deg")
def keys_keep_a_top(d: DesignTables) -> Violation | None:
    """The draft does not bring the registration keys to a point."""
    radius = 0.4 * d.mold.key_diameter_mm  # of the smaller key
    maximum = math.degrees(math.atan((radius - _KEY_TOP) / d.mold.key_height_mm)) if radius > _KEY_TOP else 0.0
    if d.mold.draft_deg <= maximum + SLACK:
        return None
    return Violation(f"{d.mold.draft_deg:g} degrees bring the registration keys to a point", at_most(maximum))


@RULES.rule("mold.key_diameter_mm")
def keys_between_bolts(d: DesignTables) -> Violation | None:
    """The registration keys fit between the bolts."""
    maximum = d.mold_layout.key_space - 2 * d.mold.land_mm
    if d.mold.key_diameter_mm <= maximum + SLACK:
        return None
    return Violation(f"{d.mold.key_diameter_mm:g} mm does not fit between the bolts", at_most(maximum))


@RULES.rule("mold.key_height_mm")
def key_socket_keeps_a_floor(d: DesignTables) -> Violation | None:
    """The sockets of the keys do not go through the palmar half."""
    maximum = d.skin.semi_axis_palmar_mm + d.mold.wall_mm - d.mold.key_clearance_mm - _SOCKET_FLOOR
    if d.mold.key_height_mm <= maximum + SLACK:
        return None
    return Violation(f"{d.mold.key_height_mm:g} mm goes through the palmar half", at_most(maximum))


@RULES.rule("mold.nut_depth_mm")
def nut_trap_keeps_a_floor(d: DesignTables) -> Violation | None:
    """The nut traps keep a floor under the nut."""
    maximum = d.skin.semi_axis_palmar_mm + d.mold.wall_mm - _NUT_FLOOR
    if d.mold.nut_depth_mm <= maximum + SLACK:
        return None
    return Violation(f"{d.mold.nut_depth_mm:g} mm leaves less than {_NUT_FLOOR:g} mm under the nut", at_most(maximum))


@RULES.rule("mold.nut_width_mm")
def trap_fits_its_nut(d: DesignTables) -> Violation | None:
    """The nut traps take the nut of the bolts' thread and keep it from turning."""
    thread = select_thread(d.mold.bolt_diameter_mm)
    minimum, maximum = thread.nut_flats_mm + NUT_TRAP_CLEARANCE_MM, thread.nut_flats_mm * MAX_TRAP_RATIO
    width = d.mold.nut_width_mm
    if minimum - SLACK <= width <= maximum + SLACK:
        return None
    nut = f"an {thread.label} nut, {thread.nut_flats_mm:g} mm across flats"
    what = f"does not take {nut}" if width < minimum else f"lets {nut} turn"
    return Violation(
        f"{width:g} mm {what}, which a hole of {d.mold.bolt_diameter_mm:g} mm asks for", ((minimum, maximum),)
    )
