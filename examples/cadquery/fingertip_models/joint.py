"""Joint of a clevis, and the anchor of its tendon.

The fingertip turns on the pin of a clevis. The hand's knuckle, a tongue or a fork, is round about
the pin within a clearance radius, and its shoulder is a plane at that distance behind the pin. The
eyes of the bone are round about the pin too, but a joint clearance smaller. Two flats at the full
radius meet the shoulder where the finger is straight and where it is bent to the end of its travel:
they are its hard stops. Without stops the eyes are round all over, and narrower.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .program_types import Finger

PIN_PLAY_MM = 0.1
"""Play of a printed pin in the bone's bore [mm]."""


@dataclass(frozen=True)
class Joint:
    """Joint of a clevis [mm]. All positions are (y, z), in the middle plane of the finger."""

    axis_y: float
    axis_z: float
    """Axis of the pin."""
    pin_radius: float
    """Radius of the bone's bore, and of a pin of steel."""
    radius: float
    """Radius within which the hand's knuckle lies, and distance of its shoulder behind the axis."""
    clearance: float
    is_fork: bool
    """True if the bone is a fork around the hand's tongue, false
    if it is a tongue in the hand's fork.
    """
    half_width: float
    """Half the width between the bone's cheeks, or of its tongue."""
    travel_deg: float
    """Angle between the hard stops; 0 without stops."""
    foot: float
    """Radius of the fillet at the root of the eyes; 0 where they
    are as wide and as high as the base.
    """

    @property
    def printed_pin_radius(self) -> float:
        return self.pin_radius - PIN_PLAY_MM / 2

    @property
    def eye_radius(self) -> float:
        return self.radius - self.clearance

    @property
    def shoulder_z(self) -> float:
        """Proximal end of the full base, from which the eyes stand out."""
        return self.axis_z + self.radius + self.clearance + self.foot

    @property
    def low_z(self) -> float:
        return self.axis_z - self.radius


HORN_RADIUS_MM = 4.0
"""Radius of the horns, over which the tendon turns from around the base towards the hand [mm]."""
MIN_HORN_RADIUS_MM = 2.0
"""Least radius of the horns, on a short or low base [mm].
Five times that of a tendon of 0.8 mm. An assumption.
"""
BESIDE_LINE_MM = 0.4
"""Room along the finger beside the tendon in its groove [mm]."""


@dataclass(frozen=True)
class TendonAnchor:
    """Loop of the tendon around the base, in a groove behind the collar [mm].

    Its strands come down both sides, turn over a round shoulder, the horn, and leave along the
    palmar corners.
    """

    y: float
    """Middle of both strands where they leave towards the hand."""
    distance: float
    line: float
    """Diameter of the tendon."""
    half_width: float
    """Half the width of the base in the groove, on whose sides both strands lie."""
    low_z: float
    """Proximal wall of the groove, where the horns begin."""
    high_z: float
    """Height at which the foot of the collar begins to slope
    outwards, so that it prints without supports.
    """
    horn_radius: float

    @property
    def z(self) -> float:
        """Middle of the loop."""
        return self.low_z + self.line / 2

    @property
    def strand_x(self) -> float:
        """Distance of the middle of each strand from the middle plane."""
        return self.half_width + self.line / 2

    @property
    def horn_y(self) -> float:
        """Height of the horns' palmar side, on which the strands lie."""
        return self.y + self.line / 2

    @property
    def horn_low_z(self) -> float:
        return self.low_z - self.horn_radius


def joint_of(finger: Finger) -> Joint:
    joint = finger.dimensions.joint
    assert joint, "only a clevis has a joint"
    return joint
