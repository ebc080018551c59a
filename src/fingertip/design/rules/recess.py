"""Rules of the recess that holds base and collar in the mold: it fits them, and does not let them lean too far."""

from __future__ import annotations

import math

from fingertip.design.geometry.dimensions import compute_dimensions
from fingertip.design.geometry.draft import add_draft
from fingertip.design.geometry.misalignment import min_thickness_held, places
from fingertip.design.parameters import DesignTables
from fingertip.design.rules.ruleset import SLACK, Ruleset, ceil2, floor2
from fingertip.design.rules.skin import COVER, cover_is_sound

RULES = Ruleset()
_COLLAR_LEFT = 0.6  # length of the collar [mm] where its draft has taken most of it
_MIN_FIT = 0.02  # lower bound of mold.fit_clearance_mm [mm]


@RULES.rule("mold.recess_length_mm", "bone.base_length_mm")
def _recess_within_base(d: DesignTables) -> str | None:
    if d.mold.recess_length_mm <= d.bone.base_length_mm:
        return None
    return (
        f"{d.mold.recess_length_mm:g} mm is longer than the bone's base; "
        f"at most {d.bone.base_length_mm:g} mm (bone.base_length_mm)."
    )


@RULES.rule(
    "mold.fit_clearance_mm", "bone.collar_inset_mm", "mold.draft_deg", "mold.recess_length_mm", "mold.method",
    "mold.sleeve_interference_mm", "skin.min_thickness_mm", "skin.squareness_dorsal", *COVER,
)  # fmt: skip
def _fit_is_tight_enough(d: DesignTables) -> str | None:
    edge, tilt = _max_fit_at_edge(d), _max_fit_by_tilt(d)
    maximum, fit = min(edge, tilt), d.mold.fit_clearance_mm
    if fit <= maximum + SLACK:
        return None
    if edge <= tilt:
        return (
            f"{fit:g} mm opens the collar's recess past the skin's edge; at most {floor2(max(0.0, maximum))} mm "
            "(bone.collar_inset_mm)."
        )
    left = max(0.0, min_thickness_held(d, compute_dimensions(d)))
    bound = f"at most {floor2(maximum)} mm, or " if maximum >= _MIN_FIT else ""
    return (
        f"{fit:g} mm lets bone or core lean in its recess until {left:.2f} mm of silicone are left where "
        f"skin.min_thickness_mm asks for {d.skin.min_thickness_mm:g} mm; {bound}make the skin thicker or shorter."
    )


def _max_fit_at_edge(d: DesignTables) -> float:
    """Clearance [mm] at which the collar's recess reaches the skin's edge."""
    dims = compute_dimensions(d)
    section, slope = dims.collar.section, dims.draft_slope
    wider = add_draft(section, slope).half_width - section.half_width if slope else 0.0
    return d.bone.collar_inset_mm - wider - 0.05


def _max_fit_by_tilt(d: DesignTables) -> float:
    """Clearance [mm] at which a bone or core that leans leaves the least thickness allowed."""
    if not cover_is_sound(d):
        return math.inf
    minimum, found = d.skin.min_thickness_mm, list(places(d, compute_dimensions(d)))
    if min(place.cover_mm for place in found) <= minimum:
        return math.inf  # too thin without any tilt: the rule of the thinnest place says it
    return min((place.cover_mm - minimum) / place.held for place in found)


@RULES.rule("mold.recess_length_mm", "bone.collar_length_mm", "mold.fit_clearance_mm", "mold.draft_deg")
def _recess_holds_collar(d: DesignTables) -> str | None:
    gap = d.mold.fit_clearance_mm * math.hypot(1.0, compute_dimensions(d).draft_slope)
    minimum = d.bone.collar_length_mm + gap + 1.0
    if d.mold.recess_length_mm >= minimum - SLACK:
        return None
    return (
        f"{d.mold.recess_length_mm:g} mm does not hold the collar and a wall behind it; at least {ceil2(minimum)} mm."
    )


@RULES.rule(
    "bone.collar_length_mm", "mold.draft_deg", "bone.collar_inset_mm", "skin.semi_axis_palmar_mm",
    "skin.semi_axis_dorsal_mm",
)  # fmt: skip
def _collar_outlasts_its_draft(d: DesignTables) -> str | None:
    section, slope = compute_dimensions(d).collar.section, compute_dimensions(d).draft_slope
    minimum = _COLLAR_LEFT + slope * max(section.palmar, section.dorsal)
    if d.bone.collar_length_mm >= minimum - SLACK:
        return None
    return (
        f"{d.bone.collar_length_mm:g} mm is used up by a draft of {d.mold.draft_deg:g} degrees before the collar's "
        f"palmar or dorsal end; at least {ceil2(minimum)} mm, or less mold.draft_deg."
    )
