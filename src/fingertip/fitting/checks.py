"""Checks of a build as rules of a fit, which foresees them: the pad, the print and the mold, the
joint, and the strength of the bone.
"""

from __future__ import annotations

import functools
import math
from typing import cast

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.overhang import MAX_LEDGE_MM, OVERHANG_DEG
from fingertip.cad.verification.mold import palmar_error_mm, palmar_error_share
from fingertip.cad.verification.skin import MAX_REST_N, WANTED_TURN_ON_N
from fingertip.cad.verification.strength import BoneStrength, assess_strength, list_load_points
from fingertip.design import Design
from fingertip.design.fit import Holds
from fingertip.design.geometry import DesignTables
from fingertip.design.interfaces import interface_of
from fingertip.design.rules.ruleset import BrokenRule, Limit, Ruleset, find_violations
from fingertip.pad.layer import find_rest_n
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.survey import find_turn_on_n

_TOLERANCE_MM = 0.01
"""Tolerance of the meshes that are cut, which is that of a build unless another is asked for."""
_STRONGER = {
    "skin.semi_axis_dorsal_mm": 1.3,
    "skin.thickness_dorsal_mm": 0.5,
    "skin.thickness_side_mm": 0.6,
    "sensor.distance_from_tip_mm": 0.7,
    "bone.post_height_mm": 1.25,
    "bone.post_width_mm": 1.25,
    "bone.foot_radius_mm": 1.6,
}
"""Factors on parameters that make a bone on a post stronger."""
# Pads with the next three turn on below 1 N.
_TILT = math.radians(5.0)
"""Tilt tip up at which a pad must feel a touch."""
_CLEAR_MM = 0.15
"""Height by which the pad stands out past the collar at that tilt."""
_BESIDE_SENSOR = 1.25
"""Distance of the touch from the sensor over the radius of its active area."""
_JOINT = Ruleset(lambda design: design.dimensions.joint)
_BONE = Ruleset()
_CROWN = Ruleset(lambda design: design.dimensions.crown)
_SKIN = Ruleset()


def judge(design: DesignTables) -> tuple[BrokenRule, ...]:
    """Find the checks of a build that a design fails, of those that no rule foresees."""
    return tuple(find_violations((*_CROWN, *_SKIN, *_BONE), design))


@_CROWN.at_least("skin.crown_drop_mm")
def pad_touches_before_the_collar(design: DesignTables) -> Limit:
    """A plate that leans on the collar touches the arc of the crown proximal of its apex."""
    skin = design.skin
    cos = math.cos(_TILT)
    sin = math.sin(_TILT)
    apex_z = design.dimensions.sensor_z - skin.crown_offset_mm
    pad = (
        (skin.semi_axis_palmar_mm - skin.crown_radius_mm) * cos
        + skin.crown_radius_mm
        - apex_z * sin
    )
    collar = design.dimensions.collar.section.palmar * cos + design.bone.collar_length_mm * sin

    return Limit(
        skin.crown_drop_mm + (_CLEAR_MM + collar - pad) / cos,
        "lets the collar touch a plate before the pad feels it",
    )


@_CROWN.at_most("skin.crown_drop_mm", when=lambda design: design.bone.platform_mm)
def platform_enters_the_mold(design: DesignTables) -> Limit:
    """The platform of the core is lowered past the base of the pad."""
    dims = design.dimensions
    outer = design.dimensions.outer
    sections = (span.z[0] for span in outer.spans if span.z[0] < dims.sensor_z)
    room = max(
        _TOLERANCE_MM, min(outer.palmar_height_at(dims.platform_radius, z) for z in sections)
    )
    needed = (
        (dims.platform_depth - design.mold.core_inset_mm + 2 * _TOLERANCE_MM)
        / room
        * dims.base_palmar_height
    )

    return Limit(
        design.skin.semi_axis_palmar_mm - needed, "lets the core touch the mold as it is lowered"
    )


@_CROWN.at_most("skin.crown_offset_mm")
def pad_touches_near_the_sensor(design: DesignTables) -> Limit:
    """A tilted plate touches the pad beside the sensor, farther off on a crown of larger radius."""
    reach = _BESIDE_SENSOR * design.dimensions.sensor.active_diameter_mm / 2
    return Limit(
        reach - math.sin(_TILT) * design.skin.crown_radius_mm,
        "lets a plate touch beside the sensor",
    )


