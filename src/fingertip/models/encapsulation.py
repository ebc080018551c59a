"""Encapsulated bone: what the silicone meets of bone and sensor, and the plug over the end of the
tail.

The silicone covers the sensor's film, whose vent is at the end of its tail, and stops at the
collar. The plug fills the notch that the trough cuts into the collar, and lies on the film up to a
lap past the end of the tail: neither the vent nor the wires meet silicone. Its wings behind the
collar keep it from sliding into the cup. It stays in the finger.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .allowances import PAST_MM
from .bone import filled_bone, find_collar_slope
from .conic import ConicBody, offset_section
from .sensor_pocket import film_column, flat_slab, sensor_recess
from .solids import Box, Prism, Solid, SuperconicSolid, cylinder, union

if TYPE_CHECKING:
    from .program_types import Finger

LAP_MM = 6.0
"""Length of the plug on the film, from the end of its tail: the silicone creeps below it beside the
film, until it sets.
"""
_LEAST_ROOF_MM = 1.5
"""Least length by which a plug reaches under the silicone, which holds it [mm]."""
_ROOF_MM = 0.8
"""Thickness of the plug over the wires in its tunnel [mm]."""
PLUG_GAP_MM = 0.1
"""Gap of the plug beside the walls of the trough [mm]."""
_FILM_GAP_MM = 0.05
"""Gap of the plug over the film [mm]."""
_WIRE_GAP_MM = 0.15
"""Gap of the tunnel over the wires, and before the end of the tail [mm]."""
_BELOW_SILICONE_MM = 0.02
"""Gap between the plug and the plane in which the skin ends [mm]."""
_ON_FLOOR_MM = 0.01
"""Gap between the wires and what they lie on [mm]."""
_KNOT_ROOM_WIRES = 4.0
"""Most thickness of a knot in both wires, in diameters of one of them. An assumption."""
WING_MM = 1.2
"""Width of a wing behind the collar, beside the trough [mm]."""
_WING_LENGTH_MM = 1.5
"""Length of a wing along the finger, behind the slope of the collar [mm]."""
_BESIDE_KNOT_MM = 0.3
"""Gap between the knot and the plug, and the slot of the holder, to either side [mm]."""
KEEL_GAP_MM = 0.15
"""Gap around the keel in its slot [mm]."""
_INTO_FLAT_MM = 0.2
"""Depth to which the silicone's form of the plug reaches into the filled bone [mm]."""


def embedded_bone(finger: Finger) -> Solid:
    """Build the bone as the silicone meets it: with the sensor on its adhesive, and the plug.

    Silicone fills what is open beside the film. Proximal to the plug's end it meets the trough
    closed.

    Section at x = 0, back up, tip to the right:

             |    |
        _____|    |_________________________
        |  collar |         bone
        |____     |________________    ________
             |    |  plug          |__| film    |___
             |____|_____  roof ____|
                  |     |____|     |
                z = 0              roof_end_z
    """
    return (
        filled_bone(finger).cut(_beside_film(finger)).union(_roof(finger, _INTO_FLAT_MM, -PAST_MM))
    )


def roof_end_z(finger: Finger) -> float:
    """Find the distal end of the plug: past the end of the tail, and of the collar."""
    return max(_LEAST_ROOF_MM, finger.dimensions.tail_end_z + LAP_MM)


def _tunnel_height(finger: Finger) -> float:
    """Height of the tunnel over the flat [mm]: a wire lies on the floor of the trough."""
    return finger.sensor.wire_diameter_mm + _WIRE_GAP_MM - finger.dimensions.pocket_depth


def roof_height(finger: Finger) -> float:
    """Height of the plug over the flat where silicone lies over it [mm]: wires pass below it only
    where the tail ends there.
    """
    return _ROOF_MM + (_tunnel_height(finger) if finger.dimensions.tail_end_z > 0.0 else 0.0)


def plug_begin_z(finger: Finger) -> float:
    """Find the proximal end of the plug, that of its wings behind the slope of the collar."""
    return find_collar_slope(finger).begin_z - PLUG_GAP_MM - _WING_LENGTH_MM


def wing_reach(finger: Finger) -> float:
    """Half of the width of the plug behind the collar."""
    return finger.dimensions.tail_half_width + WING_MM


def knot_radius(finger: Finger) -> float:
    return _KNOT_ROOM_WIRES * finger.sensor.wire_diameter_mm / 2


def keel_half_width(finger: Finger) -> float:
    return knot_radius(finger) + _BESIDE_KNOT_MM - KEEL_GAP_MM


def knot_depth(finger: Finger) -> float:
    """Depth of the knot, and of the keel, below the parting plane."""
    return floor_depth(finger) + 2 * knot_radius(finger)


