"""Force that pulls the skin off the bone, where a groove or the tightness of a sleeve holds it.

A thin ring of silicone is stretched: p = E e t / R, with the strain e, the thickness t and the radius R (thin-walled
cylinder). Over a groove the ring climbs a flank of 45 degrees without friction, so the pull is the force that presses
it together; a sleeve is held by friction. Adhesion is left out: it depends on how clean the bone is.
"""

from __future__ import annotations

import math

from fingertip.design import Design
from fingertip.silicones import Silicone

FRICTION = 0.5
"""Coefficient of friction of silicone on resin. An assumption, at the lower end of rubber's."""


def skin_pull_off_n(design: Design, silicone: Silicone) -> float:
    """Estimate the pull-off force of the skin [N], with the lowest modulus of the silicone; 0 if nothing but adhesion
    holds it."""
    section, bone, skin = design.dimensions.bone_outline.section, design.bone, design.skin
    radius = (section.half_width + (section.dorsal + design.dimensions.flat_depth) / 2) / 2
    thickness = min(skin.thickness_side_mm, skin.thickness_dorsal_mm)
    modulus = silicone.modulus_mpa.low
    held = 0.0
    if bone.groove_depth_mm:
        pressure = modulus * (bone.groove_depth_mm / radius) * thickness / radius
        held += pressure * math.tau * radius * bone.groove_width_mm
    if design.mold.method == "sleeve":
        pressure = modulus * (design.mold.sleeve_interference_mm / radius) * thickness / radius
        held += FRICTION * pressure * math.tau * radius * design.dimensions.taper_end_z
    return held


def name_retention(design: Design) -> list[str]:
    """Name what holds the skin besides adhesion: the groove, the tightness of a sleeve, or nothing."""
    held = ["the groove"] if design.bone.groove_depth_mm else []
    if design.mold.method == "sleeve" and design.mold.sleeve_interference_mm:
        held.append("the tightness of the sleeve")
    return held
