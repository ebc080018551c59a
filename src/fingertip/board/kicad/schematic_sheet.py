"""Sheet of a schematic as data: positions of symbols, wires and labels. Units of 1.27 mm, with the y axis down."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

from fingertip.board.components.supplies import Supply
from fingertip.board.parts.circuit import VEE, VMID, VREF

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


# Graphics of the schematic symbols [mm], with the y axis up, as in KiCad's libraries.
#
# Pins lie exactly where KiCad's libraries have them, so that the symbols can be updated from the libraries. A test
# compares them with KiCad 9. The lines are drawn here.


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


def _box(x0: float, y0: float, x1: float, y1: float) -> tuple[Point, ...]:
    return ((x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0))


def _connector(pins: int, top: float) -> UnitGraphic:
    ys = [round(top - 2.54 * i, 2) for i in range(pins)]
    body = _box(-1.27, ys[-1] - 1.27, 1.27, top + 1.27)
    return UnitGraphic(
        {str(i): PinGraphic(-5.08, y, 0, 3.81) for i, y in enumerate(ys, start=1)},
        (body, *(((-1.27, y), (0.0, y)) for y in ys)),
        show_numbers=True,
        reference_at=(0.0, top + 3.81),
        value_at=(0.0, ys[-1] - 3.81),
    )


def _with_mounting_pin(connector: UnitGraphic, y: float) -> UnitGraphic:
    """Connector with the mounting pin below it, whose open end has the height y."""
    tab = ((-1.27, y + 3.048), (1.27, y + 3.048))
    pins = connector.pins | {"MP": PinGraphic(0.0, y, 90, 3.048)}
    return replace(
        connector, pins=pins, lines=(*connector.lines, tab), value_at=(0.0, connector.reference_at[1] + 2.54)
    )


def _amplifier(plus: str, minus: str, out: str) -> UnitGraphic:
    return UnitGraphic(
        {
            plus: PinGraphic(-7.62, 2.54, 0, 2.54),
            minus: PinGraphic(-7.62, -2.54, 0, 2.54),
            out: PinGraphic(7.62, 0.0, 180, 2.54),
        },
        filled=(((-5.08, 5.08), (5.08, 0.0), (-5.08, -5.08), (-5.08, 5.08)),),
        show_numbers=True,
        show_names=True,
        reference_at=(2.54, 5.08),
        value_at=(3.81, -5.08),
    )


_DUAL_AMPLIFIER = (
    _amplifier("3", "2", "1"),
    _amplifier("5", "6", "7"),
    UnitGraphic(
        {"8": PinGraphic(-2.54, 7.62, 270, 3.81), "4": PinGraphic(-2.54, -7.62, 90, 3.81)},
        show_numbers=True, show_names=True, reference_at=(2.54, 1.27), value_at=(2.54, -1.27),
    ),
)  # fmt: skip
_DIODE_ARROW = ((1.27, 1.27), (-1.27, 0.0), (1.27, -1.27), (1.27, 1.27))

SYMBOL_GRAPHICS: dict[str, tuple[UnitGraphic, ...]] = {
    "R": (
        UnitGraphic(
            {"1": PinGraphic(0.0, 3.81, 270, 1.27), "2": PinGraphic(0.0, -3.81, 90, 1.27)},
            (_box(-1.016, -2.54, 1.016, 2.54),),
            reference_at=(2.032, 1.016), value_at=(2.032, -1.016), body=(1.016, 2.54),
        ),
    ),
    "C": (
        UnitGraphic(
            {"1": PinGraphic(0.0, 3.81, 270, 2.794), "2": PinGraphic(0.0, -3.81, 90, 2.794)},
            (((-1.9, 0.8), (1.9, 0.8)), ((-1.9, -0.8), (1.9, -0.8)), ((0.0, 0.8), (0.0, 1.016)),
             ((0.0, -0.8), (0.0, -1.016))),
            reference_at=(2.54, 1.27), value_at=(2.54, -1.524), body=(1.9, 0.8),
        ),
    ),
    "1N4148W": (
        UnitGraphic(
            {"1": PinGraphic(-3.81, 0.0, 0, 2.54), "2": PinGraphic(3.81, 0.0, 180, 2.54)},
            (_DIODE_ARROW, ((-1.27, 1.27), (-1.27, -1.27))),
            reference_at=(0.0, -2.54), value_at=(0.0, 2.54), body=(1.27, 1.27),
        ),
    ),
    "BAT54S": (
        UnitGraphic(
            {
                "1": PinGraphic(-7.62, 0.0, 0, 3.81), "2": PinGraphic(7.62, 0.0, 180, 3.81),
                "3": PinGraphic(0.0, -5.08, 90, 5.08),
            },
            (
                ((-3.81, 0.0), (3.81, 0.0)),
                ((-3.81, 1.27), (-1.27, 0.0), (-3.81, -1.27), (-3.81, 1.27)), ((-1.27, 1.27), (-1.27, -1.27)),
                ((1.27, 1.27), (3.81, 0.0), (1.27, -1.27), (1.27, 1.27)), ((3.81, 1.27), (3.81, -1.27)),
            ),
            circles=((0.0, 0.0, 0.2),),
            reference_at=(0.0, 2.54), value_at=(0.0, 5.08), body=(3.81, 1.27),
        ),
    ),
    **dict.fromkeys(("TL082", "TLV2372", "MCP6022", "OPA2376xxD", "LM2904"), _DUAL_AMPLIFIER),
    "TLV2371DBV": (
        replace(_amplifier("3", "4", "1"), pins=_amplifier("3", "4", "1").pins | {
            "5": PinGraphic(-2.54, 7.62, 270, 3.81), "2": PinGraphic(-2.54, -7.62, 90, 3.81),
        }),
    ),
    "AD623ARMZ": (
        UnitGraphic(
            {
                "2": PinGraphic(-7.62, 5.08, 0, 2.54), "1": PinGraphic(-7.62, 2.54, 0, 2.54),
                "8": PinGraphic(-7.62, -2.54, 0, 2.54), "3": PinGraphic(-7.62, -5.08, 0, 2.54),
                "7": PinGraphic(0.0, 7.62, 270, 2.54), "4": PinGraphic(0.0, -7.62, 90, 2.54),
                "5": PinGraphic(5.08, -7.62, 90, 5.08), "6": PinGraphic(12.7, 0.0, 180, 2.54),
            },
            filled=(((-5.08, 7.62), (10.16, 0.0), (-5.08, -7.62), (-5.08, 7.62)),),
            show_numbers=True, show_names=True, reference_at=(10.16, 8.4), value_at=(10.16, 6.4),
        ),
    ),
    "R_Potentiometer": (
        UnitGraphic(
            {"1": PinGraphic(0.0, 3.81, 270, 1.27), "3": PinGraphic(0.0, -3.81, 90, 1.27),
             "2": PinGraphic(3.81, 0.0, 180, 1.27)},
            (_box(-1.016, -2.54, 1.016, 2.54), ((2.54, 0.0), (1.2, 0.0)), ((1.7, 0.4), (1.2, 0.0), (1.7, -0.4))),
            reference_at=(-3.6, 1.016), value_at=(-3.6, -1.016),
        ),
    ),
    "LMV331": (
        UnitGraphic(
            {
                "1": PinGraphic(-7.62, 2.54, 0, 2.54), "3": PinGraphic(-7.62, -2.54, 0, 2.54),
                "4": PinGraphic(7.62, 0.0, 180, 2.54), "5": PinGraphic(-2.54, 7.62, 270, 3.81),
                "2": PinGraphic(-2.54, -7.62, 90, 3.81),
            },
            filled=(((-5.08, 5.08), (5.08, 0.0), (-5.08, -5.08), (-5.08, 5.08)),),
            show_numbers=True, show_names=True, reference_at=(3.4, 4.4), value_at=(5.08, -4.4),
        ),
    ),
    "Conn_01x02": (_connector(2, 0.0),),
    "Conn_01x02_MountingPin": (_with_mounting_pin(_connector(2, 0.0), -7.62),),
    "Conn_01x10_MountingPin": (_with_mounting_pin(_connector(10, 10.16), -17.78),),
    "AO3401A": (
        UnitGraphic(
            {"1": PinGraphic(-5.08, 0.0, 0, 2.54), "3": PinGraphic(2.54, 5.08, 270, 2.54),
             "2": PinGraphic(2.54, -5.08, 90, 2.54)},
            (((-2.54, 0.0), (0.254, 0.0)), ((0.254, 1.905), (0.254, -1.905)), ((0.762, 2.286), (0.762, 1.27)),
             ((0.762, 0.508), (0.762, -0.508)), ((0.762, -1.27), (0.762, -2.286)), ((2.54, 2.54), (2.54, 1.778),
             (0.762, 1.778)), ((2.54, -2.54), (2.54, 0.0), (0.762, 0.0)), ((2.54, -1.778), (0.762, -1.778)),
             ((2.286, 0.0), (1.27, 0.381), (1.27, -0.381), (2.286, 0.0))),
            circles=((1.651, 0.0, 2.794),),
            reference_at=(5.08, 1.905), value_at=(5.08, 0.0), body=(2.8, 2.8),
        ),
    ),
    "Conn_01x03": (_connector(3, 2.54),),
    "Conn_01x04": (_connector(4, 2.54),),
    "Conn_01x05": (_connector(5, 5.08),),
    "TestPoint": (
        UnitGraphic({"1": PinGraphic(0.0, 0.0, 90, 2.54)}, circles=((0.0, 3.302, 0.762),),
              reference_at=(0.0, 5.334), value_at=(0.0, 7.62)),
    ),
    "MountingHole": (
        UnitGraphic({}, circles=((0.0, 0.0, 1.27), (0.0, 0.0, 2.0)), reference_at=(0.0, 3.81), value_at=(0.0, -3.81)),
    ),
    "GND": (
        UnitGraphic({"1": PinGraphic(0.0, 0.0, 270, 0.0)},
              (((0.0, 0.0), (0.0, -1.27)), ((-1.27, -1.27), (1.27, -1.27)), ((-0.8, -1.778), (0.8, -1.778)),
               ((-0.3, -2.286), (0.3, -2.286))), value_at=(0.0, -3.81)),
    ),
    "VCC": (
        UnitGraphic({"1": PinGraphic(0.0, 0.0, 90, 0.0)},
              (((0.0, 0.0), (0.0, 2.54)), ((-0.762, 1.27), (0.0, 2.54), (0.762, 1.27))), value_at=(0.0, 3.81)),
    ),
    "VEE": (
        UnitGraphic({"1": PinGraphic(0.0, 0.0, 90, 0.0)},
              (((0.0, 0.0), (0.0, 2.54)), ((-0.762, 1.27), (0.0, 2.54), (0.762, 1.27))), value_at=(0.0, 3.81)),
    ),
    "PWR_FLAG": (
        UnitGraphic({"1": PinGraphic(0.0, 0.0, 90, 0.0)},
              (((0.0, 0.0), (0.0, 1.27), (-1.016, 1.905), (0.0, 2.54), (1.016, 1.905), (0.0, 1.27)),),
              value_at=(0.0, 3.81)),
    ),
}  # fmt: skip
"""Units of each symbol in order, by the symbol's name."""
