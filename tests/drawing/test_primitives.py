"""Primitives of a sheet, its renderers, and the placement of dimensions, on shapes of known size."""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

import pytest

from fingertip.design.geometry.sizes import (
    FIT,
    INNER,
    OUTER,
    Circle,
    Length,
    Tolerance,
    symmetric,
)
from fingertip.pictures.drawing.dimensioning import NoRoomError, Occupancy, PlacedLength, place_circle, place_lengths
from fingertip.pictures.drawing.primitives import (
    PROJECTIONS,
    Arc,
    Arrow,
    Hatch,
    Polyline,
    Primitive,
    Sheet,
    Styles,
    Text,
    line,
    rectangle,
    text_width,
)
from fingertip.pictures.drawing.render import render_pdf, render_svg
from tests.tools import require_module

SQUARE = ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0))
HOLE = ((3.0, 3.0), (7.0, 3.0), (7.0, 7.0), (3.0, 7.0))
ALL: tuple[Primitive, ...] = (
    rectangle(10.0, 10.0, 90.0, 60.0, Styles.EDGE), Arc((30.0, 30.0), 5.0, 0.0, 360.0, Styles.EDGE),
    Arc((60.0, 30.0), 5.0, 0.0, 90.0, Styles.DIMENSION), Arrow((20.0, 20.0), 90.0, 3.0),
    Text("Ø3 ±0.1 < A&B", (40.0, 50.0), 3.5, "middle"), Text("up", (15.0, 20.0), 2.5, turned=True),
    Hatch((SQUARE,), 2.0),
)  # fmt: skip
SHEET = Sheet("a & b", 100.0, 70.0, ALL)


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 45.0, 90.0])
@pytest.mark.parametrize(("rings", "area"), [((SQUARE,), 100.0), ((SQUARE, HOLE), 84.0)])
def test_hatching_covers_the_area_between_the_rings(
    rings: tuple[tuple[tuple[float, float], ...], ...], area: float, angle_deg: float
) -> None:
    spacing = 0.01
    length = sum(math.dist(*hatched.points) for hatched in Hatch(rings, spacing, angle_deg).lines())
    assert length * spacing == pytest.approx(area, rel=2e-3)


def test_widths_of_text_are_those_of_the_font_of_the_pdf() -> None:
    metrics = require_module("reportlab.pdfbase.pdfmetrics")
    for text in (
        "4× Ø3.4 ±0.2",
        "5.8 +0.19/-0.3",
        "wide: sand the sides until it drops in; (print) again",
        "R3.7 A-A °",
    ):
        size = Text(text, (0.0, 0.0), 2.5).size
        assert text_width(text, 2.5) == pytest.approx(metrics.stringWidth(text, "Helvetica", size), rel=1e-9)


def test_svg_is_well_formed_and_in_millimetres() -> None:
    root = ElementTree.fromstring(render_svg(SHEET))
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("100mm", "70mm", "0 0 100 70")
    texts = [element for element in root.iter() if element.tag.endswith("text")]
    assert [element.text for element in texts] == ["Ø3 ±0.1 < A&B", "up"]
    assert float(str(texts[1].get("x"))) == 15.0
    assert float(str(texts[1].get("y"))) == 50.0  # downwards from the top
    widths = {element.get("stroke-width") for element in root.iter() if element.tag.endswith(("path", "circle"))}
    assert {"0.5", "0.25"} <= widths


def test_pdf_has_a_page_for_each_sheet_and_no_date_of_today() -> None:
    require_module("reportlab")
    data = render_pdf((SHEET, SHEET), "title")
    assert data == render_pdf((SHEET, SHEET), "title")
    assert data.startswith(b"%PDF")
    assert len(re.findall(rb"/Type /Page\b", data)) == 2
    assert re.findall(rb"/CreationDate \(D:(\d{4})", data) == [b"2000"]
    assert re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", data)[0] == (b"283.4646", b"198.4252")


@pytest.mark.parametrize(
    ("tolerance", "text"),
    [
        (symmetric(0.1), "±0.1"), (symmetric(0.075), "±0.07"), (Tolerance(-0.1, 0.0), "0/-0.1"),
        (Tolerance(-0.02, 0.02), FIT),
        (Tolerance(0.0, 0.25), "+0.25/0"), (Tolerance(-0.3, 0.195), "+0.19/-0.3"), (Tolerance(0.05, 0.2), "+0.2/+0.05"),
    ],
)  # fmt: skip
def test_tolerance_is_never_written_wider_than_it_is(tolerance: Tolerance, text: str) -> None:
    assert tolerance.text() == text


def test_views_are_in_first_angle_projection() -> None:
    """The front view looks along +x. What lies towards its observer is at the foot of the view from above."""
    assert PROJECTIONS["front"].towards == (-1.0, 0.0, 0.0)
    assert PROJECTIONS["dorsal"].towards == (0.0, 1.0, 0.0)
    assert PROJECTIONS["palmar"].towards == (0.0, -1.0, 0.0)
    assert PROJECTIONS["end"].towards == (0.0, 0.0, -1.0)
    near = (-1.0, 0.0, 0.0)
    assert PROJECTIONS["dorsal"].flatten(near)[1] < 0.0  # below the front view: the near side is farther from it
    assert PROJECTIONS["palmar"].flatten(near)[1] > 0.0  # above it
    assert PROJECTIONS["end"].flatten(near)[0] > 0.0  # on its right


