"""Adapter: a body that another program has drawn, at the end of the base.

The datum plane of the file passes through a point, across the axis that points to the tip. It comes
to lie on the proximal end of the base, the point in its middle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from .solids import Placed, Point3, Shapes

if TYPE_CHECKING:
    from .program_types import Finger

_ROWS: Mapping[str, tuple[Point3, Point3, Point3]] = {
    "x": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
    "y": ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    "z": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
}
"""Axis of the file that comes to lie along z -> rows of the
rotation, which keeps the order of the axes.
"""


def shapes(finger: Finger) -> Shapes:
    """Build the adapter. It removes nothing."""
    return (place_adapter(finger),), ()


def place_adapter(finger: Finger) -> Placed:
    """Place the adapter at the end of the base. Raises InputFileError or MissingLibraryError."""
    bone = finger.bone
    turn = math.radians(bone.adapter_turn_deg)
    # Rounded, so that quarter turns are exact, and all others are the same on every processor.
    cos = round(math.cos(turn), 12)
    sin = round(math.sin(turn), 12)
    up = -1.0 if bone.adapter_axis[0] == "-" else 1.0
    turned = ((cos, -up * sin, 0.0), (sin, up * cos, 0.0), (0.0, 0.0, up))
    columns = (*zip(*_ROWS[bone.adapter_axis[-1]], strict=True),)
    x, y, z = (
        tuple(sum(map(math.prod, zip(row, column, strict=True))) for column in columns)
        for row in turned
    )
    origin = bone.adapter_x_mm, bone.adapter_y_mm, bone.adapter_z_mm
    target = 0.0, finger.dimensions.base_middle_y, -bone.base_length_mm
    moved = (
        at - sum(map(math.prod, zip(row, origin, strict=True)))
        for row, at in zip((x, y, z), target, strict=True)
    )

    return Placed(
        finger.read_adapter(), tuple((*row, by) for row, by in zip((x, y, z), moved, strict=True))
    )
