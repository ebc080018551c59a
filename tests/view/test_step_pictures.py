"""Pictures of the steps: labels stand beside the parts and end at one,
no arrow is hidden, and the sheet links them.
"""

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
from fingertip.documents.finger_sheets import list_steps
from fingertip.models.solids import Point3
from fingertip.pictures.casting_scenes import SCENES
from fingertip.pictures.joint_scenes import JOINT_SCENES
from fingertip.pictures.labelled_scene import MARGIN_PX, Scene, draw_scene
from fingertip.pictures.raster import Canvas
from fingertip.pictures.workbench import Workbench
from tests.conftest import design_file, run_fingertip


def is_inside(mesh: Mesh, point_mm: Point3) -> bool:
    """Tell whether a point is in a closed mesh, by solid angles (van Oosterom and
    Strackee, 1983).
    """
    a, b, c = (mesh.vertices[mesh.triangles].transpose(1, 0, 2) - point_mm).astype(float)
    i, j, k = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    dots = (a * b).sum(axis=1) * k + (b * c).sum(axis=1) * i + (c * a).sum(axis=1) * j
    return bool(abs(np.arctan2((a * np.cross(b, c)).sum(axis=1), i * j * k + dots).sum()) > math.pi)


def is_at_a_part(scene: Scene, point_mm: Point3) -> bool:
    """Tell whether a part is drawn where a point appears, or within 0.5 mm of it."""
    to_picture = scene.camera.axes[:2].T
    for mesh in (item.mesh for item in scene.meshes):
        for beside in 0.5 * np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)]):
            a, b, c = ((mesh.vertices - point_mm) @ to_picture + beside)[mesh.triangles].transpose(
                1, 2, 0
            )
            sides = [p[0] * q[1] - p[1] * q[0] for p, q in ((a, b), (b, c), (c, a))]
            if np.any((np.min(sides, axis=0) >= 0.0) | (np.max(sides, axis=0) <= 0.0)):
                return True
    return False


@pytest.mark.parametrize(
    ("name", "scenes"),
    [
        pytest.param("first_finger", SCENES, marks=pytest.mark.full),
        ("article", SCENES),
        pytest.param("adult_finger", SCENES, marks=pytest.mark.full),
        ("adult_finger", JOINT_SCENES),
    ],
)
def test_labels_stand_apart_inside_the_picture_and_end_at_a_part(
    name: str, scenes: Collection[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    boxes: list[tuple[float, float, float, float]] = []
    original = ImageDraw.multiline_text

    def record(self: ImageDraw, xy: Any, text: str, *args: Any, **kwargs: Any) -> None:
        box = self.multiline_textbbox(
            xy,
            text,
            font=kwargs["font"],
            anchor=kwargs["anchor"],
            spacing=kwargs["spacing"],
            align=kwargs["align"],
        )
        boxes.append(box)
        original(self, xy, text, *args, **kwargs)

    monkeypatch.setattr(ImageDraw, "multiline_text", record)
    monkeypatch.setattr(Canvas, "draw", lambda *args: None)  # the text alone
    design = Design.load(design_file(name))
    sheet = casting_sheet(design, MeshEvaluator(0.05))
    workbench = Workbench(design)
    for picture in (step.picture for step in list_steps(sheet) if step.picture in scenes):
        boxes.clear()
        scene = SCENES[picture](workbench, sheet)
        assert [
            label.text for label in scene.labels if not is_at_a_part(scene, label.point_mm)
        ] == [], picture
        for end in (end for arrow in scene.arrows for end in (arrow.start_mm, arrow.end_mm)):
            assert not any(is_inside(item.mesh, end) for item in scene.meshes), (
                picture,
                "an arrow is hidden",
            )
        width, height = Image.open(io.BytesIO(draw_scene(scene))).size
        assert boxes, picture
        for i, (left, top, right, bottom) in enumerate(boxes):
            assert 0 <= left < right <= MARGIN_PX or width - MARGIN_PX <= left < right <= width, (
                picture,
                i,
            )
            assert 0 <= top < bottom <= height, (picture, i)
            for other in boxes[:i]:
                apart = (
                    right <= other[0] or other[2] <= left or bottom <= other[1] or other[3] <= top
                )
                assert apart, (picture, i)


@pytest.mark.full
def test_sheet_command_writes_the_pictures_that_the_page_links(tmp_path: Path) -> None:
    done = run_fingertip(
        "sheet", "first_finger", "--pictures", "--out", str(tmp_path / "sheet.md"), "--quiet"
    )
    assert done.returncode == 0, done.stderr
    linked = re.findall(r"!\[step \d+\]\((steps/[^)]+)\)", (tmp_path / "sheet.md").read_text())
    assert len(linked) == 12
    assert all((tmp_path / path).read_bytes().startswith(b"\x89PNG") for path in linked)