def _beside_film(finger: Finger) -> Solid:
    """Build what is open beside the film in its pocket and its trough, distal to the plug."""
    reach = 2 * finger.skin.width_mm
    distal = Box((-reach, -reach, roof_end_z(finger)), (reach, reach, finger.skin.length_mm))
    return sensor_recess(finger).intersect(distal).cut(film_column(finger))


def _roof(finger: Finger, into_flat_mm: float, begin_z: float) -> Solid:
    """Build the plug where silicone lies over it, on the film and on the flat beside the trough."""
    half = finger.dimensions.tail_half_width + finger.bone.wall_mm
    return _lay_on_flat(finger, into_flat_mm, half, begin_z, roof_end_z(finger))


def _lay_on_flat(
    finger: Finger, into_flat_mm: float, half_width: float, begin_z: float, end_z: float
) -> Solid:
    return flat_slab(
        finger,
        low_mm=-roof_height(finger),
        high_mm=into_flat_mm,
        half_width=half_width,
        begin=begin_z,
        end=end_z,
    )


def plug(finger: Finger) -> Solid:
    r"""Build the plug in its place.

    Section at x = 0, back up, tip to the right; the tunnel of the wires is there where the tail
    ends in the plug:

                        tail_end_z
           _______________\_____________________
          |    tunnel      \____________________|   on the film, LAP_MM long
          |               ______________________|   roof_height
          |______________|
                       z = 0              roof_end_z
       plug_begin_z    within the collar's outline
    """
    half = finger.dimensions.tail_half_width - PLUG_GAP_MM
    neck = _lay_on_flat(finger, -_FILM_GAP_MM, half, -PAST_MM, PAST_MM)
    roof = _roof(finger, -_FILM_GAP_MM, _FILM_GAP_MM)
    whole = _block(finger).union(neck, roof)
    if _tunnel_end_z(finger) <= _filling_begin_z(finger):
        return whole

    hollows = (_tunnel(finger), _knot_room(finger), _slope_below_filling(finger))
    return whole.union(_tunnel_walls(finger)).cut(*hollows)


def _tunnel_end_z(finger: Finger) -> float:
    """Find the distal end of the tunnel, before that of the tail."""
    return finger.dimensions.tail_end_z - _WIRE_GAP_MM


def _tunnel_floor(finger: Finger) -> float:
    """Height of what lies on the floor of the trough, over a gap."""
    return -finger.dimensions.flat_depth + finger.dimensions.pocket_depth - _FILM_GAP_MM


def _tunnel_walls(finger: Finger) -> Box:
    """Build both walls of the tunnel down to the floor of the trough, and what is between them."""
    half = finger.dimensions.tail_half_width - PLUG_GAP_MM
    surface = -finger.dimensions.flat_depth

    return Box(
        (-half, surface - PAST_MM / 2, _filling_begin_z(finger)),
        (half, _tunnel_floor(finger), _tunnel_end_z(finger)),
    )


def _tunnel(finger: Finger) -> Prism:
    """Build the tunnel of the wires, whose end slopes by 45 degrees."""
    ceiling = -finger.dimensions.flat_depth - _tunnel_height(finger)
    low = _filling_begin_z(finger) - PAST_MM
    end = _tunnel_end_z(finger)
    past_floor = _tunnel_floor(finger) + PAST_MM
    corners = (
        (past_floor, low),
        (past_floor, end + past_floor - ceiling),
        (ceiling, end),
        (ceiling, low),
    )
    inner = finger.dimensions.tail_half_width - PLUG_GAP_MM - finger.printer.min_wall_mm

    return Prism("x", corners, -inner, inner)


def _block(finger: Finger) -> Solid:
    r"""Build the plug within the plate: what fills the notch, wings behind the collar, and a keel.

    Seen from the palm, tip to the right; the notch in the collar is as wide as the block:

             ________
            |  wing  \  collar
            |         |_________
            |  keel             |  block
            |          _________|
            |  wing   |
            |________/  collar
                               z = 0
    """
    dims = finger.dimensions
    begin = plug_begin_z(finger)
    half = dims.tail_half_width - PLUG_GAP_MM
    wide = keel_half_width(finger)
    surface = -dims.flat_depth - _FILM_GAP_MM
    deep = 2 * dims.collar.section.palmar
    ends = ((begin, 1.0), (-_BELOW_SILICONE_MM, 1.0))
    outline = SuperconicSolid(ConicBody(dims.collar.section, ends))
    flat = _over_base(finger)
    trough_z = max(begin, dims.channel_exit_z - finger.bone.channel_diameter_mm / 2)
    filling = outline.intersect(
        Box((-half, -deep, _filling_begin_z(finger)), (half, surface, PAST_MM)).union(
            Box((-half, -deep, trough_z), (half, flat, PAST_MM))
        )
    )

    deepest = -knot_depth(finger)
    keel = Box((-wide, deepest, _filling_begin_z(finger)), (wide, flat, -_BELOW_SILICONE_MM))
    behind = Box((-wide, deepest, begin), (wide, flat, -finger.bone.collar_length_mm))
    wings = outline.intersect(_behind_collar(finger))

    return filling.union(keel, wings.union(behind).cut(_collar_slope(finger)))


