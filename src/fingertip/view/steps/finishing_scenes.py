"""Scenes after the cure: open the mold, trim and patch the skin, and pull a sleeve over its bone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.filling.mold_filling import place_vents
from fingertip.view.steps.bench import Bench
from fingertip.view.steps.cameras import DORSAL, RUNNER_SIDE
from fingertip.view.steps.scene import Arrow, Label, Scene

Data = Mapping[str, Any]


def open_mold(bench: Bench, data: Data) -> Scene:
    """Show the halves apart, and the casting with what is cut off."""
    m, apart, inlet = bench.design.mold_layout, 1.3 * bench.apart_mm, bench.design.mold_layout.inlet
    pushed = "core" if bench.insert == "core" else "finger"
    labels = [Label(f"push the {pushed} out\nhere, on the base", (0.0, 0.0, bench.design.mold_layout.proximal_z - 1.0))]
    if inlet:
        labels.append(Label("cut the runner\nflush here", (inlet.gate_x, 0.3, inlet.gate_z)))
    for vent in place_vents(bench.design):
        labels.append(Label("cut the vent stub", vent.point_mm))
    return Scene(
        (
            bench.part("mold_dorsal", (0.0, apart, 0.0)), bench.part("mold_palmar", (0.0, -apart, 0.0)),
            *bench.in_mold(), bench.casting(),
        ),
        RUNNER_SIDE,
        tuple(labels),
        (
            Arrow((0.0, apart * 0.6, m.distal_z + 3.0), (0.0, apart * 1.3, m.distal_z + 3.0)),
            Arrow((0.0, -apart * 0.6, m.distal_z + 3.0), (0.0, -apart * 1.3, m.distal_z + 3.0)),
        ),
    )  # fmt: skip


def patch(bench: Bench, data: Data) -> Scene:
    """Show the finger with the hole of the chaplet, which is filled."""
    chaplet = bench.design.dimensions.chaplet
    assert chaplet
    height = bench.design.dimensions.outer.dorsal_height_at(0.0, chaplet.z)
    return Scene(
        (*bench.assembled_bone(), bench.part("skin"), *bench.patch()),
        DORSAL,
        (Label("fill this hole,\nlevel with the skin", (0.0, height, chaplet.z)),),
    )


def roll_off(bench: Bench, data: Data) -> Scene:
    """Show the core on its way out of the skin."""
    out = bench.design.skin.length_mm * 0.7
    low = bench.design.dimensions.base_end_z
    return Scene(
        (bench.part("skin"), bench.part("core", (0.0, 0.0, -out))),
        DORSAL,
        (Label("roll the edge back\nand strip the skin off", (0.0, 0.0, 0.0)), Label("core", (0.0, 0.0, low - out))),
        (Arrow((0.0, 12.0, 0.0), (0.0, 12.0, 14.0)),),
    )


def pull_on(bench: Bench, data: Data) -> Scene:
    """Show the skin on its way onto the bone."""
    out = bench.design.skin.length_mm * 1.05
    return Scene(
        (*bench.assembled_bone(), bench.part("skin", (0.0, 0.0, out))),
        DORSAL,
        (
            Label("wet inside", (0.0, 0.0, out)),
            Label(
                "edge of the skin\nends here, on the collar", (0.0, bench.design.dimensions.collar.section.dorsal, 0.0)
            ),
            Label(
                "keep sensor and slot dry", (0.0, -bench.design.dimensions.flat_depth, bench.design.dimensions.sensor_z)
            ),
        ),
        (Arrow((0.0, 12.0, out + 6.0), (0.0, 12.0, out - 10.0)),),
    )
