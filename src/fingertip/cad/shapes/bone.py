"""The bone: pocket and slot for the sensor, channel for its cables, and the interface to the proximal phalanx."""

from __future__ import annotations

from fingertip.cad.shapes.core import core
from fingertip.cad.solids import Box, ElbowTube, Solid, cylinder, difference, union
from fingertip.design import Design


def bone(design: Design) -> Solid:
    """The printable bone."""
    plus, minus = interface(design)
    hollows = (sensor_recess(design), cable_channel(design), tie_hole(design), *minus)
    return difference(union(core(design), *plus), *hollows)


def sensor_recess(design: Design) -> Solid:
    """Pocket of the head, slot of the tail and relief of the solder joints, open on the palmar side.

    Through the collar the slot is a closed passage, so that no silicone follows the tail out of the mold.
    """
    dims, bone = design.dimensions, design.bone
    flat = -dims.flat_depth
    above = -dims.collar.section.palmar - dims.envelope.section.palmar  # on the palmar side, outside everything
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    tail = dims.sensor.tail_width_mm / 2 + design.sensor.clearance_mm
    floor = flat + dims.pocket_depth
    # A little deeper than the channel's crest: a plane that touched it would leave a stray edge in the exact solid.
    relief_floor = flat + dims.channel_depth + bone.channel_diameter_mm / 2 + 0.1
    relief_top = dims.tail_end_z + dims.relief_half_length
    pocket = cylinder("y", (dims.sensor_z, 0.0), above, floor, head)
    tail_top = dims.sensor_z + design.sensor.clearance_mm  # room for a tail that is wider than its head, too
    relief = Box((-tail, above, dims.relief_proximal_z), (tail, relief_floor, relief_top))
    if not dims.tail_passes_collar:
        return union(pocket, Box((-tail, above, dims.tail_end_z), (tail, floor, tail_top)), relief)
    passage = Box((-tail, floor - dims.passage_height, dims.tail_end_z), (tail, floor, tail_top))
    under_skin = Box((-tail, above, 0.0), (tail, floor, tail_top))
    return union(pocket, passage, under_skin, relief)


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


def tie_hole(design: Design) -> Solid:
    """Hole across the back, one wall below the posterior hole: the strain relief of the cables."""
    dims, bone = design.dimensions, design.bone
    radius, half_width = bone.tie_hole_diameter_mm / 2, dims.envelope.section.half_width
    y = dims.envelope.section.dorsal - bone.wall_mm - radius
    return cylinder("x", (y, dims.tie_hole_z), -2 * half_width, 2 * half_width, radius)


def interface(design: Design) -> tuple[tuple[Solid, ...], tuple[Solid, ...]]:
    """What the interface to the proximal phalanx adds to the base, and what it takes away."""
    dims, bone = design.dimensions, design.bone
    y = (dims.envelope.section.dorsal - dims.flat_depth) / 2
    end, across = -bone.base_length_mm, 2 * dims.envelope.section.half_width
    bolt = bone.cross_bolt_diameter_mm / 2
    if bone.interface == "socket":
        radius = bone.socket_diameter_mm / 2
        socket = cylinder("z", (0.0, y), end - radius, end + bone.socket_depth_mm, radius)
        hole = cylinder("x", (y, end + bone.socket_depth_mm / 2), -across, across, bolt)
        return (), (socket, hole)
    radius = bone.post_diameter_mm / 2
    foot = end - bone.post_length_mm
    stem = cylinder("z", (0.0, y), foot, end + bone.wall_mm / 2, radius)
    return (stem,), (cylinder("x", (y, foot + bone.post_length_mm / 2), -across, across, bolt),)


def sensor_body(design: Design) -> Solid:
    """The sensor itself as it lies in the bone: for pictures and checks, never printed."""
    dims = design.dimensions
    back = -dims.flat_depth + dims.pocket_depth - design.sensor.adhesive_thickness_mm
    front, half_tail = back - dims.sensor.thickness_mm, dims.sensor.tail_width_mm / 2
    head = cylinder("y", (dims.sensor_z, 0.0), front, back, dims.sensor.head_diameter_mm / 2)
    return union(head, Box((-half_tail, front, dims.tail_end_z), (half_tail, back, dims.sensor_z)))


def genus(design: Design) -> int:
    """Through holes of the bone: the strongest single sign that something broke through a wall.

    Channel, cross bolt and tie hole; the tail's passage through the collar; and a socket crossed by its bolt has two
    mouths more than a blind hole has.
    """
    return 3 + design.dimensions.tail_passes_collar + (design.bone.interface == "socket")
