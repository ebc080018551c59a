"""A circuit as data: components, pins and nets.

The netlist, schematic, layout and SPICE deck all derive from it.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace

from fingertip.board.parts.nets import UNCONNECTED

# Requirement for purchase of a resistor or a capacitor, apart from its value and package.


@dataclass(frozen=True)
class ResistorRequirement:
    tolerance_percent: float
    """Largest tolerance [%]; 0 asks for the tightest that exists."""
    power_w: float
    """Smallest rated power [W]."""
    drift_ppm_per_k: float | None = None
    """Largest temperature coefficient [ppm/K]; None if any will do."""

    @property
    def rating(self) -> str:
        """Requirement in words, for bills of materials."""
        power = f"{self.power_w:g} W"
        if self.drift_ppm_per_k is None:
            return f"{_format_tolerance(self.tolerance_percent)}, {power}"

        return f"{self.tolerance_percent:g} %, {self.drift_ppm_per_k:g} ppm/K, {power}"


@dataclass(frozen=True)
class CapacitorRequirement:
    dielectrics: tuple[str, ...]
    voltage_v: float
    """Smallest rated voltage [V]."""
    tolerance_percent: float

    @property
    def rating(self) -> str:
        return (
            f"{' or '.join(self.dielectrics)} {self.voltage_v:g} V, "
            f"{_format_tolerance(self.tolerance_percent)}"
        )


Requirement = ResistorRequirement | CapacitorRequirement


def _format_tolerance(percent: float) -> str:
    return f"{percent:g} % or better" if percent else "tightest available"


SENSOR_CONNECTOR = "J1"
SUPPLY_CONNECTOR = "J2"
HOST_CONNECTOR = "J3"
SLIP_CONNECTOR = "J4"


@dataclass(frozen=True)
class Pin:
    """Pin of a symbol, as in KiCad's library."""

    number: str
    name: str
    """Name of the pin; "~" where the library gives none."""
    electrical_type: str
    """KiCad's electrical type: passive, input, output, power_in."""


@dataclass(frozen=True)
class Symbol:
    library: str
    name: str
    description: str
    pins: tuple[Pin, ...]


@dataclass(frozen=True)
class Component:
    """Component on the board: a purchased part, a test point or a mounting hole."""

    reference: str
    value: str
    symbol: Symbol
    footprint: str
    """Footprint as library:name, of KiCad's own libraries."""
    role: str
    """Function on this board, with the article's name where that differs from the reference."""
    rating: str = ""
    """Requirements for purchase, without a manufacturer's name. Empty for what is not purchased."""
    requirement: Requirement | None = None
    """The same as data, of a resistor or a capacitor; None for what is bought by its name."""
    is_fitted: bool = True
    """False for the empty place of a finger that the hand does not have."""


Node = tuple[str, str]
"""Reference and pin number."""


@dataclass(frozen=True)
class Net:
    name: str
    nodes: tuple[Node, ...]


@dataclass(frozen=True)
class Circuit:
    """Components and nets, as `build_circuit` makes it."""

    name: str
    components: tuple[Component, ...]
    nets: tuple[Net, ...]

    @functools.cached_property
    def net_by_pin(self) -> Mapping[Node, str]:
        return {node: net.name for net in self.nets for node in net.nodes}

    def component(self, reference: str) -> Component:
        """Return the component with this reference; KeyError if there is none."""
        for component in self.components:
            if component.reference == reference:
                return component

        raise KeyError(reference)

    def list_wires(self, component: Component) -> list[tuple[str, str]]:
        """List number and net of each wired pin, in order."""
        nets = (
            (pin.number, self.net_by_pin[component.reference, pin.number])
            for pin in component.symbol.pins
        )
        return [
            (number, net)
            for number, net in nets
            if number.isdigit() and not net.startswith(UNCONNECTED)
        ]

    def without(self, *references: str) -> Circuit:
        nets = (
            Net(net.name, tuple(node for node in net.nodes if node[0] not in references))
            for net in self.nets
        )
        components = (part for part in self.components if part.reference not in references)
        return Circuit(self.name, tuple(components), tuple(nets))

    def replace(self, reference: str, value: str, symbol: Symbol | None = None) -> Circuit:
        """Return the circuit with another value, and symbol if given, of one component."""
        components = (
            replace(part, value=value, symbol=symbol or part.symbol)
            if part.reference == reference
            else part
            for part in self.components
        )
        return replace(self, components=tuple(components))

    def connect(self, component: Component, pins: Mapping[str, str]) -> Circuit:
        """Return the circuit with one more component, given as pin number -> net name."""
        nodes = {net.name: net.nodes for net in self.nets}
        for number, net in pins.items():
            nodes[net] = (*nodes.get(net, ()), (component.reference, number))

        return Circuit(
            self.name, (*self.components, component), tuple(Net(*item) for item in nodes.items())
        )


def build_circuit(name: str, wiring: Mapping[Component, Mapping[str, str]]) -> Circuit:
    """Build a circuit from pin number -> net of each component; nets as first named."""
    nodes: dict[str, list[Node]] = {}
    for component, pins in wiring.items():
        for number, net in pins.items():
            nodes.setdefault(net, []).append((component.reference, number))

    return Circuit(
        name, tuple(wiring), tuple(Net(net, tuple(members)) for net, members in nodes.items())
    )


def reference_sort_key(component: Component) -> tuple[str, int]:
    """Return the sorting key of a component: R2 comes before R10."""
    letters = component.reference.rstrip("0123456789")
    return letters, int(component.reference[len(letters) :])


_SCALES = {
    "M": 1e6,
    "k": 1e3,
    "": 1.0,
    "m": 1e-3,
    "u": 1e-6,
    "n": 1e-9,
    "p": 1e-12,
}


def format_component_value(value: float) -> str:
    """Format a value with an SI prefix, ten digits at most: 4700 -> "4.7k", 2.2e-6 -> "2.2u"."""
    prefix = next((name for name, scale in _SCALES.items() if value >= scale * (1 - 1e-12)), "p")
    return f"{value / _SCALES[prefix]:.10g}{prefix}"


def parse_component_value(text: str) -> float:
    """Parse a component value [ohm or F]: "4.7k" -> 4700, "2.2u" -> 2.2e-6."""
    return float(text[:-1]) * _SCALES[text[-1]] if text[-1] in _SCALES else float(text)
