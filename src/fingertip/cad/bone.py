"""The bone: palmar flat, pocket and slot for the sensor, channel for its cables, and the post into the phalanx."""

from __future__ import annotations

from fingertip.cad.solids import Box, ElbowTube, Form, Solid, cylinder, difference, union
from fingertip.design import Design


def core(design: Design) -> Solid:
    """The bone's envelope with the palmar flat, everything let into it filled: what the silicone flows around."""
    dims = design.dimensions
    section = dims.envelope.section
    low, high = dims.envelope.stations[0][0], design.skin.length_mm
    # The cutting box reaches past the envelope by a length of its own size, never by a literal "big" number.
    past = section.half_width
    below = Box(
        (-section.half_width - past, -section.palmar - past, low - past),
        (section.half_width + past, -dims.flat_depth, high + past),
    )
    return difference(Form(dims.envelope), below)


def sensor_recess(design: Design) -> Solid:
    """Pocket of the head, slot of the tail and relief of the solder joints, open on the palmar side."""
    dims, bone = design.dimensions, design.bone
    flat = -dims.flat_depth
    above = flat - dims.envelope.section.palmar  # anywhere below the flat, outside the bone
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    tail = dims.sensor.tail_width_mm / 2 + design.sensor.clearance_mm
    floor = flat + dims.pocket_depth
    relief_floor = flat + dims.channel_depth + bone.channel_diameter_mm / 2
    pocket = cylinder("y", (dims.sensor_z, 0.0), above, floor, head)
    slot = Box((-tail, above, dims.tail_end_z), (tail, floor, dims.sensor_z))
    relief = Box(
        (-tail, above, dims.relief_proximal_z),
        (tail, relief_floor, dims.tail_end_z + dims.relief_half_length),
    )
    return union(pocket, slot, relief)


def cable_channel(design: Design) -> Solid:
    """From the relief of the solder joints along the bone, then by one bend out of its back (posterior hole)."""
    dims, bone = design.dimensions, design.bone
    section = dims.envelope.section
    return ElbowTube(
        start_y=-dims.flat_depth + dims.channel_depth,
        start_z=dims.relief_proximal_z + dims.relief_half_length,
        exit_z=dims.channel_exit_z,
        end_y=section.dorsal + bone.channel_diameter_mm,
        bend_radius=bone.channel_bend_radius_mm,
        radius=bone.channel_diameter_mm / 2,
    )


def post(design: Design) -> tuple[Solid, Solid]:
    """The post that enters the proximal phalanx, and the hole of its cross bolt."""
    dims, bone = design.dimensions, design.bone
    y = (dims.envelope.section.dorsal - dims.flat_depth) / 2
    end = -bone.base_length_mm - bone.post_length_mm
    radius = bone.post_diameter_mm / 2
    stem = cylinder("z", (0.0, y), end, -bone.base_length_mm + bone.wall_mm / 2, radius)
    hole = cylinder("x", (y, end + bone.post_length_mm / 2), -2 * radius, 2 * radius, bone.cross_bolt_diameter_mm / 2)
    return stem, hole


def bone(design: Design) -> Solid:
    """The printable bone."""
    stem, hole = post(design)
    return difference(union(core(design), stem), sensor_recess(design), cable_channel(design), hole)


def sensor_body(design: Design) -> Solid:
    """The sensor itself as it lies in the bone: for pictures and assemblies, never printed."""
    dims = design.dimensions
    back = -dims.flat_depth + dims.pocket_depth - design.sensor.adhesive_thickness_mm
    front, half_tail = back - dims.sensor.thickness_mm, dims.sensor.tail_width_mm / 2
    head = cylinder("y", (dims.sensor_z, 0.0), front, back, dims.sensor.head_diameter_mm / 2)
    return union(head, Box((-half_tail, front, dims.tail_end_z), (half_tail, back, dims.sensor_z)))
