"""KiCad schematic (format of version 9) of a circuit, drawn on a sheet: symbols, wires, labels and power symbols.

As in KiCad, the connections follow from the wires and labels alone. A test compares KiCad's netlist of the drawing with
the netlist of the circuit.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from fingertip.board.kicad.netlist import component_uuid, named_uuid
from fingertip.board.kicad.project import REVISION
from fingertip.board.kicad.schematic_sheet import (
    SYMBOL_GRAPHICS,
    UNIT_MM,
    PinGraphic,
    PlacedSymbol,
    Point,
    PowerSymbol,
    Sheet,
    UnitGraphic,
)
from fingertip.board.kicad.sexpr import Expression, format_expression, number, quote
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.select_part import symbol_fields

# Symbols in KiCad's schematic format: library symbols, symbols of components and power symbols on a sheet.


POWER_LIBRARY = "power"
TEXT_HEIGHT_MM = 1.27


def format_property(
    name: str, text: str, x: float, y: float, hidden: bool = False, angle: str = "0", justify: str = ""
) -> Expression:
    """Property of a symbol at a position [mm]."""
    at = ("at", number(x), number(y), angle)
    return ("property", quote(name), quote(text), at, format_text_effects(justify, hidden=hidden))


def format_text_effects(justify: str = "", height_mm: float = TEXT_HEIGHT_MM, hidden: bool = False) -> Expression:
    """Font size and justification of a text."""
    font: Expression = ("font", ("size", number(height_mm), number(height_mm)))
    sides: tuple[Expression, ...] = (("justify", *justify.split()),) if justify else ()
    return ("effects", font, *sides, *((("hide", "yes"),) if hidden else ()))


def format_stroke(width_mm: float) -> Expression:
    """Stroke of a line."""
    return ("stroke", ("width", number(width_mm)), ("type", "default"))


# Library symbols


def library_symbols(circuit: Circuit, sheet: Sheet) -> Iterator[Expression]:
    """Yield every symbol used, once, for the library that a schematic contains."""
    symbols = {component.symbol for component in circuit.components}
    for symbol in sorted(symbols, key=lambda s: (s.library, s.name)):
        pins = {pin.number: (pin.name, pin.electrical_type) for pin in symbol.pins}
        prefix = next(c.reference for c in circuit.components if c.symbol == symbol).rstrip("0123456789")
        yield _library_symbol(symbol.library, symbol.name, prefix, pins, is_power=False)
    for name in sorted({symbol.name for symbol in sheet.power_symbols}):
        kind = "power_out" if name == "PWR_FLAG" else "power_in"
        yield _library_symbol(POWER_LIBRARY, name, "#PWR", {"1": ("~", kind)}, is_power=True)


def _library_symbol(
    library: str, name: str, prefix: str, pins: dict[str, tuple[str, str]], is_power: bool
) -> Expression:
    units = SYMBOL_GRAPHICS[name]
    show_names, show_numbers = any(u.show_names for u in units), any(u.show_numbers for u in units)
    hide: Expression = ("hide", "yes")
    return (
        "symbol",
        quote(f"{library}:{name}"),
        *((("power",),) if is_power else ()),
        ("pin_numbers", *(() if show_numbers else (hide,))),
        ("pin_names", ("offset", "0.127"), *(() if show_names else (hide,))),
        ("exclude_from_sim", "no"),
        ("in_bom", "yes"),
        ("on_board", "yes"),
        format_property("Reference", prefix, 0, 0, hidden=True),
        format_property("Value", name, 0, 0, hidden=True),
        format_property("Footprint", "", 0, 0, hidden=True),
        format_property("Datasheet", "", 0, 0, hidden=True),
        format_property("Description", "", 0, 0, hidden=True),
        *(_library_unit(name, i, unit, pins) for i, unit in enumerate(units, start=1)),
        ("embedded_fonts", "no"),
    )


def _library_unit(name: str, index: int, unit: UnitGraphic, pins: dict[str, tuple[str, str]]) -> Expression:
    def fill(kind: str) -> Expression:
        return ("fill", ("type", kind))

    def polyline(points: tuple[Point, ...], kind: str) -> Expression:
        return ("polyline", ("pts", *(("xy", number(x), number(y)) for x, y in points)), format_stroke(0.2), fill(kind))

    return (
        "symbol",
        quote(f"{name}_{index}_1"),
        *(polyline(points, "none") for points in unit.lines),
        *(polyline(points, "background") for points in unit.filled),
        *(
            ("circle", ("center", number(x), number(y)), ("radius", number(r)), format_stroke(0.2), fill("none"))
            for x, y, r in unit.circles
        ),
        *(
            (
                "pin", pins[key][1], "line",
                ("at", number(pin.x), number(pin.y), str(pin.angle)),
                ("length", number(pin.length)),
                ("name", quote(pins[key][0]), format_text_effects()),
                ("number", quote(key), format_text_effects()),
            )
            for key, pin in unit.pins.items()
        ),
    )  # fmt: skip


# Symbols of components on a sheet


def pin_position(symbol: PlacedSymbol, pin: PinGraphic) -> Point:
    """Position of the open end of a placed symbol's pin on the sheet, in units."""
    x, y = _rotate_offset(symbol, pin.x / UNIT_MM, pin.y / UNIT_MM)
    return (symbol.x + round(x, 6), symbol.y + round(y, 6))


