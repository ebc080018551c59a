"""Plan view of the coupon, and the places of its lengths and heights, found again on the mesh."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from PIL.ImageDraw import ImageDraw

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.shapes.coupon import COUPON_PARTS, list_heights
from fingertip.calibration.readings import Length, list_lengths
from fingertip.design import Design
from fingertip.pictures import coupon_plan
from fingertip.pictures.coupon_plan import draw_plan
from fingertip.pictures.raster import Canvas
from tests.conftest import ROOT, design_file, some_of
from tests.drawing.test_printed_sizes import calibrated

FILES = sorted(path.stem for path in (ROOT / "params").glob("*.toml"))
STEP_MM = 0.1
"""Distance from the end of a length at which material begins or ends; half the thinnest wall is more."""


def meshes_of(design: Design) -> dict[str, Mesh]:
    evaluator = MeshEvaluator(0.01)
    return {name: evaluator.mesh(part.solid(design)) for name, part in COUPON_PARTS.items()}


def has_material(mesh: Mesh, x: float, y: float, z: float) -> bool:
    """Whether a point lies in a mesh: a vertical ray from it leaves once more than it enters."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    point = np.array([x + 1e-7, y + 2e-7])

    def side(p: np.ndarray, q: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
        along, to = q[:, :2] - p[:, :2], point - p[:, :2]
        found: np.ndarray = along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]  # type: ignore[type-arg]
        return found

    u, v, w = side(b, c), side(c, a), side(a, b)
    total = u + v + w
    crossed = ((u > 0) & (v > 0) & (w > 0)) | ((u < 0) & (v < 0) & (w < 0))
    heights = (u * a[:, 2] + v * b[:, 2] + w * c[:, 2])[crossed] / total[crossed]
    return bool((heights > z).sum() % 2)


def is_at_its_place(meshes: Mapping[str, Mesh], length: Length) -> bool:
    """Whether the material ends, or begins, at both ends of a length at some height."""
    (x0, y0), (x1, y1) = length.ends
    dx, dy = (STEP_MM, 0.0) if length.axis == "x" else (0.0, STEP_MM)
    within, beyond = ((x0 + dx, y0 + dy), (x1 - dx, y1 - dy)), ((x0 - dx, y0 - dy), (x1 + dx, y1 + dy))
    mesh, is_inner = meshes[length.piece], length.kind == "inner"
    for z in (0.2, 1.0, 1.5, 2.0, 3.0, 5.0):
        inside = [has_material(mesh, *point, z) for point in within]
        outside = [has_material(mesh, *point, z) for point in beyond]
        if inside == [not is_inner] * 2 and outside == [is_inner] * 2:
            return True
    return False


@pytest.mark.full
@pytest.mark.parametrize("name", some_of(FILES, "fsr400", "adult_thumb"))
def test_lengths_and_heights_are_where_the_plan_draws_them(name: str) -> None:
    design = Design.load(design_file(name))
    meshes = meshes_of(design)
    lengths = list_lengths(design)
    assert [each.name for each in lengths if not is_at_its_place(meshes, each)] == []
    for height in list_heights(design):
        below, above = height.height_mm - 0.02, height.height_mm + 0.02
        found = [has_material(meshes[height.piece], *height.at, z) for z in (below, above)]
        assert found == [True, False], height.feature
    for each in lengths:  # the place states the same length, and one that is off is found
        (x0, y0), (x1, y1) = each.ends
        assert each.nominal_mm == pytest.approx(abs(x1 - x0) + abs(y1 - y0), abs=1e-6), each.name
        dx, dy = (0.25, 0.0) if each.axis == "x" else (0.0, 0.25)
        moved = replace(each, ends=((x0 + dx, y0 + dy), (x1 + dx, y1 + dy)))
        assert not is_at_its_place(meshes, moved), each.name


def test_plan_of_a_calibrated_printer_states_the_heights_of_its_files(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    original = ImageDraw.text

    def record(self: ImageDraw, xy: Any, text: str, **kwargs: Any) -> None:
        said.append(text)
        original(self, xy, text, **kwargs)

    monkeypatch.setattr(ImageDraw, "text", record)
    monkeypatch.setattr(Canvas, "draw", lambda *args: None)  # the text alone
    monkeypatch.setattr(coupon_plan, "_WIDTH_PX", 200)
    design = calibrated("fsr400")
    meshes = {
        name: Mesh(1.004 * mesh.vertices, mesh.triangles)
        for name, part in COUPON_PARTS.items()
        for mesh in [MeshEvaluator(0.2).mesh(part.solid(design))]
    }
    draw_plan(design, meshes)
    heights = [float(found[1]) for found in (re.fullmatch(r"Z\d+: ([\d.]+)", text) for text in said) if found]
    tallest = max(mesh.vertices[:, 2].max() for mesh in meshes.values())
    assert max(heights) == pytest.approx(tallest, abs=0.006)
