"""Inserts of the mold around which silicone is cast, the filled bone or a core, with chaplet and skin.

Overmolding casts the skin around the bone itself. Or it is cast around a core and pulled over the bone afterwards;
the core is smaller than the bone by an interference, which makes the skin fit tightly.
"""

from __future__ import annotations

import math

from fingertip.cad.shapes.bridged_ceiling import CEILING_STEPS_MM, bridge_ceiling
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, add_groove, inset_body
from fingertip.design.geometry.features import INSERT_BASE_MM, Chaplet
from fingertip.design.geometry.foot import LEDGE_MM
from fingertip.design.geometry.seat import quarter_outline, sleeve_inset_mm
from fingertip.design.geometry.solids import (
    Box,
    Cone,
    Prism,
    Solid,
    SuperconicSolid,
    cylinder,
    difference,
    intersection,
    scaled,
    union,
)

_INTO_HOLLOW_MM = 0.3
"""Length by which holes reach past the faces in which they open [mm]. Faces in one plane would leave slivers."""


def facet_cut(design: Design) -> tuple[Solid, ...]:
    """Build what the facet cuts off the bone; none without one.

    It is a flat from side to side and up to the tip: a round one would leave crescents too thin to print beside it.
    """
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return ()
    section = design.dimensions.bone_outline.section
    side, top = 2 * section.half_width, 2 * section.dorsal  # past the bone
    low = (-side, chaplet.facet_y, chaplet.flat_z)
    return (Box(low, (side, top, design.skin.length_mm)),)


def pilot_hole(design: Design) -> tuple[Solid, ...]:
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return ()
    low, high = chaplet.facet_y - chaplet.pilot_depth, chaplet.facet_y + _INTO_HOLLOW_MM
    return (cylinder("y", (chaplet.z, 0.0), low, high, chaplet.pilot_radius),)


def boss(design: Design) -> tuple[Solid, ...]:
    """Build the boss in the cavity, widened by its draft; none without one."""
    chaplet = design.dimensions.chaplet
    return (_boss(design, chaplet),) if chaplet else ()


def _boss(design: Design, chaplet: Chaplet) -> Solid:
    """Build the boss from the facet to far outside the skin."""
    low, high = chaplet.facet_y, 4 * design.dimensions.outer.section.dorsal
    return Cone(
        "y", (chaplet.z, 0.0), low, high, chaplet.radius, chaplet.radius + design.dimensions.draft_slope * (high - low)
    )


def contact_y(design: Design) -> float:
    """Height of the plane in the closed mold in which boss and facet meet [mm]."""
    chaplet = design.dimensions.chaplet
    assert chaplet
    return chaplet.facet_y


def screw_hole(design: Design) -> tuple[Solid, ...]:
    """Build the hole of the chaplet's screw through the dorsal half, and its counterbore; none without one."""
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return ()
    centre, high, head = (axis_z(design), 0.0), 2 * design.mold_layout.dorsal_height, head_y(design)
    counterbore = cylinder("y", centre, head - CEILING_STEPS_MM, high, chaplet.head_radius)
    return (
        cylinder("y", centre, contact_y(design) - _INTO_HOLLOW_MM, high, chaplet.hole_radius),
        bridge_ceiling(counterbore, centre, head, -1.0, chaplet.hole_radius, reach=2 * chaplet.head_radius),
    )


def axis_z(design: Design) -> float:
    """Axis of the chaplet in the mold, along the finger [mm]."""
    chaplet = design.dimensions.chaplet
    assert chaplet
    return chaplet.z


def head_y(design: Design) -> float:
    chaplet = design.dimensions.chaplet
    assert chaplet
    length = chaplet.screw_length(design.mold_layout.dorsal_height)
    return contact_y(design) - chaplet.engaged + length


_NECK_OVERLAP_MM = 0.5
"""Length by which the ramp's solid begins below the flat, proximal to the ramp [mm]."""
_SKIRT, _JIG_WALL_MM, _OUT_OF_JIG_MM = 0.7, 1.6, 0.3
"""Jig of an insert: part of the platform's height that it reaches down around it, its wall, and how far the insert
stands out of it [mm]."""
_INTO_BASE = 0.01
"""Part of its size by which the foot of a sloping collar begins inside the base."""
_OUTLINE_POINTS = 16
_INTO_BONE_MM = 0.2
"""Depth to which an insert reaches into the filled bone, so that no faces coincide [mm]."""
_STEP_IN_COLLAR_MM = 0.3
"""Depth of the step between both flats in the collar, which rules keep longer than this [mm]."""


def filled_bone(design: Design, inset_mm: float = 0.0) -> Solid:
    """Build the bone without hollows; its surfaces but the collar's lie `inset_mm` inside the bone's."""
    body = add_groove(design.bone, inset_body(design.dimensions.bone_outline, inset_mm))
    return union(_cut_facets(design, body, inset_mm), collar(design))


