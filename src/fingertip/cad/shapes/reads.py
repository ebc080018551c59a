"""Parameters that the shape of each part and bought item reads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from fingertip.cad.shapes.parts import hardware, parts_by_name
from fingertip.design import Design
from fingertip.design.rules.ruleset import RecordingTables

_HARDWARE_OF = (("bone",), ("mold_dorsal",), ("mold_palmar", "mold_dorsal"))
"""Parts whose hardware is made apart, so that each item is blamed for little more than it reads itself."""


def parameters_of_shapes(design: Design) -> dict[str, frozenset[str]]:
    """Find the parameters that the shape of each part and bought item reads, by the item's name.

    They are recorded while the shape is made, so a parameter that this design does not use is in none of the sets.
    """
    found: dict[str, frozenset[str]] = {}
    for name, part in parts_by_name(design).items():
        recorder = RecordingTables(design)
        part.solid(cast(Design, recorder))
        found[name] = frozenset(recorder.reads)
    for parts in _HARDWARE_OF:
        recorder = RecordingTables(design)
        for item in hardware(cast(Design, recorder), parts):
            found.setdefault(item.name, frozenset(recorder.reads))
    return found


def shapes_of_parameters(design: Design) -> Mapping[str, tuple[str, ...]]:
    """Find the items whose shape reads each parameter, by its name; parameters that move nothing are left out."""
    moved: dict[str, list[str]] = {}
    for item, parameters in parameters_of_shapes(design).items():
        for parameter in sorted(parameters):
            moved.setdefault(parameter, []).append(item)
    return {parameter: tuple(items) for parameter, items in moved.items()}
