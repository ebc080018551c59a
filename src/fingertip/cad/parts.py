"""Parts of a design that have an exact solid, and what parameters shape each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from fingertip.design import Design
from fingertip.design.rules.ruleset import record_reads
from fingertip.models.hardware import hardware
from fingertip.models.parts import parts_by_name


def exact_parts(design: Design, names: Iterable[str]) -> tuple[str, ...]:
    """List the parts with an exact solid: a bone with an adapter of an STL file has none."""
    is_mesh = design.bone.interface == "file" and not design.read_adapter().brep
    return tuple(name for name in names if name != "bone" or not is_mesh)


def shapes_of_parameters(design: Design) -> Mapping[str, tuple[str, ...]]:
    """Find the parts and bought items whose shape reads each parameter, by its name.

    What is read is recorded while a shape is made: a parameter that this design does not use moves
    nothing, and is left out.
    """
    moved: dict[str, tuple[str, ...]] = {}

    def add(name: str, reads: Iterable[str]) -> None:
        moved.update({parameter: (*moved.get(parameter, ()), name) for parameter in sorted(reads)})

    for name, part in parts_by_name(design).items():
        tables, reads = record_reads(design)
        part.solid(tables)
        add(name, reads)

    tables, reads = record_reads(design)
    for item in hardware(tables, ("bone",)):
        add(item.name, reads)

    return moved
