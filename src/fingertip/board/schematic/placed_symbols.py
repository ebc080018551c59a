"""Symbols on a schematic's sheet: parts with their fields, and power symbols."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from fingertip.board.circuit import Circuit, Part
from fingertip.board.kicad.identity import named_uuid, part_uuid
from fingertip.board.kicad.sexpr import Expression, number, quoted
from fingertip.board.schematic.library import POWER_LIBRARY
from fingertip.board.schematic.pieces import property_
from fingertip.board.schematic.sheet import UNIT_MM, Mark, Placed, Point, Sheet
from fingertip.board.schematic.symbol_shapes import SHAPES, PinShape, Shape


def pin_point(placed: Placed, pin: PinShape) -> Point:
    """Where a placed symbol's pin ends on the sheet, in units."""
    x, y = _turned(placed, pin.x / UNIT_MM, pin.y / UNIT_MM)
    return (placed.x + round(x, 6), placed.y + round(y, 6))


def _turned(placed: Placed, x: float, y: float) -> Point:
    """An offset in a symbol (y upwards) as an offset on the sheet (y downwards)."""
    if placed.mirrored:
        x = -x
    dx, dy = {0: (x, y), 90: (-y, x), 180: (-x, -y), 270: (y, -x)}[placed.angle]
    return (dx, -dy)


def symbol(circuit: Circuit, placed: Placed, root: str) -> Expression:
    """A part's symbol, or one unit of it, on the sheet named `root`."""
    part = circuit.part(placed.reference)
    shape = SHAPES[part.symbol.name][placed.unit - 1]
    identity = part_uuid(circuit, part.reference) if placed.unit == 1 else _unit_uuid(circuit, part, placed.unit)
    bought = "yes" if part.rating else "no"
    hole = not part.symbol.pins
    x, y = placed.x * UNIT_MM, placed.y * UNIT_MM
    return (
        "symbol",
        ("lib_id", quoted(f"{part.symbol.library}:{part.symbol.name}")),
        ("at", number(x), number(y), str(placed.angle)),
        *((("mirror", "y"),) if placed.mirrored else ()),
        ("unit", str(placed.unit)),
        ("exclude_from_sim", "yes" if hole else "no"),
        ("in_bom", bought),
        ("on_board", "yes"),
        ("dnp", "no"),
        ("uuid", quoted(identity)),
        _field(placed, shape, "Reference", part.reference, shape.reference_at, above=True),
        _field(placed, shape, "Value", part.value, shape.value_at, above=False),
        property_("Footprint", part.footprint, x, y, hidden=True),
        property_("Datasheet", "", x, y, hidden=True),
        property_("Description", part.symbol.description, x, y, hidden=True),
        property_("Role", part.role, x, y, hidden=True),
        *(
            ("pin", quoted(pin), ("uuid", quoted(named_uuid(circuit, f"pin {part.reference}.{pin}"))))
            for pin in shape.pins
        ),
        _instance(circuit, root, part.reference, placed.unit),
    )


def _unit_uuid(circuit: Circuit, part: Part, unit: int) -> str:
    return named_uuid(circuit, f"{part.reference} unit {unit}")


def _field(placed: Placed, shape: Shape, name: str, words: str, at: Point, above: bool) -> Expression:
    """Reference or value: beside an upright part; above and below one that lies."""
    beside = placed.angle == 0 and bool(shape.body[1]) and at[0] != 0
    if placed.angle in (90, 270):
        gap = shape.body[0] + 1.3
        dx, dy = 0.0, -gap if above else gap
    elif placed.angle == 180:
        dx, dy = -at[0], at[1]
    else:
        dx, dy = (at[0], -at[1])
    # A field's angle is the symbol's to begin with: turned once more it reads from the left again.
    angle = "90" if placed.angle in (90, 270) else "0"
    x, y = placed.x * UNIT_MM + dx, placed.y * UNIT_MM + dy
    return property_(name, words, x, y, angle=angle, justify="left" if beside else "")


def power(circuit: Circuit, sheet: Sheet, root: str) -> Iterator[Expression]:
    """All power symbols and flags, numbered."""
    count: Counter[str] = Counter()
    for mark in sheet.marks:
        letters = "#FLG" if mark.name == "PWR_FLAG" else "#PWR"
        count[letters] += 1
        yield _power_symbol(circuit, mark, f"{letters}{count[letters]:02}", root)


def _power_symbol(circuit: Circuit, mark: Mark, reference: str, root: str) -> Expression:
    x, y = mark.x * UNIT_MM, mark.y * UNIT_MM
    at = SHAPES[mark.name][0].value_at[1]
    return (
        "symbol",
        ("lib_id", quoted(f"{POWER_LIBRARY}:{mark.name}")),
        ("at", number(x), number(y), str(mark.angle)),
        ("unit", "1"),
        ("exclude_from_sim", "no"),
        ("in_bom", "yes"),
        ("on_board", "yes"),
        ("dnp", "no"),
        ("uuid", quoted(named_uuid(circuit, f"power {reference}"))),
        property_("Reference", reference, x, y, hidden=True),
        property_("Value", mark.name, x, y + (at if mark.angle == 180 else -at), hidden=mark.name == "PWR_FLAG"),
        property_("Footprint", "", x, y, hidden=True),
        property_("Datasheet", "", x, y, hidden=True),
        property_("Description", "", x, y, hidden=True),
        ("pin", quoted("1"), ("uuid", quoted(named_uuid(circuit, f"pin {reference}")))),
        _instance(circuit, root, reference, 1),
    )


def _instance(circuit: Circuit, root: str, reference: str, unit: int) -> Expression:
    path = ("path", quoted(f"/{root}"), ("reference", quoted(reference)), ("unit", str(unit)))
    return ("instances", ("project", quoted(circuit.name), path))
