"""Encapsulated bone: what the silicone meets of bone and sensor, and the plug over the end of the
tail.

The silicone covers the sensor's film, whose vent is at the end of its tail, and stops at the
collar. The plug fills the notch that the trough cuts into the collar, and lies on the film up to a
lap past the end of the tail: neither the vent nor the wires meet silicone. It stays in the finger.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .allowances import PAST_MM
from .bone import filled_bone
from .conic import ConicBody
from .dimensions import KNOT_WIRES
from .mold_layout import PLATE_MM
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
    """Find the proximal end of the plug: level with the plate's top, or distal to the knot."""
    knot = KNOT_WIRES * finger.sensor.wire_diameter_mm / 2
    return max(-PLATE_MM, finger.dimensions.channel_exit_z + knot + _WIRE_GAP_MM)


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
    dims = finger.dimensions
    begin = plug_begin_z(finger)
    half = dims.tail_half_width - PLUG_GAP_MM
    surface = -dims.flat_depth
    deep = 2 * dims.collar.section.palmar
    outline = SuperconicSolid(
        ConicBody(dims.collar.section, ((begin, 1.0), (-_BELOW_SILICONE_MM, 1.0)))
    )
    notch = Box((-half, -deep, -2 * PLATE_MM), (half, surface - _FILM_GAP_MM, PAST_MM))
    neck = _lay_on_flat(finger, -_FILM_GAP_MM, half, -PAST_MM, PAST_MM)
    roof = _roof(finger, -_FILM_GAP_MM, _FILM_GAP_MM)
    whole = outline.intersect(notch).union(neck, roof)
    end = dims.tail_end_z - _WIRE_GAP_MM
    if end <= begin:
        return whole

    # Walls down to the floor of the trough, and the tunnel between them, whose end slopes.
    floor = surface + dims.pocket_depth - _FILM_GAP_MM
    walls = Box((-half, surface - PAST_MM / 2, begin), (half, floor, end))
    ceiling = surface - _tunnel_height(finger)
    low = begin - PAST_MM
    corners = (
        (floor + PAST_MM, low),
        (floor + PAST_MM, end + floor + PAST_MM - ceiling),
        (ceiling, end),
        (ceiling, low),
    )
    inner = half - finger.printer.min_wall_mm

    return whole.union(walls).cut(Prism("x", corners, -inner, inner))


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
    knot = KNOT_WIRES * radius
    return union(
        cylinder(
            "y",
            centre=(dims.channel_exit_z, 0.0),
            low=floor - 2 * knot,
            high=floor,
            radius=knot,
        ),
        *runs,
    )


def floor_depth(finger: Finger) -> float:
    """Depth below the parting plane at which wires and knot lie on the floor of the trough [mm]."""
    return finger.dimensions.flat_depth - finger.dimensions.pocket_depth + _ON_FLOOR_MM
