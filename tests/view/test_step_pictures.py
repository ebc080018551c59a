"""Pictures of the steps: labels are legible, what is drawn and pointed at is as approved, and the sheet links it."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PIL.ImageDraw import ImageDraw

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.casting.sheet import casting_sheet
from fingertip.design import Design
from fingertip.design.geometry.solids import Point3
from fingertip.documents.finger import list_steps
from fingertip.pictures.casting_scenes import SCENES
from fingertip.pictures.joint_scenes import JOINT_SCENES
from fingertip.pictures.raster import Canvas
from fingertip.pictures.scene import Bench, draw_scene
from tests.approved import check_figures
from tests.conftest import design_file, run_fingertip
from tests.figures import sum_up
from tests.view.describe import PenRecord

APPROVED = Path(__file__).parent / "approved"


def is_inside(mesh: Mesh, point_mm: Point3) -> bool:
    """Tell whether a point is in a closed mesh, by solid angles (van Oosterom and Strackee, 1983)."""
    a, b, c = (mesh.vertices[mesh.triangles].transpose(1, 0, 2) - point_mm).astype(float)
    i, j, k = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    dots = (a * b).sum(axis=1) * k + (b * c).sum(axis=1) * i + (c * a).sum(axis=1) * j
    return bool(abs(np.arctan2((a * np.cross(b, c)).sum(axis=1), i * j * k + dots).sum()) > math.pi)


OTHERS = [pytest.param(name, marks=pytest.mark.full) for name in ("first_finger", "adult_finger")]


@pytest.mark.parametrize(
    ("name", "scenes", "approved"),
    [
        pytest.param("first_finger", SCENES, "", marks=pytest.mark.full),
        ("article", SCENES, "steps_article.txt"),
        pytest.param("adult_finger", SCENES, "", marks=pytest.mark.full),
        ("adult_finger", JOINT_SCENES, "steps_joint.txt"),
    ],
)
def test_labels_stand_apart_inside_the_picture(
    name: str, scenes: Collection[str], approved: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is drawn, and where lines and arrows point, is as approved, of a finger with each scene."""
    boxes: list[tuple[float, float, float, float]] = []
    pen = PenRecord(monkeypatch)
    original = ImageDraw.multiline_text

    def record(self: ImageDraw, xy: Any, text: str, *args: Any, **kwargs: Any) -> None:
        box = self.multiline_textbbox(
            xy, text, font=kwargs["font"], anchor=kwargs["anchor"], spacing=kwargs["spacing"], align=kwargs["align"]
        )
        boxes.append(box)
        original(self, xy, text, *args, **kwargs)

    monkeypatch.setattr(ImageDraw, "multiline_text", record)
    monkeypatch.setattr(Canvas, "draw", lambda *args: None)  # the text alone
    design = Design.load(design_file(name))
    sheet, bench = casting_sheet(design, MeshEvaluator(0.05)), Bench(design)
    for picture in (step.picture for step in list_steps(sheet) if step.picture in scenes):
        boxes.clear()
        scene = SCENES[picture](bench, sheet)
        for mesh, colour in ((item.mesh, item.colour) for item in scene.shown):
            ends = f"{sum_up(mesh.vertices.min(axis=0))} to {sum_up(mesh.vertices.max(axis=0))}"
            pen.lines.append(f"{picture}: {mesh.area():.4g} mm2 of {sum_up(colour)} from {ends}")
        for end in (end for arrow in scene.arrows for end in (arrow.start_mm, arrow.end_mm)):
            assert not any(is_inside(each.mesh, end) for each in scene.shown), (picture, "an arrow is hidden")
        width, height = Image.open(io.BytesIO(draw_scene(scene))).size
        assert boxes, picture
        for i, (left, top, right, bottom) in enumerate(boxes):
            assert 0 <= left < right <= width, (picture, i)
            assert 0 <= top < bottom <= height, (picture, i)
            for other in boxes[:i]:
                apart = right <= other[0] or other[2] <= left or bottom <= other[1] or other[3] <= top
                assert apart, (picture, i)
    if approved:
        check_figures(APPROVED / approved, pen.lines)


@pytest.mark.full
def test_sheet_command_writes_the_pictures_that_the_page_links(tmp_path: Path) -> None:
    done = run_fingertip("sheet", "first_finger", "--pictures", "--out", str(tmp_path / "sheet.md"), "--quiet")
    assert done.returncode == 0, done.stderr
    linked = re.findall(r"!\[step \d+\]\((steps/[^)]+)\)", (tmp_path / "sheet.md").read_text())
    assert len(linked) == 12
    assert all((tmp_path / path).read_bytes().startswith(b"\x89PNG") for path in linked)
