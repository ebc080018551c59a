"""Scenes at the closed mold: try the syringe, fill, and let it cure."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.catalogues.hardware import LUER_MOUTH_MM, NOZZLE_DEPTH_MM, NOZZLE_LENGTH_MM
from fingertip.design.geometry.solids import Box, cylinder, difference
from fingertip.filling.mold_filling import place_vents
from fingertip.pictures.raster import Camera
from fingertip.pictures.steps.objects import CUP_RADIUS_MM, Bench
from fingertip.pictures.steps.scene import Arrow, Data, Label, Paint, Scene, Shown, Slope, View

_LIFT_MM = 12.0


def _signs(filling: Data) -> tuple[float, float]:
    """Return on which side and on which end of the mold its lowest corner lies in the pose."""
    return (-math.copysign(1.0, filling["up"][0]), -math.copysign(1.0, filling["up"][2]))


def _over_lowest_corner(data: Data) -> Camera:
    """Look at the dorsal face in its pose, over its lowest corner, from which both edges rise."""
    (side, end), up = _signs(data["filling"]), data["filling"]["up"]
    x, y, z = (0.6 * side, 0.0, end)
    along = x * up[0] + z * up[2]  # taken off, so that the camera stands level
    x, y, z = (a + (0.12 - along) * b for a, b in zip((x, y, z), up, strict=True))
    return Camera.looking_from((x, y, z), tuple(up))


def _closed(bench: Bench) -> list[Shown]:
    return [
        bench.part("mold_dorsal"), bench.part("mold_palmar"), *bench.in_mold(), *bench.bolts(), *bench.chaplet_screw()
    ]  # fmt: skip


def _vent_labels(bench: Bench, text: str, seen_side: float = 0.0) -> Iterator[Label]:
    """Label the vents; a side vent that opens on the side other than the one that is seen is said to be there."""
    m = bench.layout
    for vent in place_vents(bench.design):
        (x, _, z) = vent.point_mm
        match vent.kind:
            case "dorsal":
                yield Label(text, (x, m.dorsal_height, z))
            case "side":
                side, far = math.copysign(m.half_width, x), "\n(on the far side)" if seen_side * x < 0.0 else ""
                yield Label(text + far, (side, 0.0, m.clear_side_z(z, vent.diameter_mm)))


def try_cone(bench: Bench, data: Data) -> Scene:
    m, inlet = bench.layout, bench.layout.inlet
    return Scene(
        (bench.part("mold_dorsal"), bench.part("mold_palmar"), *bench.syringe(lift_mm=_LIFT_MM)),
        View.DORSAL,
        *_vent_labels(bench, "vent: a wire\nmust pass"),
        Label("Luer cone: the nozzle\nmust not rock", (inlet.x, m.dorsal_height, inlet.z)),
        _into_cone(bench),
    )


def try_syringe(bench: Bench, data: Data) -> Scene:
    """Show the mold in its pose, the empty syringe above its cone with its plunger pulled back."""
    m, inlet = bench.layout, bench.layout.inlet
    return Scene(
        (*_closed(bench), *bench.syringe(lift_mm=_LIFT_MM, drawn_share=0.8)),
        _over_lowest_corner(data),
        *_pose_marks(bench, data["filling"]),
        *_vent_labels(bench, "vent: air must come", _signs(data["filling"])[0]),
        Label("Luer cone", (inlet.x, m.dorsal_height, inlet.z)),
        _into_cone(bench),
    )


def _into_cone(bench: Bench) -> Arrow:
    m, inlet = bench.layout, bench.layout.inlet
    x, z = inlet.x, inlet.z + 10.0
    return Arrow((x, m.dorsal_height + _LIFT_MM - 1.0, z), (x, m.dorsal_height + 2.0, z))


def measure(bench: Bench, data: Data) -> Scene:
    low = bench.dims.base_end_z
    return Scene(_closed(bench), View.DORSAL, Label("ohmmeter at the wires:\nabove 1 Mohm", (0.0, 0.0, low)))


def fill(bench: Bench, data: Data) -> Scene:
    """Show the mold in its pose, cut open, while the silicone rises from the side of the collar to the vent."""
    m, inlet, filling = bench.layout, bench.layout.inlet, data["filling"]
    x, y, z = inlet.x, m.dorsal_height + 70.0, inlet.z + 12.0
    quick, slow = sorted((filling["fill_s"], filling["push_s"]))
    pressing = f"press slowly,\n{quick:g} to {slow:g} s"
    tip, way = abs(filling["tip_deg"]), "up" if filling["tip_deg"] >= 0 else "down"
    pose = f"tip {way}: {tip} degrees;\nacross: {filling['level_across_deg']} degrees"
    return Scene(
        (
            bench.part("mold_dorsal", cut=True), bench.part("mold_palmar", cut=True), *bench.in_mold(cut=True),
            bench.casting(cut=True), *bench.vents(), *bench.chaplet_screw(cut=True), *bench.bolts(cut=True),
            *bench.syringe(filling["load_cm3"] / filling["syringe"]["volume_ml"]),
        ),
        Camera.looking_from((-1.0, 0.35, 0.35), tuple(filling["up"])),
        *_vent_labels(bench, "vent: stop when\nsilicone stands here"),
        Label(pressing, (inlet.x, m.dorsal_height + 55.0, inlet.z)),
        Label(pose, (0.0, m.dorsal_height, m.distal_z)),
        Arrow((x, y, z), (x, y - 22.0, z)),
    )  # fmt: skip


def _pose_marks(bench: Bench, filling: Data) -> list[Label | Slope]:
    """Draw the angles that a level reads on the face of the mold: along the finger, and across it."""
    m, up, (side, end) = bench.layout, tuple(filling["up"]), _signs(filling)
    low = (side * m.half_width, m.dorsal_height, m.proximal_z if end < 0.0 else m.distal_z)
    slopes = (
        Slope(low, (0.0, 0.0, -end * (m.distal_z - m.proximal_z)), up),
        Slope(low, (-side * 2 * m.half_width, 0.0, 0.0), up),
    )
    tip, across = filling["tip_deg"], filling["level_across_deg"]
    texts = (f"tip {abs(tip)} degrees {'up' if tip >= 0 else 'down'},\nread along the finger",
             f"{across} degrees,\nread across the finger")  # fmt: skip
    middles = (tuple(slope.lines_mm()[1][12].tolist()) for slope in slopes)
    return [*slopes, *(Label(text, point) for text, point in zip(texts, middles, strict=True))]


def leave(bench: Bench, data: Data) -> Scene:
    m, inlet, side = bench.layout, bench.layout.inlet, _signs(data["filling"])[0]
    held = (
        side * m.half_width,
        -(data["mold"]["vise_below_mm"] + m.palmar_height) / 2,
        (m.proximal_z + m.distal_z) / 2,
    )
    return Scene(
        (*_closed(bench), *bench.syringe(0.2)),
        _over_lowest_corner(data),
        *_vent_labels(bench, "full", side),
        Label("the vise holds\nthe palmar half alone,\nby both sides", held),
        *_pose_marks(bench, data["filling"]),
        Label("leave it until\nthe silicone has set", (inlet.x, m.dorsal_height + 12.0, inlet.z)),
    )


# Scenes at the scale: weigh, degas, and load the syringe.

_FRONT = Camera.looking_from((0.15, -1.0, 0.22), (0.0, 0.0, 1.0))
_LEFT_OVER = 0.3
"""Share of the mixture that the picture shows left over. Assumption."""


def _find_level_mm(data: Data) -> float:
    """Level of the mixture in the cup [mm]."""
    density = 0.5 * sum(data["silicone"]["properties"]["density_g_cm3"][end] for end in ("low", "high"))
    return float(1000.0 * data["batch"]["total_g"] / density / (math.pi * CUP_RADIUS_MM**2))


def weigh(bench: Bench, data: Data) -> Scene:
    batch, (first, second) = data["batch"], data["silicone"]["components"]
    level = _find_level_mm(data)
    share = batch["a_g"] / batch["total_g"]
    scale = Box((-40.0, -35.0, -10.0), (40.0, 35.0, 0.0))
    return Scene(
        (*bench.cup(level), bench.solid(scale, Paint.STEEL)),
        _FRONT,
        Label(f"then {batch['b_g']:g} g of {second}:\n{batch['total_g']:g} g in all", (CUP_RADIUS_MM, 0.0, level)),
        Label(f"first {batch['a_g']:g} g of {first}", (-CUP_RADIUS_MM, 0.0, share * level)),
        Label("scale, set to zero\nwith the empty cup", (40.0, -35.0, -5.0)),
    )


def degas(bench: Bench, data: Data) -> Scene:
    level = _find_level_mm(data)
    bell = difference(
        cylinder("z", (0.0, 0.0), -2.0, 75.0, 45.0), cylinder("z", (0.0, 0.0), 0.0, 72.0, 42.0),
        Box((-60.0, -60.0, 0.0), (60.0, 0.0, 90.0)),
    )  # fmt: skip
    return Scene(
        (*bench.cup(4 * level), bench.solid(bell, Paint.GLASS)),
        _FRONT,
        Label("foam rises some\nfour times as high,\nthen falls", (CUP_RADIUS_MM, 0.0, 4 * level)),
        Label("vacuum chamber", (-43.0, 0.0, 60.0)),
        Label(f"silicone before:\n{level:.0f} mm high in this cup", (-CUP_RADIUS_MM, 0.0, level)),
    )


def cure(bench: Bench, data: Data) -> Scene:
    """Show the silicone left over in its cup, which tells when the mold may be opened."""
    hours, level = data["silicone"]["properties"]["cure_h"]["high"], _LEFT_OVER * _find_level_mm(data)
    return Scene(
        bench.cup(level), _FRONT,
        Label(f"silicone left over: after {hours:g} h\na fingernail leaves no mark", (CUP_RADIUS_MM, 0.0, level)),
    )  # fmt: skip


def load_syringe(bench: Bench, data: Data) -> Scene:
    filling, inlet = data["filling"], bench.layout.inlet
    shown = bench.syringe(filling["load_cm3"] / filling["syringe"]["volume_ml"])
    high = max(float(item.mesh.vertices[:, 1].max()) for item in shown)
    low = min(float(item.mesh.vertices[:, 1].min()) for item in shown)
    level = float(shown[-1].mesh.vertices[:, 1].max())
    radius = inlet.syringe.bore_mm / 2
    stroke = 1000.0 * inlet.syringe.volume_ml / (math.pi * radius**2)
    aside = (inlet.z + 0.7 * radius, inlet.x - 0.75 * radius)
    wire = cylinder("y", aside, level - 0.5, level + 0.5 * stroke, 0.3)
    tip = bench.layout.dorsal_height - NOZZLE_DEPTH_MM
    cap = cylinder("y", (inlet.z, inlet.x), tip - 1.5, tip + 0.7 * NOZZLE_LENGTH_MM, LUER_MOUTH_MM / 2 + 1.0)
    return Scene(
        (*shown, bench.solid(wire, Paint.SENSOR), bench.solid(cap, Paint.SEAL)),
        Camera.looking_from((-1.0, -0.2, 0.2), (0.0, 1.0, 0.0)),
        Label("nozzle up, take the\ncap off, and only then\npress the air out", (inlet.x, low, inlet.z)),
        Label(f"{filling['load_cm3']:g} cm3", (inlet.x, level, inlet.z - radius)),
        Label(
            "wire beside the plunger\nlets the air out; then\npull it out",
            (inlet.x - radius, level + 8.0, inlet.z + 0.7 * radius),
        ),
        Arrow((inlet.x, high + 16.0, inlet.z), (inlet.x, high + 2.0, inlet.z)),
    )
