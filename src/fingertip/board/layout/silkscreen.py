"""Silkscreen of a board as boxes [mm]: references and texts must not cover components, vias or one another."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import combinations

from fingertip.board.circuit import Circuit, Component
from fingertip.board.kicad.footprints import FOOTPRINTS, PIN_1_DOT_MM, Box, Point
from fingertip.board.layout.placement import Placement, rotate_offset

TEXT_HEIGHT_MM = 0.8
"""Height of a capital letter; the usual minimum for legible silkscreen."""
_ADVANCE_RATIO = 0.92
"""Width of the widest character relative to the text height."""
_EDGE_CLEARANCE_MM = 0.3
_TEXT_EDGE_CLEARANCE_MM = 0.15
"""Clearance of texts from the edge. It is smaller because single letters must fit beside J3."""
_LABEL_CLEARANCE_MM = 0.25
"""Clearance between two labels side by side."""


def silkscreen_boxes(placement: Placement) -> dict[str, Box]:
    """Boxes of the printed references, by reference, and of the texts, by number ("text 1")."""
    boxes = {reference: _box(x, y, *_text_size(reference)) for reference, (x, y) in placement.reference_labels.items()}
    boxes |= {f"text {i}": _box(x, y, *_text_size(t)) for i, (t, x, y) in enumerate(placement.texts, start=1)}
    return boxes


def silkscreen_conflicts(
    circuit: Circuit, placement: Placement, vias: Iterable[Point] = (), via_mm: float = 0.0
) -> Iterator[str]:
    """Describe silkscreen that cannot be read: missing references, and labels that overlap something or the edge."""
    labelled = [component.reference for component in circuit.components if component.symbol.pins]
    yield from (f"{ref} has no label on the board" for ref in labelled if ref not in placement.reference_labels)
    labels = silkscreen_boxes(placement)
    obstacles = {
        f"component {component.reference}": _component_box(circuit, placement, component.reference)
        for component in circuit.components
    }
    obstacles |= {
        f"the pin 1 dot of {component.reference}": box
        for component in circuit.components
        for box in _pin_1_dot_box(placement, component)
    }
    obstacles |= {f"via {i}": _box(x, y, via_mm, via_mm) for i, (x, y) in enumerate(vias, start=1)}
    for name, box in labels.items():
        left, top, right, bottom = box
        gap = min(left, top, placement.width - right, placement.height - bottom)
        if gap < (_TEXT_EDGE_CLEARANCE_MM if name.startswith("text") else _EDGE_CLEARANCE_MM):
            yield f"{name} is too close to the edge"
        yield from (f"{name} overlaps {other}" for other, obstacle in obstacles.items() if _overlap(box, obstacle))
    for (one, a), (two, b) in combinations(labels.items(), 2):
        if _overlap((a[0] - _LABEL_CLEARANCE_MM, a[1], a[2] + _LABEL_CLEARANCE_MM, a[3]), b):
            yield f"{one} overlaps or nearly touches {two}"


def _text_size(text: str) -> Point:
    return (len(text) * TEXT_HEIGHT_MM * _ADVANCE_RATIO, TEXT_HEIGHT_MM * 1.25)


def _box(x: float, y: float, width: float, height: float) -> Box:
    return (x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def _component_box(circuit: Circuit, placement: Placement, reference: str) -> Box:
    """Box around the pads, the silkscreen and the body of a component on the board."""
    footprint = FOOTPRINTS[circuit.component(reference).footprint]
    position = placement.positions[reference]
    points = [
        (p.x + sx * p.width / 2, p.y + sy * p.height / 2) for p in footprint.pads for sx in (-1, 1) for sy in (-1, 1)
    ]
    points += [(x, y) for line in footprint.silkscreen for x, y in line]
    points += [(x, y) for x in footprint.body[::2] for y in footprint.body[1::2]]
    xs, ys = zip(*(rotate_offset(position.angle, x, y) for x, y in points), strict=True)
    return (
        position.x + min(xs) - 0.1,
        position.y + min(ys) - 0.1,
        position.x + max(xs) + 0.1,
        position.y + max(ys) + 0.1,
    )


def _pin_1_dot_box(placement: Placement, component: Component) -> Iterator[Box]:
    """Yield the box of the dot beside pin 1, if the component has one."""
    if dot := FOOTPRINTS[component.footprint].pin_1_dot:
        position = placement.positions[component.reference]
        x, y = rotate_offset(position.angle, *dot)
        yield _box(position.x + x, position.y + y, PIN_1_DOT_MM + 0.2, PIN_1_DOT_MM + 0.2)


def _overlap(a: Box, b: Box) -> bool:
    return min(a[2], b[2]) > max(a[0], b[0]) and min(a[3], b[3]) > max(a[1], b[1])
