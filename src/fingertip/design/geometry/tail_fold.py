"""Folded tail of the sensor: down the palmar side, around a web of the bone, and up into a trough on the dorsal side.

A straight tail makes the base as long as itself. A folded one ends under the dorsal side of the skin, so that the base
is only as long as the fold. The film bends around a half-round nose, the proximal end of the web between both sides.
The nose stands in a window through the base, in which the tail is threaded. Tabs and crimps are stiff, so they cannot
be pushed into a closed passage around a bend: the trough is open, and a lid closes it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design.geometry.conic import TANGENT_STEP_MM

SLIDING_MM = 0.3
"""Gap beside and above film, crimps and wires [mm]. An assumption."""
END_ROOM_MM = 1.5
"""Room between the tabs and the end of the trough, for tails longer than stated [mm]. An assumption."""
_BELOW_SEAL_MM = 0.5
"""Distance of the window from the sealing part of the collar [mm]."""


@dataclass(frozen=True)
class SensorTail:
    """Tail of a sensor as it is folded [mm]."""

    film_mm: float
    """Length of the film from the centre of the head to its end."""
    thickness_mm: float
    """Thickness of the film."""
    tab_length_mm: float
    """Length of the tabs beyond the film."""
    tabs_width_mm: float
    """Width over both tabs."""
    crimp_height_mm: float
    """Height of crimps and solder above the film."""
    wire_diameter_mm: float
    """Diameter of the wires, which lie on the crimps."""


@dataclass(frozen=True)
class TailFold:
    """Course of a folded tail [mm]."""

    nose_y: float
    """Axis of the nose, across."""
    nose_z: float
    """Axis of the nose, along the finger, which is the distal face of the window."""
    radius: float
    """Radius of the nose, at which the film bends."""
    window_low_z: float
    """Proximal face of the window; crimps and wires pass between it and the nose."""
    floor_y: float
    """Floor of the trough, on which the end of the tail lies."""
    film_end_z: float
    """End of the film in the trough."""
    tabs_end_z: float
    """End of the tabs."""
    film_space_mm: float
    """Height between floor and lid beside the tabs."""
    tabs_space_mm: float
    """Height between floor and lid over the tabs, and of all openings through which they are threaded."""
    tabs_half_width: float
    """Half the width of the higher space."""

    @property
    def trough_end_z(self) -> float:
        """Distal end of the trough."""
        return self.tabs_end_z + END_ROOM_MM


def fold_tail(
    pocket_floor_y: float, sensor_z: float, seal_length_mm: float, radius_mm: float, tail: SensorTail
) -> TailFold:
    """Lay the tail around its nose. Units: `pocket_floor_y` [mm], `sensor_z` [mm]."""
    nose_y = pocket_floor_y + TANGENT_STEP_MM + radius_mm
    nose_z = -(seal_length_mm + _BELOW_SEAL_MM)
    # The neutral line of the film runs half its thickness outside the nose.
    left = tail.film_mm - (sensor_z - nose_z) - math.pi * (radius_mm + tail.thickness_mm / 2)
    film_end_z = nose_z + left
    tabs_space = tail.thickness_mm + tail.crimp_height_mm + tail.wire_diameter_mm + SLIDING_MM
    return TailFold(
        nose_y,
        nose_z,
        radius_mm,
        nose_z - radius_mm - tabs_space,
        nose_y + radius_mm + TANGENT_STEP_MM,
        film_end_z,
        film_end_z + tail.tab_length_mm,
        tail.thickness_mm + SLIDING_MM,
        tabs_space,
        tail.tabs_width_mm / 2 + SLIDING_MM,
    )
