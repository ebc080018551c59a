"""A circuit as data: parts, pins, nets. Everything that leaves for KiCad is written from this alone."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from fingertip.errors import BoardError, Issue

_REFERENCE = re.compile(r"[A-Za-z]+[1-9][0-9]*")


@dataclass(frozen=True)
class Pin:
    """A pin of a symbol, as KiCad's library has it."""

    number: str
    name: str
    """"~" where the library gives none."""
    kind: str
    """KiCad's electrical type: passive, input, output, power_in."""


@dataclass(frozen=True)
class Symbol:
    """A symbol of KiCad's own libraries."""

    library: str
    name: str
    description: str
    pins: tuple[Pin, ...]


@dataclass(frozen=True)
class Part:
    """One part on the board."""

    reference: str
    value: str
    symbol: Symbol
    footprint: str
    """library:name, of KiCad's own libraries."""
    role: str
    """What it does here, in words; with the article's name where that differs from the reference."""
    rating: str = ""
    """What to look for when buying it, no maker's name; empty for what is not bought."""


RAILS = ("GND", "VCC", "VEE")
"""Nets that power symbols name in a schematic."""


GLOBALS = (*RAILS, "VMID")
"""Nets that are the same on all sheets: the rails, and what a global label names."""


def kicad_name(net: str) -> str:
    """A net as KiCad names it: labels on a sheet get the sheet's path, which is "/" here; power symbols do not."""
    return net if net in GLOBALS else f"/{net}"


Node = tuple[str, str]
"""Reference and pin number."""


@dataclass(frozen=True)
class Net:
    """Pins that are connected."""

    name: str
    nodes: tuple[Node, ...]


@dataclass(frozen=True)
class Circuit:
    """Parts and nets. Construct it with `connected`, which checks it."""

    name: str
    parts: tuple[Part, ...]
    nets: tuple[Net, ...]

    def part(self, reference: str) -> Part:
        """The part of this reference; KeyError if there is none."""
        for part in self.parts:
            if part.reference == reference:
                return part
        raise KeyError(reference)


def connected(name: str, wiring: Mapping[Part, Mapping[str, str]]) -> Circuit:
    """A checked circuit from each part's wiring, pin number -> net name; nets come in the order first named.

    Raises
    ------
    BoardError
        With every issue `issues` finds.
    """
    nodes: dict[str, list[Node]] = {}
    for part, pins in wiring.items():
        for number, net in pins.items():
            nodes.setdefault(net, []).append((part.reference, number))
    circuit = Circuit(name, tuple(wiring), tuple(Net(net, tuple(found)) for net, found in nodes.items()))
    if found := list(issues(circuit)):
        raise BoardError(found)
    return circuit


def issues(circuit: Circuit) -> Iterator[Issue]:
    """What is inconsistent: doubled references, unknown pins, pins in two nets or none, nets of one pin."""
    for reference, count in Counter(part.reference for part in circuit.parts).items():
        if count > 1:
            yield Issue(reference, f"names {count} parts; give each its own reference.")
        if not _REFERENCE.fullmatch(reference):
            yield Issue(reference, "is not letters and a number, such as R6; KiCad would number it anew.")
    for name, count in Counter(net.name for net in circuit.nets).items():
        if count > 1:
            yield Issue(name, f"names {count} nets; KiCad would join them.")

    known = {(part.reference, pin.number) for part in circuit.parts for pin in part.symbol.pins}
    uses = Counter(node for net in circuit.nets for node in net.nodes)
    for net in circuit.nets:
        if len(set(net.nodes)) < 2:
            yield Issue(net.name, f"connects {len(set(net.nodes))} pin; a net needs two at least.")
    for (reference, number), count in uses.items():
        if (reference, number) not in known:
            yield Issue(f"{reference}.{number}", "is connected, but there is no such part or pin.")
        if count > 1:
            yield Issue(f"{reference}.{number}", f"is connected {count} times; a pin lies in one net.")
    for reference, number in sorted(known - set(uses)):
        yield Issue(f"{reference}.{number}", "is not connected; connect it or take the part out.")


def by_reference(part: Part) -> tuple[str, int]:
    """Sorting key: R2 before R10."""
    letters = part.reference.rstrip("0123456789")
    return letters, int(part.reference[len(letters) :])


def engineering(value: float, unit: str = "") -> str:
    """A part's value as a schematic prints it: 4700 -> "4.7k", 2.2e-6 -> "2.2u"; ten digits at most."""
    for prefix, scale in (("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("u", 1e-6), ("n", 1e-9)):
        if value >= scale * (1 - 1e-12):
            return f"{value / scale:.10g}{prefix}{unit}"
    return f"{value / 1e-12:.10g}p{unit}"


def farads_or_ohms(text: str) -> float:
    """The number of a printed value: "4.7k" -> 4700, "2.2u" -> 2.2e-6."""
    scales = {"M": 1e6, "k": 1e3, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12}
    return float(text[:-1]) * scales[text[-1]] if text[-1] in scales else float(text)
