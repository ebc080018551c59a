"""Rules of the mold: room for everything around the cavity, and halves that can be made."""

from __future__ import annotations

import math

from fingertip.catalogues.threads import MAX_TRAP_RATIO, NUT_TRAP_CLEARANCE_MM, select_thread
from fingertip.design.geometry.design_tables import DesignTables
from fingertip.design.rules.ruleset import SLACK, Ruleset, Violation, at_most

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
_MAX_RUNNER_DEPTH = 0.5
"""Maximum depth of the runner relative to the height of the cavity's dorsal side."""
_KEY_TOP = 0.4
"""Minimum radius of a key's top [mm]."""
_BESIDE_GATE = 0.2
"""Minimum distance of the gate from the cavity's side [mm]."""


@RULES.rule("mold.pry_depth_mm")
def pry_slot_clear_of_bolts(design: DesignTables) -> Violation | None:
    """The pry slots end before the nut traps and the keys' sockets."""
    layout, slope = design.mold_layout, design.dimensions.draft_slope
    socket = design.mold.key_diameter_mm / 2 + design.mold.key_clearance_mm * math.hypot(1.0, slope)
    beside = layout.half_inlet + max(0.0, design.printer.min_wall_mm - _BESIDE_PRY_SLOT) if layout.half_inlet else 0.0
    column = layout.bolts[-1][0]
    maximum = layout.half_width - column - max(layout.nut_circumradius, socket, beside) - _BESIDE_PRY_SLOT
    if design.mold.pry_depth_mm <= maximum + SLACK:
        return None
    return Violation(
        f"{design.mold.pry_depth_mm:g} mm reaches the keys or the inlet", at_most(maximum), "(limited by mold.land_mm)"
    )


@RULES.rule("mold.pry_width_mm")
def pry_slot_within_side(design: DesignTables) -> Violation | None:
    """The pry slots are shorter than the mold's side."""
    maximum = design.mold_layout.distal_z - design.mold_layout.proximal_z - _PRY_SLOT_ENDS
    if design.mold.pry_width_mm <= maximum + SLACK:
        return None
    return Violation(f"{design.mold.pry_width_mm:g} mm is longer than the mold's side", at_most(maximum))


@RULES.rule("mold.engraving_depth_mm")
def engraving_keeps_a_wall(design: DesignTables) -> Violation | None:
    """The engraving leaves enough of the mold's wall."""
    maximum = design.mold.wall_mm - _BEHIND_ENGRAVING
    if design.mold.engraving_depth_mm <= maximum + SLACK:
        return None
    return Violation(
        f"{design.mold.engraving_depth_mm:g} mm leaves less than {_BEHIND_ENGRAVING:g} mm of mold.wall_mm",
        at_most(maximum),
    )


@RULES.rule("mold.gate_diameter_mm")
def gate_within_funnel(design: DesignTables) -> Violation | None:
    """The gate is not wider than its funnel."""
    if design.mold.filling != "gravity" or design.mold.gate_diameter_mm <= design.mold.funnel_diameter_mm:
        return None
    return Violation(
        f"{design.mold.gate_diameter_mm:g} mm is wider than its funnel", at_most(design.mold.funnel_diameter_mm)
    )


@RULES.rule("mold.funnel_diameter_mm")
def gate_within_cavity(design: DesignTables) -> Violation | None:
    """The gate, beside the funnel, meets the cavity."""
    reach = -design.mold_layout.gate_x + design.mold.gate_diameter_mm / 2
    room = design.skin.width_mm / 2 * design.skin.taper_ratio - _BESIDE_GATE
    if design.mold.filling != "gravity" or reach <= room + SLACK:
        return None
    return Violation(
        f"{design.mold.funnel_diameter_mm:g} mm puts the edge of the gate {reach:.2f} mm from the middle, outside the "
        f"cavity, where at most {room:.2f} mm are possible",
        at_most(design.mold.funnel_diameter_mm - 2 * (reach - room)),
    )


@RULES.rule("mold.funnel_diameter_mm")
def funnel_within_block(design: DesignTables) -> Violation | None:
    """The mold keeps a wall palmar and dorsal of the funnel's mouth."""
    layout, mold = design.mold_layout, design.mold
    maximum = 2 * (min(layout.palmar_height, layout.dorsal_height) - design.printer.min_wall_mm)
    if mold.filling != "gravity" or mold.funnel_diameter_mm <= maximum + SLACK:
        return None
    return Violation(f"{mold.funnel_diameter_mm:g} mm goes through the outside of the mold", at_most(maximum))


