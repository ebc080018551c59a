"""Rules of the mold: room around the cavity, a recess that fits base and collar, and a chaplet that holds the bone."""

from __future__ import annotations

import math

from fingertip.catalogues.hardware import MAX_TRAP_RATIO, NUT_TRAP_CLEARANCE_MM, select_thread
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.conic import add_draft
from fingertip.design.geometry.features import Chaplet
from fingertip.design.geometry.seat import Loss, find_losses, list_insert_points, worst
from fingertip.design.rules.bone import collar_carries_skin, groove_clear_of_sensor
from fingertip.design.rules.ruleset import SLACK, Limit, Ruleset, Violation, at_most
from fingertip.design.rules.skin import bone_left_at_sides, bone_left_dorsally, skin_is_thick_enough, tip_within_skin
from fingertip.foundation.numerics import bisect

RULES = Ruleset(when=lambda design: design.mold.method != "plunge")
"""Rules of a closed mold, in which the bone is seated and clamped; a cup has none."""
_MIN_COLLAR_LENGTH = 0.6
"""Minimum length of the collar [mm] where its draft has taken most of it."""
_MIN_BEHIND_COLLAR = 1.0
"""Minimum length of the recess behind the collar [mm]."""
_EDGE_MARGIN = 0.05
"""Minimum distance of the collar's recess from the skin's edge [mm]."""

_MIN_PRINTED_FIT = 0.01
"""Minimum gap between base and recess as printed [mm]."""

_SOUND_COLLAR = (bone_left_at_sides, bone_left_dorsally, collar_carries_skin)
"""Prerequisites of the rules that need the collar's outline."""


@RULES.at_most("mold.recess_length_mm", slack=0.0)
def recess_within_base(design: DesignTables) -> Limit | None:
    return Limit(design.bone.base_length_mm, "is longer than the bone's base", "(limited by bone.base_length_mm)")


@RULES.at_most("mold.fit_clearance_mm", *_SOUND_COLLAR)
def fit_stays_within_skin(design: DesignTables) -> Limit | None:
    section, slope = design.dimensions.collar.section, design.dimensions.draft_slope
    widening = add_draft(section, slope).half_width - section.half_width if slope else 0.0
    maximum = design.bone.collar_inset_mm - widening - _EDGE_MARGIN
    return Limit(maximum, "makes the collar's recess wider than the skin", "(limited by bone.collar_inset_mm)")


@RULES.at_least("mold.fit_clearance_mm", when=lambda design: design.printer.offset_mm > 0.0)
def fit_stays_open(design: DesignTables) -> Limit:
    offset = design.printer.offset_mm
    return Limit(offset + _MIN_PRINTED_FIT, f"closes in the print, which adds {offset:g} mm (printer.offset_mm)")


@RULES.at_least("mold.recess_length_mm")
def recess_holds_collar(design: DesignTables) -> Limit | None:
    gap = design.mold.fit_clearance_mm * math.hypot(1.0, design.dimensions.draft_slope)
    minimum = design.bone.collar_length_mm + gap + _MIN_BEHIND_COLLAR
    return Limit(minimum, "does not hold the collar and a wall behind it")


@RULES.at_least("bone.collar_length_mm")
def collar_outlasts_its_draft(design: DesignTables) -> Limit | None:
    section, slope = design.dimensions.collar.section, design.dimensions.draft_slope
    return Limit(
        _MIN_COLLAR_LENGTH + slope * max(section.palmar, section.dorsal),
        f"is used up by a draft of {design.mold.draft_deg:g} degrees before the collar's palmar or dorsal end",
    )


_BESIDE_PRY_SLOT = 0.4
"""Minimum wall between a pry slot and what lies behind it [mm]."""
_PRY_SLOT_ENDS = 2.0
"""Length of the mold's side that a pry slot leaves, both ends together [mm]."""
_BEHIND_ENGRAVING = 1.0
_SOCKET_FLOOR = 1.0
_NUT_FLOOR = 2.0
_MAX_RUNNER_DEPTH = 0.5
"""Maximum depth of the runner relative to the height of the cavity's dorsal side."""
_KEY_TOP = 0.4


