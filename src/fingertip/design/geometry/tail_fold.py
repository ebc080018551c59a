"""Folded tail of the sensor: down the palmar side, around a web of the bone, and up into a passage on the dorsal side.

A straight tail makes the base as long as itself. A folded one ends under the dorsal side of the skin, so that the base
is only as long as the fold. The film bends around a half-round nose, the proximal end of the web between both passages.
The nose stands in a window, which is open on the palmar and the dorsal side of the base: there the tail is threaded
and bent, and there the wires leave the passage.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

SLIDING_MM = 0.3
"""Gap around film and crimps in the dorsal passage, through which they are pushed [mm]. An assumption."""
STEP_MM = 0.05
"""Height by which the web stands above its nose [mm]. Tangent surfaces would leave a stray edge in the B-rep solid."""
_BELOW_COLLAR_MM = 0.5
"""Distance of the window from the collar [mm]."""


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
    """Proximal face of the window; the tabs pass between it and the nose."""
    floor_y: float
    """Palmar face of the dorsal passage, on which the end of the tail lies."""
    film_end_z: float
    """End of the film in the dorsal passage."""
    tabs_end_z: float
    """End of the crimped tabs, which stick out of the film."""
    film_passage_mm: float
    """Height of the dorsal passage beside the tabs."""
    tabs_passage_mm: float
    """Height of a passage for film with crimps and wires: over the tabs, and wherever they are threaded."""
    tabs_half_width: float
    """Half the width of the higher part."""

    @property
    def passage_end_z(self) -> float:
        """Distal end of the dorsal passage."""
        return self.tabs_end_z + SLIDING_MM


def fold_tail(
    pocket_floor_y: float,
    sensor_z: float,
    collar_length_mm: float,
    radius_mm: float,
    film_mm: tuple[float, float],
    tabs_mm: tuple[float, float, float],
) -> TailFold:
    """Lay the tail around its nose.

    Parameters
    ----------
    pocket_floor_y
        Face of the pocket on which the sensor lies, and of the tail's slot [mm].
    sensor_z
        Centre of the sensor's head [mm].
    collar_length_mm
        Length of the collar, below which the window begins [mm].
    radius_mm
        Radius at which the film bends [mm].
    film_mm
        Length of the film from the centre of the head to its end, and its thickness [mm].
    tabs_mm
        Length of the tabs beyond the film, height of their crimps and wires above its face, and width [mm].
    """
    (length, thickness), (tab_length, crimp_height, tab_width) = film_mm, tabs_mm
    nose_y = pocket_floor_y + STEP_MM + radius_mm
    nose_z = -(collar_length_mm + _BELOW_COLLAR_MM)
    # The neutral line of the film runs half its thickness outside the nose.
    left = length - (sensor_z - nose_z) - math.pi * (radius_mm + thickness / 2)
    film_end_z = nose_z + left
    film_passage = thickness + SLIDING_MM
    tabs_passage = thickness + crimp_height + SLIDING_MM
    return TailFold(
        nose_y,
        nose_z,
        radius_mm,
        nose_z - radius_mm - tabs_passage,
        nose_y + radius_mm + STEP_MM,
        film_end_z,
        film_end_z + tab_length,
        film_passage,
        tabs_passage,
        tab_width / 2 + SLIDING_MM,
    )
