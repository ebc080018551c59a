"""Joint of a clevis: the eyes of the bone, and the space that they leave to the hand's part of the joint.

The fingertip turns on a pin. The hand's knuckle, a tongue or a fork, is round about the pin within a clearance radius,
and its shoulder is a plane at that distance behind the pin. The eyes of the bone are round about the pin too, but a
joint clearance smaller. Two flats at the full radius meet the shoulder where the finger is straight and where it is
bent to the end of its travel: they are its hard stops. Without stops the eyes are round all over, and narrower.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

NOTCH_WIDTH_MM = 2.5
"""Width of the notch in which the tendon reaches its anchor, where no window does [mm]."""


@dataclass(frozen=True)
class Joint:
    """Joint of a clevis [mm]. All positions are (y, z), in the middle plane of the finger."""

    axis_y: float
    """Axis of the pin, across."""
    axis_z: float
    """Axis of the pin, along the finger."""
    pin_radius: float
    """Radius of the pin's bore."""
    radius: float
    """Radius within which the hand's knuckle lies, and distance of its shoulder behind the axis."""
    clearance: float
    """Gap between the bone and the hand."""
    is_fork: bool
    """True if the bone is a fork around the hand's tongue, false if it is a tongue in the hand's fork."""
    half_width: float
    """Half the width between the bone's cheeks, or of its tongue."""
    travel_deg: float
    """Angle between the hard stops; 0 without stops."""

    @property
    def eye_radius(self) -> float:
        """Radius of the bone's eyes."""
        return self.radius - self.clearance

    @property
    def shoulder_z(self) -> float:
        """Proximal end of the full base, from which the eyes stand out."""
        return self.axis_z + self.radius + self.clearance

    @property
    def low_z(self) -> float:
        """Proximal end of the eyes."""
        return self.axis_z - self.radius

    def stopped_profile(self, reach: float) -> tuple[tuple[float, float], ...]:
        """Return the corners (y, z) of the eye between its stops, counter-clockwise; the arc about the pin is missing.

        In the frame of the bone the hand's shoulder turns about the pin towards the palmar side while the finger bends.
        The dorsal edge is the shoulder of the straight finger, the palmar one that at the end of the travel. What lies
        between them never meets the shoulder on the way, because the outline is convex there.

        Units: `reach` [mm].
        """
        angle = math.radians(self.travel_deg)
        foot = (-self.radius * math.sin(angle), -self.radius * math.cos(angle))
        along = min(reach, reach / math.sin(angle))
        far = (foot[0] - along * math.cos(angle), foot[1] + along * math.sin(angle))
        corners = ((0.0, -self.radius), (reach, -self.radius), (reach, reach), (far[0], reach), far, foot, (0.0, 0.0))
        return tuple((self.axis_y + y, self.axis_z + z) for y, z in corners)


@dataclass(frozen=True)
class TendonAnchor:
    """Hole across the finger for the pin or thread that holds the tendon [mm]."""

    y: float
    z: float
    radius: float
    distance: float
    """Distance of the tendon from the joint's axis."""
    inner_half_width: float
    """Half the width of the notch or window that it crosses; beyond it lie the cheeks that hold it."""
