"""Fit of a finger: derived parameters move until all rules pass and the bone holds its loads."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Collection, Sequence
from typing import cast

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.overhang import MAX_LEDGE_MM, OVERHANG_DEG
from fingertip.cad.verification.mold import palmar_error_mm, palmar_error_share
from fingertip.cad.verification.skin import MAX_REST_N, WANTED_TURN_ON_N
from fingertip.cad.verification.strength import BoneStrength, assess_strength, list_load_points
from fingertip.cad.verification.verify import check
from fingertip.design import Design
from fingertip.design.fit import LEAST_LOADS, Fit, Holds, Move, find_fit, fit_design
from fingertip.design.geometry import DesignTables
from fingertip.design.interfaces import interface_of
from fingertip.design.rules.ruleset import BrokenRule, Limit, Ruleset, find_violations
from fingertip.foundation.errors import DesignError
from fingertip.pad.layer import find_rest_n
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.survey import find_turn_on_n

_TOLERANCE_MM = 0.01
"""Tolerance of the meshes that are cut, which is that of a build unless another is asked for."""
_FEW = 200
"""Number of single rules that are checked for an offer, so that it takes no longer than
the checks.
"""
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
_TILT = math.radians(5.0)
_CLEAR_MM = 0.15
_BESIDE_SENSOR = 1.25
"""Tilt tip up at which a pad must feel a touch, height by which it stands out past the collar
there, and distance of the touch from the sensor over the radius of its active area. Pads with these
turn on below 1 N.
"""
_JOINT = Ruleset(lambda design: design.dimensions.joint)
_BONE = Ruleset()
_CROWN = Ruleset(lambda design: design.dimensions.crown)
_SKIN = Ruleset()


def fit_finger(
    tables: DesignTables,
    given: Collection[str] = (),
    before: DesignTables | None = None,
    progress: Callable[[float], None] = lambda share: None,
    provisional: Collection[str] = (),
) -> Fit:
    """Fit a design as `fit_design` does, until its bone also holds the loads that it states.

    Raises DesignError.

    Guessed sizes of the hand that are `provisional` move too, and such loads become those that the
    bone holds.
    """
    light = {
        load: least
        for load, least in LEAST_LOADS.items()
        if load in provisional and load not in given
    }
    guessed = [name for name in provisional if name not in LEAST_LOADS]
    fit = functools.partial(
        fit_design,
        given=given,
        before=before,
        holds=_HOLDS,
        progress=progress,
        guessed=guessed,
    )

    try:
        fitted = fit(tables)
    except DesignError:
        if not light:
            raise

        fitted = fit(tables.with_values(light))

    lighter = lower_loads(
        fitted.tables.with_values({load: tables.value(load) for load in light}), light
    )
    return Fit(lighter.tables, (*fitted.moves, *lighter.moves))


def lower_loads(tables: DesignTables, loads: Collection[str]) -> Fit:
    """Lower some loads to what the bone holds. Raises GeometryError."""
    held = _assess(tables).lighter_loads if loads else {}
    moves = [
        Move(load, tables.value(load), held[load], "the bone holds no more")
        for load in loads
        if load in held
    ]
    return Fit(tables.with_values({move.name: move.after for move in moves}), tuple(moves))


def find_mend(design: Design, given: Collection[str]) -> Sequence[str]:
    """Name what a fit moves of a design that fails checks, if it then
    passes all; nothing if that takes too long.
    """
    fit, _ = find_fit(design, given, holds=_HOLDS, checks=_FEW, is_early=True)
    passes = fit and all(
        each.passed for each in check(Design.model_construct(None, **dict(fit.tables))).checks
    )
    return [move.name for move in fit.moves] if fit and passes else []


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
    farthest_z = max(z for _, _, z in list_load_points(cast(Design, design)).values())
    worst = max(
        place.stress_per_n for place in interface_of(design).local_stresses(design, farthest_z)
    )
    force = design.strength.material.strength_mpa / worst / design.strength.min_grip_factor
    return Limit(
        force,
        f"is more than the joint holds with a safety factor of {design.strength.min_grip_factor:g}",
    )


@functools.lru_cache(maxsize=16)
def _assess(design: DesignTables) -> BoneStrength:
    return assess_strength(cast(Design, design), MeshEvaluator(_TOLERANCE_MM))


@_BONE.at_most("strength.grip_force_n", when=lambda design: design.strength.min_grip_factor)
def bone_holds_the_grip(design: DesignTables) -> Limit:
    found = _assess(design)
    factor = design.strength.min_grip_factor
    where = f"{found.weakest.place} at z = {found.weakest.z_mm:.0f} mm"
    return Limit(
        found.breaks_n / factor, f"leaves the bone a safety factor below {factor:g} ({where})"
    )


@_BONE.at_most("strength.knock_speed_m_s", when=lambda design: design.strength.min_knock_factor)
def bone_holds_the_knock(design: DesignTables) -> Limit:
    found = _assess(design)
    factor = design.strength.min_knock_factor
    where = f"{found.knock.weakest.place} at z = {found.knock.weakest.z_mm:.0f} mm"
    return Limit(
        found.held_speed_m_s, f"leaves the bone a safety factor below {factor:g} ({where})"
    )


_HOLDS = Holds((*_CROWN, *_SKIN, *_JOINT), judge, _STRONGER)
