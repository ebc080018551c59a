"""Registry of the scenes, the pictures of a sheet's steps, and a picture of the finished finger."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence

import numpy as np
from PIL import Image

from fingertip.casting.sheet import CastingSheet
from fingertip.design import Design
from fingertip.foundation.progress import Work
from fingertip.pictures.raster import Canvas, bounds, to_png
from fingertip.pictures.steps import joint_scenes, scenes
from fingertip.pictures.steps.scene import Bench, Scene, View, draw_scene

SCENES: dict[str, Callable[[Bench, CastingSheet], Scene]] = {
    name.rstrip("_"): scene
    for module in (scenes, joint_scenes)
    for name, scene in inspect.getmembers(module, inspect.isfunction)
    if scene.__module__ == module.__name__ and not name.startswith("_")
}
"""Scenes by the names of their steps: every public function of both modules is one."""


def draw_steps(
    design: Design, sheet: CastingSheet, names: Sequence[str], progress: Callable[[str], None] = lambda message: None
) -> dict[str, bytes]:
    bench, pictures = Bench(design), dict[str, bytes]()
    work = Work("", {"pictures of the steps": 1.0}, progress)
    work.begin("pictures of the steps")
    for number, name in enumerate(names, 1):
        work.advance((number - 1) / len(names))
        pictures[f"{number:02}-{name}.png"] = draw_scene(SCENES[name](bench, sheet))
    return pictures


_EDGE_PX = 4
"""Distance of the finished finger from the edge of its picture."""


def draw_finger(design: Design, width_px: int = 640) -> bytes:
    """Draw the finished finger from the back and below from the palm, on a clear ground."""
    bench = Bench(design)
    shown = [*bench.assembled_bone(), bench.part("skin")]
    views = []
    for camera in (View.DORSAL, View.PALMAR):
        centre, size = bounds([item.mesh for item in shown], camera)
        scale = (width_px - 2 * _EDGE_PX) / float(size[0])
        canvas = Canvas(width_px, int(size[1] * scale) + 2 * _EDGE_PX, scale, camera)
        for item in shown:
            canvas.draw(item.mesh, item.colour, centre)
        views.append(np.dstack([canvas.image(), canvas.cover()]))
    return to_png(Image.fromarray(np.concatenate(views)))
