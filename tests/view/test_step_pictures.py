"""Pictures of the casting steps: each step has its own, labels are legible, and what they say is on the sheet."""

from __future__ import annotations

import io
import math
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PIL.ImageDraw import ImageDraw

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.casting.quantities import measure_volumes
from fingertip.design import Design
from fingertip.documents.casting.sheet import casting_sheet_data, render_sheet, steps
from fingertip.pictures.raster import Canvas
from fingertip.pictures.steps.objects import Bench
from fingertip.pictures.steps.pictures import list_scenes
from fingertip.pictures.steps.scene import Scene, draw_scene
from tests.approved import check_figures
from tests.conftest import design_file, run_fingertip
from tests.view.describe import PenRecord, describe_scene, join_lines

APPROVED = Path(__file__).parent / "approved"
DESIGNS = {"fsr400": ("fsr400", ()), "adult_finger": ("adult_finger", ("sensor.insert=disc",))}
"""Designs that have all scenes between them."""


@cache
def load(name: str, *changes: str) -> tuple[Design, dict[str, Any]]:
    design = Design.load(design_file(name), changes=list(changes))
    volumes = measure_volumes(design, MeshEvaluator(0.05))
    return design, casting_sheet_data(design, volumes, design.silicone.material)


@cache
def scenes(name: str, *changes: str) -> dict[str, Scene]:
    design, data = load(name, *changes)
    bench = Bench(design)
    return {step.picture: list_scenes(design)[step.picture](bench, data) for step in steps(data)}


@pytest.mark.every_case
@pytest.mark.parametrize("name", DESIGNS)
def test_scenes_are_the_approved_ones(name: str) -> None:
    file, changes = DESIGNS[name]
    found = scenes(file, *changes).items()
    check_figures(APPROVED / f"scenes_{name}.txt", join_lines((key, describe_scene(scene)) for key, scene in found))


def test_every_scene_is_used_and_no_step_shows_the_picture_of_another() -> None:
    used = set[str]()
    for file, changes in DESIGNS.values():
        names = [step.picture for step in steps(load(file, *changes)[1])]
        assert len(names) == len(set(names))
        used |= set(names)
    assert used == set(list_scenes(load("fsr400")[0]))


def test_labels_and_arrows_are_drawn_as_approved(monkeypatch: pytest.MonkeyPatch) -> None:
    """A scene as wide as it may be, one as high as it may be, and one whose labels fill a margin."""
    shown = {name: scenes("fsr400")[name] for name in ("measure", "load_syringe", "cure_test")}
    pen = PenRecord(monkeypatch)
    monkeypatch.setattr(Canvas, "draw", lambda *args: None)
    for name, scene in shown.items():
        pen.lines.append(f"{name}, {Image.open(io.BytesIO(draw_scene(scene))).size}")
    check_figures(APPROVED / "drawn_scenes.txt", pen.lines, abs_=0.6)


@pytest.mark.full
@pytest.mark.parametrize("name", ["fsr400", "fsr402", "adult_finger", "first_finger"])
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
    for picture, scene in scenes(name).items():
        boxes.clear()
        width, height = Image.open(io.BytesIO(draw_scene(scene))).size
        assert boxes, picture
        for i, (left, top, right, bottom) in enumerate(boxes):
            assert 0 <= left < right <= width, (picture, i)
            assert 0 <= top < bottom <= height, (picture, i)
            for other in boxes[:i]:
                apart = right <= other[0] or other[2] <= left or bottom <= other[1] or other[3] <= top
                assert apart, (picture, i)


@pytest.mark.parametrize("name", ["fsr400", "adult_finger", "first_finger"])
def test_labels_state_numbers_of_the_sheet_and_lie_on_what_is_drawn(name: str) -> None:
    """Each number with a unit stands in the text of the page too, but for levels in a drawn cup."""
    file, changes = DESIGNS.get(name, (name, ()))
    page, checked = render_sheet(load(file, *changes)[1]), 0
    for picture, scene in scenes(file, *changes).items():
        corners = np.concatenate([item.mesh.vertices for item in scene.shown])
        low, high = corners.min(axis=0) - 3.0, corners.max(axis=0) + 3.0
        for label in scene.labels:
            assert np.all(low <= label.point_mm), (picture, label)
            assert np.all(label.point_mm <= high), (picture, label)
            units = r"\d+(?:\.\d+)? (?:mm|g|N|s|h|cm3|Mohm|degrees)\b"
            for number in re.findall(units, label.text.replace("\n", " ")) if picture != "degas" else ():
                assert number in page, (picture, number)
                checked += 1
    assert checked > 5


def test_syringe_is_drawn_with_as_much_silicone_as_it_holds() -> None:
    """5 ml in all, less the end wall and a hundredth of the radius. And 11 g of 1.07 g/cm3 in a cup 44 mm wide."""
    bench = Bench(load("fsr400")[0])
    most, half = (bench.syringe(fill_share=share)[-1].mesh.volume() for share in (0.9, 0.45))
    assert most - half == pytest.approx(0.45 * 5000.0 * 0.99**2, rel=0.01)
    (level,) = re.findall(r"(\d+) mm high in this cup", " ".join(one.text for one in scenes("fsr400")["degas"].labels))
    assert float(level) == pytest.approx(11e3 / 1.07 / (math.pi * 22.0**2), abs=0.5)


@pytest.mark.full
def test_sheet_command_writes_the_pictures_that_the_page_links(tmp_path: Any) -> None:
    done = run_fingertip("sheet", "fsr400", "--pictures", "--out", str(tmp_path / "sheet.md"), "--quiet")
    assert done.returncode == 0, done.stderr
    linked = re.findall(r"!\[step \d+\]\((steps/[^)]+)\)", (tmp_path / "sheet.md").read_text())
    assert len(linked) == len(steps(load("fsr400")[1]))
    assert all((tmp_path / path).read_bytes().startswith(b"\x89PNG") for path in linked)
