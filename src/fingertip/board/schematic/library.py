"""The symbols a schematic carries along, as KiCad's libraries have their pins."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.board.circuit import Circuit
from fingertip.board.kicad.sexpr import Expression, number, quoted
from fingertip.board.schematic.pieces import effects, fill, property_, stroke
from fingertip.board.schematic.sheet import Point, Sheet
from fingertip.board.schematic.symbol_shapes import SHAPES, Shape

POWER_LIBRARY = "power"


def library(circuit: Circuit, sheet: Sheet) -> Iterator[Expression]:
    """Every symbol that is used once."""
    symbols = {part.symbol for part in circuit.parts}
    for symbol in sorted(symbols, key=lambda s: (s.library, s.name)):
        names = {pin.number: (pin.name, pin.kind) for pin in symbol.pins}
        letters = next(p.reference for p in circuit.parts if p.symbol == symbol).rstrip("0123456789")
        yield _library_symbol(symbol.library, symbol.name, letters, names, power=False)
    for name in sorted({mark.name for mark in sheet.marks}):
        kind = "power_out" if name == "PWR_FLAG" else "power_in"
        yield _library_symbol(POWER_LIBRARY, name, "#PWR", {"1": ("~", kind)}, power=True)


def _library_symbol(library: str, name: str, letters: str, pins: dict[str, tuple[str, str]], power: bool) -> Expression:
    shapes = SHAPES[name]
    named, numbered = any(s.show_names for s in shapes), any(s.show_numbers for s in shapes)
    hide: Expression = ("hide", "yes")
    return (
        "symbol",
        quoted(f"{library}:{name}"),
        *((("power",),) if power else ()),
        ("pin_numbers", *(() if numbered else (hide,))),
        ("pin_names", ("offset", "0.127"), *(() if named else (hide,))),
        ("exclude_from_sim", "no"),
        ("in_bom", "yes"),
        ("on_board", "yes"),
        property_("Reference", letters, 0, 0, hidden=True),
        property_("Value", name, 0, 0, hidden=True),
        property_("Footprint", "", 0, 0, hidden=True),
        property_("Datasheet", "", 0, 0, hidden=True),
        property_("Description", "", 0, 0, hidden=True),
        *(_library_unit(name, i, shape, pins) for i, shape in enumerate(shapes, start=1)),
        ("embedded_fonts", "no"),
    )


def _library_unit(name: str, unit: int, shape: Shape, pins: dict[str, tuple[str, str]]) -> Expression:
    def poly(points: tuple[Point, ...], kind: str) -> Expression:
        return ("polyline", ("pts", *(("xy", number(x), number(y)) for x, y in points)), stroke(0.2), fill(kind))

    return (
        "symbol",
        quoted(f"{name}_{unit}_1"),
        *(poly(points, "none") for points in shape.lines),
        *(poly(points, "background") for points in shape.filled),
        *(
            ("circle", ("center", number(x), number(y)), ("radius", number(r)), stroke(0.2), fill("none"))
            for x, y, r in shape.circles
        ),
        *(
            (
                "pin", pins[key][1], "line",
                ("at", number(pin.x), number(pin.y), str(pin.angle)),
                ("length", number(pin.length)),
                ("name", quoted(pins[key][0]), effects()),
                ("number", quoted(key), effects()),
            )
            for key, pin in shape.pins.items()
        ),
    )  # fmt: skip