def sensor_insert(design: Design, down_mm: float = 0.0) -> tuple[Solid, ...]:
    """Build the insert on the sensor, down to the film under it or further; none without one."""
    dims = design.dimensions
    if dims.insert is None:
        return ()
    film, centre, parts = -dims.platform_depth, (dims.sensor_z, 0.0), dims.insert.parts
    lows = (film - INSERT_BASE_MM + down_mm, *(film - top for _, top in parts))  # the stem reaches through the cap
    solids = [
        cylinder("y", centre, film - dims.insert.height, low, r) for (r, _), low in zip(parts, lows, strict=False)
    ]
    return (union(*solids),)


def insert_jig(design: Design) -> Solid:
    """Build the ring that is slipped over the platform to centre an insert, with room for the tail.

    Pushed towards the base until it touches, it has its hole over the sensor. The insert stands out of it.
    """
    dims, gap = design.dimensions, design.sensor.clearance_mm
    assert dims.insert
    film, centre, radius = -dims.platform_depth, (dims.sensor_z, 0.0), dims.platform_radius + gap
    top, skirt = film - dims.insert.height + _OUT_OF_JIG_MM, film + _SKIRT * design.bone.platform_mm
    around = cylinder("y", centre, top, skirt, radius + _JIG_WALL_MM)
    neck = dims.neck_half_width + gap
    tail = Box((-neck, film, dims.sensor_z - 2 * radius), (neck, skirt + _INTO_HOLLOW_MM, dims.sensor_z))
    over = cylinder("y", centre, film, skirt + _INTO_HOLLOW_MM, radius)
    hole = cylinder(
        "y", (dims.sensor_z + gap, 0.0), top - _INTO_HOLLOW_MM, film + _INTO_HOLLOW_MM, dims.insert.radius + gap
    )
    return difference(around, over, tail, hole)


def _cut_facets(design: Design, body: ConicBody, inset_mm: float = 0.0) -> Solid:
    flat = union(_cut_flat(design, body, inset_mm), *_platform(design, body, inset_mm))
    return difference(flat, *facet_cut(design))


def _cut_flat(design: Design, body: ConicBody, inset_mm: float = 0.0) -> Solid:
    section, dims = body.section, design.dimensions
    # The cutting boxes extend past the outline by a length that scales with the design.
    margin = section.half_width

    def below(depth: float, low: float) -> Box:
        return Box(
            (-section.half_width - margin, -section.palmar - margin, low),
            (section.half_width + margin, -depth, design.skin.length_mm + margin),
        )

    flat, base, low = dims.flat_depth - inset_mm, dims.base_flat_depth, body.stations[0][0] - margin
    if base == dims.flat_depth:
        return difference(SuperconicSolid(body), below(flat, low))
    return difference(SuperconicSolid(body), below(base, low), below(flat, -_STEP_IN_COLLAR_MM))


def _platform(design: Design, body: ConicBody, inset_mm: float) -> tuple[Solid, ...]:
    """Build the platform under the sensor's head, and the ramp of its tail, within the outline; none without one."""
    dims = design.dimensions
    if design.bone.platform_mm == 0.0:
        return ()
    radius, half = dims.platform_radius - inset_mm, dims.neck_half_width - inset_mm
    disc = cylinder("y", (dims.sensor_z, 0.0), inset_mm - dims.platform_depth, 0.0, radius)
    neck = flat_slab(design, inset_mm, dims.platform_depth, half, dims.ramp[0] - _NECK_OVERLAP_MM, dims.sensor_z)
    return (intersection(SuperconicSolid(body), union(disc, neck)),)


def flat_slab(design: Design, low_mm: float, high_mm: float, half_width: float, begin: float, end: float) -> Solid:
    """Build what lies between two distances from the bone's palmar side, positive into the bone, from z to z [mm]."""
    dims = design.dimensions
    knots = [z for z in dims.ramp if design.bone.platform_mm and begin < z < end]
    if not knots:
        flat = -dims.flat_depth_at(begin)
        return Box((-half_width, flat + low_mm, begin), (half_width, flat + high_mm, end))
    line = [(-dims.flat_depth_at(z), z) for z in (begin, *knots, end)]
    corners = [(y + high_mm, z) for y, z in line] + [(y + low_mm, z) for y, z in reversed(line)]
    return Prism("x", tuple(corners), -half_width, half_width)


