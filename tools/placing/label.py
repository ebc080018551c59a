"""Labels of resistors and capacitors: printed on the front where there is room beside the routed vias."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from fingertip.board.kicad.footprints import Box, Point
from fingertip.board.kicad.placement import Label, Placement
from fingertip.board.kicad.silkscreen import (
    EDGE_CLEARANCE_MM,
    LABEL_CLEARANCE_MM,
    box_distance,
    label_box,
    label_places,
    silkscreen_boxes,
    silkscreen_obstacles,
)
from fingertip.board.parts.circuit import Circuit

_STRANGER_MM = 0.1
"""Distance by which a label is farther from other components than from its own, which it touches."""


def add_labels(circuit: Circuit, placement: Placement, vias: Iterable[Point], via_mm: float) -> Placement:
    """Add labels of other components, those with the fewest places first, each where it hinders the fewest others."""
    obstacles = silkscreen_obstacles(circuit, placement)
    via_boxes = [(x - via_mm / 2, y - via_mm / 2, x + via_mm / 2, y + via_mm / 2) for x, y in vias]
    taken = [*via_boxes, *(_grow(box, LABEL_CLEARANCE_MM) for box in silkscreen_boxes(placement).values())]
    open_places: dict[str, list[Label]] = {}
    for component in circuit.components:
        name = component.reference
        if not component.symbol.pins or name in placement.reference_labels:
            continue
        others = [_grow(box, _STRANGER_MM) for other, box in obstacles.items() if other != name]
        open_places[name] = [
            label
            for label in (Label(round(x, 3), round(y, 3), angle) for x, y, angle in label_places(name, obstacles[name]))
            if _is_inside(label_box(name, label), placement)
            and not any(_overlaps(label_box(name, label), box) for box in (*others, *taken))
        ]
    labels = dict(placement.reference_labels)
    while candidates := {name: places for name, places in open_places.items() if places}:
        name = min(candidates, key=lambda name: (len(candidates[name]), name))

        def hindered(label: Label, name: str = name) -> int:
            box = _grow(label_box(name, label), LABEL_CLEARANCE_MM)
            return sum(
                _overlaps(box, label_box(other, place))
                for other, places in candidates.items()
                if other != name
                for place in places
            )

        labels[name] = min(candidates[name], key=hindered)
        box = _grow(label_box(name, labels[name]), LABEL_CLEARANCE_MM)
        open_places = {
            other: [place for place in places if not _overlaps(box, label_box(other, place))]
            for other, places in candidates.items()
            if other != name
        }
    return replace(placement, reference_labels=labels)


def _is_inside(box: Box, placement: Placement) -> bool:
    return min(box[0], box[1], placement.width - box[2], placement.height - box[3]) >= EDGE_CLEARANCE_MM


def _grow(box: Box, margin: float) -> Box:
    return (box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin)


def _overlaps(a: Box, b: Box) -> bool:
    return box_distance(a, b) == 0.0 and min(a[2], b[2]) > max(a[0], b[0]) and min(a[3], b[3]) > max(a[1], b[1])
