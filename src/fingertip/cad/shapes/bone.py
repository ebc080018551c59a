"""Bone with pocket and slot for the sensor and the channel for its cables, and its seals while the skin is cast.

A tape under the skin covers pocket and slot of the sensor, and its relief. Adhesive fills the passage of the tail
through the collar, and the gap around the lid of a folded tail. The screw of the chaplet closes its own hole. A second
tape is wound around the base, where the mold holds it, and covers the window of a folded tail.
"""

from __future__ import annotations

from fingertip.cad.shapes.insert import filled_bone, flat_slab, pilot_hole
from fingertip.design import Design
from fingertip.design.geometry.conic import TANGENT_STEP_MM
from fingertip.design.geometry.features import CHEEK_FOOT_MM, END_ROOM_MM, SLIDING_MM, TailFold
from fingertip.design.geometry.foot import flat_foot, foot_line
from fingertip.design.geometry.solids import Box, ElbowTube, Solid, cylinder, difference, intersection, union
from fingertip.design.interfaces import interface_of

FOOT_GAP_MM = 0.05
"""Gap between the feet of the lid and the floor of the trough, for a bead of adhesive [mm]."""
_ALONG_FLOOR_MM = 1.0
"""Length of the channel before its bend, in the floor of a trough [mm]."""
_OVERLAP_MM = 0.2
"""Length by which passages reach into the window [mm]. Boxes that only touch would leave coincident faces."""


def bone(design: Design) -> Solid:
    added, removed = interface_of(design).shapes(design)
    cables = () if design.dimensions.window_opens_into_gap else (cable_channel(design),)
    hollows = (sensor_recess(design), *cables, *pilot_hole(design), *removed)
    return difference(union(filled_bone(design), *added), *hollows)


def sensor_recess(design: Design) -> Solid:
    """Build the recess of the sensor, open on the palmar side: head pocket, tail slot, relief for the solder joints.

    A tail that leaves through the collar does so in a closed passage, so that no silicone follows it out of the mold.
    One that is laid in has an open trough all along, as wide and deep as its slot, to the hole of its wires.
    """
    dims, bone = design.dimensions, design.bone
    flat = -dims.flat_depth
    outside = -dims.collar.section.palmar - dims.bone_outline.section.palmar  # below the palmar surface of every solid
    tail, above_floor = dims.tail_half_width, dims.pocket_depth - dims.passage_height
    if dims.fold:
        top = dims.sensor_z + design.sensor.clearance_mm
        passage = flat_slab(design, above_floor, dims.pocket_depth, tail, dims.fold.nose_z - _OVERLAP_MM, top)
        return union(
            _head_pocket(design, outside), flat_slab(design, outside, dims.pocket_depth, tail, 0.0, top), passage,
            trough(design, dims.fold), _window(design, dims.fold, tail),
        )  # fmt: skip
    if design.is_cast_apart:
        top = dims.sensor_z + design.sensor.clearance_mm
        laid = flat_slab(design, outside, dims.pocket_depth, tail, dims.trough_end_z, top)
        return union(_head_pocket(design, outside), laid)
    # 0.1 mm deeper than the top of the channel: a plane tangent to it would leave a stray edge in the B-rep solid.
    relief_floor = flat + dims.channel_depth + bone.channel_diameter_mm / 2 + 0.1
    relief_top = dims.tail_end_z + dims.relief_half_length
    pocket = _head_pocket(design, outside)
    tail_top = dims.sensor_z + design.sensor.clearance_mm  # also clears a tail that is wider than the head
    relief = Box((-tail, outside, dims.relief_proximal_z), (tail, relief_floor, relief_top))
    if not dims.tail_passes_collar:
        return union(pocket, flat_slab(design, outside, dims.pocket_depth, tail, dims.tail_end_z, tail_top), relief)
    passage = flat_slab(design, above_floor, dims.pocket_depth, tail, dims.tail_end_z, tail_top)
    under_skin = flat_slab(design, outside, dims.pocket_depth, tail, 0.0, tail_top)
    return union(pocket, passage, under_skin, relief)


def _head_pocket(design: Design, outside: float) -> Solid:
    dims = design.dimensions
    radius = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    floor = dims.pocket_depth - dims.platform_depth
    return cylinder("y", (dims.sensor_z, 0.0), outside, floor, radius, dims.platform_radius)


def trough(design: Design, fold: TailFold) -> Solid:
    half_width = design.dimensions.tail_half_width
    dorsal = 2 * design.dimensions.bone_outline.section.dorsal  # past the bone
    slot = Box((-half_width, fold.floor_y, fold.nose_z - _OVERLAP_MM), (half_width, dorsal, fold.trough_end_z))
    return union(slot, *_above_lips(design, 0.0, 0.0))


