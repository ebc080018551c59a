"""Printed pin of a joint, which prints standing. It stands out of the eyes, to be pushed out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .joint import joint_of
from .solids import Cone, Solid, cylinder

if TYPE_CHECKING:
    from .program_types import Finger

_PIN_CHAMFER_MM = 0.4
"""Chamfer at the pin's end [mm]."""
_PIN_HEAD_MM = 1.0
_WEDGE_MM = 4.0
_WEDGED_MM = 0.1
"""Height and overhang of the pin's head, length of the taper below it,
and its radius over the bore's there [mm].
"""


def pin(finger: Finger) -> Solid:
    r"""Build the pin as it stands on its head on the bed, along z.

    Below the head it wedges in a cheek of the bone.

           __
          /  \        _PIN_CHAMFER_MM
          |  |
          |  |        printed_pin_radius
          |  |
          /  \        wedge: pin_radius + _WEDGED_MM at the head, _WEDGE_MM long
         /____\
        |______|      head: pin_radius + _PIN_HEAD_MM, z = 0
    """
    joint = joint_of(finger)
    length = finger.dimensions.pin_length
    at = (0.0, 0.0)
    bore = joint.pin_radius
    radius = joint.printed_pin_radius

    return cylinder(
        "z",
        centre=at,
        low=0.0,
        high=_PIN_HEAD_MM,
        radius=bore + _PIN_HEAD_MM,
    ).union(
        Cone(
            axis="z",
            centre=at,
            low=_PIN_HEAD_MM,
            high=_PIN_HEAD_MM + _WEDGE_MM,
            low_radius=bore + _WEDGED_MM,
            high_radius=radius,
        ),
        cylinder(
            "z",
            centre=at,
            low=_PIN_HEAD_MM + _WEDGE_MM,
            high=length - _PIN_CHAMFER_MM,
            radius=radius,
        ),
        Cone(
            axis="z",
            centre=at,
            low=length - _PIN_CHAMFER_MM,
            high=length,
            low_radius=radius,
            high_radius=radius - _PIN_CHAMFER_MM,
        ),
    )
