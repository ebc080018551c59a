"""The print on both sides of the boards, read from KiCad's board file: whose label is whose, texts, fiducial marks.

KiCad's design rules check measures size and clearances with the true shapes of its letters (`test_layout.py`).
"""

from __future__ import annotations

import functools
import math
import re
from dataclasses import dataclass, replace

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.back_print import find_text_box, list_back_texts, list_values, print_values
from fingertip.board.kicad.netlist import REVISION
from fingertip.board.kicad.placement import Placement
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import Circuit
from fingertip.catalogues.output_files import LAYOUT
from fingertip.foundation.errors import BoardError
from fingertip.tasks.board import board_files
from tests.designs import load_article
from tests.oracles.sexpressions import Expression, children, parse

Box = tuple[float, float, float, float]
ADVANCES = {
    "iI.,": 0.48,
    "lftr ": 0.77,
    "jJTLk": 0.82,
    "+-": 1.05,
    "M": 1.0,
    "m": 1.34,
    "abcdeghnopqsuvxyzACEFKSVXYZ": 1.01,
}
ADVANCES |= {"0123456789": 0.953, "": 1.05}
"""Advance of KiCad's letters relative to the height, measured and rounded up; "" stands for all others."""
GAP = 0.2
"""What the last letter leaves empty."""
ABOVE, BELOW = 0.62, {"": 0.53, "Q": 0.625, "gjpqy,": 0.863}
"""Extents of KiCad's letters above and below the centre of a text, with the width of their strokes, both measured."""


@dataclass(frozen=True)
class Text:
    """Printed text: what it says, the reference of its component or "", side, and box on the page."""

    text: str
    owner: str
    side: str
    box: Box


@dataclass(frozen=True)
class Board:
    """What the board file says of print, pads and bodies."""

    tree: Expression
    texts: list[Text]
    pads: list[tuple[str, str, str, Box]]
    """Reference, side ("F" or "B"), net and box of each pad."""
    parts: dict[str, Box]
    """Box around pads, body and printed outline of each component."""


def first(item: Expression, head: str) -> list[str]:
    return next(children(item, head))


def numbers(item: Expression, head: str) -> list[float]:
    return [float(word) for word in first(item, head)[1:]]


def text_box(item: Expression, x: float, y: float, angle: float) -> Box:
    effects = first(item, "effects")
    height = numbers(first(effects, "font"), "size")[0]  # type: ignore[arg-type]
    justify = [word for words in children(effects, "justify") for word in words[1:]]
    text = item[2] if item[0] == "property" else item[1]
    advances = (next((a for letters, a in ADVANCES.items() if c in letters), ADVANCES[""]) for c in text)
    width = height * (sum(advances) - GAP)
    below = height * max(depth for letters, depth in BELOW.items() if not letters or set(letters) & set(text))
    above = height * ABOVE + (0.048 if "4" in text else 0.0)
    if justify == ["left", "mirror"]:
        x -= width / 2
    if angle % 180 == 0:
        return (x - width / 2, y - above, x + width / 2, y + below)
    return (x - above, y - width / 2, x + below, y + width / 2)


