"""Stand of a first finger: a bar with a socket for the post of its bone, which its cross bolt holds there.

It lies on the table, and prints lying, without supports. Either of its two flat sides is the lower one: the pad looks
up.
"""

from __future__ import annotations

from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Solid, difference
from fingertip.design.interfaces.interface import MATING_PLAY_MM, middle_y
from fingertip.design.interfaces.rigid import Post

_WALL_MM, _ABOVE_FLOOR_MM, _BELOW_FILLET_MM, _HANDLE_MM = 2.4, 0.5, 0.3, 26.0
"""Wall beside the post, room below it, gap below the fillet at its root, and length below its socket [mm]."""


def post_gap_mm(design: Design) -> float:
    """Return the gap beside the post in the design: what the print's errors leave of it is half the mating play."""
    return MATING_PLAY_MM / 2 + design.printer.surface_error_mm + max(0.0, design.printer.offset_mm)


def outline(design: Design) -> Box:
    bone, around = design.bone, post_gap_mm(design) + _WALL_MM
    x, half, y = bone.post_width_mm / 2 + around, bone.post_height_mm / 2 + around, middle_y(design.dimensions)
    high = -bone.base_length_mm - Post().foot_length(design) - _BELOW_FILLET_MM
    return Box((-x, y - half, Post().low_z(design) - _ABOVE_FLOOR_MM - _HANDLE_MM), (x, y + half, high))


def stand(design: Design) -> Solid:
    bone, wider = design.bone, 2 * post_gap_mm(design)
    sizes = {
        "post_width_mm": bone.post_width_mm + wider, "post_height_mm": bone.post_height_mm + wider,
        "post_length_mm": bone.post_length_mm + _ABOVE_FLOOR_MM,
    }  # fmt: skip
    (socket, _), _ = Post().shapes(design.model_copy(update={"bone": bone.model_copy(update=sizes)}))
    return difference(outline(design), socket, Post().bolt_hole(design))


def genus(design: Design) -> int:
    """Count two: the socket is blind, and the hole of the cross bolt opens into it on both sides."""
    return 2
