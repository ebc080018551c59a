"""Rules of the mold's recess for base and collar: it fits them, and ends within the skin's edge."""

from __future__ import annotations

import math

from fingertip.design.geometry.design_tables import DesignTables
from fingertip.design.geometry.insert_body import add_draft
from fingertip.design.rules.bone import collar_carries_skin
from fingertip.design.rules.ruleset import SLACK, Ruleset, Violation, at_least, at_most
from fingertip.design.rules.skin import bone_left_at_sides, bone_left_dorsally

RULES = Ruleset()
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


@RULES.rule("mold.recess_length_mm")
def recess_within_base(design: DesignTables) -> Violation | None:
    """The recess is not longer than the bone's base."""
    base = design.bone.base_length_mm
    if design.mold.recess_length_mm <= base:
        return None
    return Violation(
        f"{design.mold.recess_length_mm:g} mm is longer than the bone's base",
        at_most(base),
        "(limited by bone.base_length_mm)",
    )


@RULES.rule("mold.fit_clearance_mm", *_SOUND_COLLAR)
def fit_stays_within_skin(design: DesignTables) -> Violation | None:
    """The collar's recess stays within the skin's edge."""
    section, slope = design.dimensions.collar.section, design.dimensions.draft_slope
    widening = add_draft(section, slope).half_width - section.half_width if slope else 0.0
    maximum = design.bone.collar_inset_mm - widening - _EDGE_MARGIN
    if design.mold.fit_clearance_mm <= maximum + SLACK:
        return None
    return Violation(
        f"{design.mold.fit_clearance_mm:g} mm makes the collar's recess wider than the skin",
        at_most(maximum),
        "(limited by bone.collar_inset_mm)",
    )


@RULES.rule("mold.fit_clearance_mm")
def fit_stays_open(design: DesignTables) -> Violation | None:
    """The gap between base and recess does not close in the print."""
    minimum = design.printer.offset_mm + _MIN_PRINTED_FIT
    if design.printer.offset_mm <= 0.0 or design.mold.fit_clearance_mm >= minimum - SLACK:
        return None
    return Violation(
        f"{design.mold.fit_clearance_mm:g} mm closes in the print, which adds {design.printer.offset_mm:g} mm "
        "(printer.offset_mm)",
        at_least(minimum),
    )


@RULES.rule("mold.recess_length_mm")
def recess_holds_collar(design: DesignTables) -> Violation | None:
    """The recess holds the collar and a wall behind it."""
    gap = design.mold.fit_clearance_mm * math.hypot(1.0, design.dimensions.draft_slope)
    minimum = design.bone.collar_length_mm + gap + _MIN_BEHIND_COLLAR
    if design.mold.recess_length_mm >= minimum - SLACK:
        return None
    return Violation(
        f"{design.mold.recess_length_mm:g} mm does not hold the collar and a wall behind it", at_least(minimum)
    )


@RULES.rule("bone.collar_length_mm")
def collar_outlasts_its_draft(design: DesignTables) -> Violation | None:
    """The collar keeps a minimum length where its draft shortens it most."""
    section, slope = design.dimensions.collar.section, design.dimensions.draft_slope
    minimum = _MIN_COLLAR_LENGTH + slope * max(section.palmar, section.dorsal)
    if design.bone.collar_length_mm >= minimum - SLACK:
        return None
    return Violation(
        f"{design.bone.collar_length_mm:g} mm is used up by a draft of {design.mold.draft_deg:g} degrees before the "
        "collar's palmar or dorsal end",
        at_least(minimum),
    )
