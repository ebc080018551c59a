"""Scenes at the mold: try it, close it, fill it, open it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from fingertip.cad.shapes.chaplet import axis_z
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.shapes.seals import tape
from fingertip.cad.solids import Box, Cone, cylinder, union
from fingertip.design import Design
from fingertip.filling.mold_filling import place_vents
from fingertip.view.raster import Camera
from fingertip.view.steps.bench import GLASS, PRODUCT, STEEL, TAPE, Bench
from fingertip.view.steps.scene import Arrow, Label, Scene, Shown

Data = Mapping[str, Any]

DORSAL = Camera.from_angles(28, 24)
PALMAR = Camera.from_angles(28, -26)
SIDE = Camera.from_angles(0, 0)
_RUNNER_SIDE = Camera.from_angles(152, 14)
"""Camera on the side on which the runner lies."""
FUNNEL_UP = Camera.looking_from((-1.0, 0.5, 0.3), (0.0, 0.0, 1.0))
_SPARE_MM, _DROP_MM = 10.0, 2.5
"""Width of a spare piece, and radius of a drop [mm]."""


def _in_pose(data: Data) -> Camera:
    """Look at the mold from its side in the pose of filling, in which the first vent is the highest point."""
    x, y, z = data["filling"]["up"]
    return Camera.looking_from((-1.0, 0.35, 0.35), (x, y, z))


def cure_test(bench: Bench, data: Data) -> Scene:
    """Show drops of silicone on a spare print of each material, and on what else silicone touches."""
    names = ["print of the mold", f"print of the {bench.insert}", "tape", "adhesive,\nvarnish, primer", "plunger"]
    colours = (*(PARTS[name].colour for name in ("mold_palmar", bench.insert)), TAPE, GLASS, STEEL)
    shown, labels = [], []
    for i, (name, colour) in enumerate(zip(names, colours, strict=True)):
        # In steps, so that no leader crosses another piece.
        x, z = i * 1.3 * _SPARE_MM, i * 0.9 * _SPARE_MM
        spare = Box((x, 0.0, z), (x + _SPARE_MM, 2.0, z + _SPARE_MM))
        centre = (z + _SPARE_MM / 2, x + _SPARE_MM / 2)
        drop = Cone("y", centre, 2.0, 2.0 + _DROP_MM / 2, _DROP_MM, _DROP_MM / 3)
        shown += [bench.solid(spare, colour), bench.solid(drop, PRODUCT)]
        labels.append(Label(f"drop on {name}", (centre[1], 2.0 + _DROP_MM / 2, centre[0])))
    return Scene(tuple(shown), Camera.looking_from((0.15, 0.8, -0.6), (0.0, 0.6, 0.8)), tuple(labels))


def close_empty(bench: Bench, data: Data) -> Scene:
    """Show the halves before they close, with keys and sockets."""
    m, apart = bench.design.mold_layout, bench.apart_mm
    x, z, _ = max(bench.design.mold_layout.keys, key=lambda key: -key[0])
    return Scene(
        (bench.part("mold_dorsal", (0.0, apart, 0.0)), bench.part("mold_palmar")),
        Camera.from_angles(28, 12),
        (
            Label("dorsal half", (0.0, m.dorsal_height + apart, m.distal_z)),
            Label("palmar half", (-m.half_width, -m.palmar_height / 2, m.proximal_z)),
            Label("key", (x, apart - bench.design.mold.key_height_mm / 2, z)),
            Label("pry slot", (-m.half_width, 0.0, m.pry_z)),
        ),
        (Arrow((0.0, apart * 0.95, m.distal_z), (0.0, apart * 0.25, m.distal_z)),),
    )


def try_fit(bench: Bench, data: Data) -> Scene:
    """Show bone or core above its recess."""
    m, apart = bench.design.mold_layout, bench.apart_mm
    base = -bench.design.mold.recess_length_mm / 2
    return Scene(
        (bench.part(bench.insert, (0.0, apart, 0.0)), bench.part("mold_palmar")),
        DORSAL,
        (
            Label(bench.insert, (0.0, apart, bench.design.dimensions.base_end_z)),
            Label("recess: scrape it\nwhere it shines", (0.0, -2.0, base)),
            Label("cavity", (0.0, -m.palmar_height / 3, bench.design.dimensions.sensor_z)),
        ),
        (Arrow((0.0, 0.9 * apart, base), (0.0, 0.1 * apart, base)),),
    )


def drill(bench: Bench, data: Data) -> Scene:
    """Show the drills above the holes of the chaplet's screw, cut open."""
    m, chaplet, apart = bench.design.mold_layout, data["chaplet"], 2.2 * bench.apart_mm
    z, top = axis_z(bench.design), m.dorsal_height
    wide = _drill(z, top + 2.0, top + 16.0, chaplet["hole_mm"] / 2)
    assert bench.design.dimensions.chaplet
    facet = bench.design.dimensions.chaplet.facet_y - apart
    narrow = _drill(z, facet + 2.0, facet + 16.0, chaplet["pilot_mm"] / 2)
    return Scene(
        (
            bench.part("mold_dorsal", cut=True), bench.part(bench.insert, (0.0, -apart, 0.0), cut=True),
            bench.solid(wide, STEEL), bench.solid(narrow, STEEL),
        ),
        SIDE,
        (
            Label(f"drill {chaplet['hole_mm']:g} mm", (0.0, top + 12.0, z)),
            Label("boss", (0.0, facet + apart + 0.6, z + chaplet["diameter_mm"] / 2)),
            Label(
                f"drill {chaplet['pilot_mm']:g} mm,\nno deeper than\n{chaplet['pilot_depth_mm']:g} mm",
                (0.0, facet + 12.0, z),
            ),
            Label("pocket of the sensor" if bench.insert == "bone" else "core", (0.0, -apart - 2.0, z + 3.0)),
        ),
        (Arrow((0.0, top + 9.0, z - 4.0), (0.0, top + 2.0, z - 4.0)),),
    )  # fmt: skip