def make_length(span: float, name: str, balloon: int = 0, side: str = "above") -> PlacedLength:
    size = Length(name, OUTER, "front", side, "z", (0.0, 0.0, 0.0), (0.0, 0.0, span), symmetric(0.1))  # type: ignore[arg-type]
    ends = ((60.0, 70.0), (60.0 + span, 70.0)) if side in ("above", "below") else ((60.0, 40.0), (60.0, 40.0 + span))
    edge = {"above": 80.0, "below": 60.0, "left": 55.0, "right": 120.0}[side]
    return PlacedLength(size, *ends, edge, balloon)


def boxes_overlap(one: Text, other: Text) -> bool:
    a, b = one.box(), other.box()
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


@pytest.mark.parametrize("side", ["above", "below", "left", "right"])
def test_dimension_lines_lie_in_lanes_and_texts_apart(side: str) -> None:
    occupancy = Occupancy(200.0, 150.0)
    lengths = [make_length(span, f"{span}", i, side) for i, span in enumerate((2.0, 9.0, 30.0, 31.0, 60.0))]
    drawn = list(place_lengths(lengths, occupancy))
    texts = [primitive for primitive in drawn if isinstance(primitive, Text)]
    assert sorted(text.text for text in texts if "±" in text.text) == sorted(length.size.text() for length in lengths)
    assert not any(boxes_overlap(a, b) for i, a in enumerate(texts) for b in texts[:i])
    arrows = [primitive for primitive in drawn if isinstance(primitive, Arrow)]
    across = 1 if side in ("above", "below") else 0
    assert len({round(arrow.tip[across], 3) for arrow in arrows}) >= 3
    distances = [abs(arrow.tip[across] - lengths[0].edge) for arrow in arrows]
    assert min(distances) >= 8.0


def test_arrows_stand_outside_a_narrow_dimension() -> None:
    def directions(span: float) -> list[float]:
        drawn = place_lengths([make_length(span, "size")], Occupancy(200.0, 150.0))
        return [arrow.direction_deg % 360.0 for arrow in drawn if isinstance(arrow, Arrow)]

    assert directions(40.0) == [180.0, 0.0]  # from inside, outwards
    assert directions(2.0) == [0.0, 180.0]


def test_size_without_room_is_refused() -> None:
    occupancy = Occupancy(200.0, 150.0)
    occupancy.block((0.0, 0.0, 200.0, 150.0))
    with pytest.raises(NoRoomError, match="size"):
        list(place_lengths([make_length(40.0, "size")], occupancy))
    with pytest.raises(NoRoomError, match="bore"):
        place_circle(Circle("bore", INNER, "front", "x", (0.0, 0.0, 0.0), 2.0), (50.0, 50.0), 4.0, 0, occupancy)


def test_leader_ends_on_its_circle_and_keeps_off_edges() -> None:
    occupancy = Occupancy(200.0, 150.0)
    grid: list[Primitive] = [line((60.0, y), (100.0, y), Styles.EDGE) for y in range(0, 150, 3)]
    occupancy.add(grid, is_view=True)
    size = Circle("bore", INNER, "front", "x", (0.0, 0.0, 0.0), 2.0, count=4)
    drawn = place_circle(size, (50.0, 75.0), 4.0, 3, occupancy)
    tip = next(primitive.tip for primitive in drawn if isinstance(primitive, Arrow))
    assert math.dist(tip, (50.0, 75.0)) == pytest.approx(4.0)
    texts = [primitive for primitive in drawn if isinstance(primitive, Text)]
    assert [text.text for text in texts] == ["3", "4× Ø4"]
    assert all(text.box()[2] < 60.0 or text.box()[0] > 100.0 for text in texts)


def test_occupancy_finds_what_a_line_crosses() -> None:
    occupancy = Occupancy(100.0, 100.0)
    occupancy.add((Polyline(((10.0, 50.0), (90.0, 50.0)), Styles.EDGE),), is_view=True)
    occupancy.add((Text("word", (40.0, 70.0), 3.0),))
    assert occupancy.crossings(((50.0, 40.0), (50.0, 60.0)))[0] in (1, 2)
    assert occupancy.crosses_text(((42.0, 65.0), (42.0, 80.0)))
    assert not occupancy.crosses_text(((20.0, 65.0), (20.0, 80.0)))
    assert not occupancy.is_free((20.0, 49.0, 30.0, 49.5), 0.6)
    assert occupancy.is_free((20.0, 45.0, 30.0, 48.0), 0.6)
    assert not occupancy.is_free((95.0, 10.0, 101.0, 12.0), 0.6)
