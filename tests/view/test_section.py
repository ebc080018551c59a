"""Section and exploded view: every name stands where the solids have
what it names, and no name covers a part.
"""

from __future__ import annotations

import io
import itertools
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageDraw

from fingertip import Design
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.models.parts import parts_by_name
from fingertip.models.solids import Box
from fingertip.pictures import cameras, design_picture, section
from fingertip.pictures.design_picture import draw, find_free_place, place_on_hand
from fingertip.pictures.section import Section, draw_section, list_sections, slice_solid, spread
from tests.approved import check_figures
from tests.figures import sum_up
from tests.view.describe import PenRecord, describe_pixels

APPROVED = Path(__file__).parent / "approved"
DESIGNS = {"fsr400": "fsr400", "fork": "child_finger"}
EVALUATOR = MeshEvaluator(0.05)


@cache
def load(name: str) -> tuple[Design, tuple[Section, ...]]:
    design = Design.load(DESIGNS[name])
    return design, tuple(list_sections(design))


def describe_section(shown: Section) -> Iterator[str]:
    """Title, area of the cut through each part, bounds of what is dashed, and features [mm]."""
    yield shown.title
    for name, solid in shown.parts.items():
        yield (
            f"  {name}: "
            f"{abs(sum(area(ring) for ring in slice_solid(EVALUATOR, solid, 1e-3))):.4g} mm2"
        )
    for solid, x in shown.dashed:
        corners = np.concatenate([np.empty((0, 2)), *slice_solid(EVALUATOR, solid, x)])
        ends = (
            f"{sum_up(corners.min(axis=0))} to {sum_up(corners.max(axis=0))}"
            if len(corners)
            else "nothing"
        )
        yield f"  dashed at {x:.4g}: {ends}"
    yield from (f"  {name} at {sum_up(at)}" for name, at in shown.features)


def area(ring: Any) -> float:
    return 0.5 * float(
        np.sum(ring[:, 0] * np.roll(ring[:, 1], -1) - np.roll(ring[:, 0], -1) * ring[:, 1])
    )


@pytest.mark.parametrize("name", DESIGNS)
def test_section_is_the_approved_one(name: str) -> None:
    sections = load(name)[1]
    check_figures(
        APPROVED / f"section_{name}.txt",
        (line for each in sections for line in describe_section(each)),
    )


def test_picture_is_drawn_as_approved(monkeypatch: pytest.MonkeyPatch) -> None:
    """Names, marks and outlines of all panels, and the pixels without them.

    The parts are coarse.
    """
    pen = PenRecord(monkeypatch)
    monkeypatch.setattr(design_picture, "_TOLERANCE_MM", 0.3)
    monkeypatch.setattr(section, "_dash", lambda pen, line: pen.polygon(line, outline="dashed"))
    drawn = draw(
        load("fork")[0],
        400,
        lambda message: pen.lines.append(f"{message.label} {message.share:.3f}"),
    )
    size = Image.open(io.BytesIO(drawn)).size
    lines = [f"picture of {size}", *pen.lines, *describe_pixels(drawn)]
    check_figures(APPROVED / "picture_fork.txt", lines, rel=5e-3, abs_=1.1)


def test_dashes_are_7_pixels_long_and_4_apart_around_corners(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pen = PenRecord(monkeypatch)
    section._dash(ImageDraw.Draw(Image.new("RGB", (9, 9))), [(0.0, 0.0), (60.0, 0.0), (60.0, 39.0)])
    ends = [[float(number) for number in line.split()[1:5]] for line in pen.lines]
    assert ends == [[0, 0, 21, 0], [33, 0, 54, 0], [60, 6, 60, 27]]


def test_slices_have_the_area_of_the_solid() -> None:
    ring = Box((-1.0, -2.0, -3.0), (1.0, 4.0, 5.0)).cut(Box((-2.0, -1.0, -1.0), (2.0, 1.0, 2.0)))
    outlines = slice_solid(EVALUATOR, ring, 0.5)
    assert abs(sum(area(ring) for ring in outlines)) == pytest.approx(8 * 6 - 3 * 2)
    corners = np.concatenate(outlines)
    assert corners.min(axis=0) == pytest.approx([-3.0, -2.0])  # along the finger, dorsal
    assert corners.max(axis=0) == pytest.approx([5.0, 4.0])


def test_a_section_has_no_speckles() -> None:
    """Two blocks that meet in one face: each row of the cut changes its colour once, in
    one place.
    """
    left = Box((-5.0, 0.0, 0.0), (5.0, 10.0, 10.0))
    right = Box((-5.0, 0.0, 10.0), (5.0, 10.0, 20.0))
    picture = draw_section(
        Section("", {"bone": left, "skin": right}, (), ()), MeshEvaluator(0.05), 800
    )
    colours = {tuple(colour) for colour in picture.reshape(-1, 3)}
    rows = [row for row in picture if len({tuple(pixel) for pixel in row[100:700:5]}) >= 2]
    middle = rows[len(rows) // 2]
    changes = np.flatnonzero((middle[1:] != middle[:-1]).any(axis=1))
    # White, edge, bone, edge, skin, edge, white, with a blended pixel beside each edge.
    assert len(changes) <= 9
    assert len(colours) < 400


@pytest.mark.parametrize("total", [60.0, 100.0])
def test_names_never_overlap(total: float) -> None:
    random = np.random.default_rng(0)
    for _ in range(200):
        widths = list(random.uniform(2, 12, 5))
        wanted = sorted(random.uniform(-10, total + 10, 5))
        middles = spread(widths, wanted, total)
        ends = [(m - w / 2, m + w / 2) for m, w in zip(middles, widths, strict=True)]
        assert ends[0][0] >= -1e-9
        assert ends[-1][1] <= total + 1e-9
        assert all(a[1] <= b[0] + 1e-9 for a, b in itertools.pairwise(ends))
    assert spread([2.0, 2.0], [10.0, 50.0], 60.0) == [10.0, 50.0]


def test_a_free_place_is_free_and_near() -> None:
    taken = np.zeros((200, 300), dtype=bool)
    taken[80:120, 100:200] = True
    x, y = find_free_place(taken, (0.0, 2.0, 60.0, 20.0), (100.0, 80.0, 200.0, 120.0))
    left = int(x)
    top = int(y + 2)
    assert not taken[top : top + 18, left : left + 60].any()
    assert abs(y + 11 - 100) < 45
    taken[:] = True
    assert find_free_place(taken, (0.0, 0.0, 10.0, 10.0), (1.0, 2.0, 3.0, 4.0)) == (1.0, 4.0)


def test_views_show_the_side_that_they_name() -> None:
    """Distal is to the right; the dorsal side (y) or the palmar one faces the viewer.

    A finger bends to its palm.
    """
    for camera, side in ((cameras.DORSAL, 1.0), (cameras.PALMAR, -1.0)):
        right, up, towards = camera.axes
        assert right[2] > 0.8
        assert up[1] > 0.7
        assert np.sign(round(float(towards[1]), 9)) == side
    design = Design.load("adult_finger")
    coarse = MeshEvaluator(0.5)
    assert design.dimensions.joint
    parts = {"bone": parts_by_name(design)["bone"].solid(design)}
    placed = place_on_hand(design, design.dimensions.joint, coarse, parts)
    straight, bent = (mesh.vertices for name, mesh in placed if name == "bone")
    assert bent[:, 1].min() < straight[:, 1].min() - 15.0, "the tip is far palmar"
    assert bent[:, 1].max() < straight[:, 1].max() + 2.0