def _rotate_offset(symbol: PlacedSymbol, x: float, y: float) -> Point:
    """Convert an offset in a symbol (y axis up) to an offset on the sheet (y axis down)."""
    if symbol.mirrored:
        x = -x
    dx, dy = {0: (x, y), 90: (-y, x), 180: (-x, -y), 270: (y, -x)}[symbol.angle]
    return (dx, -dy)


def component_symbol(circuit: Circuit, symbol: PlacedSymbol, root: str) -> Expression:
    """Symbol of a component, or one unit of it, on the sheet with the UUID `root`."""
    component = circuit.component(symbol.reference)
    unit = SYMBOL_GRAPHICS[component.symbol.name][symbol.unit - 1]
    if symbol.unit == 1:
        identifier = component_uuid(circuit, component.reference)
    else:
        identifier = named_uuid(circuit, f"{component.reference} unit {symbol.unit}")
    is_hole = not component.symbol.pins
    x, y = symbol.x * UNIT_MM, symbol.y * UNIT_MM
    return (
        "symbol",
        ("lib_id", quote(f"{component.symbol.library}:{component.symbol.name}")),
        ("at", number(x), number(y), str(symbol.angle)),
        *((("mirror", "y"),) if symbol.mirrored else ()),
        ("unit", str(symbol.unit)),
        ("exclude_from_sim", "yes" if is_hole else "no"),
        ("in_bom", "yes" if component.rating else "no"),
        ("on_board", "yes"),
        ("dnp", "no"),
        ("uuid", quote(identifier)),
        _visible_property(symbol, unit, "Reference", component.reference, unit.reference_at, above=True),
        _visible_property(symbol, unit, "Value", component.value, unit.value_at, above=False),
        format_property("Footprint", component.footprint, x, y, hidden=True),
        format_property("Datasheet", "", x, y, hidden=True),
        format_property("Description", component.symbol.description, x, y, hidden=True),
        *(format_property(name, text, x, y, hidden=True) for name, text in symbol_fields(component).items()),
        *(
            ("pin", quote(pin), ("uuid", quote(named_uuid(circuit, f"pin {component.reference}.{pin}"))))
            for pin in unit.pins
        ),
        _instance(circuit, root, component.reference, symbol.unit),
    )


def _visible_property(
    symbol: PlacedSymbol, unit: UnitGraphic, name: str, text: str, position: Point, above: bool
) -> Expression:
    """Reference or value: beside an upright symbol, above and below a symbol that is rotated by 90 degrees."""
    is_beside = symbol.angle == 0 and bool(unit.body[1]) and position[0] != 0
    if symbol.angle in (90, 270):
        gap = unit.body[0] + 1.3
        dx, dy = 0.0, -gap if above else gap
    elif symbol.angle == 180:
        dx, dy = -position[0], position[1]
    else:
        dx, dy = (position[0], -position[1])
    # KiCad rotates a property with its symbol. Another 90 degrees make it read from the left again.
    angle = "90" if symbol.angle in (90, 270) else "0"
    x, y = symbol.x * UNIT_MM + dx, symbol.y * UNIT_MM + dy
    return format_property(name, text, x, y, angle=angle, justify="left" if is_beside else "")


# Power symbols on a sheet


def power_symbols(circuit: Circuit, sheet: Sheet, root: str) -> Iterator[Expression]:
    """Yield all power symbols and flags of a sheet, numbered."""
    count: Counter[str] = Counter()
    for symbol in sheet.power_symbols:
        prefix = "#FLG" if symbol.name == "PWR_FLAG" else "#PWR"
        count[prefix] += 1
        yield _power_symbol(circuit, symbol, f"{prefix}{count[prefix]:02}", root)


def _power_symbol(circuit: Circuit, symbol: PowerSymbol, reference: str, root: str) -> Expression:
    x, y = symbol.x * UNIT_MM, symbol.y * UNIT_MM
    value_y = SYMBOL_GRAPHICS[symbol.name][0].value_at[1]
    value_y = y + (value_y if symbol.angle == 180 else -value_y)
    return (
        "symbol",
        ("lib_id", quote(f"{POWER_LIBRARY}:{symbol.name}")),
        ("at", number(x), number(y), str(symbol.angle)),
        ("unit", "1"),
        ("exclude_from_sim", "no"),
        ("in_bom", "yes"),
        ("on_board", "yes"),
        ("dnp", "no"),
        ("uuid", quote(named_uuid(circuit, f"power {reference}"))),
        format_property("Reference", reference, x, y, hidden=True),
        format_property("Value", symbol.name, x, value_y, hidden=symbol.name == "PWR_FLAG"),
        format_property("Footprint", "", x, y, hidden=True),
        format_property("Datasheet", "", x, y, hidden=True),
        format_property("Description", "", x, y, hidden=True),
        ("pin", quote("1"), ("uuid", quote(named_uuid(circuit, f"pin {reference}")))),
        _instance(circuit, root, reference, 1),
    )


