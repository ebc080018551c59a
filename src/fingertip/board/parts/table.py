"""Parts table of the package: resistors, capacitors, named parts, mating parts, sources.

Every number is copied from the source that is named beside it. Nothing here can tell what is in
stock.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal

from fingertip.board.parts.circuit import Circuit, Component, reference_sort_key
from fingertip.foundation import tables
from fingertip.foundation.tables import Row

FOLDER = Path(__file__).parent

PRICES = {"a": (0.0, 0.05), "b": (0.05, 0.5), "c": (0.5, 5.0)}
"""Price of one piece [US dollar] by class: estimates of November 2026."""
UNCONFIRMED = "confirm before ordering"
BASIC_SOURCE = "kicad_library"
"""Key of the document that lists the house's basic and preferred parts."""


@dataclass(frozen=True)
class Source:
    """Document from which numbers were copied."""

    key: str
    title: str
    date: str
    """Date of the document, or on which it was read where it bears none."""
    address: str
    """Address of the document, or of the part's page that it names; empty if neither was stated."""


@dataclass(frozen=True)
class Part:
    manufacturer: str
    """Name of the manufacturer; empty where the source names none."""
    number: str
    lcsc: str
    """Number at the distributor LCSC and the assembly house; empty if no source gives it."""
    price: str
    """Class of `PRICES`."""
    sources: tuple[str, ...]
    """Keys of the documents that give these numbers, each by another author."""

    @property
    def source_text(self) -> str:
        sources = (load_sources()[key] for key in self.sources)
        return "; ".join(f"{source.title} ({source.date})" for source in sources)


_PART = tuple(field.name for field in fields(Part))


@dataclass(frozen=True)
class ChipResistor:
    ohm: float
    tolerance_percent: float
    drift_ppm_per_k: float
    power_w: float
    package: str
    """Size by its inch code, such as 0603."""
    part: Part


@dataclass(frozen=True)
class ChipCapacitor:
    farad: float
    dielectric: str
    voltage_v: float
    tolerance_percent: float
    package: str
    part: Part


@dataclass(frozen=True)
class NamedPart:
    """Part that is bought by its name: a semiconductor, a connector or a trimmer."""

    value: str
    footprint: str
    part: Part | None
    reason: str


@functools.cache
def load_sources() -> dict[str, Source]:
    return {source.key: source for source in load_table(Source, "sources.csv")}


def read_rows(name: str) -> Iterator[dict[str, str]]:
    """Read the rows of one of the table's files, each by column."""
    return tables.read_rows(FOLDER / name)


def load_table(kind: type[Row], name: str) -> tuple[Row, ...]:
    """Load the rows of one of the table's files once.

    Of several that fit, the first is to be preferred.
    """
    return _load_table(kind, name)  # type: ignore[arg-type]  # mypy takes no class for hashable


@functools.cache
def _load_table(kind: type[Any], name: str) -> tuple[Any, ...]:
    """Load rows whose columns are the fields; five of them make the field `part`."""

    def join(row: dict[str, Any]) -> dict[str, Any]:
        if "number" in row:
            part = {column: row.pop(column) for column in _PART}
            row["part"] = tables.load_table(Part, [part])[0] if part["number"] else None

        return row

    return tables.load_table(kind, map(join, read_rows(name)))


# Mating parts: the plug of each connector, its contacts or finished leads, and the wires they take.


@dataclass(frozen=True)
class MatingPart:
    """Part that a person buys for the cable of one connector."""

    footprint: str
    kind: Literal["plug", "contact", "leads", "cable", "socket"]
    choice: Literal["", "either:", "or:", "or"]
    """Words before the item where another one does too."""
    item: str
    per: str
    """Use of one of them: for the connector, for each of its wires, or for two of them."""
    part: Part | None
    reason: str

    def count(self, wires: int) -> int:
        """Count how many a cable of so many wires takes."""
        return {"connector": 1, "wire": wires, "two wires": (wires + 1) // 2}[self.per]


@dataclass(frozen=True)
class PlugWire:
    """Wires that the contacts of a plug take. A larger gauge number is a thinner conductor."""

    series: str
    """Maker and series of the plug."""
    min_awg: int
    max_awg: int
    min_insulation_mm: float
    """Smallest and largest diameter over the insulation."""
    max_insulation_mm: float
    source: str

    @property
    def description(self) -> str:
        """Gauge and diameter as text."""
        return (
            f"AWG {self.min_awg} to {self.max_awg} with {self.min_insulation_mm:g} to "
            f"{self.max_insulation_mm:g} mm "
            "over the insulation"
        )


def list_mating_parts(component: Component) -> tuple[MatingPart, ...]:
    """List what to buy for the cable of a connector."""
    name = component.footprint.split(":")[1]
    return tuple(
        mating for mating in load_table(MatingPart, "mating_parts.csv") if mating.footprint == name
    )


def find_plug_wire(component: Component) -> PlugWire | None:
    """Return the wires that a connector's plug takes; None for pin headers."""
    name = component.footprint.split(":")[1].replace("_", " ")
    return next(
        (
            wire
            for wire in load_table(PlugWire, "plug_wires.csv")
            if name.startswith(f"{wire.series} ")
        ),
        None,
    )


def list_connectors(circuit: Circuit) -> Iterator[Component]:
    connectors = (
        part for part in circuit.components if part.reference.startswith("J") and part.is_fitted
    )
    yield from sorted(connectors, key=reference_sort_key)


def group_plug_wires(circuit: Circuit) -> dict[PlugWire, list[str]]:
    """Group the connectors by the wires that their plugs take; others are left out."""
    groups: dict[PlugWire, list[str]] = {}
    for connector in list_connectors(circuit):
        wire = find_plug_wire(connector)
        if wire:
            groups.setdefault(wire, []).append(connector.reference)

    return groups
