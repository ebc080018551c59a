"""Stand of a first finger: a socket for the post of its bone, on a handle. The cross bolt of the post holds it there.

It lies on its flat back while the pad is loaded from above, and prints so too, without supports.
"""

from __future__ import annotations

from fingertip.design import Design
from fingertip.design.geometry.solids import Prism, Solid, difference
from fingertip.design.interfaces.interface import MATING_PLAY_MM, middle_y
from fingertip.design.interfaces.rigid import Post

_WALL_MM, _FLOOR_MM, _ABOVE_FLOOR_MM, _BELOW_FILLET_MM = 2.4, 2.0, 0.5, 0.3
"""Wall beside the post, floor of its socket, room between both, and gap below the fillet at its root [mm]."""
_HANDLE_MM, _HANDLE_HEIGHT_MM = 26.0, 6.0


def post_gap_mm(design: Design) -> float:
    """Return the gap beside the post in the design: what the print's errors leave of it is half the mating play."""
    return MATING_PLAY_MM / 2 + design.printer.surface_error_mm + max(0.0, design.printer.offset_mm)


def outline(design: Design) -> tuple[float, float, float, float]:
    """Return low and high z of the stand, half the width of its block, and half its height around the post [mm]."""
    bone, around = design.bone, post_gap_mm(design) + _WALL_MM
    half_width, half_height = (size / 2 + around for size in (bone.post_width_mm, bone.post_height_mm))
    low = Post().low_z(design) - _ABOVE_FLOOR_MM - _FLOOR_MM - 2 * half_height + _HANDLE_HEIGHT_MM - _HANDLE_MM
    return low, -bone.base_length_mm - Post().foot_length(design) - _BELOW_FILLET_MM, half_width, half_height


def stand(design: Design) -> Solid:
    low, high, half_width, half_height = outline(design)
    bone, y, wider = design.bone, middle_y(design.dimensions), 2 * post_gap_mm(design)
    back, front, grip, slope = y + half_height, y - half_height, y + half_height - _HANDLE_HEIGHT_MM, low + _HANDLE_MM
    corners = ((back, low), (back, high), (front, high), (front, slope + grip - front), (grip, slope), (grip, low))
    sizes = {
        "post_width_mm": bone.post_width_mm + wider, "post_height_mm": bone.post_height_mm + wider,
        "post_length_mm": bone.post_length_mm + _ABOVE_FLOOR_MM,
    }  # fmt: skip
    (socket, _), _ = Post().shapes(design.model_copy(update={"bone": bone.model_copy(update=sizes)}))
    return difference(Prism("x", corners, -half_width, half_width), socket, Post().bolt_hole(design))


def genus(design: Design) -> int:
    """Count two: the socket is blind, and the hole of the cross bolt opens into it on both sides."""
    return 2
