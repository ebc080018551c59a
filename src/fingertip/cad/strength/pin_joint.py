"""Stress of a clevis about its pin, and of the anchor of its tendon.

A load on the fingertip turns it about the pin. On a straight finger a hard stop holds it, and the pin then pulls at the
ends of the eyes. On a bent one the tendon holds it: it pulls at its anchor, and the eyes press on the pin. Forces are
those of statics; stresses are nominal ones of a lug with a pin (net section, bearing, shear-out), the first with the
concentration at a hole.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.cad.strength.concentration import hole_in_tension
from fingertip.design import Design
from fingertip.design.geometry.joint import Joint, TendonAnchor

_SHEAR = math.sqrt(3.0)
"""Tensile stress that is equivalent to a shear stress of 1 (von Mises)."""


@dataclass(frozen=True)
class JointStress:
    """Stress at one place of a clevis per newton of load on the fingertip [MPa/N]."""

    place: str
    z_mm: float
    stress_per_n: float
    concentration: float
    at_shock: bool
    """False for the tendon: its drive is assumed to yield above the tendon force of the grip."""


def tendon_force_per_n(design: Design, load_z_mm: float) -> float:
    """Force of the tendon per newton of load on the pad or apex, by their levers about the pin; 0 without a tendon."""
    joint, anchor = design.dimensions.joint, design.dimensions.anchor
    return (load_z_mm - joint.axis_z) / anchor.distance if joint and anchor else 0.0


def stress_joint(design: Design, load_z_mm: float) -> Iterator[JointStress]:
    """Yield the stresses of eyes and anchor under a load at a height of the finger."""
    joint, anchor = design.dimensions.joint, design.dimensions.anchor
    if joint is None:
        return
    thickness = _eye_thickness(design, joint)
    if joint.travel_deg:
        # The stop pushes the finger away from the hand, and the pin holds it, besides the load itself.
        dorsal = design.dimensions.bone_outline.section.dorsal
        # The pressure on the stop grows outwards, so its force acts at two thirds of the length.
        lever = 2 / 3 * (dorsal - joint.axis_y)
        pull = (load_z_mm - joint.axis_z) / lever + 1.0
        width, bore = 2 * joint.eye_radius, 2 * joint.pin_radius
        factor = hole_in_tension(bore, width)
        yield JointStress("eye", joint.axis_z, factor * pull / (thickness * (width - bore)), factor, True)
        shear = pull / (2 * thickness * (joint.eye_radius - joint.pin_radius))
        yield JointStress("end of the eye", joint.low_z, _SHEAR * shear, 1.0, True)
    if anchor:
        force = tendon_force_per_n(design, load_z_mm)
        yield JointStress(
            "bearing of the pin", joint.axis_z, (force + 1.0) / (thickness * 2 * joint.pin_radius), 1.0, False
        )
        length = _anchor_length(design, anchor)
        yield JointStress("bearing of the anchor", anchor.z, force / (length * 2 * anchor.radius), 1.0, False)
        shear = force / (2 * length * design.bone.wall_mm)
        yield JointStress("wall at the anchor", anchor.z, _SHEAR * shear, 1.0, False)


def _eye_thickness(design: Design, joint: Joint) -> float:
    """Thickness [mm] of both cheeks beside the pin, or of the tongue."""
    if not joint.is_fork:
        return 2 * joint.half_width
    section = design.dimensions.bone_outline.section
    edges = (joint.axis_y - joint.pin_radius, joint.axis_y + joint.pin_radius)
    return 2 * (min(section.half_width_at(y) for y in edges) - joint.half_width)


def _anchor_length(design: Design, anchor: TendonAnchor) -> float:
    """Length [mm] of the anchor's hole in both cheeks together."""
    return 2 * (design.dimensions.collar.section.half_width_at(anchor.y) - anchor.inner_half_width)