def _above_lips(design: Design, up_mm: float, begin_z: float) -> tuple[Solid, ...]:
    """Build the space above lips that are too thin to print, from side to side and to the tip; none above others.

    Their end is as low as they are: a higher one would be printed over air.
    """
    dims = design.dimensions
    if dims.lips_top_y is None:
        return ()
    side, dorsal = 2 * dims.bone_outline.section.half_width, 2 * dims.bone_outline.section.dorsal
    return (Box((-side, dims.lips_top_y + up_mm, begin_z), (side, dorsal, design.skin.length_mm)),)


def tail_space(design: Design) -> Solid:
    """Build the space under the trough's lid, higher over crimps and wires; it stands on feet beside the tabs.

    It ends below a lid that reaches past the trough's end, and is open at the end of others.
    """
    fold = design.dimensions.fold
    assert fold
    half = design.dimensions.tail_half_width
    past = _OVERLAP_MM if design.dimensions.lips_top_y is None else 0.0
    low, high, deep = fold.nose_z - _OVERLAP_MM, fold.trough_end_z + past, fold.floor_y - _OVERLAP_MM
    return union(
        Box(
            (-half - _OVERLAP_MM, deep, low),
            (half + _OVERLAP_MM, fold.floor_y + fold.film_space_mm, fold.film_end_z + END_ROOM_MM),
        ),
        Box((-fold.tabs_half_width, deep, low), (fold.tabs_half_width, fold.floor_y + fold.tabs_space_mm, high)),
    )


def lid(design: Design) -> Solid:
    """Build the lid of the trough. Its dorsal side continues the surface of bone and collar, on which the skin lies."""
    fold, gap = design.dimensions.fold, design.sensor.clearance_mm
    assert fold
    half = design.dimensions.sensor.tail_width_mm / 2
    dorsal = 2 * design.dimensions.bone_outline.section.dorsal
    block = Box((-half, fold.floor_y + FOOT_GAP_MM, fold.nose_z), (half, dorsal, fold.trough_end_z - gap))
    outline = union(block, *_above_lips(design, FOOT_GAP_MM, gap))
    return difference(intersection(filled_bone(design), outline), tail_space(design))


def _window(design: Design, fold: TailFold, half_width: float) -> Solid:
    """Build the window through the base in which the tail bends around the nose, and the cut above its cheeks.

    The cheeks stand on the base with fillets, on their upper and inner sides, because the bone breaks there first.
    """
    section = design.dimensions.bone_outline.section
    palmar, dorsal = -2 * section.palmar, 2 * section.dorsal  # past the base on both sides
    low, high = fold.window_low_z, fold.nose_z
    nose = cylinder("x", (fold.nose_y, fold.nose_z), -2 * half_width, 2 * half_width, fold.radius)
    through = Box((-half_width, palmar, low), (half_width, dorsal, high))
    reach, top = 2 * section.half_width, design.dimensions.cheek_top_y
    above = Box((-reach, top, low), (reach, dorsal, high))
    line, end = foot_line(CHEEK_FOOT_MM, low, -1.0), low - section.half_width
    over = flat_foot("x", palmar, top, line, end, 2 * reach)
    if design.dimensions.window_opens_into_gap:
        return union(difference(through, nose), difference(above, over))
    beside = (flat_foot("y", *sides, line, end, 2 * reach) for sides in ((half_width, reach), (-reach, -half_width)))
    return union(difference(through, nose, *beside), difference(above, over))


def cable_channel(design: Design) -> Solid:
    """Build the cable channel.

    It runs from the solder relief along the bone, or from the floor of the trough of a tail that is laid in, then by
    one bend to its opening on the dorsal side of the base. The cables of a folded tail lie in a groove instead, which
    leads from the window past the mold.
    """
    dims, bone = design.dimensions, design.bone
    section = dims.bone_outline.section
    if dims.fold:
        half, floor = bone.channel_diameter_mm / 2, section.dorsal - dims.cable_groove_depth
        return Box(
            (-half, floor, dims.cable_groove_end_z), (half, 2 * section.dorsal, dims.fold.window_low_z + _OVERLAP_MM)
        )
    if design.is_cast_apart:  # its beginning lies half in the floor of the trough
        begin_y, begin_z = dims.pocket_depth, dims.channel_exit_z + bone.channel_bend_radius_mm + _ALONG_FLOOR_MM
    else:
        begin_y, begin_z = dims.channel_depth, dims.relief_proximal_z + dims.relief_half_length
    return ElbowTube(
        start_y=-dims.flat_depth + begin_y, start_z=begin_z,
        exit_z=dims.channel_exit_z, end_y=section.dorsal + bone.channel_diameter_mm,
        bend_radius=bone.channel_bend_radius_mm, radius=bone.channel_diameter_mm / 2,
    )  # fmt: skip


