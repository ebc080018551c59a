"""Chaplet: the boss of the mold's dorsal half that carries bone or core near the tip, and the screw that holds it.

The base alone is a cantilever, whose play grows towards the tip. The chaplet is a second support: the screw pulls a
flat facet of the bone against the boss, so that neither gap nor pressure of the silicone moves it. It stands on the
dorsal side and leaves a round hole in the skin there, which is closed after casting. No object is touched with it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fingertip.catalogues.threads import Thread, find_thread

if TYPE_CHECKING:
    from fingertip.design.geometry.conic import ConicBody

_BESIDE_BOSS_MM = 0.5
"""Width of the facet beside the boss, so that a misplaced bone still rests on it [mm]."""
_FACET_DEPTH_MM = 0.2
"""Least depth of the facet in the bone [mm]."""
_ENGAGED_DIAMETERS = 2.0
"""Engaged length of the self-tapping screw, in diameters. An assumption for printed resin."""
_PILOT_RATIO = 0.8
"""Diameter of the pilot hole over that of the screw. An assumption for printed resin."""
_PILOT_END_MM = 0.7
"""Length of the pilot hole beyond the screw [mm]."""
_POINTS = 16
"""Points of the facet's edge at which the height of the bone is taken."""
_HOLE_CLEARANCE_MM = 0.1
"""Clearance of the screw in its hole, over its diameter [mm]. The hole is drilled, because a print closes it."""
_HEAD_CLEARANCE_MM = 0.3
"""Gap beside the head of the screw [mm]."""
SCREW_LENGTHS_MM = (4, 5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50)
"""Standard lengths of small machine screws (ISO 888)."""


@dataclass(frozen=True)
class Chaplet:
    """Boss, facet and screw [mm]. The axis is parallel to y, in the middle plane."""

    z: float
    """Axis, along the finger."""
    facet_y: float
    """Height of the facet."""
    radius: float
    """Radius of the boss where it meets the facet."""
    facet_radius: float
    thread: Thread

    @property
    def hole_radius(self) -> float:
        """Radius of the hole in the mold, which the screw passes."""
        return (self.thread.diameter_mm + _HOLE_CLEARANCE_MM) / 2

    @property
    def head_radius(self) -> float:
        """Radius of the counterbore for the screw's head, which is at most as wide as a nut."""
        return self.thread.nut_flats_mm / 2 + _HEAD_CLEARANCE_MM

    @property
    def pilot_radius(self) -> float:
        """Radius of the hole in the bone, into which the screw cuts its thread."""
        return _PILOT_RATIO * self.thread.diameter_mm / 2

    @property
    def engaged(self) -> float:
        """Engaged length of the screw."""
        return _ENGAGED_DIAMETERS * self.thread.diameter_mm

    @property
    def pilot_depth(self) -> float:
        """Depth of the hole in the bone, below the facet."""
        return self.engaged + _PILOT_END_MM

    @property
    def play(self) -> float:
        """Distance by which the bone can shift across the axis, before the screw meets its hole."""
        return _HOLE_CLEARANCE_MM / 2

    def screw_length(self, dorsal_height: float) -> float:
        """Select the longest screw whose head does not stand out of the dorsal face, at this height."""
        longest = dorsal_height - self.facet_y + self.engaged
        return float(max((length for length in SCREW_LENGTHS_MM if length <= longest), default=SCREW_LENGTHS_MM[0]))


def place_chaplet(outline: ConicBody, z: float, diameter: float, screw_mm: float) -> Chaplet:
    """Place the chaplet at a height of the finger, with its facet as high as the bone allows."""
    radius = diameter / 2
    facet = radius + _BESIDE_BOSS_MM
    lowest = min(
        outline.dorsal_height_at(facet * math.sin(angle), z + facet * math.cos(angle))
        for angle in (math.pi * i / _POINTS for i in range(_POINTS + 1))
    )
    return Chaplet(z, lowest - _FACET_DEPTH_MM, radius, facet, find_thread(screw_mm))
