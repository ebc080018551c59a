"""Scenes at the open mold: try the parts, prepare them, and close it around the bone."""

from __future__ import annotations

from fingertip.cad.shapes.bone import tape
from fingertip.cad.shapes.insert import axis_z
from fingertip.cad.shapes.mold import pry_slots_z
from fingertip.cad.shapes.parts import PARTS
from fingertip.casting.consumables import uses_adhesive
from fingertip.design.geometry.solids import Box, Cone, Solid, cylinder, union
from fingertip.filling.mold_filling import place_vents
from fingertip.pictures.raster import Camera
from fingertip.pictures.steps.objects import Bench
from fingertip.pictures.steps.scene import Arrow, Data, Label, Paint, Scene, View, given

_SPARE_MM, _DROP_MM = 10.0, 2.5
"""Width of a spare piece, and radius of a drop [mm]."""


def cure_test(bench: Bench, data: Data) -> Scene:
    peels = ": peels off"
    tested = [
        (f"print\nof the mold{peels}", PARTS["mold_palmar"].colour),
        (f"print\nof the bone{peels}", PARTS["bone"].colour),
        (f"released\nprint{peels}", PARTS["mold_palmar"].colour),
        ("tape:\npeels off", Paint.TAPE),
        (("adhesive,\nprimer" if uses_adhesive(data) else "primer") + ": must stick", Paint.GLASS),
        ("plunger:\npeels off", Paint.STEEL),
    ]
    shown, labels = [], []
    for i, (name, colour) in enumerate(tested):
        # In steps, so that no leader crosses another piece.
        x, z = i * 1.3 * _SPARE_MM, i * 0.9 * _SPARE_MM
        spare = Box((x, 0.0, z), (x + _SPARE_MM, 2.0, z + _SPARE_MM))
        centre = (z + _SPARE_MM / 2, x + _SPARE_MM / 2)
        drop = Cone("y", centre, 2.0, 2.0 + _DROP_MM / 2, _DROP_MM, _DROP_MM / 3)
        shown += [bench.solid(spare, colour), bench.solid(drop, Paint.SILICONE)]
        labels.append(Label(f"drop on {name}", (centre[1], 2.0 + _DROP_MM / 2, centre[0])))
    return Scene(shown, Camera.looking_from((0.15, 0.8, -0.6), (0.0, 0.6, 0.8)), *labels)


def close_empty(bench: Bench, data: Data) -> Scene:
    m, apart = bench.layout, bench.apart_mm
    x, z, _ = max(m.keys, key=lambda key: -key[0])
    return Scene(
        (bench.part("mold_dorsal", (0.0, apart, 0.0)), bench.part("mold_palmar")),
        View.LOW,
        Label("dorsal half", (0.0, m.dorsal_height + apart, m.distal_z)),
        Label("palmar half", (-m.half_width, -m.palmar_height / 2, m.proximal_z)),
        Label("key", (x, apart - bench.design.mold.key_height_mm / 2, z)),
        Label("pry slot", (-m.half_width, 0.0, pry_slots_z(bench.design))),
        Arrow((0.0, apart * 0.95, m.distal_z), (0.0, apart * 0.25, m.distal_z)),
    )


def try_fit(bench: Bench, data: Data) -> Scene:
    m, apart = bench.layout, bench.apart_mm
    base = -bench.design.mold.recess_length_mm / 2
    return Scene(
        (bench.part("bone", (0.0, apart, 0.0)), bench.part("mold_palmar")),
        View.DORSAL,
        Label("bone", (0.0, apart, bench.dims.base_end_z)),
        Label("recess: scrape it\nwhere it shines", (0.0, -2.0, base)),
        Label("cavity", (0.0, -m.palmar_height / 3, bench.dims.sensor_z)),
        Arrow((0.0, 0.9 * apart, base), (0.0, 0.1 * apart, base)),
    )