def _drill(z: float, low: float, high: float, radius: float) -> Any:
    """Build a drill bit along y, its tip at `low`."""
    return union(
        Cone("y", (z, 0.0), low, low + radius, 0.05, radius), cylinder("y", (z, 0.0), low + radius, high, radius)
    )


def release(bench: Bench, data: Data) -> Scene:
    """Show both cavities, opened like a book."""
    m = bench.design.mold_layout
    dorsal = bench.part("mold_dorsal")
    beside = 2 * m.half_width + 6.0
    flipped = dorsal.mesh.vertices * np.array((-1.0, -1.0, 1.0))
    turned = type(dorsal.mesh)(flipped + np.array((beside, 0.0, 0.0)), dorsal.mesh.triangles)
    camera = Camera.looking_from((0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    z = bench.design.dimensions.sensor_z
    marks = [
        Label("cavity: release", (0.0, -2.0, z + 4.0)),
        Label("parting plane: release", (m.half_width * 0.8, 0.0, m.distal_z - 3.0)),
        Label("recess: leave bare", (0.0, -2.0, -bench.design.mold.recess_length_mm / 2)),
    ]
    if data["chaplet"]:
        marks.append(Label("boss: leave bare", (beside, -1.0, axis_z(bench.design))))
    return Scene((bench.part("mold_palmar"), Shown(turned, dorsal.colour)), camera, tuple(marks))


def seat_tape(bench: Bench, data: Data) -> Scene:
    """Show the tape around the seat."""
    tape = data["fit"]["seat_tape"]
    half = bench.design.dimensions.bone_outline.section.half_width
    middle = -(tape["from_mm"] + tape["to_mm"]) / 2
    return Scene(
        (*bench.in_mold(), *bench.seat_tape()),
        DORSAL,
        (
            Label(f"one turn of tape,\n{tape['thickness_mm']:g} mm thick", (-half, 0.0, middle)),
            Label("the skin begins here", (0.0, bench.design.dimensions.bone_outline.section.dorsal, 0.0)),
        ),
    )


def hold(bench: Bench, data: Data) -> Scene:
    """Show bone or core in the dorsal half, with the screw that holds it."""
    m, z = bench.design.mold_layout, axis_z(bench.design) if data["chaplet"] else 0.0
    lift = 10.0
    labels = [
        Label("dorsal half", (0.0, m.dorsal_height * 0.8, m.proximal_z)),
        Label(bench.insert, (0.0, 0.0, bench.design.dimensions.base_end_z + 2.0)),
    ]
    if data["chaplet"]:
        chaplet = data["chaplet"]
        labels += [
            Label(f"{chaplet['thread']} x {chaplet['length_mm']:g} mm", (0.0, m.dorsal_height + lift, z)),
            Label("facet on boss,\npaper between\nuntil it is held", (0.0, _facet_y(bench.design), z + 2.0)),
        ]
    return Scene(
        (bench.part("mold_dorsal", cut=True), *bench.in_mold(cut=True), *bench.chaplet_screw((0.0, lift, 0.0))),
        SIDE,
        tuple(labels),
        (Arrow((0.0, m.dorsal_height + lift, z + 6.0), (0.0, m.dorsal_height + 1.0, z + 6.0)),)
        if data["chaplet"]
        else (),
    )


def _facet_y(design: Design) -> float:
    chaplet = design.dimensions.chaplet
    assert chaplet
    return chaplet.facet_y


def bolt(bench: Bench, data: Data) -> Scene:
    """Show bolts and nuts on their way into the closed mold."""
    m, apart = bench.design.mold_layout, bench.apart_mm
    (x, z), count = m.bolts[0], data["mold"]["bolts"]
    return Scene(
        (
            bench.part("mold_dorsal"), bench.part("mold_palmar"), *bench.in_mold(),
            *bench.bolts((0.0, apart, 0.0), (0.0, -0.7 * apart, 0.0)),
        ),
        Camera.from_angles(28, 14),
        (
            Label(f"{count} bolts, crosswise,\nby hand", (x, m.dorsal_height + apart, z)),
            Label(f"{count} nuts in their traps", (x, -m.palmar_height - 0.6 * apart, z)),
            Label("no gap here", (-m.half_width, 0.0, m.distal_z - 2.0)),
        ),
        (Arrow((x, m.dorsal_height + 0.9 * apart, z), (x, m.dorsal_height + 0.2 * apart, z)),),
    )  # fmt: skip


def _closed(bench: Bench) -> list[Shown]:
    """Show the closed mold with its bolts."""
    return [
        bench.part("mold_dorsal"), bench.part("mold_palmar"), *bench.in_mold(), *bench.bolts(), *bench.chaplet_screw()
    ]  # fmt: skip


def _vent_labels(bench: Bench, text: str) -> list[Label]:
    """Label the outer ends of all vents."""
    m, labels = bench.design.mold_layout, []
    for vent in place_vents(bench.design):
        (x, _, z) = vent.point_mm
        match vent.kind:
            case "dorsal":
                labels.append(Label(text, (x, m.dorsal_height, z)))
            case "tip":
                labels.append(Label(text, (x, 0.0, m.distal_z)))
            case "side":
                side = math.copysign(m.half_width, x)
                labels.append(Label(text, (side, 0.0, m.clear_side_z(z, vent.diameter_mm))))
    return labels


def try_syringe(bench: Bench, data: Data) -> Scene:
    """Show the empty syringe above its cone."""
    m, inlet, lift = bench.design.mold_layout, bench.design.mold_layout.inlet, 12.0
    assert inlet
    start = (inlet.x, m.dorsal_height + lift - 1.0, inlet.z + 10.0)
    return Scene(
        (*_closed(bench), *bench.syringe(lift_mm=lift)),
        DORSAL,
        (*_vent_labels(bench, "vent: air must come"), Label("Luer cone", (inlet.x, m.dorsal_height, inlet.z))),
        (Arrow(start, (start[0], m.dorsal_height + 2.0, start[2])),),
    )


def measure(bench: Bench, data: Data) -> Scene:
    """Show where to measure the sensor of the closed mold."""
    low = bench.design.dimensions.base_end_z
    return Scene(
        tuple(_closed(bench)),
        DORSAL,
        (Label("ohmmeter at the wires:\nabove 1 Mohm", (0.0, 0.0, low)),),
    )


def fill(bench: Bench, data: Data) -> Scene:
    """Show the mold in its pose, cut open, while the silicone rises from the side of the collar to the vent."""
    m, inlet, filling = bench.design.mold_layout, bench.design.mold_layout.inlet, data["filling"]
    assert inlet
    start = (inlet.x, m.dorsal_height + 70.0, inlet.z)
    pressing = f"{filling['syringe']['thumb_n']:g} N, steadily,\nsome {filling['fill_s']:g} s"
    return Scene(
        (
            bench.part("mold_dorsal", cut=True), bench.part("mold_palmar", cut=True), *bench.in_mold(cut=True),
            bench.casting(cut=True), *bench.vents(),  # without the screw, which would hide a vent
            *bench.syringe(filling["load_cm3"] / filling["syringe"]["volume_ml"]),
        ),
        _in_pose(data),
        (
            *_vent_labels(bench, "vent: stop when\nsilicone stands here"),
            Label(pressing, (inlet.x, m.dorsal_height + 55.0, inlet.z)),
            
        ),
        (Arrow((start[0], start[1], start[2] + 12.0), (start[0], start[1] - 22.0, start[2] + 12.0)),),
    )  # fmt: skip


def leave(bench: Bench, data: Data) -> Scene:
    """Show the full mold with the syringe in its cone."""
    m, inlet = bench.design.mold_layout, bench.design.mold_layout.inlet
    assert inlet
    return Scene(
        (*_closed(bench), *bench.syringe(0.2)),
        _in_pose(data),
        (
            *_vent_labels(bench, "full"),
            Label("the vise holds\nboth sides here", (-m.half_width, 0.0, m.pry_z)),
            Label("leave it until\nthe silicone has set", (inlet.x, m.dorsal_height + 12.0, inlet.z)),
        ),
    )


def stand(bench: Bench, data: Data) -> Scene:
    """Show the mold that gravity fills, its funnel up."""
    m = bench.design.mold_layout
    return Scene(
        tuple(_closed(bench)),
        FUNNEL_UP,
        (
            Label("funnel", (m.gate_x, 0.0, m.distal_z)),
            Label(f"{bench.insert}, down", (0.0, 0.0, bench.design.dimensions.base_end_z)),
            Label("hold here", (-m.half_width, 0.0, m.pry_z)),
        ),
    )


def pour(bench: Bench, data: Data) -> Scene:
    """Show the stream into the funnel, the mold cut open."""
    m = bench.design.mold_layout
    stream = cylinder("z", (m.gate_x, 0.0), m.distal_z - 2.0, m.distal_z + 25.0, 0.6)
    return Scene(
        (
            bench.part("mold_dorsal"), bench.part("mold_palmar"), *bench.in_mold(), *bench.bolts(),
            bench.solid(stream, PRODUCT),
        ),
        FUNNEL_UP,
        (Label("thin stream", (m.gate_x, 0.0, m.distal_z + 20.0)), *_vent_labels(bench, "silicone must rise here")),
    )  # fmt: skip


def cure(bench: Bench, data: Data) -> Scene:
    """Show the mold while the silicone cures, with the syringe still in its cone."""
    hours, m = data["silicone"]["properties"]["cure_h"]["high"], bench.design.mold_layout
    syringe = bench.syringe(0.2) if m.inlet else []
    pose = _in_pose(data) if m.inlet else FUNNEL_UP
    return Scene((*_closed(bench), *syringe), pose, (Label(f"{hours:g} h in this pose", (0.0, 0.0, m.distal_z)),))


def open_mold(bench: Bench, data: Data) -> Scene:
    """Show the halves apart, and the casting with what is cut off."""
    m, apart, inlet = bench.design.mold_layout, 1.3 * bench.apart_mm, bench.design.mold_layout.inlet
    labels = [Label("push the finger out\nat this end", (0.0, 0.0, bench.design.dimensions.base_end_z))]
    if inlet:
        labels.append(Label("cut the runner\nflush here", (inlet.gate_x, 0.3, inlet.gate_z)))
    for vent in place_vents(bench.design):
        labels.append(Label("cut the vent stub", vent.point_mm))
    return Scene(
        (
            bench.part("mold_dorsal", (0.0, apart, 0.0)), bench.part("mold_palmar", (0.0, -apart, 0.0)),
            *bench.in_mold(), bench.casting(),
        ),
        _RUNNER_SIDE,
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


def core_only(bench: Bench, data: Data) -> Scene:
    """Show the core in the palmar half."""
    return Scene(
        (bench.part("core"), bench.part("mold_palmar")),
        DORSAL,
        (Label("core, without sensor", (0.0, 2.0, bench.design.dimensions.base_end_z + 2.0)),),
    )


def prime(bench: Bench, data: Data) -> Scene:
    """Show where the primer goes on the bone."""
    dims = bench.design.dimensions
    (_, y, z) = (0.0, -dims.flat_depth, dims.sensor_z)
    return Scene(
        (*bench.assembled_bone(), bench.solid(tape(bench.design), TAPE)),
        PALMAR,
        (
            Label("primer on all that\nthe skin will cover", (0.0, 0.0, bench.design.skin.length_mm - 3.0)),
            Label("none on the tape", (0.0, y, z / 2)),
            Label("none below the collar", (0.0, 0.0, dims.base_end_z / 2)),
        ),
    )
