"""Registry of the scenes, the pictures of a procedure, and a picture of the finished finger."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence

import numpy as np
from PIL import Image

from fingertip.cad.shapes.insert import cavity_outline
from fingertip.design import Design
from fingertip.design.geometry.solids import cylinder, intersection
from fingertip.foundation.progress import Work
from fingertip.pictures.raster import Canvas, bounds, to_png
from fingertip.pictures.steps import filling_scenes, first_scenes, mold_scenes, sensor_scenes
from fingertip.pictures.steps.objects import Bench
from fingertip.pictures.steps.scene import Data, Paint, Scene, View, draw_scene


def list_scenes(design: Design) -> dict[str, Callable[[Bench, Data], Scene]]:
    """List the scenes by the names of their steps: every public function of the modules is one."""
    modules = (first_scenes,) if design.mold.method == "plunge" else (mold_scenes, filling_scenes, sensor_scenes)
    return {
        name.rstrip("_"): scene
        for module in modules
        for name, scene in inspect.getmembers(module, inspect.isfunction)
        if scene.__module__ == module.__name__ and not name.startswith("_")
    }


def draw_steps(
    design: Design, data: Data, names: Sequence[str], progress: Callable[[str], None] = lambda message: None
) -> dict[str, bytes]:
    bench, scenes, pictures = Bench(design), list_scenes(design), {}
    work = Work("", {"pictures of the steps": 1.0}, progress)
    work.begin("pictures of the steps")
    for number, name in enumerate(names, 1):
        work.advance((number - 1) / len(names))
        pictures[f"{number:02}-{name}.png"] = draw_scene(scenes[name](bench, data))
    return pictures


_EDGE_PX = 4
"""Distance of the finished finger from the edge of its picture."""


def draw_finger(design: Design, width_px: int = 640) -> bytes:
    """Draw the finished finger, its skin patched, from the back and below from the palm, on a clear ground."""
    bench = Bench(design)
    shown = [*bench.assembled_bone(), bench.part("skin")]
    if chaplet := bench.dims.chaplet:
        hole = cylinder("y", (chaplet.z, 0.0), chaplet.facet_y, bench.layout.dorsal_height, chaplet.radius)
        shown.append(bench.solid(intersection(hole, cavity_outline(design)), Paint.SILICONE))
    views = []
    for camera in (View.DORSAL, View.PALMAR):
        centre, size = bounds([item.mesh for item in shown], camera)
        scale = (width_px - 2 * _EDGE_PX) / float(size[0])
        canvas = Canvas(width_px, int(size[1] * scale) + 2 * _EDGE_PX, scale, camera)
        for item in shown:
            canvas.draw(item.mesh, item.colour, centre)
        views.append(np.dstack([canvas.image(), canvas.cover()]))
    return to_png(Image.fromarray(np.concatenate(views)))
