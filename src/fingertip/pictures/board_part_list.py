"""List of what to place on a board, beside its assembly drawing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from fingertip.board.circuits.channels import split_name
from fingertip.board.fabrication.bom import BomLine, list_bom
from fingertip.board.parts.circuit import Circuit, Component
from fingertip.pictures.board_sheet import SheetBox
from fingertip.pictures.drawing.primitives import Primitive, Style, Text

_ROW_MM = 4.6
"""Distance of two rows."""
_TEXT_MM = 2.0
"""Height of a capital, and of the box to tick."""
_COUNT_MM = 4.0
"""Distance of the numbers of parts from the left edge of the list."""
_VALUE_MM = 10.0
"""Distance of values and packages from the left edge of the list."""
_REFERENCES_MM = 33.0
"""Distance of references from the left edge of the list."""
_TICK_BOX = Style("part", 0.2)
"""Line around the box to tick."""


def is_chip(part: Component) -> bool:
    """Return whether a part is a resistor or capacitor, which goes in either way."""
    return part.symbol.name in ("R", "C")


def describe_value(part: Component) -> str:
    """Write a value, with R behind ohms: a part marked 100 has 10 ohm, one of 100 ohm 101."""
    is_in_ohms = part.symbol.name == "R" and part.value[-1].isdigit()
    return f"{part.value}R" if is_in_ohms else part.value


def draw_part_list(circuit: Circuit, left: float, top: float) -> Iterator[Primitive]:
    """List what to place: a box to tick, number of parts, value, package and references.

    `left` and `top` are the edges of the list on the sheet [mm].
    """
    fingers = _count_fingers(circuit)
    for row, bom_line in enumerate(list_bom(circuit), 1):
        y = top - row * _ROW_MM
        value = describe_value(bom_line.components[0])
        value_and_package = f"{value} {_describe_package(bom_line)}".strip()
        references = _describe_references(bom_line.references, fingers)

        yield SheetBox(left, y, left + _TEXT_MM, y + _TEXT_MM).outline(_TICK_BOX)
        yield Text(f"{len(bom_line.components)} x", (left + _COUNT_MM, y), _TEXT_MM)
        yield Text(value_and_package, (left + _VALUE_MM, y), _TEXT_MM)
        yield Text(references, (left + _REFERENCES_MM, y), _TEXT_MM)


def _count_fingers(circuit: Circuit) -> int:
    """Return the number of fingers that have parts of their own; 0 on a board for one finger."""
    channels = [split_name(part.reference)[0] for part in circuit.components if part.is_fitted]
    return max(channels)


def _describe_package(bom_line: BomLine) -> str:
    """Return the package of chips and the series of connectors; empty for other parts."""
    words = bom_line.footprint.split("_")
    if is_chip(bom_line.components[0]):
        return words[1]
    if bom_line.footprint.startswith("JST"):
        return " ".join(words[:2])

    return ""


def _describe_references(references: list[str], fingers: int) -> str:
    """List references; where each finger has the same parts, only those of the first finger."""
    channels = [split_name(reference)[0] for reference in references]
    parts_of_finger = Counter(channel for channel in channels if channel)
    is_at_each_finger = len(parts_of_finger) == fingers and fingers > 1
    if not is_at_each_finger or len(set(parts_of_finger.values())) > 1:
        return " ".join(references)

    shared_or_first = [
        reference for reference, channel in zip(references, channels, strict=True) if channel <= 1
    ]
    return " ".join(shared_or_first) + "; the same at each finger"
