"""Stand of a first finger: a socket for the post of its bone, on a handle. The cross bolt of the post holds it there.

It lies on its flat back while the pad is loaded from above, and prints so too, without supports.
"""

from __future__ import annotations

from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Prism, Solid, cylinder, difference, intersection
from fingertip.design.interfaces.interface import MATING_PLAY_MM, middle_y
from fingertip.design.interfaces.rigid import Post

WALL_MM = 2.4
"""Wall beside the post [mm]: six lines of a usual nozzle. An assumption."""
_FLOOR_MM, _ABOVE_FLOOR_MM, _BELOW_FILLET_MM = 2.0, 0.5, 0.3
"""Floor of the socket, room between it and the post, and gap below the fillet at the post's root [mm]."""
_HANDLE_MM, _HANDLE_HEIGHT_MM = 26.0, 6.0
_OVERLAP_MM = 0.5
"""Length by which solids reach into each other [mm]."""


def post_gap_mm(design: Design) -> float:
    """Return the gap beside the post in the design: what the print's errors leave of it is half the mating play."""
    return MATING_PLAY_MM / 2 + design.printer.surface_error_mm + max(0.0, design.printer.offset_mm)


def _half_sizes(design: Design) -> tuple[float, float]:
    """Return half the width and half the height of the socket's block [mm]."""
    around, bone = post_gap_mm(design) + WALL_MM, design.bone
    return bone.post_width_mm / 2 + around, min(bone.post_height_mm, bone.post_width_mm) / 2 + around


def heights_mm(design: Design) -> tuple[float, float, float, float]:
    """Return the heights at which handle, slope and block begin, and at which the block ends [mm]."""
    top = -design.bone.base_length_mm - Post().foot_length(design) - _BELOW_FILLET_MM
    block = Post().low_z(design) - _ABOVE_FLOOR_MM - _FLOOR_MM
    slope = block - (2 * _half_sizes(design)[1] - _HANDLE_HEIGHT_MM)
    return slope - _HANDLE_MM, slope, block, top


def stand(design: Design) -> Solid:
    y, (half_width, half_height), bone = middle_y(design.dimensions), _half_sizes(design), design.bone
    end, slope, block, top = heights_mm(design)
    back, front = y + half_height, y - half_height
    grip = back - _HANDLE_HEIGHT_MM
    outline = Prism(
        "x",
        ((back, end), (back, top), (front, top), (front, block), (grip, slope), (grip, end)),
        -half_width,
        half_width,
    )
    gap, floor = post_gap_mm(design), block + _FLOOR_MM
    socket: Solid = cylinder("z", (0.0, y), floor, top + _OVERLAP_MM, bone.post_width_mm / 2 + gap)
    if bone.post_height_mm < bone.post_width_mm:
        half, far = bone.post_height_mm / 2 + gap, 2 * half_width
        socket = intersection(socket, Box((-far, y - half, floor - far), (far, y + half, top + far)))
    return difference(outline, socket, Post().bolt_hole(design))


def genus(design: Design) -> int:
    """Count two: the socket is blind, and the hole of the cross bolt opens into it on both sides."""
    return 2
