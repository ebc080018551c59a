"""Rules of the bone: room for solder joints, collar and groove, and for a folded tail."""

from __future__ import annotations

import math

from fingertip.catalogues.sensors import MIN_FOLD_RADIUS_MM
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.dimensions import HEAD_MM, KNOT_WIRES, TAIL_MM
from fingertip.design.geometry.features import TailFold
from fingertip.design.rules.ruleset import SLACK, Limit, Ruleset, Violation, at_least, at_most
from fingertip.design.rules.skin import bone_left_at_sides, bone_left_dorsally, tip_within_skin
from fingertip.foundation.numerics import bisect

WALL_RULES, RULES, FOLD_RULES = Ruleset(), Ruleset(), Ruleset()

_BESIDE_WIRE_MM = 0.1
"""Gap between the wires and their hole [mm]."""
_MIN_COLLAR_HEIGHT = 0.1
"""Minimum height of the collar's face, on which the skin ends [mm]."""
_BEFORE_TIP = 0.1
_DEPTH_HALVINGS = 30
_MIN_STRAIGHT_MM = 5.0
"""Least length of tail that stays straight behind the head [mm]."""
_MIN_IN_PASSAGE_MM = 2.0
"""Least length of film in the trough [mm]. An assumption."""
_DIRECTIONS = 16
"""Directions in which the thickness of the lid is measured."""


@WALL_RULES.at_least("bone.wall_mm")
def walls_print(design: DesignTables) -> Limit | None:
    minimum = design.printer.min_wall_mm
    return Limit(minimum, f"is thinner than the {minimum:g} mm of printer.min_wall_mm")


@RULES.at_most("bone.relief_length_mm", when=lambda design: not (design.is_cast_apart or design.dimensions.fold))
def relief_clear_of_pocket(design: DesignTables) -> Limit:
    dims = design.dimensions
    pocket = dims.sensor_z - dims.sensor.head_diameter_mm / 2 - design.sensor.clearance_mm
    return Limit(2 * (pocket - dims.tail_end_z), "reaches under the sensor's head")


@RULES.rule("sensor.distance_from_tip_mm", when=lambda design: not (design.is_cast_apart or design.dimensions.fold))
def relief_clear_of_collar(design: DesignTables) -> Violation | None:
    dims, distance = design.dimensions, design.sensor.distance_from_tip_mm
    low, high = dims.relief_proximal_z, dims.tail_end_z + dims.relief_half_length
    if high <= -design.bone.collar_length_mm + SLACK or low >= -SLACK:
        return None
    # The solder joints lie either above the collar, under the skin, or below it.
    above, below = distance + low, distance + high + design.bone.collar_length_mm
    return Violation(
        f"{distance:g} mm ends the tail in the collar, where there is no room for the solder joints",
        (*at_least(below), *at_most(above)),
    )


@RULES.rule("sensor.tail")
def tail_laid_in(design: DesignTables) -> Violation | None:
    """A skin that is made apart goes over a sensor that is laid in, whose tail is straight."""
    if design.sensor.tail == "straight" or design.mold.method != "plunge":
        return None
    return Violation("folded needs mold.method=overmold", alternatives={"mold.method": "overmold"})


@RULES.at_least("bone.channel_diameter_mm", tail_laid_in, when=lambda design: design.is_cast_apart)
def hole_takes_both_wires(design: DesignTables) -> Limit:
    """Two wires side by side leave half of the hole's area free, through which the sensor's vent breathes."""
    wires = 2 * design.sensor.wire_diameter_mm
    return Limit(wires + 2 * _BESIDE_WIRE_MM, f"does not take two wires of {design.sensor.wire_diameter_mm:g} mm")


@RULES.at_most(
    "bone.channel_diameter_mm", tail_laid_in, hole_takes_both_wires, when=lambda design: design.is_cast_apart
)
def hole_stops_the_knot(design: DesignTables) -> Limit:
    knot = KNOT_WIRES * design.sensor.wire_diameter_mm
    return Limit(knot, f"lets a knot in both wires of {design.sensor.wire_diameter_mm:g} mm through")


@RULES.at_least("sensor.clearance_mm", tail_laid_in, when=lambda design: design.is_cast_apart)
def trough_takes_measured_sensors(design: DesignTables) -> Limit:
    return Limit(
        max(HEAD_MM, TAIL_MM) / 2,
        f"does not take a tail {TAIL_MM:g} mm wider than stated: {design.dimensions.sensor.label}s differ",
    )


