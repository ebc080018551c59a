"""Sheets of the board variants as data: positions of symbols, wires and labels, and the graphics of the symbols.

A sheet shows the signal from left to right, in rows, with the supply below; its units are 1.27 mm, the y axis is down.
`schematic_blocks.json` holds the blocks that do not depend on the supply. `symbol_graphics.json` holds the graphics of
each unit of a symbol in mm, with the y axis up, as in KiCad's libraries. Pins lie exactly where these have them, so
that the symbols can be updated from them; a test compares them with KiCad 9. The lines are drawn here.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from fingertip.board.components.values import Supply
from fingertip.board.parts.circuit import VEE, VMID, VREF

_FOLDER = Path(__file__).parent
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
    """Name of a net on a wire, or in a flag, which connects all sheets.

    On a wire, with an angle of 180 the text runs to the left of the point. A flag points in the direction `angle`
    [degree].
    """

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
    global_labels: tuple[Label, ...] = ()
    """Names of nets in flags."""

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
    return Sheet(**{field.name: sum((getattr(block, field.name) for block in blocks), ()) for field in fields(Sheet)})


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
            global_labels.append(Label(net, symbol.x, symbol.y, {0: 270, 90: 0, 180: 90}[symbol.angle]))
        elif net == VREF:
            global_labels.append(Label(net, symbol.x, symbol.y, 90))
        elif symbol.name == VNEG:
            power_symbols.append(PowerSymbol(net, symbol.x, symbol.y, 180 if net == VEE else 0))
        else:
            power_symbols.append(replace(symbol, name=net, angle=0 if symbol.angle == 90 else symbol.angle))
    return replace(sheet, power_symbols=tuple(power_symbols), global_labels=tuple(global_labels))


def _lies_between(a: Point, c: Point, b: Point) -> bool:
    if a[0] == b[0] == c[0]:
        return min(a[1], b[1]) < c[1] < max(a[1], b[1])
    return a[1] == b[1] == c[1] and min(a[0], b[0]) < c[0] < max(a[0], b[0])


@dataclass(frozen=True)
class PinGraphic:
    """Pin of a symbol: position of its open end, and its direction from there to the body."""

    x: float
    y: float
    angle: int
    """Direction [degree]: 0 is right, 90 is up, 180 is left, 270 is down."""
    length: float


@dataclass(frozen=True)
class UnitGraphic:
    """Graphics of one unit of a symbol."""

    pins: dict[str, PinGraphic]
    lines: tuple[tuple[Point, ...], ...] = ()
    filled: tuple[tuple[Point, ...], ...] = ()
    circles: tuple[tuple[float, float, float], ...] = ()
    """Circles, by centre and radius."""
    show_numbers: bool = False
    show_names: bool = False
    reference_at: Point = (0.0, 0.0)
    """Position of the reference when the symbol is not rotated."""
    value_at: Point = (0.0, 0.0)
    """Position of the value when the symbol is not rotated."""
    body: Point = (0.0, 0.0)
    """Half width and half height of the body, which texts of a rotated symbol must clear."""


def _load_graphics() -> dict[str, tuple[UnitGraphic, ...]]:
    data = json.loads((_FOLDER / "symbol_graphics.json").read_text("utf-8"))
    return {name: tuple(map(_read_unit, units)) for name, units in data.items()}


def _read_unit(unit: dict[str, Any]) -> UnitGraphic:
    pins = {number: PinGraphic(*pin) for number, pin in unit.pop("pins").items()}
    return UnitGraphic(pins, **{name: _freeze(value) for name, value in unit.items()})


def _freeze(value: Any) -> Any:
    return tuple(map(_freeze, value)) if isinstance(value, list) else value


SYMBOL_GRAPHICS = _load_graphics()
"""Units of each symbol in order, by the symbol's name."""


# Blocks of the sheets, and the sheets.


@functools.cache
def _load_blocks() -> dict[str, Sheet]:
    kinds = {"symbols": PlacedSymbol, "power_symbols": PowerSymbol, "labels": Label, "global_labels": Label}

    def read(kind: str, items: Any) -> Any:
        return tuple(kinds[kind](*item) for item in items) if kind in kinds else _freeze(items)

    data = json.loads((_FOLDER / "schematic_blocks.json").read_text("utf-8"))
    return {name: Sheet(**{kind: read(kind, items) for kind, items in block.items()}) for name, block in data.items()}


def _controller_connector(supply: Supply, has_slip_output: bool) -> Sheet:
    """Connector J3 to the controller: every second pin is ground, and the ninth is the slip output or ground."""
    grounds = (62, 66, 70, 74, 78) if has_slip_output else (62, 66, 70, 74, 76, 78)
    slip = Sheet(wires=(((218, 76), (214, 76)),), labels=(Label("SLIP", 214, 76, 180),)) if has_slip_output else Sheet()
    connector = Sheet(
        symbols=(PlacedSymbol("J3", 222, 68), PlacedSymbol("R24", 218, 95)),
        wires=(
            ((211, 84), (211, 68), (218, 68)), *(((218, y), (216, y)) for y in grounds), ((216, 62), (216, 82)),
            ((218, 72), (214, 72)), ((218, 89), (218, 92)),
        ),
        power_symbols=(PowerSymbol("GND", 216, 82), PowerSymbol("GND", 222, 82), PowerSymbol("GND", 16, 52)),
        labels=(Label("M_OUT", 214, 72, 180), Label("M_OUT", 218, 89)),
        global_labels=(Label(supply.signal_ground, 218, 98, 270),),
    )  # fmt: skip
    return join_blocks(connector, slip, _load_blocks()["filtered_output"])


