"""Animation of the example that holds a slipping block, with and without the detector, for the
docs.

Run with MuJoCo beside the packages of the tests: `python -m tools.docs_site.grip_animation
docs/grip.webp`.
"""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fingertip import Design
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.foundation.numerics import Array
from fingertip.models.solids import Box
from fingertip.pictures.raster import Camera, Canvas
from fingertip.robot.finger_model import build_finger

_FROM_S = 1.9
_EVERY_S = 0.01
_FRAME_MS = 60
"""Beginning of what is shown, time between two pictures, and how
long each is shown: six times slower.
"""
_WIDTH_PX = 330
_HEIGHT_PX = 330
_PX_PER_MM = 2.9
_TEXT_PX = 58
Moment = tuple[float, Array, Array, bool]
"""Time, places of finger and block [mm], and whether the detector is ON."""
_SLAB_MM = 10.0
_SLABS = ((0.55, 0.62, 0.72), (0.78, 0.83, 0.9))
_ON = (176, 32, 32)
_OFF = (70, 70, 70)


def record(with_detector: bool, example: dict[str, Any]) -> list[Moment]:
    """Run the example, and return time, places of finger and block
    [mm], and the detector's state for each picture.
    """
    frames = list[Moment]()

    def watch(data: Any, on: bool) -> None:
        if data.time >= _FROM_S + len(frames) * _EVERY_S:
            places = (1e3 * data.body(name).xpos.copy() for name in ("fsr400", "block"))
            frames.append((data.time, *places, on))

    example["hold"](with_detector, watch)
    return frames


def draw_animation(example: dict[str, Any]) -> list[Image.Image]:
    finger = build_finger(Design.load("fsr400"))
    evaluator = MeshEvaluator(0.05)
    slab = evaluator.mesh(Box((-20.0, -20.0, 0.0), (20.0, 20.0, _SLAB_MM)))
    camera = Camera.looking_from((1.0, -0.25, 0.2), (0.0, 0.0, 1.0))
    offset_mm = 1e3 * np.array(finger.offset_m)
    font = ImageFont.load_default(15)
    runs = [record(with_detector, example) for with_detector in (True, False)]
    begin = runs[0][0][2][2]
    pictures = []

    for moments in zip(*runs, strict=True):
        whole = Image.new("RGB", (2 * _WIDTH_PX, _HEIGHT_PX + _TEXT_PX), "white")
        pen = ImageDraw.Draw(whole)
        for side, (time_s, at, block, on) in enumerate(moments):
            canvas = Canvas(_WIDTH_PX, _HEIGHT_PX, _PX_PER_MM, camera)
            centre = np.array([0.0, -8.0, 38.0])
            for number in range(-7, 7):
                moved = block + np.array([0.0, 0.0, _SLAB_MM * number])
                canvas.draw(Mesh(slab.vertices + moved, slab.triangles), _SLABS[number % 2], centre)

            for body in finger.bodies:
                canvas.draw(
                    Mesh(body.mesh.vertices + offset_mm + at, body.mesh.triangles),
                    body.colour,
                    centre,
                )

            whole.paste(Image.fromarray(canvas.image()), (side * _WIDTH_PX, _TEXT_PX))
            left = side * _WIDTH_PX + 12
            title = "the grip stays as it is" if side else "the grip tightens when slip is found"
            said = "pulled" if time_s >= example["PULL_S"] else "held"
            pen.text((left, 6), title, _OFF, font)
            pen.text((left, 26), f"{said}, slipped {abs(block[2] - begin):.1f} mm", _OFF, font)
            pen.text((left + 200, 26), "SLIP" if on else "", _ON, font)

        pictures.append(whole)

    return pictures


if __name__ == "__main__":
    pictures = draw_animation(
        runpy.run_path(str(Path(__file__).parents[2] / "examples/hold_a_slipping_block.py"))
    )
    pictures[0].save(
        sys.argv[1],
        save_all=True,
        append_images=pictures[1:],
        duration=_FRAME_MS,
        loop=0,
        quality=70,
        method=6,
    )
