"""Registry of the scenes, and the pictures of a procedure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from fingertip.design import Design
from fingertip.pictures.steps import filling_scenes as filling
from fingertip.pictures.steps import filling_scenes as mixing
from fingertip.pictures.steps import mold_scenes as finishing
from fingertip.pictures.steps import mold_scenes as mold
from fingertip.pictures.steps import sensor_scenes as sensor
from fingertip.pictures.steps.bench import Bench
from fingertip.pictures.steps.scene import Scene, draw_scene

SCENES: Mapping[str, Callable[[Bench, Mapping[str, Any]], Scene]] = {
    "cure_test": mold.cure_test, "close_empty": mold.close_empty, "try_fit": mold.try_fit, "drill": mold.drill,
    "release": mold.release, "seat_tape": mold.seat_tape, "hold": mold.hold, "bolt": mold.bolt,
    "try_cone": filling.try_cone,
    "try_syringe": filling.try_syringe, "measure": filling.measure, "fill": filling.fill, "leave": filling.leave,
    "stand": filling.stand, "pour": filling.pour, "cure": filling.cure,
    "open": finishing.open_mold, "patch": finishing.patch,
    "core_only": mold.core_only, "roll_off": finishing.roll_off, "pull_on": finishing.pull_on,
    "weigh": mixing.weigh, "degas": mixing.degas, "load_syringe": mixing.load_syringe,
    "place_sensor": sensor.place_sensor, "wires": sensor.wires, "try_fold": sensor.try_fold,
    "solder_tabs": sensor.solder_tabs, "thread": sensor.thread, "fold": sensor.fold, "stick_head": sensor.stick_head,
    "bend_wires": sensor.bend_wires, "stick_lid": sensor.stick_lid, "cover_sensor": sensor.cover_sensor,
    "seal_passage": sensor.seal_passage, "peel_tape": sensor.peel_tape,
    "cover_for_sleeve": sensor.cover_sensor, "try_anchor": sensor.try_anchor, "prime": mold.prime,
    "pin": sensor.pin, "bend": sensor.bend, "anchor": sensor.anchor, "wire_loop": sensor.wire_loop,
}  # fmt: skip
"""Every scene by the name of its step."""


def draw_steps(
    design: Design,
    data: Mapping[str, Any],
    names: Sequence[str],
    progress: Callable[[str], None] = lambda message: None,
) -> dict[str, bytes]:
    """Draw the picture of each step, by the names of their scenes."""
    bench, pictures = Bench(design), {}
    for number, name in enumerate(names, 1):
        progress(f"drawing step {number} of {len(names)}")
        pictures[f"{number:02}-{name}.png"] = draw_scene(SCENES[name](bench, data))
    return pictures