def adc_connector(supply: Supply, has_slip_output: bool = False) -> Sheet:
    """Connector J3 to the ADC or the controller, and the end of the envelope's wire.

    The fourth pin of a pin header is the slip output or ground. On a single supply its fifth pin is the signal ground.
    """
    if supply.is_for_controller:
        return _controller_connector(supply, has_slip_output)
    return join_blocks(_pin_header(supply, has_slip_output), Sheet(wires=(((211, 84), (211, 62), (218, 62)),)))


def _pin_header(supply: Supply, has_slip_output: bool) -> Sheet:
    if has_slip_output:
        pin_4 = Sheet(
            wires=(((218, 66), (216, 66), (216, 76)), ((218, 64), (214, 64))),
            power_symbols=(PowerSymbol("GND", 214, 64),),
            labels=(Label("SLIP", 216, 76, 180),),
        )
    else:
        pin_4 = Sheet(
            wires=(((218, 64), (216, 64), (216, 68)), ((218, 66), (216, 66))),
            power_symbols=(PowerSymbol("GND", 216, 68),),
        )
    if not supply.signal_ground_ratio:
        return join_blocks(Sheet(symbols=(PlacedSymbol("J3", 222, 62),)), pin_4)
    with_signal_ground = Sheet(
        symbols=(PlacedSymbol("J3", 222, 64), PlacedSymbol("R24", 218, 89)),
        wires=(((218, 68), (218, 86)),),
        labels=(Label("M_OUT", 218, 82),),
        global_labels=(Label(supply.signal_ground, 218, 92, 270),),
    )
    return join_blocks(with_signal_ground, pin_4)


_PLAIN_ENTRY = ((20, 122), (24, 122), (24, 114))
"""Wire from the supply's connector to the rail."""


def supply_block(supply: Supply, positive: Sequence[str], negative: Sequence[str], amplifiers: Sequence[str]) -> Sheet:
    """Supply connector J2, decoupling capacitors and supply pins of the amplifiers."""
    # On a board for a controller the protection stands between the connector and the capacitors.
    first, pitch, entry, flag = (40, 7, ((32, 114),), 37) if supply.is_for_controller else (30, 9, _PLAIN_ENTRY, 79)
    columns = [first + pitch * i for i in range(len(positive))]
    pins = [86 + 9 * i for i in range(len(amplifiers))]
    rail_ends = (79, 114), *((x, 114) for x in pins)
    positive_row = Sheet(
        symbols=(
            *(PlacedSymbol(reference, x, 120) for reference, x in zip(positive, columns, strict=True)),
            *(PlacedSymbol(reference, 88 + 9 * i, 124, unit=3) for i, reference in enumerate(amplifiers)),
        ),
        wires=(
            (*entry, *rail_ends), *(((x, 114), (x, 118)) for x in pins),
            *(((x, 114), (x, 117)) for x in columns), *(((x, 123), (x, 124)) for x in columns),
        ),
        power_symbols=(
            PowerSymbol("VCC", 34 if supply.is_for_controller else 26, 114), PowerSymbol("PWR_FLAG", flag, 114),
            PowerSymbol("GND", 26, 124),
        ),
        texts=(("Supply and decoupling", 12, 108),),
    )  # fmt: skip
    if supply.signal_ground_ratio:
        ground = Sheet(
            symbols=(PlacedSymbol("J2", 16, 122, mirrored=True),),
            wires=(((20, 124), (83, 124)),),
            power_symbols=(*(PowerSymbol("GND", x, 130) for x in pins), PowerSymbol("PWR_FLAG", 83, 124)),
        )
        names = ("supply_midpoint", *(("protection", "bridge_supply") if supply.is_for_controller else ()))
        return join_blocks(positive_row, ground, *(_load_blocks()[name] for name in names))
    negative_columns = columns[: len(negative)]
    negative_row = Sheet(
        symbols=(
            PlacedSymbol("J2", 16, 124, mirrored=True), PlacedSymbol("TP5", 79, 124),
            *(PlacedSymbol(reference, x, 128) for reference, x in zip(negative, negative_columns, strict=True)),
        ),
        wires=(
            ((20, 124), (79, 124)), ((20, 126), (24, 126), (24, 134), (74, 134), *((x, 134) for x in pins)),
            *(((x, 134), (x, 130)) for x in pins),
            *(((x, 124), (x, 125)) for x in negative_columns), *(((x, 131), (x, 134)) for x in negative_columns),
        ),
        power_symbols=(
            PowerSymbol("VEE", 26, 134, 180), PowerSymbol("PWR_FLAG", 74, 134, 180), PowerSymbol("PWR_FLAG", 74, 124),
        ),
    )  # fmt: skip
    return join_blocks(positive_row, negative_row)


_ROWS = {
    "article": ("article_filters",),
    "precision": ("precision_filters", "rectifier"),
    "comparator": ("precision_filters", "rectifier"),
}
"""Blocks between the connectors and the supply, by variant."""


def make_sheet(variant: str, supply: Supply) -> Sheet:
    """Make the schematic sheet of a variant on a supply."""
    has_slip, is_article = variant == "comparator", variant == "article"
    positive = ["C10", "C5", "C12", *([] if is_article else ["C15"]), *(["C18"] if has_slip else [])]
    if supply.signal_ground_ratio:
        positive.append("C22")
    negative, amplifiers = ["C11", "C6", "C13"], ["U1"]
    if not is_article:
        negative, amplifiers = [*negative, "C16"], [*amplifiers, "U3"]
    blocks = _load_blocks()
    sheet = join_blocks(
        blocks["bridge"],
        adc_connector(supply, has_slip),
        *(blocks[name] for name in _ROWS[variant]),
        supply_block(supply, positive, negative, amplifiers),
        *((blocks["comparator"],) if has_slip else ()),
        blocks["mounting_holes"],
    )
    return apply_supply(sheet, supply)
