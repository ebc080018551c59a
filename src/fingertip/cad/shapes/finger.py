"""Bone with pocket and trough for the sensor and the channel for its cables, and the skin with the
core it is cast on.

The core may be smaller than the bone by an inset, which makes the skin fit tightly.
"""

from __future__ import annotations

from dataclasses import replace

from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, add_groove, inset_body
from fingertip.design.geometry.outlines import LEDGE_MM, ramp_slab
from fingertip.design.geometry.profile import farthest_corner
from fingertip.design.geometry.solids import (
    Box,
    Cone,
    ElbowTube,
    Solid,
    SuperconicSolid,
    cylinder,
    difference,
    intersection,
    scaled,
    union,
)
from fingertip.design.interfaces import interface_of

_ALONG_FLOOR_MM = 1.0
"""Length of the channel before its bend, in the floor of the trough [mm]."""
_INTO_HOLLOW_MM = 0.3
"""Length by which holes reach past the faces in which they open [mm].
Faces in one plane would leave slivers.
"""
_INTO_COLLAR_MM = 0.2
"""Depth to which the body of a core reaches into its plate [mm]:
solids that only touch have coincident faces.
"""
_NECK_OVERLAP_MM = 0.5
"""Length by which the ramp's solid begins below the flat, proximal to the ramp [mm]."""
_INTO_BASE = 0.01
"""Part of its size by which the foot of a sloping collar begins inside the base."""
_OUTLINE_POINTS = 16
_STEP_IN_COLLAR_MM = 0.3
"""Depth of the step between both flats in the collar, which rules keep longer than this [mm]."""


def bone(design: Design) -> Solid:
    added, removed = interface_of(design).shapes(design)
    return difference(
        union(filled_bone(design), *added), sensor_recess(design), cable_channel(design), *removed
    )


def sensor_recess(design: Design) -> Solid:
    """Build the recess of the sensor, open to the palm: head pocket,
    and trough of the tail to the wires' hole.
    """
    dims = design.dimensions
    gap = design.sensor.clearance_mm
    outside = (
        -dims.collar.section.palmar - dims.bone_outline.section.palmar
    )  # below the palmar surface of every solid
    radius = dims.sensor.head_diameter_mm / 2 + gap
    floor = dims.pocket_depth - dims.platform_depth
    pocket = cylinder(
        "y",
        centre=(dims.sensor_z, 0.0),
        low=outside,
        high=floor,
        radius=radius,
        around_radius=dims.platform_radius,
    )
    top = dims.sensor_z + gap  # also clears a tail that is wider than the head

    return union(
        pocket,
        flat_slab(
            design,
            low_mm=outside,
            high_mm=dims.pocket_depth,
            half_width=dims.tail_half_width,
            begin=dims.trough_end_z,
            end=top,
        ),
    )


def cable_channel(design: Design) -> ElbowTube:
    """Build the cable channel: from the floor of the trough by
    one bend to the dorsal side of the base.
    """
    dims = design.dimensions
    bone = design.bone
    assert bone.channel_bend_radius_mm > bone.channel_diameter_mm / 2, (
        "the channel folds into itself"
    )

    return ElbowTube(
        start_y=-dims.flat_depth + dims.pocket_depth,
        start_z=dims.channel_exit_z + bone.channel_bend_radius_mm + _ALONG_FLOOR_MM,
        exit_z=dims.channel_exit_z,
        end_y=dims.bone_outline.section.dorsal + bone.channel_diameter_mm,
        bend_radius=bone.channel_bend_radius_mm,
        radius=bone.channel_diameter_mm / 2,
    )


def sensor_body(design: Design) -> Solid:
    """Build the sensor as mounted in the bone, for pictures and checks; it is not printed."""
    dims = design.dimensions
    thickness = dims.sensor.thickness_mm
    half_tail = dims.sensor.tail_width_mm / 2
    head_y = (-dims.platform_depth, thickness - dims.platform_depth)
    radius = dims.sensor.head_diameter_mm / 2
    head = cylinder("y", (dims.sensor_z, 0.0), *head_y, radius)

    return union(
        head,
        flat_slab(
            design,
            low_mm=0.0,
            high_mm=thickness,
            half_width=half_tail,
            begin=dims.tail_end_z,
            end=dims.sensor_z,
        ),
    )


def genus(design: Design) -> int:
    """Count the through holes that the bone must have: the cable channel, and those of the
    interface.

    A different count in the built solid reveals a hollow that breaks through a wall.
    """
    return 1 + interface_of(design).genus(design)


def filled_bone(design: Design, inset_mm: float = 0.0) -> Solid:
    """Build the bone without hollows; all its surfaces but the collar's may lie deeper by
    an inset.
    """
    body = add_groove(design.bone, inset_body(design.dimensions.bone_outline, inset_mm))
    return union(
        _cut_flat(design, body, inset_mm), *_platform(design, body, inset_mm), collar(design)
    )


