"""Bone with pocket and trough for the sensor, and the channel for its cables."""

from __future__ import annotations

from fingertip.cad.shapes.skin import filled_bone, flat_slab
from fingertip.design import Design
from fingertip.design.geometry.solids import ElbowTube, Solid, cylinder, difference, union
from fingertip.design.interfaces import interface_of

_ALONG_FLOOR_MM = 1.0
"""Length of the channel before its bend, in the floor of the trough [mm]."""


def bone(design: Design) -> Solid:
    added, removed = interface_of(design).shapes(design)
    return difference(union(filled_bone(design), *added), sensor_recess(design), cable_channel(design), *removed)


def sensor_recess(design: Design) -> Solid:
    """Build the recess of the sensor, open to the palm: head pocket, and trough of the tail to the wires' hole."""
    dims, gap = design.dimensions, design.sensor.clearance_mm
    outside = -dims.collar.section.palmar - dims.bone_outline.section.palmar  # below the palmar surface of every solid
    radius, floor = dims.sensor.head_diameter_mm / 2 + gap, dims.pocket_depth - dims.platform_depth
    pocket = cylinder("y", (dims.sensor_z, 0.0), outside, floor, radius, dims.platform_radius)
    top = dims.sensor_z + gap  # also clears a tail that is wider than the head
    return union(pocket, flat_slab(design, outside, dims.pocket_depth, dims.tail_half_width, dims.trough_end_z, top))


def cable_channel(design: Design) -> Solid:
    """Build the cable channel: from the floor of the trough by one bend to the dorsal side of the base."""
    dims, bone = design.dimensions, design.bone
    return ElbowTube(
        start_y=-dims.flat_depth + dims.pocket_depth,
        start_z=dims.channel_exit_z + bone.channel_bend_radius_mm + _ALONG_FLOOR_MM,
        exit_z=dims.channel_exit_z, end_y=dims.bone_outline.section.dorsal + bone.channel_diameter_mm,
        bend_radius=bone.channel_bend_radius_mm, radius=bone.channel_diameter_mm / 2,
    )  # fmt: skip


def sensor_body(design: Design) -> Solid:
    """Build the sensor as mounted in the bone, for pictures and checks; it is not printed."""
    dims = design.dimensions
    depth, half_tail = dims.pocket_depth - design.sensor.adhesive_thickness_mm, dims.sensor.tail_width_mm / 2
    at_head, thickness = depth - dims.platform_depth, dims.sensor.thickness_mm
    head = cylinder("y", (dims.sensor_z, 0.0), at_head - thickness, at_head, dims.sensor.head_diameter_mm / 2)
    return union(head, flat_slab(design, depth - thickness, depth, half_tail, dims.tail_end_z, dims.sensor_z))


def genus(design: Design) -> int:
    """Count the through holes that the bone must have: the cable channel, and those of the interface.

    A different count in the built solid reveals a hollow that breaks through a wall.
    """
    return 1 + interface_of(design).genus(design)
