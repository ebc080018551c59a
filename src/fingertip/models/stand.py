"""Stand: a bar with a socket, in which the cross bolt holds the post.

Either of its flat sides lies on the table: the pad looks up. So it lies on the printer's bed,
unless its socket is too wide for a bridge.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from . import post
from .allowances import MATING_PLAY_MM
from .cross_bolt import bolt_hole
from .solids import Box, Solid

if TYPE_CHECKING:
    from .program_types import Finger

BESIDE_POST_MM = 2.4
_ABOVE_FLOOR_MM = 0.5
_BELOW_FILLET_MM = 0.3
_HANDLE_MM = 26.0
"""Wall beside the post, room below it, gap below the fillet at its root, and length below its
socket [mm].
"""


def post_gap_mm(finger: Finger) -> float:
    """Return the gap beside the post in the design: what the print's errors leave of it is half the
    mating play.
    """
    return MATING_PLAY_MM / 2 + finger.printer.surface_error_mm + max(0.0, finger.printer.offset_mm)


def stand_outline(finger: Finger) -> Box:
    bone = finger.bone
    around = post_gap_mm(finger) + BESIDE_POST_MM
    x = bone.post_width_mm / 2 + around
    half = bone.post_height_mm / 2 + around
    y = finger.dimensions.base_middle_y
    high = -bone.base_length_mm - post.post_foot_length(finger) - _BELOW_FILLET_MM

    return Box(
        (-x, y - half, post.low_z(finger) - _ABOVE_FLOOR_MM - _HANDLE_MM), (x, y + half, high)
    )


def stand(finger: Finger) -> Solid:
    """Build the stand, with a blind socket and the hole of the cross bolt, which opens into it.

    Section at x = 0, back up, tip of the finger to the right:

           ________________________________________
          |                    ____________________|   BESIDE_POST_MM
          |                   |                        post_height_mm + 2 post_gap_mm
          |                   |   (o)  socket          cross bolt
          |                   |____________________
          |________________________________________|
          |<---- _HANDLE_MM ->|
    """
    bone = finger.bone
    wider = 2 * post_gap_mm(finger)
    socket = post.post_body(
        finger,
        width=bone.post_width_mm + wider,
        height=bone.post_height_mm + wider,
        length=bone.post_length_mm + _ABOVE_FLOOR_MM,
    )

    return stand_outline(finger).cut(socket, bolt_hole(finger, post.cross_bolt_z(finger)))


def socket_ceiling_mm(finger: Finger) -> float:
    """Measure what overhangs in the socket of a lying stand [mm]: its flat, or the round side above
    45 degrees.
    """
    gap = post_gap_mm(finger)
    radius = finger.bone.post_width_mm / 2 + gap
    half = finger.bone.post_height_mm / 2 + gap

    return 2 * max(radius * math.sqrt(0.5), math.sqrt(max(0.0, radius**2 - half**2)))
