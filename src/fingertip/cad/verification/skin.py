"""Checks of the skin: thickness, deviation of its mesh, stretch as it is put on, its pad, and what
holds a loose one.

Thickness is measured above the plane z = 0, where the skin is cut square: the least gap between
bone and outside. A skin that lies on the bone without a bond fits as `PadForm.of_design` says: the
tightest fit presses most on the sensor at rest, the loosest leaves the largest dead zone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from fingertip.cad.kernel.mesh import Manifold, MeshEvaluator
from fingertip.cad.verification.check import (
    PLANE_OFFSET_MM,
    Check,
    Checks,
    Solids,
    above_z,
    complement,
    measure_gap,
)
from fingertip.cad.verification.deviation import max_facet_deviation
from fingertip.design import Design
from fingertip.models.bone import filled_bone
from fingertip.models.making import making_of
from fingertip.models.outline import skin_outline
from fingertip.models.skin import skin_interior
from fingertip.pad.pad_geometry import INNER_FRICTION
from fingertip.pad.survey import FORCE_N, MAX_TURN_ON_N, survey_pad

CHECKS = Checks()

MAX_STRETCH_SHARE = 0.2
"""Share of its elongation at break by which a skin may be stretched: tight ones split after weeks.
"""
_SECTIONS = 24
"""Sections along the straight part of a skin whose perimeters are measured."""


@CHECKS.register(
    "skin",
    change={
        "skin.min_thickness": (
            "skin.thickness_side_mm",
            "bone.palmar_fullness",
            "skin.min_thickness_mm",
        ),
        "pad.turn_on_force": (
            "sensor.distance_from_tip_mm",
            "bone.collar_inset_mm",
            "skin.crown_radius_mm",
        ),
        "pad.rest_force": ("skin.bump_height_mm", "skin.bump_radius_mm"),
    },
)
def check_skin(design: Design, solids: Solids) -> Iterator[Check]:
    tolerance_mm = solids.evaluator.tolerance_mm
    mesh = solids.mesh("skin")
    minimum = design.skin.min_thickness_mm - 2 * tolerance_mm  # facets of both surfaces deviate
    yield Check(
        name="skin.min_thickness",
        value=min_thickness(design, solids.evaluator),
        limit=minimum,
        unit="mm",
        relation="at least",
    )
    deviation = max_facet_deviation(design.dimensions.outer, mesh.vertices, mesh.triangles)
    yield Check("skin.surface_deviation", deviation, tolerance_mm, "mm")
    yield check_pad(design)
    if not making_of(design).is_bonded:
        yield check_rest_force(design)


def min_thickness(design: Design, evaluator: MeshEvaluator) -> float:
    """Measure the smallest thickness [mm] between a skin's interior and its outside.

    It is 0 where they meet.
    """
    interior = above_z(evaluator.manifold(skin_interior(design)), PLANE_OFFSET_MM)
    # Everything around the skin, but not beyond its flat end, where the skin is open.
    outside = above_z(complement(evaluator, skin_outline(design)), PLANE_OFFSET_MM)
    return measure_gap(interior, outside, 1.0)


def check_fitting_stretch(design: Design, evaluator: MeshEvaluator) -> Check:
    """Check the stretch [%] of a skin's narrowest section when it is pulled over the widest section
    of the bone.
    """
    interior, whole = (evaluator.manifold(s) for s in (skin_interior(design), filled_bone(design)))
    straight_length = design.skin.length_mm - design.skin.tip_length_mm
    heights = [straight_length * (i + 0.5) / _SECTIONS for i in range(_SECTIONS)]
    narrowest = min(_perimeter(interior, z) for z in heights)
    widest = max(_perimeter(whole, z) for z in heights)
    stretch = widest / narrowest - 1.0
    limit = MAX_STRETCH_SHARE * design.silicone.material.elongation_percent.low

    return Check("skin.fitting_stretch", 100 * stretch, limit, "%")


def _perimeter(solid: Manifold, z: float) -> float:
    """Compute the perimeter [mm] of a solid's section at height `z` [mm]."""
    outlines = solid.slice(z).to_polygons()
    return sum(math.dist(a, b) for outline in outlines for a, b in pairwise([*outline, outline[0]]))


WANTED_TURN_ON_N = 1.0
"""Force on the pad at which the sensor must be on, at every tilt of a wide range [N].
An assumption.
"""


def check_pad(design: Design) -> Check:
    """Check that the sensor feels a light touch.

    What else a pad does stands in the report's section `pad`.
    """
    force = survey_pad(design).worst_turn_on_n
    value = min(force, MAX_TURN_ON_N)
    is_beyond = force > MAX_TURN_ON_N

    return Check("pad.turn_on_force", value, WANTED_TURN_ON_N, "N", is_beyond=is_beyond)


MAX_REST_N = 0.1
"""Force on the sensor that nothing touches: half of what turns a typical one on."""
BEAD_MM = 2.0
_BEAD_MPA = 0.25
"""Width of the bead of neutral silicone adhesive between skin and collar, and the shear that it
holds. Assumptions.
"""
_SLIDE = 0.23
_SLIDE_FLAT = 0.33
"""Slide of the skin over the sensor under a force along the finger, times modulus over force
[1/mm], by finite elements without friction: 0.18 to 0.23 in four designs with a platform, which is
a key, and 0.33 without one.
"""


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
    """Estimate the force along the finger that pulls the skin off [N], a lower bound, with its
    softest silicone.

    The skin is a tube on an elastic foundation, its own hoops, and a rib must stretch it by the
    groove's depth to come out: a ring load near a free end (M. Hetenyi, Beams on Elastic
    Foundation, 1946, chapter 2), which climbs a flank of 45 degrees with friction. A tight skin
    adds friction, a bead of adhesive its shear.
    """
    bone = design.bone
    skin = design.skin
    section = design.dimensions.bone_outline.section
    modulus = design.silicone.material.modulus_mpa.low
    thickness = min(skin.thickness_side_mm, skin.thickness_dorsal_mm)
    radius = (section.half_width + (section.dorsal + design.dimensions.flat_depth) / 2) / 2
    wave = math.sqrt(math.sqrt(3 * (1 - 0.5**2)) / (radius * thickness))
    at = wave * (bone.groove_distance_mm + bone.groove_depth_mm + bone.groove_width_mm / 2)
    free = 1 + math.exp(-2 * at) * (1 + 2 * math.cos(at) ** 2 - 2 * math.sin(at) * math.cos(at))
    ring = 4 * math.pi * modulus * thickness * bone.groove_depth_mm / (radius * wave * free)
    tight = (
        modulus
        * design.mold.core_inset_mm
        * thickness
        / radius
        * math.tau
        * design.dimensions.taper_end_z
    )
    bead = _BEAD_MPA * BEAD_MM * math.tau * radius if is_glued else 0.0

    return ring * (1 + INNER_FRICTION) / (1 - INNER_FRICTION) + INNER_FRICTION * tight + bead


def slide_mm(design: Design) -> float:
    """Estimate how far 1 N along the finger moves the skin over the sensor [mm], if it slides."""
    modulus = design.silicone.material.modulus_mpa
    factor = _SLIDE if design.bone.platform_mm else _SLIDE_FLAT
    return factor * FORCE_N / math.sqrt(modulus.low * modulus.high)