def _instance(circuit: Circuit, root: str, reference: str, unit: int) -> Expression:
    path = ("path", quote(f"/{root}"), ("reference", quote(reference)), ("unit", str(unit)))
    return ("instances", ("project", quote(circuit.name), path))


_HEADING_HEIGHT_MM = 1.8


def kicad_schematic_file(circuit: Circuit, sheet: Sheet, title: str) -> bytes:
    """Content of the schematic file, UTF-8."""
    root = named_uuid(circuit, "sheet")
    items: list[Expression] = [
        ("version", "20250114"),
        ("generator", quote("fingertip")),
        ("generator_version", quote("9.0")),
        ("uuid", quote(root)),
        ("paper", quote("A4")),
        _title_block(title),
        ("lib_symbols", *library_symbols(circuit, sheet)),
        *_texts(circuit, sheet),
        *_wires(circuit, sheet),
        *_labels(circuit, sheet),
        *_global_labels(circuit, sheet),
        *(component_symbol(circuit, symbol, root) for symbol in sheet.symbols),
        *power_symbols(circuit, sheet, root),
        ("sheet_instances", ("path", quote("/"), ("page", quote("1")))),
        ("embedded_fonts", "no"),
    ]
    return ("(kicad_sch\n" + "\n".join(format_expression(item, "  ") for item in items) + "\n)\n").encode()


def _title_block(title: str) -> Expression:
    return (
        "title_block",
        ("title", quote(title)),
        ("rev", quote(REVISION)),
        ("comment", "1", quote("generated by fingertip board")),
        ("comment", "2", quote("References of the article: R_LP is R6, C_LP is C4")),
    )


def _at(x: float, y: float, *angle: int) -> Expression:
    return ("at", number(x * UNIT_MM), number(y * UNIT_MM), *(str(a) for a in angle))


def _wires(circuit: Circuit, sheet: Sheet) -> Iterator[Expression]:
    """Wires, and a junction wherever more than two ends and pins meet."""
    pins = [
        pin_position(symbol, pin)
        for symbol in sheet.symbols
        for pin in SYMBOL_GRAPHICS[circuit.component(symbol.reference).symbol.name][symbol.unit - 1].pins.values()
    ]
    segments = sheet.segments(pins)
    ends = Counter(point for segment in segments for point in segment) + Counter(pins)
    ends += Counter((symbol.x, symbol.y) for symbol in sheet.power_symbols if symbol.name == "PWR_FLAG")
    for x, y in sorted(point for point, count in ends.items() if count > 2):
        identifier = ("uuid", quote(named_uuid(circuit, f"junction {x} {y}")))
        yield ("junction", _at(x, y), ("diameter", "0"), ("color", "0", "0", "0", "0"), identifier)
    for a, b in segments:
        points = (("xy", number(x * UNIT_MM), number(y * UNIT_MM)) for x, y in (a, b))
        identifier = ("uuid", quote(named_uuid(circuit, f"wire {a} {b}")))
        yield ("wire", ("pts", *points), format_stroke(0), identifier)


def _labels(circuit: Circuit, sheet: Sheet) -> Iterator[Expression]:
    for label in sheet.labels:
        side = "right" if label.angle == 180 else "left"
        identifier = ("uuid", quote(named_uuid(circuit, f"label {label.net} {label.x} {label.y}")))
        at = _at(label.x, label.y, label.angle)
        yield ("label", quote(label.net), at, format_text_effects(f"{side} bottom"), identifier)


def _global_labels(circuit: Circuit, sheet: Sheet) -> Iterator[Expression]:
    for label in sheet.global_labels:
        side = "right" if label.angle in (180, 270) else "left"
        identifier = ("uuid", quote(named_uuid(circuit, f"flag {label.net} {label.x} {label.y}")))
        yield (
            "global_label", quote(label.net), ("shape", "passive"), _at(label.x, label.y, label.angle),
            format_text_effects(side), identifier,
            format_property("Intersheetrefs", "${INTERSHEET_REFS}", 0, 0, hidden=True),
        )  # fmt: skip


def _texts(circuit: Circuit, sheet: Sheet) -> Iterator[Expression]:
    for text, x, y in sheet.texts:
        identifier = ("uuid", quote(named_uuid(circuit, f"words {text}")))
        effects = format_text_effects("left", _HEADING_HEIGHT_MM)
        yield ("text", quote(text), ("exclude_from_sim", "no"), _at(x, y, 0), effects, identifier)