def sensor_body(design: Design) -> Solid:
    """Build the sensor as mounted in the bone, for pictures and checks; it is not printed."""
    dims = design.dimensions
    depth, half_tail = dims.pocket_depth - design.sensor.adhesive_thickness_mm, dims.sensor.tail_width_mm / 2
    dorsal_face, at_head = depth - dims.flat_depth, depth - dims.platform_depth
    head = cylinder(
        "y", (dims.sensor_z, 0.0), at_head - dims.sensor.thickness_mm, at_head, dims.sensor.head_diameter_mm / 2
    )
    fold = dims.fold
    low = fold.nose_z if fold else dims.tail_end_z
    palmar = flat_slab(design, depth - dims.sensor.thickness_mm, depth, half_tail, low, dims.sensor_z)
    if not fold:
        return union(head, palmar)
    # Around the nose the film keeps to the plane in which it lies in its slot, and to that of the dorsal passage.
    inner, low = fold.floor_y + SLIDING_MM / 2, fold.nose_z
    y, r = (dorsal_face + inner) / 2, (inner - dorsal_face) / 2
    outer = cylinder("x", (y, low), -half_tail, half_tail, r + dims.sensor.thickness_mm)
    bend = difference(outer, cylinder("x", (y, low), -2 * half_tail, 2 * half_tail, r))
    reach = 2 * r
    bend = intersection(bend, Box((-half_tail, y - reach, low - reach), (half_tail, y + reach, low + TANGENT_STEP_MM)))
    dorsal = Box((-half_tail, inner, low), (half_tail, inner + dims.sensor.thickness_mm, fold.film_end_z))
    half_tabs = fold.tabs_half_width - SLIDING_MM
    tabs = Box(
        (-half_tabs, inner, fold.film_end_z - TANGENT_STEP_MM),
        (half_tabs, inner + dims.sensor.thickness_mm, fold.tabs_end_z),
    )
    return union(head, palmar, bend, dorsal, tabs)


def genus(design: Design) -> int:
    """Count the through holes that the bone must have.

    One is the cable channel, and the passage of the tail through the collar adds one. A folded tail has the passage and
    its window; the groove of its cables is open, and its trough ends blind. Where the window opens into the gap of a
    fork, only the passage is left. A different count in the built solid reveals a hollow that breaks through a wall.
    """
    dims = design.dimensions
    of_interface = interface_of(design).genus(design)
    if dims.fold:
        return (1 if dims.window_opens_into_gap else 2) + of_interface
    return 1 + dims.tail_passes_collar + of_interface


TAPE_MM = 0.1
_INTO_BONE_MM = 0.02
"""Depth to which the tape on a ramp reaches into the bone [mm]: oblique faces that only touch leave slits."""
TAPE_RIM_MM = 0.5
"""Width by which the tape reaches past what it covers [mm]."""
_INTO_COLLAR_MM = 0.3
"""Depth to which the tape reaches under the collar's seal [mm]."""


def tape_outline_mm(design: Design) -> tuple[float, float]:
    """Return half the width of the tape over the sensor, and the height z at which it ends [mm]."""
    dims = design.dimensions
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    return max(head, dims.tail_half_width) + tape_rim_mm(design), dims.sensor_z + head + tape_rim_mm(design)


def tape_rim_mm(design: Design) -> float:
    """Return the width by which the tape reaches past the pocket: half the rim of a platform, which ends there [mm]."""
    return min(TAPE_RIM_MM, design.bone.rim_mm / 2) if design.bone.platform_mm else TAPE_RIM_MM


def tape(design: Design) -> Solid:
    """Build the tape on the flat of the bone, from the collar over the sensor's head."""
    half, top = tape_outline_mm(design)
    if design.bone.platform_mm == 0.0:
        return flat_slab(design, -TAPE_MM, 0.0, half, -_INTO_COLLAR_MM, top)
    dims = design.dimensions
    low, high, neck = dims.platform_depth + 2 * TAPE_MM, dims.flat_depth / 2, dims.tail_half_width + tape_rim_mm(design)
    disc = cylinder("y", (dims.sensor_z, 0.0), -low, -high, top - dims.sensor_z)
    outline = union(disc, Box((-neck, -low, -1.0), (neck, -high, dims.sensor_z)))
    return intersection(flat_slab(design, -TAPE_MM, _INTO_BONE_MM, half, -_INTO_COLLAR_MM, top), outline)


def passage_seal(design: Design) -> tuple[Solid, ...]:
    """Build the adhesive in the passage of the tail through the collar; none if the tail ends under the skin."""
    dims = design.dimensions
    if not dims.tail_passes_collar:
        return ()
    floor = -dims.flat_depth + dims.pocket_depth
    low = dims.fold.nose_z if dims.fold else -design.bone.collar_length_mm
    passage = Box(
        (-dims.tail_half_width, floor - dims.passage_height, low), (dims.tail_half_width, floor, _INTO_COLLAR_MM)
    )
    return (difference(passage, sensor_body(design)),)


def seals(design: Design) -> tuple[Solid, ...]:
    """Build what closes hollows: tape, adhesive in the passage of the tail and around the lid, and the screw."""
    found = [tape(design), *passage_seal(design)]
    if fold := design.dimensions.fold:
        around = intersection(trough(design, fold), filled_bone(design))
        found.append(difference(around, lid(design), tail_space(design)))
    return (*found, *pilot_hole(design))
