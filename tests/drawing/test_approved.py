"""Sizes of every part, and sheets around the boxes of parts, compared whole with approved ones."""

from __future__ import annotations

import base64
import re
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.design import Design
from fingertip.design.geometry.sizes import Circle, PartDrawing, Size, ViewName
from fingertip.models.parts import PARTS
from fingertip.pictures.drawing.draw import part_drawings
from fingertip.pictures.drawing.layout import lay_out
from fingertip.pictures.drawing.primitives import PROJECTIONS, Arrow, ProjectedView, Sheet, Text
from fingertip.pictures.drawing.svg_and_pdf import render_pdf, render_svg
from fingertip.pictures.drawing.title_block import Heading
from tests.approved import check_figures
from tests.drawing.conftest import CALIBRATED, load_variant
from tests.drawing.test_primitives import SHEET
from tests.figures import sum_up
from tests.tools import require_module

APPROVED = Path(__file__).parent / "approved"
DESIGNS = {
    "calibrated": ("adult_finger", (*CALIBRATED, "hand.axis_height_mm=6")),
    "flange": (
        "fsr400",
        (
            "bone.interface=flange",
            "bone.base_length_mm=27",
            "bone.foot_radius_mm=1.65",
            "printer.surface_error_mm=0",
        ),
    ),
}


def describe_drawing(drawing: PartDrawing) -> Iterator[str]:
    yield f"{drawing.part}: {drawing.title}, plan {drawing.plan}, {drawing.material}"
    yield from (f"  {line}" for size in drawing.sizes for line in describe_size(size))
    yield from (f"  {note}" for note in drawing.notes)


def describe_size(size: Size) -> Iterator[str]:
    yield (
        f"{size.name}: {size.text()}, {size.printed:.4g} in print, grows {size.growth:g}; "
        f"{size.view}"
    )
    if isinstance(size, Circle):
        yield f"  circle about {size.axis} at {sum_up(size.centre)}, {size.count} times"
    else:
        yield f"  {size.side}, along {size.axis}, {sum_up(size.start)} to {sum_up(size.end)}"
    if size.tolerance or size.action:
        limits = (size.tolerance.low, size.tolerance.high) if size.tolerance else ()
        yield f"  limits {sum_up(limits)}: {size.action}"


@pytest.mark.every_case
@pytest.mark.parametrize("name", DESIGNS)
def test_sizes_of_all_parts_are_the_approved_ones(name: str) -> None:
    drawings = part_drawings(load_variant(DESIGNS[name]))
    check_figures(
        APPROVED / f"sizes_{name}.txt", (line for one in drawings for line in describe_drawing(one))
    )


def draw_box(design: Design, drawing: PartDrawing) -> dict[ViewName, ProjectedView]:
    """Views of the box around a part, with a hidden line, and its section filled."""
    corners = MeshEvaluator(0.2).mesh(PARTS[drawing.part].solid(design)).vertices
    views = {}
    for name in drawing.views:
        flat = [
            PROJECTIONS[name].flatten(tuple(corner))
            for corner in (corners.min(axis=0), corners.max(axis=0))
        ]
        (left, right), (low, high) = (sorted(values) for values in zip(*flat, strict=True))
        ring = ((left, low), (right, low), (right, high), (left, high))
        hidden = (((left, 0.0), (right, 0.0)),)
        views[name] = ProjectedView(
            ((*ring, ring[0]),), hidden, (ring,) if name == "section" else ()
        )
    return views


def describe_sheet(sheet: Sheet) -> Iterator[str]:
    """Every text with its place, and of the lines of each kind
    their number, length and mean end [mm].
    """
    yield f"{sheet.name}, {sheet.width:g} x {sheet.height:g}"
    drawn: dict[str, list[np.ndarray]] = {}
    for one in sheet.primitives:
        if isinstance(one, Text):
            yield (
                f"text {one.text!r} {one.height:g} high at {sum_up(one.at)} "
                f"{one.anchor}{' upwards' * one.turned}"
            )
        else:
            style = (
                ""
                if isinstance(one, Arrow)
                else f" {one.style.name} {one.style.width_mm} {one.style.dashes_mm}"
            )
            drawn.setdefault(f"{type(one).__name__}{style}", []).extend(map(np.array, one.trace()))
    for kind, lines in drawn.items():
        length = sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in lines)
        x, y = np.concatenate(lines).mean(axis=0)
        yield f"{kind}: {len(lines)}, long {length:.2f}, about {x:.3f} {y:.3f}"


@pytest.mark.parametrize(("name", "part"), [("calibrated", "mold_dorsal"), ("flange", "bone")])
def test_sheet_is_the_approved_one(name: str, part: str) -> None:
    design = load_variant(DESIGNS[name])
    (drawing,) = (one for one in part_drawings(design) if one.part == part)
    sheet = lay_out(
        drawing,
        draw_box(design, drawing),
        Heading("a-name-of-forty-characters-is-cut-1234567", "", 2, 4),
    )
    check_figures(APPROVED / f"sheet_{part}.txt", describe_sheet(sheet), 0.0, 0.02)


def test_pdf_and_svg_of_all_primitives_are_the_approved_ones() -> None:
    """And the PDF has a page for each sheet and no date of today."""
    require_module("reportlab")
    check_figures(APPROVED / "primitives.svg", render_svg(SHEET).decode().splitlines())
    data = render_pdf((SHEET, SHEET), "title")
    assert data == render_pdf((SHEET, SHEET), "title")
    assert re.findall(rb"/CreationDate \(D:(\d{4})", data) == [b"2000"]
    assert re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", data) == 2 * [
        (b"283.4646", b"198.4252")
    ]
    contents = re.findall(rb"stream\r?\n(.*?)endstream", data, re.DOTALL)
    first, second = (
        zlib.decompress(base64.a85decode(text.strip(), adobe=False) if text else b"")
        for text in (part.strip().removesuffix(b"~>") for part in contents)
    )
    assert first == second
    check_figures(APPROVED / "primitives_pdf.txt", first.decode("latin-1").splitlines())
