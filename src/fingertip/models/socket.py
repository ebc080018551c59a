"""Socket: a hole in the base for a post of the phalanx, and a cross bolt through both."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .cross_bolt import bolt_hole
from .solids import Shapes, cylinder

if TYPE_CHECKING:
    from .program_types import Finger


def shapes(finger: Finger) -> Shapes:
    """Build what is removed: the socket, and the hole of the cross bolt.

    Section at x = 0, tip to the right:

            _______________________
           |_______________        |   base
                           |       |
                (o)        |       |   socket_diameter_mm
            _______________|       |
           |_______________________|
           |<------------->|
            socket_depth_mm
    """
    radius = finger.bone.socket_diameter_mm / 2
    end = -finger.bone.base_length_mm
    bore = cylinder(
        "z",
        centre=(0.0, finger.dimensions.base_middle_y),
        low=end - radius,
        high=end + finger.bone.socket_depth_mm,
        radius=radius,
    )

    return (), (bore, bolt_hole(finger, cross_bolt_z(finger)))


def cross_bolt_z(finger: Finger) -> float:
    """Axis of the cross bolt: halfway up the socket."""
    return -finger.bone.base_length_mm + finger.bone.socket_depth_mm / 2
