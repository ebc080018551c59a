"""Lengths that follow from a design: computed once here, read by the rules, the parts and the mold alike.

Axes: x width, +y dorsal, -y palmar, z distal [mm]. The parting plane is y = 0; the skin begins at z = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design.geometry.conic import ConicBody, CrossSection, Tip
from fingertip.design.parameters import DesignTables
from fingertip.sensors import CATALOGUE, ForceSensor

TUNNEL_MM = 0.8
"""Least height of the tail's passage through the collar [mm]: lower ones close up in printing. An assumption."""


@dataclass(frozen=True)
class Dimensions:
    """Derived lengths [mm] and forms of one design."""

    sensor: ForceSensor
    outer: ConicBody
    """Outer form of the skin; the mold's cavity."""
    envelope: ConicBody
    """Bone with its base before the palmar flat is cut."""
    sensor_z: float
    """Middle of the active area."""
    flat_depth: float
    """The palmar flat lies at y = -flat_depth."""
    pocket_depth: float
    passage_height: float
    """Of the tail's passage through the collar, from its floor: it never presses on film and tail."""
    tail_end_z: float
    channel_depth: float
    """The channel starts with its centre at y = -flat_depth + channel_depth."""
    channel_exit_z: float
    """Centre of the posterior hole."""

    relief_half_length: float
    """Of the recess for the solder joints, around the end of the tail."""
    collar: ConicBody
    """Flange below the skin: the skin ends on it, and it locates the bone in the mold. This long at the parting
    plane; away from that its foot rises by `draft_slope`."""
    draft_slope: float
    """Tangent of the mold's draft [mm per mm]: no half rubs along key, base or collar while it is pulled."""
    shrinkage: float
    """Size of the cavity against the skin's."""

    tie_hole_z: float
    """Middle of the hole for the cables' tie."""

    @property
    def relief_proximal_z(self) -> float:
        """Proximal face of the recess for the solder joints, where the channel begins."""
        return self.tail_end_z - self.relief_half_length

    @property
    def tail_passes_collar(self) -> bool:
        """Whether the tail runs out through the collar (a long one) or ends under the skin (a short one)."""
        return self.tail_end_z < 0.0

    def sensor_rim_margin(self, rim_mm: float, clearance_mm: float) -> float:
        """Least margin [mm] between the flat's edge and the circle the sensor's head and rim need.

        Measured along x at 65 heights of the circle; negative if the flat is too narrow there.
        """
        r = self.sensor.head_diameter_mm / 2 + clearance_mm + rim_mm
        margins = []
        for i in range(65):
            phi = math.pi * (i / 64 - 0.5)
            z = self.sensor_z + r * math.sin(phi)
            margins.append(self.envelope.half_width_at(-self.flat_depth, z) - r * math.cos(phi))
        return min(margins)


def compute_dimensions(design: DesignTables) -> Dimensions:
    """Derive every length that follows from the parameters.

    Never raises for parameters within their bounds: what cannot be made shows as lengths that the rules refuse.
    """
    sensor, bone, skin = design.sensor, design.bone, design.skin
    part = _sensor(design)
    join = skin.length_mm - skin.tip_length_mm
    a = skin.width_mm / 2
    section = CrossSection(
        a, skin.semi_axis_palmar_mm, skin.semi_axis_dorsal_mm, skin.squareness_palmar, skin.squareness_dorsal
    )
    outer = ConicBody(section, ((0.0, 1.0), (join, skin.taper_ratio)), Tip(skin.length_mm, skin.squareness_tip))
    sensor_z = skin.length_mm - sensor.distance_from_tip_mm
    flat_depth = skin.semi_axis_palmar_mm * outer.scale_at(sensor_z) - skin.thickness_palmar_mm

    inner = CrossSection(
        a - skin.thickness_side_mm,
        skin.semi_axis_palmar_mm - skin.thickness_side_mm,
        skin.semi_axis_dorsal_mm - skin.thickness_dorsal_mm,
        bone.squareness_palmar,
        skin.squareness_dorsal,
    )
    # The taper keeps the thickness at the sides where the tip begins; the base runs straight below the skin.
    scale = (a * skin.taper_ratio - skin.thickness_side_mm) / inner.half_width if inner.half_width else 0.0
    envelope = ConicBody(
        inner,
        ((-bone.base_length_mm, 1.0), (0.0, 1.0), (join, scale)),
        Tip(skin.length_mm - skin.thickness_tip_mm, skin.squareness_tip),
    )
    tail_end_z = sensor_z + part.head_diameter_mm / 2 - part.length_mm
    channel_radius = bone.channel_diameter_mm / 2
    # The cables leave the bone below the mold too: overmolding closes it with them in place.
    covered = max(bone.collar_length_mm, design.mold.recess_length_mm)
    exit_below_skin = -(covered + channel_radius + bone.wall_mm)
    after_bend = tail_end_z - bone.relief_length_mm / 2 - bone.channel_bend_radius_mm
    channel_exit_z = min(exit_below_skin, after_bend)
    pocket_depth = part.thickness_mm + sensor.adhesive_thickness_mm
    return Dimensions(
        sensor=part,
        outer=outer,
        envelope=envelope,
        sensor_z=sensor_z,
        flat_depth=flat_depth,
        pocket_depth=pocket_depth,
        passage_height=max(TUNNEL_MM, pocket_depth + sensor.clearance_mm),
        tail_end_z=tail_end_z,
        channel_depth=bone.wall_mm + channel_radius,
        channel_exit_z=channel_exit_z,
        tie_hole_z=channel_exit_z - channel_radius - bone.wall_mm - bone.tie_hole_diameter_mm / 2,
        relief_half_length=bone.relief_length_mm / 2,
        collar=ConicBody(
            CrossSection(
                a - bone.collar_inset_mm,
                skin.semi_axis_palmar_mm - bone.collar_inset_mm,
                skin.semi_axis_dorsal_mm - bone.collar_inset_mm,
                skin.squareness_palmar,
                skin.squareness_dorsal,
            ),
            ((-bone.collar_length_mm, 1.0), (0.0, 1.0)),
        ),
        draft_slope=math.tan(math.radians(design.mold.draft_deg)),
        shrinkage=1.0 / (1.0 - design.mold.silicone_shrinkage_percent / 100.0),
    )


def _sensor(design: DesignTables) -> ForceSensor:
    if design.sensor.model != "custom":
        return CATALOGUE[design.sensor.model]
    own = design.custom_sensor
    return ForceSensor(
        "custom", "custom sensor", own.active_diameter_mm, own.head_diameter_mm, own.thickness_mm, own.length_mm,
        own.tail_width_mm, 2.54, "the design file", (),
    )  # fmt: skip
