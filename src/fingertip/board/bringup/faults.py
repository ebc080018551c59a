"""Faults of single parts: what goes wrong when a board is soldered, each as a changed circuit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from fingertip.board.circuit import Circuit, Component, Net, parse_component_value
from fingertip.board.kicad.symbols import RESISTOR
from fingertip.board.network import list_amplifiers

_OPEN_OHM, _SHORT_OHM = "1e10", "1e-2"
_OPEN_FARAD = "1e-16"
_WRONG_VALUES = ((0.1, "a tenth of its value"), (0.5, "half its value"), (2.0, "twice its value"), (10.0, "ten times"))


@dataclass(frozen=True)
class Fault:
    """Fault of one part."""

    reference: str
    """Reference of the part; empty for a board without a fault."""
    description: str
    circuit: Circuit
    rarity: int = 0
    """Rank by how rare the fault is: 0 not soldered or reversed, 1 bridged, 2 a wrong value, 3 a whole amplifier. An
    assumption, which only orders what the readings do not tell apart."""
    stuck_v: dict[str, float] = field(default_factory=dict)
    """Nets that an amplifier's output holds at a voltage [V]."""

    @property
    def sentence(self) -> str:
        """The part and what is wrong with it."""
        return f"{self.reference} {self.description}"


def list_faults(circuit: Circuit, ends_v: Mapping[str, tuple[float, float]]) -> Iterator[Fault]:
    """Yield the faults of a circuit, one part at a time.

    Parameters
    ----------
    circuit
        The circuit without a fault.
    ends_v
        Ends of the swing of each measured output of an amplifier above ground [V], by its net.
    """
    for component in circuit.components:
        if component.symbol.name in ("R", "C"):
            yield from _list_passive_faults(circuit, component)
        elif component.symbol.name == "1N4148W":
            yield from _list_diode_faults(circuit, component)
    for output in list_amplifiers(circuit):
        if output.net in ends_v:
            for volts, end in zip(ends_v[output.net], ("lowest", "highest"), strict=True):
                what = f"holds {output.net} at its {end} voltage: rotated, not soldered, or with bridged pins"
                yield Fault(output.reference, what, circuit, 3, {output.net: volts})


def _list_passive_faults(circuit: Circuit, part: Component) -> Iterator[Fault]:
    reference, is_resistor = part.reference, part.symbol.name == "R"
    value = parse_component_value(part.value)
    opened = circuit.replace(reference, _OPEN_OHM if is_resistor else _OPEN_FARAD)
    yield Fault(reference, "is open: not soldered, or cracked", opened)
    yield Fault(reference, "is bridged", _replace(circuit, replace(part, symbol=RESISTOR, value=_SHORT_OHM)), 1)
    for factor, description in _WRONG_VALUES:
        yield Fault(reference, f"has {description}", circuit.replace(reference, f"{factor * value:.10g}"), 2)


def _list_diode_faults(circuit: Circuit, part: Component) -> Iterator[Fault]:
    swapped = {(part.reference, "1"): (part.reference, "2"), (part.reference, "2"): (part.reference, "1")}
    nets = tuple(Net(net.name, tuple(swapped.get(node, node) for node in net.nodes)) for net in circuit.nets)
    yield Fault(part.reference, "is reversed", Circuit(circuit.name, circuit.components, nets))
    yield Fault(part.reference, "is open: not soldered", circuit.without(part.reference))
    yield Fault(part.reference, "is bridged", _replace(circuit, replace(part, symbol=RESISTOR, value=_SHORT_OHM)), 1)


def _replace(circuit: Circuit, part: Component) -> Circuit:
    components = tuple(part if c.reference == part.reference else c for c in circuit.components)
    return Circuit(circuit.name, components, circuit.nets)
