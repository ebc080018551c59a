"""Pictures of the steps: labels are legible, and the sheet links what is written."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from PIL.ImageDraw import ImageDraw

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.casting.sheet import casting_sheet
from fingertip.design import Design
from fingertip.documents.finger import list_steps
from fingertip.pictures.casting_scenes import SCENES
from fingertip.pictures.raster import Canvas
from fingertip.pictures.scene import Bench, draw_scene
from tests.conftest import design_file, run_fingertip

OTHERS = [pytest.param(name, marks=pytest.mark.full) for name in ("first_finger", "adult_finger")]


@pytest.mark.parametrize("name", ["article", *OTHERS])
def test_labels_stand_apart_inside_the_picture(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    boxes: list[tuple[float, float, float, float]] = []
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
    for picture in (step.picture for step in list_steps(sheet)):
        boxes.clear()
        width, height = Image.open(io.BytesIO(draw_scene(SCENES[picture](bench, sheet)))).size
        assert boxes, picture
        for i, (left, top, right, bottom) in enumerate(boxes):
            assert 0 <= left < right <= width, (picture, i)
            assert 0 <= top < bottom <= height, (picture, i)
            for other in boxes[:i]:
                apart = right <= other[0] or other[2] <= left or bottom <= other[1] or other[3] <= top
                assert apart, (picture, i)


@pytest.mark.full
def test_sheet_command_writes_the_pictures_that_the_page_links(tmp_path: Path) -> None:
    done = run_fingertip("sheet", "first_finger", "--pictures", "--out", str(tmp_path / "sheet.md"), "--quiet")
    assert done.returncode == 0, done.stderr
    linked = re.findall(r"!\[step \d+\]\((steps/[^)]+)\)", (tmp_path / "sheet.md").read_text())
    assert len(linked) == 12
    assert all((tmp_path / path).read_bytes().startswith(b"\x89PNG") for path in linked)