@RULES.at_most("bone.collar_inset_mm", bone_left_at_sides, bone_left_dorsally)
def collar_carries_skin(design: DesignTables) -> Limit | None:
    dims = design.dimensions
    sides = min(
        _thickness_at_collar(design, half, thickness) - _MIN_COLLAR_HEIGHT
        for half, thickness in (
            (design.skin.width_mm / 2, design.skin.thickness_side_mm),
            (design.skin.semi_axis_dorsal_mm, design.skin.thickness_dorsal_mm),
        )
    )
    passage = dims.flat_depth - dims.pocket_depth + dims.passage_height
    below = dims.base_palmar_height - passage - design.bone.wall_mm
    if dims.crown:  # the pad's base is lower than the bone's outline
        steps = (dims.collar_step_at(dims.base_flat_depth * i / _DIRECTIONS) for i in range(_DIRECTIONS + 1))
        sides = min(sides, design.bone.collar_inset_mm + min(steps) - _MIN_COLLAR_HEIGHT)
    maximum = min(sides, below) if dims.tail_passes_collar else sides
    what = "the collar's height" if maximum == sides else "the collar below the tail's passage"
    return Limit(maximum, f"leaves too little of {what}")


def _thickness_at_collar(design: DesignTables, half_mm: float, thickness_mm: float) -> float:
    """Compute the silicone [mm] that ends on the collar, around the bone or around an enlarged core."""
    if not design.is_cast_apart:
        return thickness_mm
    core = (half_mm - thickness_mm - design.mold.core_inset_mm) * design.dimensions.shrinkage
    return min(thickness_mm, half_mm - core)


@RULES.rule("bone.groove_depth_mm", tip_within_skin, bone_left_at_sides)
def groove_clear_of_sensor(design: DesignTables) -> Violation | None:
    """The groove ends before the sensor's head and keeps the wall beside its slot."""
    dims = design.dimensions
    depth, width, low = design.bone.groove_depth_mm, design.bone.groove_width_mm, design.bone.groove_distance_mm
    if depth == 0.0:
        return None
    z = low + depth + width
    head = dims.sensor_z - dims.sensor.head_diameter_mm / 2 - design.sensor.clearance_mm - design.bone.rim_mm
    join = dims.taper_end_z
    limit = min(head, join - _BEFORE_TIP)
    if z + depth > limit + SLACK:
        obstacle = "the rim of the sensor's head" if head < join else "the rounded tip"
        # A short finger leaves no space at all, for which the limit is negative.
        begins = f", which begins {limit:.2f} mm from the collar" if limit > 0.0 else ""
        return Violation(
            f"{depth:g} mm deep and {width:g} mm wide, {low:g} mm from the collar, the groove runs into "
            f"{obstacle}{begins}",
            at_most(max(0.0, (limit - low - width) / 2)),
        )
    section = dims.bone_outline.section
    slot = dims.tail_half_width + design.bone.wall_mm

    def keeps_wall(depth: float) -> bool:
        scale = dims.bone_outline.scale_at(min(low + depth + width, head)) * (1 - depth / section.half_width)
        return section.half_width_at(-dims.flat_depth, scale) >= slot - SLACK

    if keeps_wall(depth):
        return None
    # The flat narrows faster than the groove deepens, so the bound has no closed form.
    maximum = bisect(keeps_wall, 0.0, depth, halvings=_DEPTH_HALVINGS)[0] if keeps_wall(0.0) else 0.0
    return Violation(f"{depth:g} mm cuts into the wall beside the tail's slot", at_most(maximum))


@FOLD_RULES.at_least("sensor.fold_radius_mm")
def film_bends_gently(design: DesignTables) -> Limit | None:
    if design.sensor.tail == "straight" or design.sensor.model == "custom":
        return None
    return Limit(MIN_FOLD_RADIUS_MM, "bends the film tighter than its maker allows")


@FOLD_RULES.rule("sensor.distance_from_tip_mm")
def tail_long_enough_to_fold(design: DesignTables) -> Violation | None:
    dims, distance = design.dimensions, design.sensor.distance_from_tip_mm
    fold = dims.fold
    if fold is None:
        return None
    # The further the head lies from the tip, the closer it is to the fold: the more film is left, the less is straight.
    minimum = distance + fold.nose_z + _MIN_IN_PASSAGE_MM - fold.film_end_z
    straight = dims.sensor_z - dims.sensor.head_diameter_mm / 2 - fold.nose_z
    maximum = distance + straight - _MIN_STRAIGHT_MM
    if minimum - SLACK <= distance <= maximum + SLACK:
        return None
    what = "too short to fold" if distance < minimum else "bent right behind the sensor's head"
    return Violation(
        f"{distance:g} mm leaves the tail of the {dims.sensor.label} {what}",
        ((minimum, maximum),) if minimum <= maximum else (),
        alternatives={"sensor.tail": "straight"},
    )


@FOLD_RULES.rule("skin.semi_axis_dorsal_mm", bone_left_at_sides, bone_left_dorsally, tip_within_skin)
def lid_thick_enough_over_film(design: DesignTables) -> Violation | None:
    """The lid keeps a wall above the film, also where the groove of the skin thins it."""
    dims, dorsal = design.dimensions, design.skin.semi_axis_dorsal_mm
    lacking = _find_lacking_roof(design, dims.fold, dims.tail_half_width, dims.fold.film_space_mm) if dims.fold else 0.0
    if lacking <= SLACK:
        return None
    return Violation(f"{dorsal:g} mm leaves no lid of a wall above the folded tail", at_least(dorsal + lacking))


