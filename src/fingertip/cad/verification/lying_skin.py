"""Checks of a skin that lies on the bone without a bond: what its sensor feels with every fit, its hold, its slide.

The fits are those of `PadForm.of_design`: the tightest presses most on the sensor at rest, the loosest leaves the
largest dead zone. They warn, but for a sensor that is pressed without a touch.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.cad.verification.check import Check
from fingertip.design import Design
from fingertip.pad.form import INNER_FRICTION
from fingertip.pad.survey import FIRM_N, FORCE_N, GRASP_DEG, MAX_TURN_ON_N, WIDE_DEG, survey_pad

MAX_REST_N = 0.1
"""Force on the sensor that nothing touches: half of what turns a typical one on."""
_RANGES = (("grasp", GRASP_DEG, 0.30, 0.60), ("wide", WIDE_DEG, 0.40, 0.52))
"""Range of tilts, dead zone that is wanted there at most [N], and share at least."""
BEAD_MM, _BEAD_MPA = 2.0, 0.25
"""Width of the bead of neutral silicone adhesive between skin and collar, and the shear that it holds. Assumptions."""
_SLIDE, _SLIDE_FLAT = 0.23, 0.33
"""Slide of the skin over the sensor under a force along the finger, times modulus over force [1/mm], by finite elements
without friction: 0.18 to 0.23 in four designs with a platform, which is a key, and 0.33 without one."""


def check_lying_skin(design: Design) -> Iterator[Check]:
    if design.mold.method != "plunge":
        return
    tight, loose = survey_pad(design), survey_pad(design, is_loose=True)
    yield Check("pad.rest_force", tight.rest_n, MAX_REST_N, "N")
    for name, tilts, limit_n, least in _RANGES:
        dead, share = loose.dead_zone_n(*tilts), min(found.least_share(*tilts) for found in (tight, loose))
        where = f"on a plate tilted by {tilts[0]:g} to {tilts[1]:g} degrees"
        warning = f"{where} a loose skin passes nothing on up to {dead:.2g} N, above {limit_n:g}; a higher bump helps."
        yield Check(
            f"pad.dead_zone.{name}", min(dead, MAX_TURN_ON_N), MAX_TURN_ON_N, "N",
            warning=warning if dead > limit_n else "", is_beyond=dead > MAX_TURN_ON_N,
        )  # fmt: skip
        warning = f"{where} a loose skin passes {share:.0%} of {FORCE_N:g} N on, below {least:.0%}; a crown helps."
        yield Check(f"pad.loose_share.{name}", share, 0.0, "", "at least", warning if share < least else "")
    for name, held_n, wanted_n in (
        ("", pull_off_n(design), FIRM_N), ("_glued", pull_off_n(design, is_glued=True), design.strength.grip_force_n)
    ):  # fmt: skip
        warning = f"{held_n:.2g} N along the finger pull the skin off, less than {wanted_n:g} N of a grip that sticks."
        yield Check(f"skin.pull_off{name}", held_n, 0.0, "N", "at least", warning if held_n < wanted_n else "")
    if design.skin.bump_height_mm:
        slide = slide_mm(design)
        room = design.skin.bump_radius_mm - design.dimensions.sensor.active_diameter_mm / 2
        warning = f"{FORCE_N:g} N along the finger moves the rim of the bump by {slide:.2g} mm onto the active area."
        yield Check("skin.slide", slide, design.skin.bump_radius_mm, "mm", warning=warning if slide > room else "")


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
