"""Registry of the scenes, and the pictures of a procedure."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence

from fingertip.design import Design
from fingertip.foundation.progress import Work
from fingertip.pictures.steps import filling_scenes, mold_scenes, sensor_scenes
from fingertip.pictures.steps.objects import Bench
from fingertip.pictures.steps.scene import Data, Scene, draw_scene

SCENES: Mapping[str, Callable[[Bench, Data], Scene]] = {
    name.rstrip("_"): scene
    for module in (mold_scenes, filling_scenes, sensor_scenes)
    for name, scene in inspect.getmembers(module, inspect.isfunction)
    if scene.__module__ == module.__name__ and not name.startswith("_")
} | {"cover_for_sleeve": sensor_scenes.cover_sensor}
"""Scenes by the names of their steps: every public function of the three modules is one."""


def draw_steps(
    design: Design, data: Data, names: Sequence[str], progress: Callable[[str], None] = lambda message: None
) -> dict[str, bytes]:
    bench, pictures = Bench(design), {}
    work = Work("", {"pictures of the steps": 1.0}, progress)
    work.begin("pictures of the steps")
    for number, name in enumerate(names, 1):
        work.advance((number - 1) / len(names))
        pictures[f"{number:02}-{name}.png"] = draw_scene(SCENES[name](bench, data))
    return pictures