@FOLD_RULES.rule("sensor.crimp_height_mm", lid_thick_enough_over_film)
def lid_thick_enough_over_tabs(design: DesignTables) -> Violation | None:
    fold, crimp = design.dimensions.fold, design.sensor.crimp_height_mm
    lacking = _find_lacking_roof(design, fold, fold.tabs_half_width, fold.tabs_space_mm) if fold else 0.0
    if lacking <= SLACK:
        return None
    return Violation(
        f"{crimp:g} mm leaves no lid of a wall above the tabs of the folded tail", at_most(crimp - lacking)
    )


@FOLD_RULES.rule("skin.width_mm", bone_left_at_sides, bone_left_dorsally)
def cheeks_hold_the_nose(design: DesignTables) -> Violation | None:
    """The cheeks beside the window are as high as the nose, and a wall thick there."""
    dims = design.dimensions
    fold, section = dims.fold, dims.bone_outline.section
    if fold is None:
        return None
    half = dims.tail_half_width + design.bone.wall_mm
    top = fold.nose_y + fold.radius
    if section.half_width_at(top) >= half - SLACK:
        return None
    width, share = design.skin.width_mm, section.half_width_at(top) / section.half_width
    passing = at_least(width + 2 * (half / share - section.half_width)) if share > 0.0 else ()
    return Violation(f"{width:g} mm leaves no wall beside the folded tail", passing)


@FOLD_RULES.rule("skin.width_mm", bone_left_at_sides, bone_left_dorsally, tip_within_skin)
def trough_keeps_side_walls(design: DesignTables) -> Violation | None:
    """The bone keeps a wall beside the film's space at the end of the trough, where the finger is narrowest."""
    dims, wall = design.dimensions, design.bone.wall_mm
    fold, section = dims.fold, dims.bone_outline.section
    if fold is None:
        return None
    half = dims.tail_half_width
    top, scale = fold.floor_y + fold.film_space_mm, _outline_scale(design, fold.trough_end_z)
    angles = [math.pi / 2 * i / _DIRECTIONS for i in range(_DIRECTIONS)]
    lacking = max(
        half + wall * math.cos(a) - section.half_width_at(max(top + wall * math.sin(a), 0.0), scale) for a in angles
    )
    if lacking <= SLACK:
        return None
    width = design.skin.width_mm
    return Violation(
        f"{width:g} mm leaves no wall beside the end of the folded tail",
        at_least(width + 2 * lacking / scale) if scale > 0.0 else (),
    )


def _find_lacking_roof(design: DesignTables, fold: TailFold, half_width: float, space_mm: float) -> float:
    """Find by how much the top of a space [mm] must be lower for its corners to keep a wall; 0 if they keep it."""
    top, scale = fold.floor_y + space_mm, _outline_scale(design, fold.trough_end_z)

    def keeps(lower: float) -> bool:
        return _has_wall(design, half_width, top - lower, scale)

    if keeps(0.0):
        return 0.0
    height = top + design.skin.semi_axis_dorsal_mm
    return bisect(lambda lower: not keeps(lower), 0.0, height, halvings=40)[1]


def _outline_scale(design: DesignTables, end_z: float) -> float:
    """Scale of the bone's outline at the distal end of the trough, or in the groove of the skin if that is smaller."""
    outline, bone = design.dimensions.bone_outline, design.bone
    scale = outline.scale_at(min(end_z + bone.wall_mm, outline.tip.z if outline.tip else end_z))
    groove_end = bone.groove_distance_mm + bone.groove_depth_mm + bone.groove_width_mm
    if bone.groove_depth_mm and bone.groove_distance_mm < end_z:
        floor = outline.scale_at(min(groove_end, design.dimensions.taper_end_z))
        scale = min(scale, floor * (1 - bone.groove_depth_mm / outline.section.half_width))
    return scale


def _has_wall(design: DesignTables, x: float, y: float, scale: float) -> bool:
    """Return whether the lid is a wall thick around a point of the bone's section [mm], in all directions outwards."""
    section, wall = design.dimensions.bone_outline.section, design.bone.wall_mm
    edge = design.dimensions.sensor.tail_width_mm / 2
    for i in range(_DIRECTIONS + 1):
        angle = math.pi / 2 * i / _DIRECTIONS
        beside, above = x + wall * math.cos(angle), y + wall * math.sin(angle)
        # Beyond its edge the lid ends.
        if beside <= max(edge, x) + SLACK and section.half_width_at(max(above, 0.0), scale) < beside:
            return False
    return True
