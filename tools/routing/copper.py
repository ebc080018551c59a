"""Copper of a routed board as discs swept along lines and as boxes, and the distances between them [mm]."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from fingertip.board.kicad.footprints import FIDUCIAL, FIDUCIAL_CLEARANCE_MM, FOOTPRINTS, Point
from fingertip.board.kicad.placement import PlacedPad, Placement, Segment, Tracks, list_fiducials
from tools.routing.grid import DesignRules
from tools.routing.paths import BACK, FRONT


@dataclass(frozen=True)
class Copper:
    """Copper of one net on one layer: a line with round ends, or with `half_height` a box around its first end."""

    net: str
    layer: int
    a: Point
    b: Point
    half_width: float
    half_height: float = 0.0
    is_pad: bool = False


def fiducial_pads(placement: Placement, rules: DesignRules) -> Iterator[PlacedPad]:
    """Yield the fiducial marks as pads of no net, grown by what their clearance surpasses that of the rules."""
    pad = FOOTPRINTS[FIDUCIAL].pads[0]
    half = pad.width / 2 + FIDUCIAL_CLEARANCE_MM - rules.clearance
    for name, position in list_fiducials(placement).items():
        yield PlacedPad(name, pad, position.x, position.y, half, half, "")


def list_copper(pads: Sequence[PlacedPad], tracks: Mapping[str, Tracks], via_mm: float) -> Iterator[Copper]:
    """Yield all copper of a board; vias and drilled pads once for each layer."""
    for pad in pads:
        at = (pad.x, pad.y)
        for layer in (FRONT, BACK) if pad.pad.drill else (FRONT,):
            height = 0.0 if pad.pad.shape == "circle" else pad.half_height
            yield Copper(pad.net, layer, at, at, pad.half_width, height, is_pad=True)
    for net, copper in tracks.items():
        for layer, a, b, width in copper.segments:
            yield Copper(net, layer, a, b, width / 2)
        for via in copper.vias:
            for layer in (FRONT, BACK):
                yield Copper(net, layer, via, via, via_mm / 2)


def segment_gap(segment: Segment, other: Copper) -> float:
    """Distance from the centre line of a segment to other copper; negative where it overlaps."""
    _, a, b, _ = segment
    if other.half_height:
        return _line_to_box(a, b, other)
    return _line_to_line(a, b, other.a, other.b) - other.half_width


def _point_to_line(p: Point, a: Point, b: Point) -> float:
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    t = 0.0 if square == 0 else min(max(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, 0.0), 1.0)
    return math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy)


def _line_to_line(a: Point, b: Point, c: Point, d: Point) -> float:
    def side(p: Point, q: Point, r: Point) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    if side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0:
        return 0.0
    return min(_point_to_line(a, c, d), _point_to_line(b, c, d), _point_to_line(c, a, b), _point_to_line(d, a, b))


def _line_to_box(a: Point, b: Point, box: Copper) -> float:
    (x, y), w, h = box.a, box.half_width, box.half_height
    if any(abs(p[0] - x) <= w and abs(p[1] - y) <= h for p in (a, b)):
        return 0.0
    corners = ((x - w, y - h), (x + w, y - h), (x + w, y + h), (x - w, y + h))
    return min(_line_to_line(a, b, p, q) for p, q in zip(corners, (*corners[1:], corners[0]), strict=True))