@RULES.at_most("mold.pry_depth_mm")
def pry_slot_clear_of_bolts(design: DesignTables) -> Limit | None:
    layout, slope = design.mold_layout, design.dimensions.draft_slope
    socket = design.mold.key_diameter_mm / 2 + design.mold.key_clearance_mm * math.hypot(1.0, slope)
    beside = layout.half_inlet + max(0.0, design.printer.min_wall_mm - _BESIDE_PRY_SLOT)
    column = layout.bolts[-1][0]
    maximum = layout.half_width - column - max(layout.nut_circumradius, socket, beside) - _BESIDE_PRY_SLOT
    return Limit(maximum, "reaches the keys or the inlet", "(limited by mold.land_mm)")


@RULES.at_most("mold.pry_width_mm")
def pry_slot_within_side(design: DesignTables) -> Limit | None:
    maximum = design.mold_layout.distal_z - design.mold_layout.proximal_z - _PRY_SLOT_ENDS
    return Limit(maximum, "is longer than the mold's side")


@RULES.at_most("mold.engraving_depth_mm")
def engraving_keeps_a_wall(design: DesignTables) -> Limit | None:
    return Limit(design.mold.wall_mm - _BEHIND_ENGRAVING, f"leaves less than {_BEHIND_ENGRAVING:g} mm of mold.wall_mm")


@RULES.rule("mold.runner_width_mm")
def gate_within_straight_skin(design: DesignTables) -> Violation | None:
    width = design.mold.runner_width_mm
    excess = design.mold_layout.inlet.gate_z + width / 2 - design.dimensions.taper_end_z
    if excess <= SLACK:
        return None
    return Violation(f"{width:g} mm makes the gate end on the rounded tip", at_most(width - excess))


@RULES.at_most("mold.runner_depth_mm")
def gate_meets_cavity(design: DesignTables) -> Limit:
    """The runner is less deep than the cavity is high, so that it enters at the side."""
    maximum = _MAX_RUNNER_DEPTH * design.skin.semi_axis_dorsal_mm * design.skin.taper_ratio
    return Limit(maximum, "ends above the side of the cavity")


@RULES.at_most("mold.draft_deg")
def keys_keep_a_top(design: DesignTables) -> Limit | None:
    radius = 0.4 * design.mold.key_diameter_mm  # of the smaller key
    maximum = math.degrees(math.atan((radius - _KEY_TOP) / design.mold.key_height_mm)) if radius > _KEY_TOP else 0.0
    return Limit(maximum, "bring the registration keys to a point")


@RULES.at_most("mold.key_height_mm")
def key_socket_keeps_a_floor(design: DesignTables) -> Limit | None:
    maximum = design.skin.semi_axis_palmar_mm + design.mold.wall_mm - design.mold.key_clearance_mm - _SOCKET_FLOOR
    return Limit(maximum, "goes through the palmar half")


@RULES.at_most("mold.nut_depth_mm")
def nut_trap_keeps_a_floor(design: DesignTables) -> Limit | None:
    maximum = design.skin.semi_axis_palmar_mm + design.mold.wall_mm - _NUT_FLOOR
    return Limit(maximum, f"leaves less than {_NUT_FLOOR:g} mm under the nut")


@RULES.rule("mold.nut_width_mm")
def trap_fits_its_nut(design: DesignTables) -> Violation | None:
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


MIN_RETAINED_OVER_SENSOR, MIN_RETAINED = 0.9, 0.8
"""Smallest shares of the skin's thickness that a misplaced bone may leave, over the sensor and elsewhere."""
_HALVINGS = 6
"""Halvings with which the largest clearance that holds is found: a solution takes milliseconds."""
_STEP_MM = 0.25
"""Step in which positions of the chaplet are tried."""
_SOUND_BONE = (bone_left_at_sides, bone_left_dorsally, tip_within_skin, groove_clear_of_sensor)


@RULES.at_least("mold.chaplet_diameter_mm")
def boss_keeps_a_wall(design: DesignTables) -> Limit | None:
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return None
    return Limit(2 * (chaplet.hole_radius + design.printer.min_wall_mm), "leaves no wall around its screw")


@RULES.rule("mold.chaplet_from_tip_mm", *_SOUND_BONE)
def chaplet_stands_on_bone(design: DesignTables) -> Violation | None:
    """The facet lies on the bone, clear of collar, groove and trough, and the pilot hole ends above the sensor."""
    distance = design.mold.chaplet_from_tip_mm
    if design.dimensions.chaplet is None or (missing := _find_missing_mm(design, distance)) <= SLACK:
        return None
    steps = (_STEP_MM * i for i in range(4, int(design.skin.length_mm / _STEP_MM)))
    passing = [value for value in steps if _find_missing_mm(design, value) <= SLACK]
    return Violation(
        f"{distance:g} mm leaves no room for the chaplet's facet and the hole of its screw",
        ((passing[0], passing[-1]),) if passing else (),
        alternatives={"mold.chaplet_diameter_mm": 5.0},
        shortfall=missing,
    )


