"""Pocket and trough of the bone for the sensor, and the sensor that lies in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .allowances import PAST_MM
from .solids import Box, Prism, Solid, cylinder

if TYPE_CHECKING:
    from .program_types import Finger


def sensor_recess(finger: Finger) -> Solid:
    r"""Build the recess of the sensor, open to the palm: head pocket, and trough of the tail to the
    wires' hole.

    Seen from the palm, tip to the right; both are pocket_depth deep:

                                        _____
                                      .'     '.
           __________________________/         \
          |                         |           |
          |  trough,                |     +     |   pocket, radius:
          |  2 tail_half_width      |           |   head_diameter_mm / 2 + clearance_mm
          |__________________________\         /
          |                           '._____.'
          trough_end_z                 sensor_z
    """
    dims = finger.dimensions
    gap = finger.sensor.clearance_mm
    # Below the palmar surface of every solid.
    outside = -dims.collar.section.palmar - dims.bone_outline.section.palmar
    radius = dims.sensor.head_diameter_mm / 2 + gap
    floor = dims.pocket_depth - dims.platform_depth
    pocket = cylinder(
        "y",
        centre=(dims.sensor_z, 0.0),
        low=outside,
        high=floor,
        radius=radius,
        around_radius=dims.platform_radius,
    )
    top = dims.sensor_z + gap  # also clears a tail that is wider than the head

    return pocket.union(
        flat_slab(
            finger,
            low_mm=outside,
            high_mm=dims.pocket_depth,
            half_width=dims.tail_half_width,
            begin=dims.trough_end_z,
            end=top,
        )
    )


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


def film_column(finger: Finger) -> Solid:
    """Build what lies over and under the sensor's film, adhesive included."""
    dims = finger.dimensions
    outside = -2 * (dims.collar.section.palmar + dims.bone_outline.section.palmar)
    inside = dims.pocket_depth + PAST_MM
    head = cylinder(
        "y",
        centre=(dims.sensor_z, 0.0),
        low=outside,
        high=inside - dims.platform_depth,
        radius=dims.sensor.head_diameter_mm / 2,
    )

    return head.union(
        flat_slab(
            finger,
            low_mm=outside,
            high_mm=inside,
            half_width=dims.sensor.tail_width_mm / 2,
            begin=dims.tail_end_z,
            end=dims.sensor_z,
        )
    )


def flat_slab(
    finger: Finger,
    low_mm: float,
    high_mm: float,
    half_width: float,
    begin: float,
    end: float,
) -> Solid:
    """Build what lies between two distances from the bone's palmar side, positive into the bone,
    from z to z [mm].

    Section at x = 0, back up, tip to the right:

                         ramp[0]   ramp[1]
             high_mm  ______:         :
                            `'--..____:_____   high_mm
             low_mm   ______          :
                            `'--..____:_____   low_mm
             flat     ______          :
                            `'--..____:_____   platform
                   begin                  end
    """
    dims = finger.dimensions
    has_ramp = dims.platform_depth > dims.flat_depth
    bends = [z for z in dims.ramp if has_ramp and begin < z < end]
    surface = [(-dims.flat_depth_at(z), z) for z in (begin, *bends, end)]
    if not bends:
        y = surface[0][0]
        return Box((-half_width, y + low_mm, begin), (half_width, y + high_mm, end))

    high_line = [(y + high_mm, z) for y, z in surface]
    low_line = [(y + low_mm, z) for y, z in surface]
    return Prism("x", (*high_line, *reversed(low_line)), -half_width, half_width)