def collar(design: Design) -> Solid:
    """Build the collar: the flange proximal to the skin, on which the skin ends."""
    dims = design.dimensions
    section = dims.collar.section
    if design.prints_without_supports:
        return _sloping_collar(design)
    low = dims.collar.stations[0][0] - section.half_width  # below the foot, where the intersection cuts it
    flange = SuperconicSolid(ConicBody(section, ((low, 1.0), (0.0, 1.0))))
    return intersection(flange, above_collar_foot(design))


def _sloping_collar(design: Design) -> Solid:
    """Build a collar whose foot rises from the base at 45 degrees or more, but for a short palmar ledge."""
    dims, section, base = design.dimensions, design.dimensions.collar.section, design.dimensions.bone_outline.section
    palm = (dims.base_flat_depth + LEDGE_MM) / section.palmar
    share = min(base.half_width / section.half_width, base.dorsal / section.dorsal, palm) - _INTO_BASE
    corner = max(math.hypot(x, y) for x, y in quarter_outline(section, True, _OUTLINE_POINTS))
    low = dims.collar.stations[0][0]
    return SuperconicSolid(ConicBody(section, ((low - corner * (1.0 - share), share), (low, 1.0), (0.0, 1.0))))


def above_collar_foot(design: Design, gap_mm: float = 0.0) -> Solid:
    """Build the region above the collar's foot, or above the foot of its recess, which lies `gap_mm` lower.

    The foot slopes down towards the parting plane from both sides. The foot of the recess is parallel to it, so that
    the two separate at once when a mold half is pulled off.
    """
    dims, slope = design.dimensions, design.dimensions.draft_slope
    lowest = dims.collar.stations[0][0] - gap_mm * math.hypot(1.0, slope)
    section = dims.collar.section
    reach, top = section.palmar + section.dorsal, section.half_width
    side = lowest + slope * reach
    outline = ((0.0, lowest), (reach, side), (reach, side + top), (-reach, side + top), (-reach, side))
    return Prism("x", outline, -2 * section.half_width, 2 * section.half_width)


def core_within_skin(design: Design) -> Solid:
    """Build what of a core lies inside the skin, enlarged by the shrinkage; it reaches into collar or plate."""
    above, _, _ = design.dimensions.insert_body()
    body = _cut_facets(design, above, design.mold.core_inset_mm)
    recess = bump_recess(design)
    return scaled(difference(body, *recess) if recess else body, design.dimensions.shrinkage)


def bump_recess(design: Design) -> tuple[Solid, ...]:
    """Build the recess of a core for the skin's bump over the sensor; none without one.

    Its side slopes by 45 degrees, so that no air stays in it and the bump leaves it.
    """
    skin, dims = design.skin, design.dimensions
    if not design.is_cast_apart or skin.bump_height_mm == 0.0:
        return ()
    floor = sleeve_inset_mm(design) - dims.platform_depth + skin.bump_height_mm
    reach = skin.bump_height_mm + _INTO_HOLLOW_MM
    centre, radius = (dims.sensor_z, 0.0), skin.bump_radius_mm
    return (Cone("y", centre, floor - reach, floor, radius + reach, radius),)


def mold_insert(design: Design) -> Solid:
    """Build the body that lies in the closed mold while the silicone cures, with its hollows filled.

    Of a core on a plate it is the part inside the skin.
    """
    return core_within_skin(design) if design.is_cast_apart else skin_interior(design)


def skin_interior(design: Design) -> Solid:
    """Build what the skin lies on: the bone, or what a core gives it, with an insert on its sensor."""
    bone, recess = filled_bone(design, sleeve_inset_mm(design)), bump_recess(design)
    bone = difference(bone, *recess) if recess else bone
    return union(bone, *sensor_insert(design, INSERT_BASE_MM + _INTO_BONE_MM)) if design.dimensions.insert else bone


def skin(design: Design) -> Solid:
    """Build the cured skin at its design size, unstretched, with the hole that the chaplet leaves."""
    chaplet = design.dimensions.chaplet
    hole = (_boss(design, chaplet),) if chaplet else ()
    return difference(skin_outline(design), skin_interior(design), *hole)


def skin_outline(design: Design) -> Solid:
    """Build the skin with all that lies in it."""
    return SuperconicSolid(design.dimensions.outer)


def cavity(design: Design) -> Solid:
    """Build the cavity of the closed mold: its outline without the boss of the chaplet."""
    return difference(cavity_outline(design), *boss(design))


def cavity_outline(design: Design) -> Solid:
    """Build the outline of the cavity: the outer surface, enlarged to allow for silicone shrinkage.

    A skin around a core shrinks freely, and the core is enlarged by the same factor. An overmolded skin is held by the
    bone: its volume shrinkage, three times the linear one, reduces its thickness only. The distance is the same as for
    free shrinkage where the skin is a third of the finger's half width thick.
    """
    return scaled(skin_outline(design), design.dimensions.shrinkage)
