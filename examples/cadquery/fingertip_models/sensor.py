"""Sensor as it is mounted in the bone. It is bought; pictures and checks show it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .bone import flat_slab
from .solids import Solid, cylinder

if TYPE_CHECKING:
    from .program_types import Finger


def sensor_body(finger: Finger) -> Solid:
    r"""Build the sensor as mounted in the bone, for pictures and checks; it is not printed.

    Seen from the palm, tip to the right; thickness_mm thick:

                                    _____
           ________________________/     \
          |   tail, tail_width_mm         |   head_diameter_mm
          |________________________       |
          |                        \_____/
       tail_end_z                  sensor_z
    """
    dims = finger.dimensions
    thickness = dims.sensor.thickness_mm
    half_tail = dims.sensor.tail_width_mm / 2
    head_y = (-dims.platform_depth, thickness - dims.platform_depth)
    radius = dims.sensor.head_diameter_mm / 2
    head = cylinder("y", (dims.sensor_z, 0.0), *head_y, radius)

    return head.union(
        flat_slab(
            finger,
            low_mm=0.0,
            high_mm=thickness,
            half_width=half_tail,
            begin=dims.tail_end_z,
            end=dims.sensor_z,
        )
    )
