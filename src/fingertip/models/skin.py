"""Skin: its outer surface, and what the core leaves open in it.

The core may be smaller than the bone by an inset, which makes the skin fit tightly.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .bone import filled_bone
from .conic import inset_body
from .solids import Cone, Solid, SuperconicSolid

if TYPE_CHECKING:
    from .program_types import Finger

_INTO_HOLLOW_MM = 0.3
"""Length by which holes reach past the faces in which they open [mm].
Faces in one plane would leave slivers.
"""


def skin(finger: Finger) -> Solid:
    """Build the cured skin at its design size, unstretched.

    Section at x = 0, back up, tip to the right:

            |<------------------ length_mm ----------------->|
             _____________________________________
            |____________________________________ ``-.            thickness_dorsal_mm
                                                 `.   `.
                         skin_interior              |    |        thickness_tip_mm
             ______                           ____.'   .'
            |      ``--.________________.--'' bump   .'           thickness_palmar_mm
             ``--..__                           _.-''
                     ``---....__________....--''                  apex, crown_radius_mm
          z = 0                            sensor_z
    """
    return skin_outline(finger).hollowed(skin_interior(finger))


def skin_outline(finger: Finger, inset_mm: float = 0.0) -> Solid:
    """Build the skin with all that lies in it, smaller by an inset."""
    return SuperconicSolid(inset_body(finger.dimensions.outer, inset_mm))


def skin_interior(finger: Finger) -> Solid:
    """Build what is open inside the skin, as its core leaves it."""
    return filled_bone(finger, finger.mold.core_inset_mm).cut(*bump_recess(finger))


def bump_recess(finger: Finger) -> tuple[Solid, ...]:
    """Build the recess of a core for the skin's bump over the sensor; none without one.

    Its side slopes by 45 degrees, so that no air stays in it and the bump leaves it.
    """
    skin = finger.skin
    dims = finger.dimensions
    if skin.bump_height_mm == 0.0:
        return ()

    floor = finger.mold.core_inset_mm - dims.platform_depth + skin.bump_height_mm
    reach = skin.bump_height_mm + _INTO_HOLLOW_MM
    centre = (dims.sensor_z, 0.0)
    radius = skin.bump_radius_mm

    return (
        Cone(
            axis="y",
            centre=centre,
            low=floor - reach,
            high=floor,
            low_radius=radius + reach,
            high_radius=radius,
        ),
    )