def drill(bench: Bench, data: Data) -> Scene:
    m, chaplet, apart = bench.layout, data["chaplet"], 2.2 * bench.apart_mm
    z, top = axis_z(bench.design), m.dorsal_height
    wide = _drill(z, top + 2.0, top + 16.0, chaplet["hole_mm"] / 2)
    facet = given(bench.dims.chaplet).facet_y - apart
    narrow, depth_mm = _drill(z, facet + 2.0, facet + 16.0, chaplet["pilot_mm"] / 2), chaplet["pilot_depth_mm"]
    return Scene(
        (
            bench.part("mold_dorsal", cut=True), bench.part("bone", (0.0, -apart, 0.0), cut=True),
            bench.solid(wide, Paint.STEEL), bench.solid(narrow, Paint.STEEL),
        ),
        View.SIDE,
        Label(f"drill {chaplet['hole_mm']:g} mm", (0.0, top + 12.0, z)),
        Label("boss", (0.0, facet + apart + 0.6, z + chaplet["diameter_mm"] / 2)),
        Label(f"drill {chaplet['pilot_mm']:g} mm,\nno deeper than\n{depth_mm:g} mm", (0.0, facet + 12.0, z)),
        Label("pocket of the sensor", (0.0, -apart - 2.0, z + 3.0)),
        Arrow((0.0, top + 9.0, z - 4.0), (0.0, top + 2.0, z - 4.0)),
    )  # fmt: skip


def _drill(z: float, low: float, high: float, radius: float) -> Solid:
    """Build a drill bit along y, its tip at `low`."""
    return union(
        Cone("y", (z, 0.0), low, low + radius, 0.05, radius), cylinder("y", (z, 0.0), low + radius, high, radius)
    )


