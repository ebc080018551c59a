"""Rules of the chaplet: it stands on the bone, its screw keeps clear of the sensor, and it holds the bone in place."""

from __future__ import annotations

from collections.abc import Callable

from fingertip.design.geometry.chaplet import Chaplet, place_chaplet
from fingertip.design.geometry.design_tables import DesignTables
from fingertip.design.geometry.seat import Loss, find_losses, worst
from fingertip.design.rules.bone import collar_carries_skin, groove_clear_of_sensor
from fingertip.design.rules.ruleset import SLACK, Interval, Ruleset, Violation, at_least, at_most
from fingertip.design.rules.skin import SOUND_SECTIONS, bone_left_at_sides, bone_left_dorsally, tip_within_skin
from fingertip.foundation.numerics import bisect

RULES = Ruleset()
MIN_RETAINED_OVER_SENSOR, MIN_RETAINED = 0.9, 0.8
"""Smallest shares of the skin's thickness that a misplaced bone may leave, over the sensor and elsewhere."""
_HALVINGS = 6
"""Halvings with which the largest clearance that holds is found: a solution takes milliseconds."""
_STEP_MM = 0.25
"""Step in which positions of the chaplet are tried."""
_SOUND_BONE = (bone_left_at_sides, bone_left_dorsally, tip_within_skin, groove_clear_of_sensor)


@RULES.rule("mold.chaplet_diameter_mm")
def boss_keeps_a_wall(design: DesignTables) -> Violation | None:
    """The boss keeps a wall around the hole of its screw."""
    chaplet, diameter = design.dimensions.chaplet, design.mold.chaplet_diameter_mm
    if chaplet is None:
        return None
    minimum = 2 * (chaplet.hole_radius + design.printer.min_wall_mm)
    if diameter >= minimum - SLACK:
        return None
    return Violation(f"{diameter:g} mm leaves no wall around its screw", at_least(minimum))


@RULES.rule("mold.chaplet_from_tip_mm", *_SOUND_BONE)
def chaplet_stands_on_bone(design: DesignTables) -> Violation | None:
    """The facet lies on the bone, clear of collar, groove and trough, and the pilot hole ends above the sensor."""
    distance = design.mold.chaplet_from_tip_mm
    if design.dimensions.chaplet is None or (missing := _find_missing_mm(design, distance)) <= SLACK:
        return None
    return Violation(
        f"{distance:g} mm leaves no room for the chaplet's facet and the hole of its screw",
        _find_passing(design, lambda value: _find_missing_mm(design, value) <= SLACK),
        alternatives={"mold.chaplet_diameter_mm": 5.0},
        shortfall=missing,
    )


@RULES.rule("mold.fit_clearance_mm", *SOUND_SECTIONS, collar_carries_skin, chaplet_stands_on_bone, takes_long=True)
def bone_is_held(design: DesignTables) -> Violation | None:
    """A bone or core that lies off as far as its supports allow leaves most of the skin, everywhere."""
    losses = design.losses
    sensor, elsewhere = worst(losses, over_sensor=True), worst(losses, over_sensor=False)
    least = min(loss.left_mm for loss in losses)
    nominal = min(loss.point.thickness_mm for loss in losses)
    if nominal <= design.skin.min_thickness_mm:
        return None  # Too thin without any play, which another rule reports.
    if all(_leaves_enough(design, loss) for loss in losses):
        return None
    clearance = design.mold.fit_clearance_mm

    # A point that keeps enough silicone does so with less clearance too.
    failing = [loss.point for loss in losses if not _leaves_enough(design, loss)]

    def holds(value: float) -> bool:
        return all(_leaves_enough(design, loss) for loss in find_losses(design, design.dimensions, value, failing))

    limit = bisect(holds, 0.0, clearance, halvings=_HALVINGS)[0] if holds(0.0) else 0.0
    return Violation(
        f"{clearance:g} mm lets bone or core lie off until {100 * max(sensor.retained, 0.0):.0f} % of the skin are "
        f"left over the sensor, {100 * max(elsewhere.retained, 0.0):.0f} % elsewhere and {least:.2f} mm at the "
        f"thinnest place; {100 * MIN_RETAINED_OVER_SENSOR:g} %, {100 * MIN_RETAINED:g} % and "
        f"{design.skin.min_thickness_mm:g} mm are needed",
        at_most(limit) if limit else (),
        shortfall=max(_find_share_missing(design, loss) for loss in losses),
    )


def _leaves_enough(design: DesignTables, loss: Loss) -> bool:
    """Return whether a loss leaves enough skin."""
    return _find_share_missing(design, loss) <= SLACK


def _find_share_missing(design: DesignTables, loss: Loss) -> float:
    """Return the share of the skin's thickness that is missing at a point; negative if there is more than is needed."""
    minimum = MIN_RETAINED_OVER_SENSOR if loss.point.over_sensor else MIN_RETAINED
    too_thin_mm = design.skin.min_thickness_mm - loss.left_mm
    return max(minimum - loss.retained, too_thin_mm / loss.point.thickness_mm)


def _find_missing_mm(design: DesignTables, from_tip_mm: float) -> float:
    """Return the length [mm] that the chaplet lacks at this distance from the tip; not positive where it fits."""
    dims, bone, wall = design.dimensions, design.bone, design.bone.wall_mm
    placed = dims.chaplet
    assert placed
    z = design.skin.length_mm - from_tip_mm
    low = z - placed.facet_radius
    groove = bone.groove_distance_mm + 2 * bone.groove_depth_mm + bone.groove_width_mm if bone.groove_depth_mm else 0.0
    begins = max(groove, dims.fold.trough_end_z if dims.fold else 0.0) + wall
    if low < begins - SLACK:
        return begins - low
    moved = place_chaplet(dims.bone_outline, z, design.mold.chaplet_diameter_mm, placed.thread.diameter_mm)
    return _least_facet_y(design, moved) - moved.facet_y


def _least_facet_y(design: DesignTables, chaplet: Chaplet) -> float:
    """Height [mm] that the facet needs above everything that is cut into the bone from its palmar side."""
    dims = design.dimensions
    hollow = dims.pocket_depth
    ends = dims.tail_end_z + dims.relief_half_length + design.bone.wall_mm + chaplet.pilot_radius
    if not dims.tail_passes_collar and chaplet.z < ends:
        hollow = dims.channel_depth + design.bone.channel_diameter_mm / 2
    return -dims.flat_depth + hollow + design.bone.wall_mm + chaplet.pilot_depth


def _find_passing(design: DesignTables, passes: Callable[[float], bool]) -> tuple[Interval, ...]:
    """Find the distances from the tip that pass, as one interval on the grid of steps."""
    count = int(design.skin.length_mm / _STEP_MM)
    passing = [_STEP_MM * i for i in range(4, count) if passes(_STEP_MM * i)]
    return ((passing[0], passing[-1]),) if passing else ()
