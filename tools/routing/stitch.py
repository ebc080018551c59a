"""Stitching vias: they join the ground pours of both layers wherever both have room for one."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from fingertip.board.kicad.footprints import Box, Point
from fingertip.board.kicad.layout import CORNER_RADIUS_MM
from fingertip.board.kicad.placement import PlacedPad, Placement, Tracks
from fingertip.board.kicad.project import POUR_CLEARANCE_MM
from tools.routing.copper import list_copper, segment_gap
from tools.routing.grid import DesignRules

_STEP_MM = 0.4
SPACING_MM = 3.0
"""Least distance between two stitching vias."""
_GROUND_VIA_MM = 1.6
"""Least distance from the other vias of the ground."""
_RING_MM = 0.15
"""Width of pour that must surround a via."""

Outlines = Sequence[Sequence[Point]]


def find_stitching(
    tracks: Mapping[str, Tracks], fills: Mapping[str, Outlines], pads: Sequence[PlacedPad], placement: Placement,
    rules: DesignRules, no_vias: Iterable[Box] = (),
) -> tuple[Point, ...]:  # fmt: skip
    """Find places of stitching vias inside both pours, clear of all pads, tracks and silkscreen."""
    copper = list(list_copper(pads, tracks, rules.via))
    ground = tracks["GND"].vias if "GND" in tracks else ()
    boxes = list(no_vias)
    found: list[Point] = []
    margin = rules.edge + rules.via / 2 + _RING_MM
    for row in range(math.ceil(margin / _STEP_MM), int((placement.height - margin) / _STEP_MM) + 1):
        for column in range(math.ceil(margin / _STEP_MM), int((placement.width - margin) / _STEP_MM) + 1):
            point = (round(column * _STEP_MM, 3), round(row * _STEP_MM, 3))
            if any(math.dist(point, other) < SPACING_MM for other in found) or _is_at_corner(point, placement, margin):
                continue
            if any(math.dist(point, other) < _GROUND_VIA_MM for other in ground) or _is_covered(point, boxes, rules):
                continue
            spot = (0, point, point, 0.0)
            # A via may touch the ground's tracks, but no pad: its hole would draw the solder off.
            clear = all(
                segment_gap(spot, item) >= rules.via / 2 + POUR_CLEARANCE_MM + (0.0 if item.net == "GND" else _RING_MM)
                for item in copper
                if item.net != "GND" or item.is_pad
            )
            if clear and all(any(is_inside(point, outline) for outline in outlines) for outlines in fills.values()):
                found.append(point)
    return tuple(found)


def _is_at_corner(point: Point, placement: Placement, margin: float) -> bool:
    """Return whether a point is nearer than a margin to the rounded corners of the board."""
    dx = max(CORNER_RADIUS_MM - point[0], point[0] - placement.width + CORNER_RADIUS_MM, 0.0)
    dy = max(CORNER_RADIUS_MM - point[1], point[1] - placement.height + CORNER_RADIUS_MM, 0.0)
    return dx > 0 and dy > 0 and math.hypot(dx, dy) > CORNER_RADIUS_MM - margin


def is_inside(point: Point, outline: Sequence[Point]) -> bool:
    """Return whether a point lies inside a polygon (even-odd rule)."""
    x, y = point
    inside = False
    for (x0, y0), (x1, y1) in zip(outline, (*outline[1:], outline[0]), strict=True):
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) / (y1 - y0) * (x1 - x0):
            inside = not inside
    return inside


def _is_covered(point: Point, boxes: Sequence[Box], rules: DesignRules) -> bool:
    m = rules.via / 2
    return any(b[0] - m < point[0] < b[2] + m and b[1] - m < point[1] < b[3] + m for b in boxes)
