"""Scenes at the scale: weigh, degas, and load the syringe."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fingertip.cad.solids import Box, cylinder, difference
from fingertip.view.raster import Camera
from fingertip.view.steps.bench import GLASS, STEEL, Bench
from fingertip.view.steps.scene import Arrow, Label, Scene

Data = Mapping[str, Any]

_FRONT = Camera.looking_from((0.15, -1.0, 0.22), (0.0, 0.0, 1.0))
_CUP_RADIUS_MM, _CUP_HEIGHT_MM = 22.0, 45.0


def _find_level_mm(data: Data) -> float:
    """Level of the mixture in the cup [mm]."""
    density = 0.5 * sum(data["silicone"]["properties"]["density_g_cm3"][end] for end in ("low", "high"))
    return float(1000.0 * data["batch"]["total_g"] / density / (math.pi * _CUP_RADIUS_MM**2))


def weigh(bench: Bench, data: Data) -> Scene:
    """Show the cup on the scale, and the level after each component."""
    batch, (first, second) = data["batch"], data["silicone"]["components"]
    level = _find_level_mm(data)
    share = batch["a_g"] / batch["total_g"]
    scale = Box((-40.0, -35.0, -10.0), (40.0, 35.0, 0.0))
    return Scene(
        (*bench.cup(0.0, _CUP_RADIUS_MM, _CUP_HEIGHT_MM, level), bench.solid(scale, STEEL)),
        _FRONT,
        (
            Label(f"then {batch['b_g']:g} g of {second}:\n{batch['total_g']:g} g in all", (_CUP_RADIUS_MM, 0.0, level)),
            Label(f"first {batch['a_g']:g} g of {first}", (-_CUP_RADIUS_MM, 0.0, share * level)),
            Label("scale, set to zero\nwith the empty cup", (40.0, -35.0, -5.0)),
        ),
    )


def degas(bench: Bench, data: Data) -> Scene:
    """Show the cup under vacuum, large enough for the foam."""
    level = _find_level_mm(data)
    bell = difference(
        cylinder("z", (0.0, 0.0), -2.0, 75.0, 45.0), cylinder("z", (0.0, 0.0), 0.0, 72.0, 42.0),
        Box((-60.0, -60.0, 0.0), (60.0, 0.0, 90.0)),
    )  # fmt: skip
    return Scene(
        (*bench.cup(0.0, _CUP_RADIUS_MM, _CUP_HEIGHT_MM, 4 * level), bench.solid(bell, GLASS)),
        _FRONT,
        (
            Label("foam rises some\nfour times as high,\nthen falls", (_CUP_RADIUS_MM, 0.0, 4 * level)),
            Label("vacuum chamber", (-43.0, 0.0, 60.0)),
            Label(f"silicone before:\n{level:.0f} mm high in this cup", (-_CUP_RADIUS_MM, 0.0, level)),
        ),
    )


def load_syringe(bench: Bench, data: Data) -> Scene:
    """Show the syringe with its silicone."""
    filling, inlet = data["filling"], bench.design.mold_layout.inlet
    assert inlet
    share = filling["load_cm3"] / filling["syringe"]["volume_ml"]
    shown = bench.syringe(share)
    high = max(float(item.mesh.vertices[:, 1].max()) for item in shown)
    low = min(float(item.mesh.vertices[:, 1].min()) for item in shown)
    camera = Camera.looking_from((-1.0, -0.2, 0.2), (0.0, 1.0, 0.0))
    level = float(shown[-1].mesh.vertices[:, 1].max())
    radius = inlet.syringe.bore_mm / 2
    shown += [*bench.plunger_wire(level), *bench.nozzle_cap()]
    return Scene(
        tuple(shown),
        camera,
        (
            Label("cap: take it off\nbefore you press\nthe air out", (inlet.x, low, inlet.z)),
            Label(f"{filling['load_cm3']:g} cm3", (inlet.x, level, inlet.z - radius)),
            Label(
                "wire beside the plunger\nlets the air out; then\npull it out",
                (inlet.x - radius, level + 8.0, inlet.z + 0.7 * radius),
            ),
        ),
        (Arrow((inlet.x, high + 16.0, inlet.z), (inlet.x, high + 2.0, inlet.z)),),
    )