@_SKIN.at_most("skin.bump_height_mm", when=lambda design: design.skin.bump_height_mm)
def bump_rests_lightly(design: DesignTables) -> Limit | None:
    """The force at rest is proportional to the height of the bump."""
    rest_n = find_rest_n(PadForm.of_design(cast(Design, design)))
    return Limit(
        design.skin.bump_height_mm * MAX_REST_N / max(rest_n, MAX_REST_N),
        "presses too hard on the sensor at rest",
    )


@_SKIN.at_most("bone.platform_mm", when=lambda design: design.dimensions.prints_without_supports)
def platform_prints_as_a_ledge(design: DesignTables) -> Limit | None:
    """A wide head stands out beside the ramp, where it prints over air."""
    dims = design.dimensions
    steep = math.sin(math.radians(OVERHANG_DEG))
    is_wide = dims.platform_radius * steep - dims.neck_half_width > MAX_LEDGE_MM

    return Limit(MAX_LEDGE_MM, "overhangs beside its ramp") if is_wide else None


@_SKIN.at_least("skin.thickness_palmar_mm")
def mold_is_true_over_the_sensor(design: DesignTables) -> Limit:
    """The error with which the mold holds its core must be a small share of the skin."""
    built = cast(Design, design)
    least = palmar_error_mm(built) / palmar_error_share(built)
    return Limit(least, "is too thin for the error with which the mold holds its core")


@_BONE.at_most("skin.crown_offset_mm", when=lambda design: design.dimensions.crown)
def tilted_pad_turns_the_sensor_on(design: DesignTables) -> Limit:
    """Little silicone over the sensor spreads a touch beside it less than most do."""
    force_n = find_turn_on_n(PadForm.of_design(cast(Design, design)), -math.degrees(_TILT))
    share = WANTED_TURN_ON_N / max(force_n, WANTED_TURN_ON_N)
    return Limit(design.skin.crown_offset_mm * share, "lets a plate turn the sensor on too late")


@_JOINT.at_most("strength.grip_force_n", when=lambda design: design.strength.min_grip_factor)
def joint_holds_the_grip(design: DesignTables) -> Limit:
    """The stress at the joint is proportional to the grip force at the farthest point."""
    farthest_z = max(z for _, _, z in list_load_points(cast(Design, design)).values())
    stresses = interface_of(design).local_stresses(design, farthest_z)
    worst = max(place.stress_per_n for place in stresses)
    factor = design.strength.min_grip_factor
    force = design.strength.material.strength_mpa / worst / factor
    return Limit(force, f"is more than the joint holds with a safety factor of {factor:g}")


@functools.lru_cache(maxsize=16)
def assess(design: DesignTables) -> BoneStrength:
    """Assess the strength of the bone; the last designs are remembered."""
    return assess_strength(cast(Design, design), MeshEvaluator(_TOLERANCE_MM))


@_BONE.at_most("strength.grip_force_n", when=lambda design: design.strength.min_grip_factor)
def bone_holds_the_grip(design: DesignTables) -> Limit:
    strength = assess(design)
    factor = design.strength.min_grip_factor
    where = f"{strength.weakest.place} at z = {strength.weakest.z_mm:.0f} mm"
    return Limit(
        strength.breaks_n / factor, f"leaves the bone a safety factor below {factor:g} ({where})"
    )


@_BONE.at_most("strength.knock_speed_m_s", when=lambda design: design.strength.min_knock_factor)
def bone_holds_the_knock(design: DesignTables) -> Limit:
    strength = assess(design)
    factor = design.strength.min_knock_factor
    where = f"{strength.knock.weakest.place} at z = {strength.knock.weakest.z_mm:.0f} mm"
    return Limit(
        strength.held_speed_m_s, f"leaves the bone a safety factor below {factor:g} ({where})"
    )


HOLDS = Holds((*_CROWN, *_SKIN, *_JOINT), judge, _STRONGER)
"""Judgement of a fit: rules that cost little first, then the strength of the bone."""