def _cut_flat(design: Design, body: ConicBody, inset_mm: float) -> Solid:
    section = body.section
    dims = design.dimensions
    # The cutting boxes extend past the outline by a length that scales with the design: its half
    # width.

    def below(depth: float, low: float) -> Box:
        return Box(
            (-2 * section.half_width, -section.palmar - section.half_width, low),
            (2 * section.half_width, -depth, design.skin.length_mm + section.half_width),
        )

    flat = dims.flat_depth - inset_mm
    base = dims.base_flat_depth
    low = body.stations[0][0] - section.half_width
    below_base = below(base, low)
    if base == dims.flat_depth:
        return difference(SuperconicSolid(body), below_base)

    below_flat = below(flat, -_STEP_IN_COLLAR_MM)
    return difference(SuperconicSolid(body), below_base, below_flat)


def _platform(design: Design, body: ConicBody, inset_mm: float) -> tuple[Solid, ...]:
    """Build the platform under the sensor's head, and the ramp of its
    tail, within the outline; none without one.
    """
    dims = design.dimensions
    if design.bone.platform_mm == 0.0:
        return ()

    radius = dims.platform_radius - inset_mm
    half = dims.neck_half_width - inset_mm
    disc = cylinder(
        "y",
        centre=(dims.sensor_z, 0.0),
        low=inset_mm - dims.platform_depth,
        high=0.0,
        radius=radius,
    )
    neck = flat_slab(
        design,
        low_mm=inset_mm,
        high_mm=dims.platform_depth,
        half_width=half,
        begin=dims.ramp[0] - _NECK_OVERLAP_MM,
        end=dims.sensor_z,
    )

    return (intersection(SuperconicSolid(body), union(disc, neck)),)


def flat_slab(
    design: Design,
    low_mm: float,
    high_mm: float,
    half_width: float,
    begin: float,
    end: float,
) -> Solid:
    """Build what lies between two distances from the bone's palmar
    side, positive into the bone, from z to z [mm].
    """
    dims = design.dimensions
    return ramp_slab(
        (low_mm, high_mm),
        half_width=half_width,
        z=(begin, end),
        depths=(dims.flat_depth, dims.platform_depth),
        ramp=dims.ramp,
    )


def collar(design: Design) -> Solid:
    """Build the collar: the flange proximal to the skin, on which the skin ends."""
    return (
        _sloping_collar(design)
        if design.prints_without_supports
        else SuperconicSolid(design.dimensions.collar)
    )


def _sloping_collar(design: Design) -> Solid:
    """Build a collar whose foot rises from the base at 45 degrees
    or more, but for a short palmar ledge.
    """
    dims = design.dimensions
    base = design.dimensions.bone_outline.section
    section = design.dimensions.collar.section
    palm = (dims.base_flat_depth + LEDGE_MM) / section.palmar
    share = (
        min(base.half_width / section.half_width, base.dorsal / section.dorsal, palm) - _INTO_BASE
    )
    corner = farthest_corner(
        section.half_width, section.dorsal, section.dorsal_weight, _OUTLINE_POINTS
    )
    low = dims.collar.stations[0][0]

    return SuperconicSolid(
        ConicBody(section, ((low - corner * (1.0 - share), share), (low, 1.0), (0.0, 1.0)))
    )


def core_within_skin(design: Design) -> Solid:
    """Build what of a core lies inside the skin, enlarged by the
    shrinkage; it reaches into the plate.
    """
    inset = design.mold.core_inset_mm
    body = inset_body(design.dimensions.bone_outline, inset)
    (_, scale), *stations = body.stations
    body = add_groove(design.bone, replace(body, stations=((-_INTO_COLLAR_MM, scale), *stations)))
    inside = union(_cut_flat(design, body, inset), *_platform(design, body, inset))

    return scaled(difference(inside, *bump_recess(design)), design.dimensions.shrinkage)


def bump_recess(design: Design) -> tuple[Solid, ...]:
    """Build the recess of a core for the skin's bump over the sensor; none without one.

    Its side slopes by 45 degrees, so that no air stays in it and the bump leaves it.
    """
    skin = design.skin
    dims = design.dimensions
    if skin.bump_height_mm == 0.0:
        return ()

    floor = design.mold.core_inset_mm - dims.platform_depth + skin.bump_height_mm
    reach = skin.bump_height_mm + _INTO_HOLLOW_MM
    centre = (dims.sensor_z, 0.0)
    radius = skin.bump_radius_mm

    return (
        Cone(
            axis="y",
            centre=centre,
            low=floor - reach,
            high=floor,
            low_radius=radius + reach,
            high_radius=radius,
        ),
    )


def skin_interior(design: Design) -> Solid:
    """Build what is open inside the skin, as its core leaves it."""
    return difference(filled_bone(design, design.mold.core_inset_mm), *bump_recess(design))


def skin(design: Design) -> Solid:
    """Build the cured skin at its design size, unstretched."""
    return difference(skin_outline(design), skin_interior(design))


def skin_outline(design: Design, inset_mm: float = 0.0) -> Solid:
    """Build the skin with all that lies in it, smaller by an inset."""
    return SuperconicSolid(inset_body(design.dimensions.outer, inset_mm))


def cavity(design: Design, inset_mm: float = 0.0) -> Solid:
    """Build the cavity of the mold: the outer surface, enlarged
    to allow for the silicone's shrinkage.
    """
    return scaled(skin_outline(design, inset_mm), design.dimensions.shrinkage)