def turn(angle: float, x: float, y: float) -> tuple[float, float]:
    """Offset of a footprint that is rotated anticlockwise, the y axis pointing down."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return (c * x + s * y, c * y - s * x)


@functools.cache
def read_board(name: str, changes: tuple[str, ...] = ()) -> Board:
    design = load_article((*BOARD_CONFIGURATIONS[name].changes, *changes))
    return parse_board(board_files(design)[LAYOUT].decode())


def parse_board(text: str) -> Board:
    tree = parse(text)
    texts, pads, parts = [], [], {}
    for item in children(tree, "gr_text"):
        x, y, *angle = numbers(item, "at")
        layer = first(item, "layer")[1]
        texts.append(Text(item[1], "", layer[0], text_box(item, x, y, angle[0] if angle else 0.0)))
    for footprint in children(tree, "footprint"):
        x, y, *rest = numbers(footprint, "at")
        angle = rest[0] if rest else 0.0
        reference = next(p[2] for p in children(footprint, "property") if p[1] == "Reference")
        boxes = []
        for pad in children(footprint, "pad"):
            px, py, *_ = numbers(pad, "at")
            w, h = numbers(pad, "size")
            margin = next((float(m[1]) for m in children(pad, "solder_mask_margin")), 0.0)
            dx, dy = turn(angle, px, py)
            w, h = (w, h) if angle % 180 == 0 else (h, w)
            box = (x + dx - w / 2, y + dy - h / 2, x + dx + w / 2, y + dy + h / 2)
            box = (box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin)
            net = next((n[2] for n in children(pad, "net")), "")
            sides = "FB" if pad[2].endswith("thru_hole") else "F"
            pads += [(reference, side, net, box) for side in sides]
            boxes.append(box)
        outlines = [r for r in children(footprint, "fp_rect") if first(r, "layer")[1] == "F.Fab"]
        outlines += [r for r in children(footprint, "fp_line") if first(r, "layer")[1] == "F.SilkS"]
        for body in outlines:
            corners = [turn(angle, *numbers(body, end)) for end in ("start", "end")]
            xs, ys = [x + c[0] for c in corners], [y + c[1] for c in corners]
            boxes.append((min(xs), min(ys), max(xs), max(ys)))
        parts[reference] = (
            min(b[0] for b in boxes), min(b[1] for b in boxes), max(b[2] for b in boxes), max(b[3] for b in boxes)
        )  # fmt: skip
        for field in children(footprint, "property"):
            layer = first(field, "layer")[1]
            if layer.endswith("SilkS") and not list(children(field, "hide")):
                fx, fy, text_angle = numbers(field, "at")
                dx, dy = turn(angle, fx, fy)
                texts.append(Text(field[2], reference, layer[0], text_box(field, x + dx, y + dy, text_angle)))
    return Board(tree, texts, pads, parts)


def distance(a: Box, b: Box) -> float:
    return math.hypot(max(a[0] - b[2], b[0] - a[2], 0.0), max(a[1] - b[3], b[1] - a[3], 0.0))


def misleading(board: Board) -> list[str]:
    """References that are as near to another component as to their own."""
    found = []
    for text in board.texts:
        if text.owner:
            own = distance(text.box, board.parts[text.owner])
            nearest = min((distance(text.box, box), ref) for ref, box in board.parts.items() if ref != text.owner)
            if nearest[0] <= own + 1e-6:
                found.append(f"{text.text} at {nearest[1]}")
    return found


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_each_reference_is_nearest_to_its_own_part(name: str) -> None:
    assert misleading(read_board(name)) == []


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_front_shows_all_references_but_some_of_resistors_and_capacitors(name: str) -> None:
    board = read_board(name)
    printed = {text.owner for text in board.texts if text.owner}
    missing = {ref for ref in board.parts if ref not in printed and not ref.startswith(("H", "FID"))}
    assert {re.sub(r"\d", "", ref) for ref in missing} <= {"R", "C"}
    assert all(text.text == text.owner for text in board.texts if text.owner)


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_signs_at_the_supply_are_at_the_right_pins(name: str) -> None:
    """The pad of J2 nearest to each sign is on the net of that polarity."""
    board, supply = read_board(name), BOARD_CONFIGURATIONS[name].supply
    positive = "/POWER_IN" if supply.is_for_controller else "VCC"
    signs = {"+": positive, "-": "VEE", "0": "GND"} if supply.negative_rail == "VEE" else {"+": positive, "-": "GND"}
    power = [(net, box) for reference, side, net, box in board.pads if reference == "J2" and side == "F"]
    for sign, net in signs.items():
        boxes = [text.box for text in board.texts if text.text == sign and text.side == "F"]
        box = min(boxes, key=lambda box: min(distance(box, pad) for _, pad in power))
        assert min(power, key=lambda item: distance(box, item[1]))[0] == net
    only = [text for text in board.texts if "3.3 V only" in text.text]
    assert {text.side for text in only} == ({"F", "B"} if supply.is_for_controller else set())


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_back_names_board_and_revision_and_lists_the_values(name: str) -> None:
    configuration = BOARD_CONFIGURATIONS[name]
    circuit = board_circuit(board_values(load_article(configuration.changes)))
    texts = [text.text for text in read_board(name).texts if text.side == "B"]
    assert texts[0] == f"fingertip {name.replace('_', ' ')}"
    assert texts[1] == f"rev {REVISION}"
    warning = [f"{configuration.supply.nominal_v:g} V only"] if configuration.supply.is_for_controller else []
    listed = [f"{c.reference} {c.value}" for c in circuit.components if c.reference[0] in "RC"]
    assert sorted(texts[2:]) == sorted([*warning, *listed])


def long_values(name: str) -> tuple[Circuit, Placement]:
    """A board whose values are as long as the list prints them."""
    configuration = BOARD_CONFIGURATIONS[name]
    circuit = board_circuit(board_values(load_article(configuration.changes)))
    for component in circuit.components:
        if component.reference[0] in "RC" and component.reference != "RV1":
            circuit = circuit.replace(component.reference, "14.321987k")
    return circuit, configuration.placement


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_back_has_room_for_values_of_any_length(name: str) -> None:
    circuit, placement = long_values(name)
    texts = list_back_texts(circuit, placement)
    values = [text.text for text in texts]
    assert values == list_values(circuit)
    assert all(value.endswith(" 14.3k") for value in values if value[:2] != "RV")
    left, top, right, bottom = zip(*map(find_text_box, texts), strict=True)
    assert min(*left, *top) > 0.3
    assert max(right) < placement.width - 0.3
    assert max(bottom) < placement.height - 0.3


def test_list_that_does_not_fit_is_refused() -> None:
    circuit, placement = long_values("comparator_single_3v3")
    with pytest.raises(BoardError, match="no room for the list of values"):
        list_back_texts(circuit, replace(placement, width=24.0))


def test_layout_that_prints_no_value_of_a_part_is_refused() -> None:
    circuit, placement = long_values("article_split")
    layout = BOARD_CONFIGURATIONS["article_split"].project.layout.replace('(gr_text "R4 ', '(gr_text "R44 ')
    with pytest.raises(BoardError, match=r"prints no value of R4 on its back; add a text there in KiCad"):
        print_values(layout, circuit, placement)


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_three_fiducial_marks_span_the_board(name: str) -> None:
    """1 mm of copper in an opening of 2 mm, clear of all other copper, and not on one line."""
    board, placement = read_board(name), BOARD_CONFIGURATIONS[name].placement
    marks = [item for item in children(board.tree, "footprint") if item[1] == "Fiducial:Fiducial_1mm_Mask2mm"]
    points = [tuple(numbers(item, "at")[:2]) for item in marks]
    (ax, ay), (bx, by), (cx, cy) = points
    assert abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2 > 0.25 * placement.width * placement.height
    for item, (x, y) in zip(marks, points, strict=True):
        pad = first(item, "pad")
        assert numbers(pad, "size") == [1.0, 1.0]  # type: ignore[arg-type]
        assert numbers(pad, "solder_mask_margin") == [0.5]  # type: ignore[arg-type]
        mark = (x - 1.0, y - 1.0, x + 1.0, y + 1.0)
        assert all(distance(mark, box) > 0 for ref, side, _, box in board.pads if side == "F" and ref[:3] != "FID")
        assert placement.corner[0] + 1.0 < x < placement.corner[0] + placement.width - 1.0
