"""Widening of rails: tracks of the supplies, and from ground pads to their vias, as wide as there is room."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from fingertip.board.kicad.footprints import Point
from fingertip.board.kicad.placement import PlacedPad, Placement, Segment, Tracks
from tools.routing.copper import Copper, list_copper, segment_gap
from tools.routing.grid import DesignRules

RAILS = ("GND", "POWER_IN", "VCC", "VEE", "VMID", "VREF")
"""Nets to widen."""
WIDTHS_MM = (0.8, 0.6, 0.5, 0.4, 0.3)
"""Widths to try, the widest first."""
_MIN_LENGTH_MM = 0.5
"""Length below which a segment is not divided further."""


def widen_rails(
    tracks: Mapping[str, Tracks], pads: Sequence[PlacedPad], placement: Placement, rules: DesignRules
) -> dict[str, Tracks]:
    """Widen the rails of a routed board where the clearances stay; all else is returned as it is."""
    widened = dict(tracks)
    for net in RAILS:
        if net not in widened:
            continue
        foreign = [copper for copper in list_copper(pads, widened, rules.via) if copper.net != net]
        segments: list[Segment] = []
        for segment in widened[net].segments:
            near = [copper for copper in foreign if copper.layer == segment[0]]
            segments += _widen(segment, near, placement, rules)
        widened[net] = replace(widened[net], segments=tuple(segments))
    return widened


def rail_share(tracks: Mapping[str, Tracks], width_mm: float, nets: Sequence[str] = RAILS) -> float:
    """Share of the rails' length that is at least this wide."""
    segments = [s for net in nets if net in tracks for s in tracks[net].segments]
    total = math.fsum(math.dist(a, b) for _, a, b, _ in segments)
    return math.fsum(math.dist(a, b) for _, a, b, width in segments if width >= width_mm - 1e-9) / max(total, 1e-9)


def _widen(segment: Segment, near: Sequence[Copper], placement: Placement, rules: DesignRules) -> Iterator[Segment]:
    """Yield a segment at its greatest width, or divided where a part of it can be wider."""
    layer, a, b, width = segment
    best = max(_greatest_width(segment, near, placement, rules), width)
    if best < WIDTHS_MM[0] and math.dist(a, b) >= 2 * _MIN_LENGTH_MM:
        middle = (round((a[0] + b[0]) / 2, 3), round((a[1] + b[1]) / 2, 3))
        halves = [
            s for p, q in ((a, middle), (middle, b)) for s in _widen((layer, p, q, width), near, placement, rules)
        ]
        if any(half[3] > best for half in halves):
            yield from _join(halves)
            return
    yield (layer, a, b, best)


def _join(segments: Sequence[Segment]) -> Iterator[Segment]:
    """Yield the segments of one straight line, neighbours of the same width as one."""
    start = segments[0]
    for segment in segments[1:]:
        if segment[3] == start[3]:
            start = (start[0], start[1], segment[2], start[3])
        else:
            yield start
            start = segment
    yield start


def _greatest_width(segment: Segment, near: Sequence[Copper], placement: Placement, rules: DesignRules) -> float:
    room = 2 * (min((segment_gap(segment, copper) for copper in near), default=math.inf) - rules.clearance)
    edge = min(_edge_gap(point, placement) for point in segment[1:3])
    room = min(room, 2 * (edge - rules.edge))
    return next((width for width in WIDTHS_MM if width <= room + 1e-9), 0.0)


def _edge_gap(point: Point, placement: Placement) -> float:
    return min(point[0], point[1], placement.width - point[0], placement.height - point[1])
