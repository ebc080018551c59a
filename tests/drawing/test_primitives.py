"""Primitives of a sheet, its renderers, and the placement of dimensions, on shapes of
known size.
"""

from __future__ import annotations

import math

import pytest

from fingertip.design.geometry.sizes import FIT, INNER, OUTER, Circle, Length, Tolerance, symmetric
from fingertip.pictures.drawing.dimensioning import (
    NoRoomError,
    Occupancy,
    PlacedLength,
    place_circle,
    place_lengths,
)
from fingertip.pictures.drawing.primitives import (
    PROJECTIONS,
    Arrow,
    Hatch,
    Primitive,
    Ring,
    Sheet,
    Styles,
    Text,
    rectangle,
    text_width,
)
from tests.tools import require_module

SQUARE = ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0))
HOLE = ((3.0, 3.0), (7.0, 3.0), (7.0, 7.0), (3.0, 7.0))
ALL: tuple[Primitive, ...] = (
    rectangle(10.0, 10.0, 90.0, 60.0, Styles.EDGE),
    Ring((30.0, 30.0), 5.0, Styles.EDGE),
    Arrow((20.0, 20.0), 90.0, 3.0),
    Text("Ø3 ±0.1 < A&B", (40.0, 50.0), 3.5, "middle"),
    Text("up", (15.0, 20.0), 2.5, turned=True),
    Hatch((SQUARE,), 2.0),
)
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
        *map(chr, range(32, 127)),
    ):
        size = Text(text, (0.0, 0.0), 2.5).size
        assert text_width(text, 2.5) == pytest.approx(
            metrics.stringWidth(text, "Helvetica", size), rel=1e-9
        )


@pytest.mark.parametrize(
    ("tolerance", "text"),
    [
        (symmetric(0.1), "±0.1"),
        (symmetric(0.075), "±0.07"),
        (Tolerance(-0.1, 0.0), "0/-0.1"),
        (Tolerance(-0.02, 0.02), FIT),
        (Tolerance(-0.03, 0.1), FIT),
        (Tolerance(0.0, 0.25), "+0.25/0"),
        (Tolerance(-0.3, 0.195), "+0.19/-0.3"),
        (Tolerance(0.05, 0.2), "+0.2/+0.05"),
    ],
)
def test_tolerance_is_never_written_wider_than_it_is(tolerance: Tolerance, text: str) -> None:
    assert tolerance.text() == text


def test_views_are_in_first_angle_projection() -> None:
    """The front view looks along +x.

    What lies towards its observer is at the foot of the view from above.
    """
    assert PROJECTIONS["front"].towards == (-1.0, 0.0, 0.0)
    assert PROJECTIONS["dorsal"].towards == (0.0, 1.0, 0.0)
    assert PROJECTIONS["palmar"].towards == (0.0, -1.0, 0.0)
    assert PROJECTIONS["end"].towards == (0.0, 0.0, -1.0)
    near = (-1.0, 0.0, 0.0)
    # Below the front view: the near side is farther from it.
    assert PROJECTIONS["dorsal"].flatten(near)[1] < 0.0
    assert PROJECTIONS["palmar"].flatten(near)[1] > 0.0  # above it
    assert PROJECTIONS["end"].flatten(near)[0] > 0.0  # on its right


def test_size_without_room_is_refused() -> None:
    occupancy = Occupancy(200.0, 150.0)
    occupancy.block((0.0, 0.0, 200.0, 150.0))
    length = Length(
        "size", OUTER, "front", "above", "z", (0.0, 0.0, 0.0), (0.0, 0.0, 40.0), symmetric(0.1)
    )
    with pytest.raises(NoRoomError, match="size"):
        list(place_lengths([PlacedLength(length, (60.0, 70.0), (100.0, 70.0), 80.0, 0)], occupancy))
    with pytest.raises(NoRoomError, match="bore"):
        place_circle(
            Circle("bore", INNER, "front", "x", (0.0, 0.0, 0.0), 2.0),
            (50.0, 50.0),
            4.0,
            0,
            occupancy,
        )