def release(bench: Bench, data: Data) -> Scene:
    m = bench.layout
    beside = 2 * m.half_width + 6.0
    camera = Camera.looking_from((0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    z = bench.dims.sensor_z
    marks = [
        Label("cavity: release", (0.0, -2.0, z + 4.0)),
        Label("parting plane: release", (m.half_width * 0.8, 0.0, m.distal_z - 3.0)),
        Label("recess: leave bare", (0.0, -2.0, -bench.design.mold.recess_length_mm / 2)),
    ]
    if data["chaplet"]:
        marks.append(Label("face of the boss:\nleave bare", (beside, -1.0, axis_z(bench.design))))
    return Scene((bench.part("mold_palmar"), bench.part("mold_dorsal").turned((beside, 0.0, 0.0))), camera, *marks)


def seat_tape(bench: Bench, data: Data) -> Scene:
    seat, dims = data["fit"]["seat_tape"], bench.dims
    half = dims.bone_outline.section.half_width
    middle, floor = -(seat["from_mm"] + seat["to_mm"]) / 2, -dims.base_flat_depth
    labels = [
        Label(f"one turn of tape,\n{seat['thickness_mm']:g} mm thick", (0.0, floor, middle)),
        # The runner lies on the other side.
        Label("its ends meet here,\nwithout overlapping", (-half, 0.0, middle)),
    ]
    shown = [*bench.in_mold(), *bench.seat_tape()]
    shown.append(bench.solid(tape(bench.design), Paint.TAPE))
    if data["sensor_tail"] == "straight" and data["mold"]["tail_passes_collar"]:
        low = max(dims.tail_end_z, -seat["to_mm"] - 2.0)
        scrap = Box((-dims.tail_half_width, floor - 0.1, low), (dims.tail_half_width, floor + 0.1, -seat["from_mm"]))
        shown.append(bench.solid(scrap, Paint.PAPER))
        labels.append(Label("baking paper\non the bare film", (0.0, floor, low + 1.0)))
    labels.append(Label("the skin begins here", (0.0, -dims.flat_depth, 0.0)))
    return Scene(shown, View.PALMAR, *labels)


def prime(bench: Bench, data: Data) -> Scene:
    dims = bench.dims
    _, y, z = bench.head
    shown = [*bench.assembled_bone(), bench.solid(tape(bench.design), Paint.TAPE), *bench.stiff(), *bench.seat_tape()]
    marks = [
        Label("primer on all that\nthe skin will cover", (0.0, 0.0, bench.design.skin.length_mm - 3.0)),
        Label("none on the tape", (0.0, y, z / 2)),
        Label("none below the collar", (0.0, 0.0, dims.base_end_z / 2)),
    ]
    if chaplet := dims.chaplet:  # the mask is on the other side, which is shown above
        above, top = 3.2 * dims.collar.section.half_width, chaplet.facet_y + 0.2
        mask = bench.solid(cylinder("y", (chaplet.z, 0.0), chaplet.facet_y, top, chaplet.radius), Paint.TAPE)
        shown += [item.turned((0.0, above, 0.0)) for item in (*shown, mask)]
        marks.append(Label("mask, peeled off\nwhen the primer is dry", (0.0, above - top, chaplet.z)))
    return Scene(shown, View.PALMAR, *marks)


def hold(bench: Bench, data: Data) -> Scene:
    m, z = bench.layout, axis_z(bench.design) if data["chaplet"] else 0.0
    lift = 10.0
    marks: list[Label | Arrow] = [
        Label("dorsal half", (0.0, m.dorsal_height * 0.8, m.proximal_z)),
        Label("bone", (0.0, 0.0, bench.dims.base_end_z + 2.0)),
    ]
    if seat := data["fit"]["seat_tape"]:  # whole, or its cut edges alone would show
        middle = -(seat["from_mm"] + seat["to_mm"]) / 2
        marks.append(Label("tape on the seat", (0.0, -bench.dims.base_flat_depth, middle)))
    if data["chaplet"]:
        chaplet, facet = data["chaplet"], given(bench.dims.chaplet).facet_y
        marks += [
            Label(f"{chaplet['thread']} x {chaplet['length_mm']:g} mm", (0.0, m.dorsal_height + lift, z)),
            Label("facet on boss, forked\npaper between\nuntil it drags", (0.0, facet, z + 2.0)),
            Arrow((0.0, m.dorsal_height + lift, z + 6.0), (0.0, m.dorsal_height + 1.0, z + 6.0)),
        ]
    return Scene(
        (
            bench.part("mold_dorsal", cut=True), *bench.in_mold(cut=True), *bench.seat_tape(),
            *bench.chaplet_screw((0.0, lift, 0.0)),
        ),
        View.CAVITY_UP if data["chaplet"] else View.SIDE,
        *marks,
    )  # fmt: skip


def bolt(bench: Bench, data: Data) -> Scene:
    m, apart = bench.layout, bench.apart_mm
    (x, z), count = m.bolts[0], data["mold"]["bolts"]
    return Scene(
        (
            bench.part("mold_dorsal"), bench.part("mold_palmar"), *bench.in_mold(),
            *bench.bolts((0.0, apart, 0.0), (0.0, -1.3 * apart, 0.0)),
        ),
        View.LOW,
        Label(f"{count} bolts, crosswise,\nby hand", (x, m.dorsal_height + apart, z)),
        Label(f"{count} nuts in their traps", (x, -m.palmar_height - 1.2 * apart, z)),
        Label("no gap here", (-m.half_width, 0.0, m.distal_z - 2.0)),
        Arrow((x, m.dorsal_height + 0.9 * apart, z), (x, m.dorsal_height + 0.2 * apart, z)),
    )  # fmt: skip


# Scenes after the cure: open the mold, trim and patch the skin.


def open_(bench: Bench, data: Data) -> Scene:
    m, apart = bench.layout, 1.3 * bench.apart_mm
    section, text = bench.dims.eyes, "push the finger out\nhere, on the base"
    if data["joint"] and data["joint"]["travel_deg"]:
        text = "lay wood across the joint\nhere, and lift the finger"
    labels = [
        Label(text, (section.half_width, 0.0, m.proximal_z - 1.0)),
        Label("cut the runner\nflush here", (m.inlet.gate_x, 0.3, m.inlet.gate_z)),
    ]
    for vent in place_vents(bench.design):
        hidden = vent.kind == "side" and vent.point_mm[0] < 0.0  # the camera looks at the side of the runner
        labels.append(Label("cut the vent stub" + ("\non the far side" if hidden else ""), vent.point_mm))
    return Scene(
        (
            bench.part("mold_dorsal", (0.0, apart, 0.0)), bench.part("mold_palmar", (0.0, -apart, 0.0)),
            *bench.in_mold(), bench.casting(),
        ),
        View.RUNNER_SIDE,
        *labels,
        Arrow((0.0, apart * 0.6, m.distal_z + 3.0), (0.0, apart * 1.3, m.distal_z + 3.0)),
        Arrow((0.0, -apart * 0.6, m.distal_z + 3.0), (0.0, -apart * 1.3, m.distal_z + 3.0)),
    )  # fmt: skip


def patch(bench: Bench, data: Data) -> Scene:
    chaplet, outer = given(bench.dims.chaplet), bench.dims.outer
    z, radius = chaplet.z, chaplet.radius
    top = outer.dorsal_height_at(0.9 * radius, z + 0.9 * radius)
    filled = cylinder("y", (z, 0.0), chaplet.facet_y, top, 0.99 * radius)
    return Scene(
        (*bench.assembled_bone(), bench.part("skin"), bench.solid(filled, Paint.PATCH)),
        View.DORSAL,
        Label("fill this hole,\nlevel with the skin", (0.0, outer.dorsal_height_at(0.0, z), z)),
    )