def _over_base(finger: Finger) -> float:
    """Height of what lies on the flat of the base, over a gap."""
    return -finger.dimensions.base_flat_depth - PLUG_GAP_MM


def _filling_begin_z(finger: Finger) -> float:
    """Find the proximal end of what fills the trough, which ends at the hole of the wires."""
    return max(plug_begin_z(finger), finger.dimensions.channel_exit_z)


def _slope_below_filling(finger: Finger) -> Solid:
    """Build what is left out at the proximal end of the filling: it stands on its wings while it
    prints, and begins in a slope of 45 degrees.
    """
    dims = finger.dimensions
    begin = _filling_begin_z(finger)
    flat = _over_base(finger)
    floor = -floor_depth(finger) + PAST_MM
    corners = (
        (flat, begin - PAST_MM),
        (floor, begin - PAST_MM),
        (floor, begin + floor - flat),
        (flat, begin),
    )

    return Prism("x", corners, -dims.tail_half_width, dims.tail_half_width)


def _behind_collar(finger: Finger) -> Box:
    """Build the room of both wings, on the flat of the base."""
    reach = wing_reach(finger)
    deep = 2 * finger.dimensions.collar.section.palmar
    begin = plug_begin_z(finger)
    flat = _over_base(finger)

    return Box((-reach, -deep, begin - PAST_MM), (reach, flat, -finger.bone.collar_length_mm))


def _collar_slope(finger: Finger) -> Solid:
    """Build the slope of the collar, larger by a gap."""
    slope = find_collar_slope(finger)
    section = finger.dimensions.collar.section
    stations = (
        (slope.begin_z - PLUG_GAP_MM, slope.share),
        (slope.end_z - PLUG_GAP_MM, 1.0),
        (PAST_MM, 1.0),
    )

    return SuperconicSolid(ConicBody(offset_section(section, PLUG_GAP_MM), stations))


def _knot_room(finger: Finger) -> Solid:
    """Build what stays open around the knot on the hole of the wires, and proximal to it: wider
    than the keel.
    """
    exit_z = finger.dimensions.channel_exit_z
    far = 2 * knot_depth(finger)
    radius = knot_radius(finger) + _BESIDE_KNOT_MM
    around = cylinder("y", centre=(exit_z, 0.0), low=-far, high=far, radius=radius)

    return around.union(Box((-radius, -far, exit_z - far), (radius, far, exit_z)))


def wires(finger: Finger) -> Solid:
    """Build legs, both wires on the floor of the trough and the knot on their hole, for checks.

    Seen from the palm, tip to the right:

           _____
          |     |______________
          | knot|______________|=====|   leg, tab_pitch_mm apart
          |     |______________|=====|   film
          |_____|   wires          tail_end_z
         channel_exit_z
    """
    dims = finger.dimensions
    radius = finger.sensor.wire_diameter_mm / 2
    floor = -floor_depth(finger)
    half = dims.sensor.tab_pitch_mm / 2
    end = dims.tail_end_z - _ON_FLOOR_MM
    runs = (
        cylinder(
            "z",
            centre=(x, floor - radius),
            low=dims.channel_exit_z,
            high=end,
            radius=radius,
        )
        for x in (-half, half)
    )
    return union(
        cylinder(
            "y",
            centre=(dims.channel_exit_z, 0.0),
            low=-knot_depth(finger),
            high=floor,
            radius=knot_radius(finger),
        ),
        *runs,
    )


def wires_on_back(finger: Finger) -> Solid:
    """Build both wires side by side on the back of the bone, from their hole past the post, for
    checks.
    """
    radius = finger.sensor.wire_diameter_mm / 2
    centre_y = finger.dimensions.bone_outline.section.dorsal + radius + _ON_FLOOR_MM
    end = finger.bone.base_length_mm + 2 * finger.bone.post_length_mm

    return union(
        *(
            cylinder(
                "z",
                centre=(x, centre_y),
                low=-end,
                high=finger.dimensions.channel_exit_z,
                radius=radius,
            )
            for x in (-radius, radius)
        )
    )


def floor_depth(finger: Finger) -> float:
    """Depth below the parting plane at which wires and knot lie on the floor of the trough [mm]."""
    return finger.dimensions.flat_depth - finger.dimensions.pocket_depth + _ON_FLOOR_MM
