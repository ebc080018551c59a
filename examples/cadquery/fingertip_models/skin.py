"""Skin: its outer surface, and what lies in it while it is cast."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .making import making_of
from .outline import skin_outline
from .solids import Solid

if TYPE_CHECKING:
    from .program_types import Finger


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

    The bump is that of a skin around a core. An encapsulated one lies on the sensor.
    """
    return skin_outline(finger).hollowed(skin_interior(finger))


def skin_interior(finger: Finger) -> Solid:
    """Build what is open inside the skin, as its making leaves it."""
    return making_of(finger).interior(finger)
