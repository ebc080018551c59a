"""Skin that lies on the bone without a bond: what presses on its sensor at rest, its hold, its slide.

The fits are those of `PadForm.of_design`: the tightest presses most on the sensor at rest, the loosest leaves the
largest dead zone.
"""

from __future__ import annotations

import math
from typing import Any

from fingertip.cad.verification.check import Check
from fingertip.design import Design
from fingertip.pad.form import INNER_FRICTION
from fingertip.pad.survey import FORCE_N, survey_pad

MAX_REST_N = 0.1
"""Force on the sensor that nothing touches: half of what turns a typical one on."""
BEAD_MM, _BEAD_MPA = 2.0, 0.25
"""Width of the bead of neutral silicone adhesive between skin and collar, and the shear that it holds. Assumptions."""
_SLIDE, _SLIDE_FLAT = 0.23, 0.33
"""Slide of the skin over the sensor under a force along the finger, times modulus over force [1/mm], by finite elements
without friction: 0.18 to 0.23 in four designs with a platform, which is a key, and 0.33 without one."""


def check_rest_force(design: Design) -> Check:
    return Check("pad.rest_force", survey_pad(design).rest_n, MAX_REST_N, "N")


def describe_lying_skin(design: Design) -> dict[str, Any]:
    """Describe the skin in the report: what its loosest fit feels, and how it holds and slides."""
    loose = survey_pad(design, is_loose=True)
    return {
        "loose": loose.to_dict(),
        "pull_off_n": round(pull_off_n(design), 1),
        "pull_off_glued_n": round(pull_off_n(design, is_glued=True), 1),
        "slide_mm": round(slide_mm(design), 2),
    }


def pull_off_n(design: Design, *, is_glued: bool = False) -> float:
    """Estimate the force along the finger that pulls the skin off [N], a lower bound, with its softest silicone.

    The skin is a tube on an elastic foundation, its own hoops, and a rib must stretch it by the groove's depth to come
    out: a ring load near a free end (M. Hetenyi, Beams on Elastic Foundation, 1946, chapter 2), which climbs a flank of
    45 degrees with friction. A tight skin adds friction, a bead of adhesive its shear.
    """
    bone, skin, section = design.bone, design.skin, design.dimensions.bone_outline.section
    modulus, thickness = design.silicone.material.modulus_mpa.low, min(skin.thickness_side_mm, skin.thickness_dorsal_mm)
    radius = (section.half_width + (section.dorsal + design.dimensions.flat_depth) / 2) / 2
    wave = math.sqrt(math.sqrt(3 * (1 - 0.5**2)) / (radius * thickness))
    at = wave * (bone.groove_distance_mm + bone.groove_depth_mm + bone.groove_width_mm / 2)
    free = 1 + math.exp(-2 * at) * (1 + 2 * math.cos(at) ** 2 - 2 * math.sin(at) * math.cos(at))
    ring = 4 * math.pi * modulus * thickness * bone.groove_depth_mm / (radius * wave * free)
    tight = modulus * design.mold.core_inset_mm * thickness / radius * math.tau * design.dimensions.taper_end_z
    bead = _BEAD_MPA * BEAD_MM * math.tau * radius if is_glued else 0.0
    return ring * (1 + INNER_FRICTION) / (1 - INNER_FRICTION) + INNER_FRICTION * tight + bead


def slide_mm(design: Design) -> float:
    """Estimate how far 1 N along the finger moves the skin over the sensor, without friction [mm]."""
    modulus, factor = design.silicone.material.modulus_mpa, _SLIDE if design.bone.platform_mm else _SLIDE_FLAT
    return factor * FORCE_N / math.sqrt(modulus.low * modulus.high)
