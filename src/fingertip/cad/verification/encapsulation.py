"""Checks of an encapsulated bone: film, wires and plug, how far silicone creeps, and what holds it.

While the plate closes onto the rim, the silicone that overflows presses on all that is open to it.
The flow through a slot of a height h, a width w and a length L is p w h^3 / (12 mu L), and a
rectangle takes 1 - 0.63 h / w of it (F. M. White, Viscous Fluid Flow, section 3-3). The speed
cancels: the time integral of p / mu depends on the shapes alone. A gap g is filled to the depth
g sqrt(integral / 6).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.cad.verification.check import Check, Checks, Solids
from fingertip.cad.verification.skin import pull_off_n
from fingertip.design import Design
from fingertip.models import encapsulation, post
from fingertip.models.holder import flat_play_mm
from fingertip.models.making import making_of
from fingertip.models.mold_layout import GAP_MM, LIP_GAP_MM, LIP_WIDTH_MM, NOTCH_MM
from fingertip.models.sensor_pocket import sensor_body
from fingertip.models.solids import union
from fingertip.models.stand import post_gap_mm

CHECKS = Checks()

_PLAY_SHARE = 0.05
"""Largest part of the skin over the sensor by which the bone's play in its holder may move it."""
_FRICTION = 0.6
"""Friction of silicone on what is held, by which a grip pulls along the finger. An assumption."""
_INSERTING_STEPS = 24
"""Places along the way of the bone into its holder that are looked at."""
_WAY_MM = 5.0
_STEPS = 100
"""Last way of the plate over which the pressure is added up [mm], and steps along it."""


@CHECKS.register(
    "bone",
    "skin",
    "plug",
    "holder",
    change={
        "encapsulation.creep_to_vent": ("sensor.clearance_mm",),
        "encapsulation.creep_past_collar": ("printer.surface_error_mm", "bone.collar_length_mm"),
        "encapsulation.inserting_overlap": ("sensor.wire_diameter_mm", "skin.thickness_dorsal_mm"),
        "encapsulation.bone_play": ("bone.post_length_mm", "printer.surface_error_mm"),
        "encapsulation.pull_off": ("bone.groove_depth_mm", "skin.thickness_side_mm"),
    },
)
def check_encapsulation(design: Design, solids: Solids) -> Iterator[Check]:
    evaluator = solids.evaluator
    film = evaluator.manifold(sensor_body(design))
    wires = evaluator.manifold(encapsulation.wires(design))
    for name in ("skin", "plug", "holder"):
        part = evaluator.manifold(solids.parts[name])
        yield Check.zero_volume(f"overlap.sensor.{name}", float((film ^ part).volume()))
        yield Check.zero_volume(f"overlap.wires.{name}", float((wires ^ part).volume()))

    dims = design.dimensions
    reach = encapsulation.roof_end_z(design) - dims.tail_end_z
    yield Check("encapsulation.creep_to_vent", creep_beside_film_mm(design), reach, "mm")
    length = design.bone.collar_length_mm
    yield Check("encapsulation.creep_past_collar", creep_at_collar_mm(design), length, "mm")
    inserting = inserting_overlap_mm3(design, solids)
    yield Check.zero_volume("encapsulation.inserting_overlap", inserting)
    play = _PLAY_SHARE * design.skin.thickness_palmar_mm
    yield Check("encapsulation.bone_play", bone_play_mm(design), play, "mm")
    yield Check(
        name="encapsulation.pull_off",
        value=pull_off_n(design),
        limit=_FRICTION * design.strength.grip_force_n,
        unit="N",
        relation="at least",
    )


def inserting_overlap_mm3(design: Design, solids: Solids) -> float:
    """Measure the largest overlap with the holder while the bone goes in, with plug and knot, its
    wires on its back [mm3].
    """
    evaluator = solids.evaluator
    holder = evaluator.manifold(solids.parts["holder"])
    wires = encapsulation.wires(design).union(encapsulation.wires_on_back(design))
    moved = evaluator.manifold(union(solids.parts["bone"], solids.parts["plug"], wires))
    way = design.bone.base_length_mm + design.bone.post_length_mm
    steps = (way * i / _INSERTING_STEPS for i in range(1, _INSERTING_STEPS + 1))

    return max(float((moved.translate((0.0, 0.0, z)) ^ holder).volume()) for z in steps)


def closing_integral(design: Design) -> float:
    """Compute the time integral of the pressure over the viscosity while the plate closes.

    A motion dx of the plate drives A dx out, through the notches and through the gaps of lip and
    rim.
    """
    layout = design.mold_layout
    section = design.dimensions.outer.section
    height = section.dorsal + design.dimensions.base_palmar_height
    area = math.pi / 4 * 2 * section.half_width * height
    around = math.pi * (section.half_width + height / 2)
    rim = layout.half_width - layout.cavity_half_width - LIP_WIDTH_MM
    width, depth = NOTCH_MM
    steps = [_WAY_MM * (i + 0.5) / _STEPS for i in range(_STEPS)]
    spent = 0.0

    for x in steps:
        lip = _flow(around, x + LIP_GAP_MM) / LIP_WIDTH_MM
        land = _flow(around, x + GAP_MM) / rim
        notches = 4 * _flow(width, min(depth + GAP_MM + x, width)) / (rim + LIP_WIDTH_MM)
        spent += area / (notches + lip * land / (lip + land)) * _WAY_MM / _STEPS

    return spent


def _flow(width_mm: float, height_mm: float) -> float:
    """Compute the flow through a rectangle over pressure per length, for a viscosity of 1 [mm4]."""
    return width_mm * height_mm**3 / 12.0 * (1.0 - 0.63 * height_mm / width_mm)


def creep_beside_film_mm(design: Design) -> float:
    """Compute how far silicone creeps beside the film below the plug [mm], while the bone goes down
    and while the plate closes.

    Of the pressure at the tip there is as much as of the way from the rim to it.
    """
    gap = max(design.sensor.clearance_mm, 2 * encapsulation.PLUG_GAP_MM)
    depth = encapsulation.roof_end_z(design) / design.skin.length_mm
    viscosity = design.silicone.material.viscosity_pa_s.high
    pressure = 1e3 * design.mold_layout.plunge_kpa * depth
    lowering = pressure * making_of(design).lowering_s / viscosity
    spent = closing_integral(design) + lowering

    return gap * math.sqrt(spent / 6.0)


def creep_at_collar_mm(design: Design) -> float:
    """Compute how far silicone creeps into the gap around the collar [mm]."""
    gap = post_gap_mm(design) + design.printer.surface_error_mm
    return gap * math.sqrt(closing_integral(design) / 6.0)


def bone_play_mm(design: Design) -> float:
    """Compute how far the sensor moves towards the pad where the bone turns about its collar by the
    play beside the post [mm].
    """
    dims = design.dimensions
    collar = -design.bone.collar_length_mm
    lever = (dims.sensor_z - collar) / (collar - post.low_z(design))
    return flat_play_mm(design) * lever
