"""A part on KiCad's board: its footprint with pads, outlines, reference and fields (version 9's format)."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from fingertip.board.circuit import Circuit, Part, kicad_name
from fingertip.board.kicad.footprints import DOT_MM, FOOTPRINTS, ROUND_RATIO, Footprint, Pad
from fingertip.board.kicad.identity import named_uuid, part_uuid
from fingertip.board.kicad.sexpr import Expression, number, quoted
from fingertip.board.layout.names import SIZE_MM
from fingertip.board.layout.placement import Placement, turned

CORNER_MM = (100.0, 80.0)
"""Where the board's upper left corner lies on KiCad's page."""


def at(x: float, y: float, *angle: int) -> Expression:
    """A place on KiCad's page."""
    return ("at", number(CORNER_MM[0] + x), number(CORNER_MM[1] + y), *(str(a) for a in angle))


def effects(size: float) -> Expression:
    """How words of this height look."""
    return ("effects", ("font", ("size", number(size), number(size)), ("thickness", number(round(size * 0.15, 3)))))


def placed_footprint(circuit: Circuit, part: Part, placement: Placement, codes: dict[str, int]) -> Expression:
    """One part; `codes` numbers the nets."""
    spot = placement.spots[part.reference]
    shape = FOOTPRINTS[part.footprint]
    nets = {
        pin: kicad_name(net.name) for net in circuit.nets for reference, pin in net.nodes if reference == part.reference
    }
    drilled = any(pad.drill for pad in shape.pads)
    kind = ("through_hole",) if drilled and part.rating else ("smd",) if part.rating else ()
    flags = () if part.rating else ("exclude_from_pos_files", "exclude_from_bom")

    def name(what: str) -> str:
        return quoted(named_uuid(circuit, f"board {part.reference} {what}"))

    return (
        "footprint",
        quoted(part.footprint),
        ("layer", quoted("F.Cu")),
        ("uuid", name("footprint")),
        at(spot.x, spot.y, spot.angle),
        ("descr", quoted(part.role)),
        _reference(part, placement, shape, name("reference")),
        _property("Value", part.value, _middle(shape), "F.Fab", name("value"), 0.4, hidden=True),
        *(_property(field, words, (0.0, 0.0), "F.Fab", name(field), 0.4, True) for field, words in _fields(part)),
        ("path", quoted(f"/{part_uuid(circuit, part.reference)}")),
        ("sheetname", quoted("/")),
        ("sheetfile", quoted(f"{circuit.name}.kicad_sch")),
        *((("attr", *kind, *flags),) if kind or flags else ()),
        *_lines(shape, name),
        *(_pad(part, shape, pad, spot.angle, nets, codes, name(f"pad {pad.number}")) for pad in shape.pads),
        ("embedded_fonts", "no"),
    )


def _fields(part: Part) -> tuple[tuple[str, str], ...]:
    return (("Datasheet", ""), ("Description", part.symbol.description), ("Role", part.role))


def _middle(shape: Footprint) -> tuple[float, float]:
    left, top, right, bottom = shape.body
    return ((left + right) / 2, (top + bottom) / 2)


def _reference(part: Part, placement: Placement, shape: Footprint, identity: str) -> Expression:
    """Printed where the placement says; of what has no name there, in the middle of the assembly drawing's part."""
    if part.reference not in placement.names:
        return _property("Reference", part.reference, _middle(shape), "F.Fab", identity, 0.5)
    spot, (x, y) = placement.spots[part.reference], placement.names[part.reference]
    at = turned(-spot.angle % 360, x - spot.x, y - spot.y)
    return _property("Reference", part.reference, at, "F.SilkS", identity, SIZE_MM)


def _property(
    name: str, words: str, at: tuple[float, float], layer: str, identity: str, size: float, hidden: bool = False,
) -> Expression:  # fmt: skip
    # Upright for whoever looks at the board from its lower edge, however the part is turned.
    return (
        "property", quoted(name), quoted(words),
        ("at", number(at[0]), number(at[1]), "0"),
        ("unlocked", "yes"),
        ("layer", quoted(layer)),
        *((("hide", "yes"),) if hidden else ()),
        ("uuid", identity),
        effects(size),
    )  # fmt: skip


def _lines(shape: Footprint, name: Callable[[str], str]) -> Iterator[Expression]:
    def rectangle(box: tuple[float, float, float, float], layer: str, width: float, what: str) -> Expression:
        return (
            "fp_rect", ("start", number(box[0]), number(box[1])), ("end", number(box[2]), number(box[3])),
            ("stroke", ("width", number(width)), ("type", "solid")), ("fill", "no"), ("layer", quoted(layer)),
            ("uuid", name(what)),
        )  # fmt: skip

    if shape.pads[0].plated:
        yield rectangle(shape.courtyard, "F.CrtYd", 0.05, "courtyard")
        yield rectangle(shape.body, "F.Fab", 0.1, "body")
    else:
        radius = shape.courtyard[2]
        yield (
            "fp_circle", ("center", "0", "0"), ("end", number(radius), "0"),
            ("stroke", ("width", "0.05"), ("type", "solid")), ("fill", "no"), ("layer", quoted("F.CrtYd")),
            ("uuid", name("courtyard")),
        )  # fmt: skip
    for i, (a, b) in enumerate(shape.silk):
        yield (
            "fp_line", ("start", number(a[0]), number(a[1])), ("end", number(b[0]), number(b[1])),
            ("stroke", ("width", "0.12"), ("type", "solid")), ("layer", quoted("F.SilkS")),
            ("uuid", name(f"silk {i}")),
        )  # fmt: skip
    if shape.dot:
        x, y = shape.dot
        yield (
            "fp_circle", ("center", number(x), number(y)), ("end", number(x + DOT_MM / 4), number(y)),
            ("stroke", ("width", number(DOT_MM / 2)), ("type", "solid")), ("fill", "no"), ("layer", quoted("F.SilkS")),
            ("uuid", name("dot")),
        )  # fmt: skip


def _pad(
    part: Part, shape: Footprint, pad: Pad, angle: int, nets: dict[str, str], codes: dict[str, int], identity: str
) -> Expression:
    kind = "np_thru_hole" if not pad.plated else "thru_hole" if pad.drill else "smd"
    layers = ("*.Cu", "*.Mask") if pad.drill else ("F.Cu", "F.Mask", *(("F.Paste",) if shape.paste else ()))
    connection: tuple[Expression, ...] = ()
    if net := nets.get(pad.number):
        pin = next(pin for pin in part.symbol.pins if pin.number == pad.number)
        named = () if pin.name == "~" else (("pinfunction", quoted(pin.name)),)
        connection = (("net", str(codes[net]), quoted(net)), *named, ("pintype", quoted(pin.kind)))
    ratio = ROUND_RATIO.get(part.footprint, 0.25)
    return (
        "pad", quoted(pad.number), kind, pad.shape,
        ("at", number(pad.x), number(pad.y), *((str(angle),) if angle else ())),
        ("size", number(pad.width), number(pad.height)),
        *((("drill", number(pad.drill)),) if pad.drill else ()),
        ("layers", *(quoted(layer) for layer in layers)),
        *((("remove_unused_layers", "no"),) if pad.drill and pad.plated else ()),
        *((("roundrect_rratio", number(ratio)),) if pad.shape == "roundrect" else ()),
        *connection,
        ("uuid", identity),
    )  # fmt: skip
