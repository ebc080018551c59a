"""Sheet of a schematic as data: positions of symbols, wires and labels. Units of 1.27 mm, with the y axis down."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

from fingertip.board.nets import VEE, VMID, VREF
from fingertip.board.supplies import Supply

UNIT_MM = 1.27
"""Half the pitch of the grid that KiCad's pins lie on."""

SGND, VNEG, VBRIDGE = "SGND", "VNEG", "VBRIDGE"
"""Placeholders for the signal ground, the negative rail of the amplifiers and the supply of the bridge; `apply_supply`
replaces them."""

Point = tuple[float, float]
Segment = tuple[Point, Point]


@dataclass(frozen=True)
class PlacedSymbol:
    """Symbol of a component, or one unit of it, on the sheet."""

    reference: str
    x: int
    y: int
    angle: int = 0
    """Anticlockwise rotation [degree]: 0, 90, 180 or 270."""
    unit: int = 1
    mirrored: bool = False
    """True if left and right are exchanged; only with angle 0."""


@dataclass(frozen=True)
class PowerSymbol:
    """Power symbol (GND, VCC or VEE), PWR_FLAG, or placeholder (SGND, VNEG or VBRIDGE)."""

    name: str
    x: int
    y: int
    angle: int = 0


@dataclass(frozen=True)
class Label:
    """Name of a net on a wire. With an angle of 180 the text runs to the left of the point."""

    net: str
    x: int
    y: int
    angle: int = 0


@dataclass(frozen=True)
class GlobalLabel:
    """Name of a net in a flag that points in the direction `angle` [degree]. It connects all sheets."""

    net: str
    x: int
    y: int
    angle: int = 0


@dataclass(frozen=True)
class Sheet:
    """Sheet of a schematic, or a block of it."""

    symbols: tuple[PlacedSymbol, ...] = ()
    wires: tuple[tuple[Point, ...], ...] = ()
    """Polylines of horizontal and vertical segments."""
    power_symbols: tuple[PowerSymbol, ...] = ()
    labels: tuple[Label, ...] = ()
    texts: tuple[tuple[str, int, int], ...] = ()
    """Texts with their positions."""
    global_labels: tuple[GlobalLabel, ...] = ()

    def segments(self, pins: Iterable[Point]) -> list[Segment]:
        """Segments of the wires, split where another wire ends or a pin lies on them, as KiCad requires."""
        unsplit = [(a, b) for wire in self.wires for a, b in pairwise(wire) if a != b]
        split_points = {point for segment in unsplit for point in segment} | set(pins)
        split_points |= {(symbol.x, symbol.y) for symbol in self.power_symbols}
        split: list[Segment] = []
        for a, b in unsplit:
            inner = sorted(
                (c for c in split_points if _lies_between(a, c, b)), key=lambda c: abs(c[0] - a[0]) + abs(c[1] - a[1])
            )
            split += list(pairwise([a, *inner, b]))
        return split


def join_blocks(*blocks: Sheet) -> Sheet:
    """Join several blocks to one sheet."""
    return Sheet(
        symbols=tuple(item for block in blocks for item in block.symbols),
        wires=tuple(item for block in blocks for item in block.wires),
        power_symbols=tuple(item for block in blocks for item in block.power_symbols),
        labels=tuple(item for block in blocks for item in block.labels),
        texts=tuple(item for block in blocks for item in block.texts),
        global_labels=tuple(item for block in blocks for item in block.global_labels),
    )


def apply_supply(sheet: Sheet, supply: Supply) -> Sheet:
    """Replace the placeholders SGND, VNEG and VBRIDGE by the symbols and global labels of a supply.

    A global label for SGND points down, or up for a placeholder with an angle of 180, or right for one of 90. One for
    VBRIDGE points up.
    """
    power_symbols, global_labels = [], list(sheet.global_labels)
    for symbol in sheet.power_symbols:
        placeholders = {SGND: supply.signal_ground, VNEG: supply.negative_rail, VBRIDGE: supply.bridge_supply}
        net = placeholders.get(symbol.name, symbol.name)
        if net == VMID:
            global_labels.append(GlobalLabel(net, symbol.x, symbol.y, {0: 270, 90: 0, 180: 90}[symbol.angle]))
        elif net == VREF:
            global_labels.append(GlobalLabel(net, symbol.x, symbol.y, 90))
        elif symbol.name == VNEG:
            power_symbols.append(PowerSymbol(net, symbol.x, symbol.y, 180 if net == VEE else 0))
        else:
            power_symbols.append(replace(symbol, name=net, angle=0 if symbol.angle == 90 else symbol.angle))
    return replace(sheet, power_symbols=tuple(power_symbols), global_labels=tuple(global_labels))


def _lies_between(a: Point, c: Point, b: Point) -> bool:
    """Return whether c lies inside the horizontal or vertical segment from a to b."""
    if a[0] == b[0] == c[0]:
        return min(a[1], b[1]) < c[1] < max(a[1], b[1])
    return a[1] == b[1] == c[1] and min(a[0], b[0]) < c[0] < max(a[0], b[0])