@RULES.rule("mold.runner_width_mm")
def gate_within_straight_skin(design: DesignTables) -> Violation | None:
    """The gate enters the cavity between the collar and the rounded tip."""
    inlet, width = design.mold_layout.inlet, design.mold.runner_width_mm
    if inlet is None:
        return None
    excess = inlet.gate_z + width / 2 - design.dimensions.taper_end_z
    if excess <= SLACK:
        return None
    return Violation(f"{width:g} mm makes the gate end on the rounded tip", at_most(width - excess))


@RULES.rule("mold.runner_depth_mm")
def gate_meets_cavity(design: DesignTables) -> Violation | None:
    """The runner is less deep than the cavity is high, so that it enters at the side."""
    maximum = _MAX_RUNNER_DEPTH * design.skin.semi_axis_dorsal_mm * design.skin.taper_ratio
    depth = design.mold.runner_depth_mm
    if design.mold.filling == "gravity" or depth <= maximum + SLACK:
        return None
    return Violation(f"{depth:g} mm ends above the side of the cavity", at_most(maximum))


@RULES.rule("mold.draft_deg")
def keys_keep_a_top(design: DesignTables) -> Violation | None:
    """The draft does not bring the registration keys to a point."""
    radius = 0.4 * design.mold.key_diameter_mm  # of the smaller key
    maximum = math.degrees(math.atan((radius - _KEY_TOP) / design.mold.key_height_mm)) if radius > _KEY_TOP else 0.0
    if design.mold.draft_deg <= maximum + SLACK:
        return None
    return Violation(f"{design.mold.draft_deg:g} degrees bring the registration keys to a point", at_most(maximum))


@RULES.rule("mold.key_diameter_mm")
def keys_between_bolts(design: DesignTables) -> Violation | None:
    """The registration keys fit between the bolts."""
    maximum = design.mold_layout.key_space - 2 * design.mold.land_mm
    if design.mold.key_diameter_mm <= maximum + SLACK:
        return None
    return Violation(f"{design.mold.key_diameter_mm:g} mm does not fit between the bolts", at_most(maximum))


@RULES.rule("mold.key_height_mm")
def key_socket_keeps_a_floor(design: DesignTables) -> Violation | None:
    """The sockets of the keys do not go through the palmar half."""
    maximum = design.skin.semi_axis_palmar_mm + design.mold.wall_mm - design.mold.key_clearance_mm - _SOCKET_FLOOR
    if design.mold.key_height_mm <= maximum + SLACK:
        return None
    return Violation(f"{design.mold.key_height_mm:g} mm goes through the palmar half", at_most(maximum))


@RULES.rule("mold.nut_depth_mm")
def nut_trap_keeps_a_floor(design: DesignTables) -> Violation | None:
    """The nut traps keep a floor under the nut."""
    maximum = design.skin.semi_axis_palmar_mm + design.mold.wall_mm - _NUT_FLOOR
    if design.mold.nut_depth_mm <= maximum + SLACK:
        return None
    return Violation(
        f"{design.mold.nut_depth_mm:g} mm leaves less than {_NUT_FLOOR:g} mm under the nut", at_most(maximum)
    )


@RULES.rule("mold.nut_width_mm")
def trap_fits_its_nut(design: DesignTables) -> Violation | None:
    """The nut traps take the nut of the bolts' thread and keep it from turning."""
    thread = select_thread(design.mold.bolt_diameter_mm)
    closed = design.printer.offset_mm  # by so much the printed trap is narrower
    minimum, maximum = thread.nut_flats_mm + NUT_TRAP_CLEARANCE_MM, thread.nut_flats_mm * MAX_TRAP_RATIO
    minimum, maximum = minimum + closed, maximum + closed
    width = design.mold.nut_width_mm
    if minimum - SLACK <= width <= maximum + SLACK:
        return None
    hole = f"a {design.mold.bolt_diameter_mm:g} mm hole"
    nut = f"the {thread.label} nut ({thread.nut_flats_mm:g} mm across flats) of {hole}"
    problem = f"is too narrow for {nut}" if width < minimum else f"is too wide: {nut} would turn"
    return Violation(f"{width:g} mm {problem}", ((minimum, maximum),))