@RULES.rule("mold.fit_clearance_mm", skin_is_thick_enough, collar_carries_skin, chaplet_stands_on_bone, takes_long=True)
def bone_is_held(design: DesignTables) -> Violation | None:
    """A bone that lies off as far as its supports allow leaves most of the skin, everywhere."""
    losses = design.losses
    sensor, elsewhere = worst(losses, over_sensor=True), worst(losses, over_sensor=False)
    least = min(loss.left_mm for loss in losses)
    if all(_leaves_enough(design, loss) for loss in losses):
        return None
    clearance = design.mold.fit_clearance_mm

    # A point that keeps enough silicone does so with less clearance too.
    failing = [loss.point for loss in losses if not _leaves_enough(design, loss)]

    def holds(value: float) -> bool:
        return all(_leaves_enough(design, loss) for loss in find_losses(design, design.dimensions, value, failing))

    limit = bisect(holds, 0.0, clearance, halvings=_HALVINGS)[0] if holds(0.0) else 0.0
    return Violation(
        f"{clearance:g} mm lets the bone lie off until {100 * max(sensor.retained, 0.0):.0f} % of the skin are "
        f"left over the sensor, {100 * max(elsewhere.retained, 0.0):.0f} % elsewhere and {least:.2f} mm at the "
        f"thinnest place; {100 * MIN_RETAINED_OVER_SENSOR:g} %, {100 * MIN_RETAINED:g} % and "
        f"{design.skin.min_thickness_mm:g} mm are needed",
        at_most(limit) if limit else (),
        shortfall=max(_find_share_missing(design, loss) for loss in losses),
    )


@RULES.rule("sensor.insert_height_mm", bone_is_held, takes_long=True)
def skin_covers_insert(design: DesignTables) -> Violation | None:
    """The skin keeps its minimum thickness over the edge of an insert, on a bone that lies off too."""
    dims, height, minimum = design.dimensions, design.sensor.insert_height_mm, design.skin.min_thickness_mm

    def holds(value: float) -> bool:
        losses = find_losses(design, dims, points=list_insert_points(dims, height - value))
        return min(loss.point.thickness_mm - loss.loss_mm for loss in losses) >= minimum - SLACK

    if dims.insert is None or holds(height):
        return None
    return Violation(
        f"{height:g} mm leaves less than skin.min_thickness_mm={minimum:g} of silicone over its edge",
        at_most(bisect(holds, 0.0, height, halvings=2 * _HALVINGS)[0]) if holds(0.0) else (),
    )


def _leaves_enough(design: DesignTables, loss: Loss) -> bool:
    return _find_share_missing(design, loss) <= SLACK


def _find_share_missing(design: DesignTables, loss: Loss) -> float:
    """Return the share of the skin's thickness that is missing at a point; negative if there is more than is needed."""
    minimum = MIN_RETAINED_OVER_SENSOR if loss.point.over_sensor else MIN_RETAINED
    too_thin_mm = design.skin.min_thickness_mm - loss.left_mm
    return max(minimum - loss.retained, too_thin_mm / loss.point.thickness_mm)


def _find_missing_mm(design: DesignTables, from_tip_mm: float) -> float:
    """Return the length [mm] that the chaplet lacks at this distance from the tip; not positive where it fits."""
    moved = design.dimensions.place_chaplet(design.skin.length_mm - from_tip_mm)
    missing = design.dimensions.facet_begin_z - (moved.z - moved.facet_radius)
    if missing > SLACK:
        return missing
    return _least_facet_y(design, moved) - moved.facet_y


def _least_facet_y(design: DesignTables, chaplet: Chaplet) -> float:
    """Height [mm] that the facet needs above everything that is cut into the bone from its palmar side."""
    dims = design.dimensions
    hollow = dims.pocket_depth
    ends = dims.tail_end_z + dims.relief_half_length + design.bone.wall_mm + chaplet.pilot_radius
    if not dims.tail_passes_collar and chaplet.z < ends:
        hollow = dims.channel_depth + design.bone.channel_diameter_mm / 2
    return -dims.flat_depth + hollow + design.bone.wall_mm + chaplet.pilot_depth
