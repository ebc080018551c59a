"""Sheets of all bundled designs: nothing covers a text, nothing
leaves the frame, and every size is there.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from functools import partial
from itertools import combinations, pairwise

import pytest

from fingertip.design import Design
from fingertip.design.geometry.sizes import general
from fingertip.foundation.errors import GeometryError
from fingertip.models import solids
from fingertip.models.parts import parts_by_name
from fingertip.pictures.drawing.draw import part_drawings, project_part, run_apart
from fingertip.pictures.drawing.primitives import Hatch, Point, Sheet, Text

Drawn = tuple[Design, dict[str, Sheet]]
Box = tuple[float, float, float, float]
TOUCHING_MM = 0.02


def texts(sheet: Sheet) -> list[Text]:
    return [primitive for primitive in sheet.primitives if isinstance(primitive, Text)]


def segments(sheet: Sheet) -> Iterator[tuple[Point, Point]]:
    """All straight pieces of all lines, circles included."""
    for primitive in sheet.primitives:
        for points in primitive.trace():
            yield from pairwise(points)


def overlap(a: Box, b: Box) -> bool:
    return (
        min(a[2], b[2]) - max(a[0], b[0]) > TOUCHING_MM
        and min(a[3], b[3]) - max(a[1], b[1]) > TOUCHING_MM
    )


def crosses(box: Box, a: Point, b: Point) -> bool:
    """Whether a segment passes through a box (Liang and Barsky's clipping)."""
    low = 0.0
    high = 1.0
    for k in (0, 1):
        d = b[k] - a[k]
        begin = box[k] + TOUCHING_MM
        end = box[k + 2] - TOUCHING_MM
        if abs(d) < 1e-12:
            if not begin < a[k] < end:
                return False
            continue
        t0, t1 = sorted(((begin - a[k]) / d, (end - a[k]) / d))
        low = max(low, t0)
        high = min(high, t1)
    return low < high


def faults(sheet: Sheet) -> list[str]:
    """Texts that cover each other, are crossed by a line, or leave the sheet's frame."""
    found = []
    boxes = [(text.text, text.box()) for text in texts(sheet)]
    found += [
        f"{a} covers {b}" for (a, one), (b, other) in combinations(boxes, 2) if overlap(one, other)
    ]
    for a, b in segments(sheet):
        found += [f"a line crosses {text}" for text, box in boxes if crosses(box, a, b)]
    frame = (20.0, 10.0, sheet.width - 10.0, sheet.height - 10.0)
    for text, box in boxes:
        if box[0] < frame[0] or box[1] < frame[1] or box[2] > frame[2] or box[3] > frame[3]:
            found.append(f"{text} leaves the frame")
    for a, b in segments(sheet):
        for x, y in (a, b):
            if (
                x < frame[0] - 1e-6
                or y < frame[1] - 1e-6
                or x > frame[2] + 1e-6
                or y > frame[3] + 1e-6
            ):
                found.append(f"a line leaves the frame at {x:.2f}, {y:.2f}")
    return found


@pytest.mark.full
def test_text_is_clear_of_everything_and_in_the_frame(drawn: Drawn) -> None:
    for part, sheet in drawn[1].items():
        assert not faults(sheet), part


@pytest.mark.full
def test_every_size_stands_on_its_sheet_once_and_checks_have_a_row(drawn: Drawn) -> None:
    design, sheets = drawn
    assert set(sheets) == {name for name, part in parts_by_name(design).items() if part.is_printed}
    for drawing in part_drawings(design):
        found = Counter(text.text for text in texts(sheets[drawing.part]))
        wanted = Counter(size.text() for size in drawing.sizes)
        for number, size in enumerate(drawing.checked, 1):
            tolerance = (size.tolerance or general(size.printed)).text()
            nominal = size.text().removesuffix(f" {tolerance}")
            # In its balloon, and its row of the table.
            wanted.update([str(number), str(number), nominal, tolerance])
        assert {text: found[text] for text in wanted} == wanted, drawing.part


@pytest.mark.full
def test_errors_of_the_process_are_raised_here(monkeypatch: pytest.MonkeyPatch) -> None:
    box = solids.Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    nothing = box.cut(solids.Box((-1.0, -1.0, -1.0), (2.0, 2.0, 2.0)))
    with pytest.raises(GeometryError, match="one valid solid was expected"):
        run_apart((("nothing", partial(project_part, nothing, ("front",))),))
    monkeypatch.setattr("fingertip.pictures.drawing.draw.TIME_LIMIT_S", 1e-5)
    with pytest.raises(GeometryError, match=r"still projecting after 1e-05 s"):
        run_apart((("box", partial(project_part, box, ("front",))),))


@pytest.mark.second
def test_box_is_projected_exactly_with_its_hidden_bore() -> None:
    bore = solids.cylinder("y", (4.0, 0.0), -2.0, 4.0, 0.5)
    box = solids.Box((-2.0, -1.0, 0.0), (2.0, 3.0, 9.0)).cut(bore)
    views = run_apart((("box", partial(project_part, box, ("front", "dorsal", "section"))),))["box"]
    assert views["front"].bounds() == (0.0, -1.0, 9.0, 3.0)
    (hidden,) = views["front"].hidden
    corners = {(round(x, 2), round(y, 2)) for x, y in hidden}
    assert corners == {(3.5, -1.0), (3.5, 3.0), (4.5, -1.0), (4.5, 3.0)}
    circle = max(views["dorsal"].visible, key=len)
    assert all(math.dist(point, (4.0, 0.0)) == pytest.approx(0.5, abs=2e-4) for point in circle)
    area = (
        sum(math.dist(*hatched.points) for hatched in Hatch(views["section"].cut, 0.01).lines())
        * 0.01
    )
    assert area == pytest.approx(9.0 * 4.0 - 4.0, rel=2e-3)
