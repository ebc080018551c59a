"""Mating parts of a board: the plug of each connector, its contacts or finished leads, and the wires they take.

Numbers are copied from the sources that stand beside them, as those of the other parts are.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.board.parts.circuit import Circuit, Component
from fingertip.board.parts.table import Part, read_rows

_PER_CONNECTOR, _PER_WIRE, _PER_TWO_WIRES = "connector", "wire", "two wires"


@dataclass(frozen=True)
class MatingPart:
    """Part that a person buys for the cable of one connector."""

    item: str
    per: str
    """Use of one of them: for the connector, for each of its wires, or for two of them."""
    part: Part | None
    reason: str
    """Reason why there is no part."""

    def count(self, wires: int) -> int:
        """Count how many a cable of so many wires takes."""
        return {_PER_CONNECTOR: 1, _PER_WIRE: wires, _PER_TWO_WIRES: (wires + 1) // 2}[self.per]


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
            f"AWG {self.min_awg} to {self.max_awg} with {self.min_insulation_mm:g} to {self.max_insulation_mm:g} mm "
            "over the insulation"
        )

    def describe_common(self, max_diameter_mm: float, thickest_awg: int) -> str:
        """Describe which of these wires pass a hole too."""
        thickest, widest = max(self.min_awg, thickest_awg), min(self.max_insulation_mm, max_diameter_mm)
        if thickest > self.max_awg or widest < self.min_insulation_mm:
            return "none of them fits the finger, so solder thinner ones to leads of the plug"
        if (thickest, widest) == (self.min_awg, self.max_insulation_mm):
            return "all of them fit the finger"
        gauge = f"AWG {thickest} to {self.max_awg}" if thickest < self.max_awg else f"AWG {thickest}"
        return f"of them, {gauge} with at most {widest:g} mm fit the finger"


def list_mating_parts(component: Component) -> tuple[MatingPart, ...]:
    """List what to buy for the cable of a connector."""
    name = component.footprint.split(":")[1]
    return tuple(mating for footprint, mating in _load_mating_parts() if footprint == name)


def find_plug_wire(component: Component) -> PlugWire | None:
    """Find the wires that the plug of a connector takes; None for pin headers, of which no maker is named."""
    name = component.footprint.split(":")[1]
    return next((wire for prefix, wire in _load_plug_wires() if name.startswith(prefix)), None)


def count_wires(component: Component) -> int:
    """Count the pins that a wire leads to: all but those that only hold the connector."""
    return sum(pin.number.isdigit() for pin in component.symbol.pins)


def list_connectors(circuit: Circuit) -> Iterator[Component]:
    """Yield the connectors of a board in order."""
    yield from sorted((c for c in circuit.components if c.reference.startswith("J")), key=lambda c: c.reference)


def group_plug_wires(circuit: Circuit) -> dict[PlugWire, list[str]]:
    """Group the connectors by the wires that their plugs take; those of which no plug is named are left out."""
    found: dict[PlugWire, list[str]] = {}
    for connector in list_connectors(circuit):
        if wire := find_plug_wire(connector):
            found.setdefault(wire, []).append(connector.reference)
    return found


@functools.cache
def _load_mating_parts() -> tuple[tuple[str, MatingPart], ...]:
    return tuple(
        (
            row["footprint"],
            MatingPart(
                row["item"],
                row["per"],
                Part(row["manufacturer"], row["number"], row["lcsc"], row["source"]) if row["number"] else None,
                row["reason"],
            ),
        )
        for row in read_rows("mating_parts.csv")
    )


@functools.cache
def _load_plug_wires() -> tuple[tuple[str, PlugWire], ...]:
    return tuple(
        (
            row["footprint_prefix"],
            PlugWire(
                row["series"],
                int(row["min_awg"]),
                int(row["max_awg"]),
                float(row["min_insulation_mm"]),
                float(row["max_insulation_mm"]),
                row["source"],
            ),
        )
        for row in read_rows("plug_wires.csv")
    )
