"""Scenes at the bone: mount the sensor, keep silicone out, open the air vent, mount the finger on the hand."""

from __future__ import annotations

from fingertip.cad.shapes.bone import passage_seal, sensor_body, tape
from fingertip.design.geometry.seat import tape_span_mm
from fingertip.design.geometry.solids import Box, ElbowTube, Point3, Solid, cylinder, difference, intersection, union
from fingertip.pictures.picture import HAND, place_on_hand
from fingertip.pictures.raster import Camera, Colour
from fingertip.pictures.steps.objects import Bench
from fingertip.pictures.steps.scene import Arrow, Data, Label, Paint, Scene, Shown, View, given

_LIFT_MM = 10.0
_BEYOND_COLLAR_MM = 9.0
"""Length of the bone that is shown distal to the collar in a close view of it [mm]."""


def place_sensor(bench: Bench, data: Data) -> Scene:
    dims, (x, y, z) = bench.dims, bench.head
    if dims.tail_passes_collar:
        out = 0.6 * (dims.sensor.length_mm - dims.sensor.head_diameter_mm)
        return Scene(
            (bench.part("bone"), bench.sensor((0.0, -0.1, out))),
            View.PALMAR,
            Label("head, stuck down last", (x, y, z + out)),
            Label("pocket", (x, y, z)),
            Label("passage through\nthe collar", (dims.tail_half_width, y - 0.4, 0.0)),
            Label("solder relief", (0.0, y + 1.0, dims.tail_end_z)),
            Arrow((-8.0, y - 3.0, z + out), (-8.0, y - 3.0, z + 0.3 * out)),
        )
    return Scene(
        (bench.part("bone"), bench.sensor((0.0, -_LIFT_MM, 0.0))),
        View.PALMAR,
        Label("head, adhesive film\non this side", (x, y - _LIFT_MM, z)),
        Label("pocket", (x, y, z + dims.sensor.head_diameter_mm / 2)),
        Label("slot of the tail", (0.0, y, dims.tail_end_z / 2 + z / 2)),
        Label("solder relief", (0.0, y, dims.tail_end_z)),
        Arrow((x, y - 0.9 * _LIFT_MM, z), (x, y - 0.2 * _LIFT_MM, z)),
    )


def wires(bench: Bench, data: Data) -> Scene:
    """Show the way of the wires through the channel, cut open: both as one tube."""
    dims, bone = bench.dims, bench.design.bone
    path = ElbowTube(
        start_y=-dims.flat_depth + dims.channel_depth, start_z=dims.relief_proximal_z + dims.relief_half_length,
        exit_z=dims.channel_exit_z, end_y=3 * dims.bone_outline.section.dorsal,
        bend_radius=bone.channel_bend_radius_mm, radius=0.35 * bone.channel_diameter_mm,
    )  # fmt: skip
    return Scene(
        (
            bench.part("bone", cut=True), bench.sensor(cut=True),
            bench.solid(path, Paint.WIRE),
        ),
        View.CUT_FROM_BELOW,
        Label("solder here", (0.0, -dims.flat_depth, dims.tail_end_z)),
        Label("thread the wires\nin here first", (0.0, dims.bone_outline.section.dorsal, dims.channel_exit_z)),
        Label("sensor", bench.head),
    )  # fmt: skip


def try_fold(bench: Bench, data: Data) -> Scene:
    fold, y = given(bench.dims.fold), bench.head[1]
    return Scene(
        (bench.part("bone", cut=True),),
        View.CUT_FROM_ABOVE,
        Label("trough", (0.0, fold.floor_y, (fold.nose_z + fold.trough_end_z) / 2)),
        Label("window", (0.0, fold.nose_y, (fold.window_low_z + fold.nose_z - fold.radius) / 2)),
        Label("passage in\nthe collar", (0.0, y - 0.5, fold.nose_z / 2)),
        Label("nose", (0.0, fold.nose_y, fold.nose_z - fold.radius / 2)),
        Label("pocket", bench.head),
    )


def _straight_sensor(bench: Bench, length: float, width: float, shift: Point3) -> list[Shown]:
    """Show the sensor flat, with a wire at each tab."""
    dims, fold = bench.dims, given(bench.dims.fold)
    x, y, z = shift
    thickness = dims.sensor.thickness_mm
    half = dims.sensor.tail_width_mm / 2
    flat = union(
        cylinder("y", (z, x), y, y + thickness, dims.sensor.head_diameter_mm / 2),
        Box((x - half, y, z - length), (x + half, y + thickness, z)),
    )
    apart = fold.tabs_half_width * 0.5
    leads = [
        cylinder("z", (x + side * apart, y + thickness + width / 2), z - length - 18.0, z - length + 2.0, width / 2)
        for side in (-1.0, 1.0)
    ]
    return [bench.solid(flat, Paint.SENSOR), bench.solid(union(*leads), Paint.WIRE)]


def _film_mm(bench: Bench) -> float:
    body = bench.dims.sensor
    return body.length_mm - body.head_diameter_mm / 2


def solder_tabs(bench: Bench, data: Data) -> Scene:
    wire, film = data["fit"]["wire_mm"], _film_mm(bench)
    return Scene(
        _straight_sensor(bench, film, wire, (0.0, 0.0, 0.0)),
        Camera.from_angles(28, 50),
        Label("head", (0.0, 0.0, 0.0)),
        Label(f"wires of {wire:g} mm,\nstraight out", (0.0, wire, -film - 12.0)),
        Label(f"joints at most\n{data['fit']['crimp_mm']:g} mm high,\nvarnished", (0.0, wire, -film)),
    )


def thread(bench: Bench, data: Data) -> Scene:
    """Show the tail on its way through the passage, from the pocket out below the base."""
    film, (_, y, z) = _film_mm(bench), bench.head
    wire = data["fit"]["wire_mm"]
    return Scene(
        (bench.part("bone", cut=True), *_straight_sensor(bench, film, wire, (0.0, y + 0.05, z + 0.35 * film))),
        View.CUT_FROM_BELOW,
        Label("head comes last", (0.0, y, z + 0.35 * film)),
        Label("wires and tabs first", (0.0, y, z - 0.65 * film - 14.0)),
        Label("passage", (0.0, y, given(bench.dims.fold).nose_z / 2)),
        Arrow((0.0, y - 6.0, z + 0.3 * film), (0.0, y - 6.0, z)),
    )


def fold(bench: Bench, data: Data) -> Scene:
    course = given(bench.dims.fold)
    return Scene(
        bench.assembled_bone(cut=True, lid=False),
        View.CUT_FROM_ABOVE,
        Label("around the nose,\nwithout a crease", (0.0, course.nose_y, course.nose_z - course.radius)),
        Label("end of the film\nin the trough", (0.0, course.floor_y, course.film_end_z)),
        Label("head", bench.head),
    )


def stick_head(bench: Bench, data: Data) -> Scene:
    course, room = given(bench.dims.fold), data["fit"]["end_room_mm"] / 2
    return Scene(
        bench.assembled_bone(cut=True, lid=False),
        View.CUT_FROM_ABOVE,
        Label(f"{room:g} mm must be free", (0.0, course.floor_y, course.tabs_end_z + room)),
        Label("head: adhesive film last", bench.head),
    )


def bend_wires(bench: Bench, data: Data) -> Scene:
    """Show the wires over the folded tail and out at the proximal end of the window, cut open."""
    course, dims, wire = given(bench.dims.fold), bench.dims, data["fit"]["wire_mm"]
    y = course.floor_y + dims.sensor.thickness_mm + bench.design.sensor.crimp_height_mm + wire / 2
    end, low, high = course.tabs_end_z, y - wire / 2, y + wire / 2
    loop = difference(
        cylinder("y", (end, wire), low, high, 1.5 * wire), cylinder("y", (end, wire), low - 1.0, high + 1.0, wire / 2),
        Box((-wire, low - 1.0, end - 2 * wire), (3 * wire, high + 1.0, end)),
    )  # fmt: skip
    out = cylinder("z", (0.0, y), dims.base_end_z - 8.0, end, wire / 2)
    wires = union(out, loop, cylinder("z", (2 * wire, y), end - 1.5, end, wire / 2))
    way = "between the cheeks" if data["wires_between_cheeks"] else "in the groove"
    return Scene(
        (*bench.assembled_bone(cut=True, lid=False), bench.solid(wires, Paint.WIRE)),
        Camera.from_angles(24, 45),
        Label("loop, not pulled\nat the joints", (wire, y, end + wire)),
        Label(f"fix with adhesive here,\nthen {way}", (0.0, course.floor_y + wire, course.nose_z)),
    )


def stick_lid(bench: Bench, data: Data) -> Scene:
    course = given(bench.dims.fold)
    lid, half = bench.part("lid", (0.0, _LIFT_MM, 0.0)), bench.dims.tail_half_width
    beads = (cylinder("z", (x, course.floor_y + 0.3), course.nose_z, course.trough_end_z, 0.3) for x in (-half, half))
    middle = (course.nose_z + course.trough_end_z) / 2
    return Scene(
        (*bench.assembled_bone(lid=False), lid, bench.solid(union(*beads), Paint.SEAL)),
        View.DORSAL,
        Label("lid", (0.0, bench.dims.bone_outline.section.dorsal + _LIFT_MM, middle)),
        Label("bead of adhesive\nalong the edges", (half, course.floor_y + 0.3, middle)),
        Arrow((0.0, _LIFT_MM + 3.0, middle), (0.0, course.floor_y + 4.0, middle)),
    )


def cover_sensor(bench: Bench, data: Data) -> Scene:
    (_, y, z), flat, cut = bench.head, -bench.dims.flat_depth, data["fit"]["cover_tape"]
    least, most = (f"{width_mm:g}" for width_mm in cut["width_mm"])
    width = least if least == most else f"{least} to {most}"
    turned_up = f",\n{cut['turned_up_mm']:g} mm turned up" if cut["turned_up_mm"] else ""
    neck = f",\nneck {cut['neck_mm']:g} mm wide" if cut["neck_mm"] else ""
    return Scene(
        (*bench.assembled_bone(), bench.solid(tape(bench.design), Paint.TAPE)),
        View.PALMAR,
        Label(f"one strip of\npolyimide tape{neck},\nedges pressed down", (0.0, flat, z / 2)),
        Label(f"over the head,\n{width} mm wide", (0.0, y, z + 1.0)),
        Label(f"from the collar on{turned_up}", (0.0, flat, 0.3)),
    )


def place_insert(bench: Bench, data: Data) -> Scene:
    (_, y, z), kind = bench.head, data["fit"]["sensor_insert"]["kind"]
    above = y - given(bench.dims.insert).height - _LIFT_MM / 2
    shown = (bench.solid(tape(bench.design), Paint.TAPE), bench.part("insert_jig"))
    return Scene(
        (*bench.assembled_bone(), *shown, bench.part("sensor_insert", (0.0, -_LIFT_MM, 0.0))),
        View.PALMAR,
        Label(f"{kind}, double-sided\nfilm towards the tape", (0.0, y - _LIFT_MM, z)),
        Label("jig over the platform,\nopen towards the tail", (0.0, y - 1.0, z + bench.dims.platform_radius)),
        Label("tape over the sensor", (0.0, -bench.dims.flat_depth, z / 3)),
        Arrow((0.0, above, z), (0.0, above + _LIFT_MM / 3, z)),
    )


def seal_passage(bench: Bench, data: Data) -> Scene:
    """Show the seal in the passage of the tail, near the collar, cut open."""
    dims = bench.dims
    (plug,) = passage_seal(bench.design)
    y = -dims.flat_depth - 0.3
    beside = "window" if dims.fold else "tail"
    end = dims.fold.window_low_z + 1.0 if dims.fold else dims.tail_end_z
    reach = 3 * (dims.collar.section.half_width + dims.collar.section.palmar + dims.collar.section.dorsal)
    near = Box((-reach, -reach, end - 4.0), (reach, reach, _BEYOND_COLLAR_MM))
    shown = [bench.part_solid("bone"), (sensor_body(bench.design), Paint.SENSOR), (plug, Paint.SEAL)]
    if dims.fold:
        shown.append(bench.part_solid("lid"))
    return Scene(
        tuple(bench.solid(intersection(solid, near), colour, cut=True) for solid, colour in shown),
        View.CUT_FROM_BELOW,
        Label("silicone adhesive,\nflush with the collar", (0.0, y, -0.3)),
        Label(f"leave the {beside} open", (0.0, 0.0 if dims.fold else y, end)),
    )


def peel_tape(bench: Bench, data: Data) -> Scene:
    """Show where the finished finger breathes, and the tape around its seat if it has one."""
    dims = bench.dims
    if dims.fold:
        opening = (0.0, dims.fold.floor_y + 1.0, (dims.fold.window_low_z + dims.fold.nose_z) / 2)
    else:
        opening = (0.0, dims.bone_outline.section.dorsal, dims.channel_exit_z)
    labels = [Label("must be open:\nair vent of the sensor", opening)]
    if span := tape_span_mm(bench.design):
        at = (-dims.bone_outline.section.half_width, 0.0, -(span[0] + span[1]) / 2)
        labels.append(Label("peel the tape off here,\nacross the finger", at))
    shown = (*bench.assembled_bone(), bench.part("skin"), *bench.seat_tape())
    return Scene(shown, View.DORSAL, *labels)


def _on_hand(bench: Bench, *, finished: bool) -> tuple[tuple[Shown, ...], list[float]]:
    """Show the bone or the finished finger on the hand, straight and bent; return also z at each knuckle's end."""
    joint = given(bench.dims.joint)
    colours: dict[str, Colour] = {"sensor": Paint.SENSOR, HAND: Paint.HAND}
    solids: dict[str, Solid] = {"sensor": sensor_body(bench.design)} if finished else {}
    for name in ("bone", *(("lid", "skin") if finished else ())):
        if name != "lid" or bench.dims.fold:
            solids[name], colours[name] = bench.part_solid(name)
    placed = place_on_hand(bench.design, joint, bench.evaluator, solids)
    ends = [float(mesh.vertices[:, 2].max()) for name, mesh in placed if name == HAND]
    return tuple(Shown(mesh, colours[name]) for name, mesh in placed), ends


def pin(bench: Bench, data: Data) -> Scene:
    joint, half = given(bench.dims.joint), bench.dims.pin_length / 2
    out = 2.5 * half
    shaft = cylinder("x", (joint.axis_y, joint.axis_z), -half - out, half - out, joint.pin_radius)
    return Scene(
        (bench.part("bone"), bench.solid(shaft, Paint.STEEL)),
        View.DORSAL,
        Label(f"pin of {data['joint']['pin_mm']:g} mm", (-half - out, joint.axis_y, joint.axis_z)),
        Label("ream this bore", (-half, joint.axis_y, joint.axis_z)),
        Arrow((-half - 0.6 * out, joint.axis_y + 4.0, joint.axis_z), (-half, joint.axis_y + 4.0, joint.axis_z)),
    )


def bend(bench: Bench, data: Data) -> Scene:
    (shown, ends), joint = _on_hand(bench, finished=False), given(bench.dims.joint)
    texts = ("straight:\nmust stop here", f"bent by {data['joint']['travel_deg']:g} degrees:\nmust stop here")
    # The hand's shoulder lies a radius behind the pin, and its round knuckle ends as far before it.
    places = [
        (0.0, joint.axis_y + y, z - 2 * joint.radius) for y, z in zip((joint.radius, -joint.radius), ends, strict=True)
    ]
    return Scene(shown, View.SIDE, *(Label(text, place) for text, place in zip(texts, places, strict=True)))


def try_anchor(bench: Bench, data: Data) -> Scene:
    return _show_anchor(bench, "anchor pin: try it,\ntake it out again")


def anchor(bench: Bench, data: Data) -> Scene:
    return _show_anchor(bench, "anchor pin; the tendon\nis knotted here")


def _show_anchor(bench: Bench, text: str) -> Scene:
    found = given(bench.dims.anchor)
    half = bench.dims.collar.section.half_width_at(found.y)
    wire = cylinder("x", (found.y, found.z), -half, half, 0.95 * found.radius)
    return Scene(
        (bench.part("bone", cut=True), bench.solid(wire, Paint.STEEL)),
        Camera.from_angles(30, -20),
        Label(text, (0.0, found.y, found.z)),
    )


def wire_loop(bench: Bench, data: Data) -> Scene:
    (shown, ends), dorsal = _on_hand(bench, finished=True), bench.dims.collar.section.dorsal
    return Scene(
        shown,
        View.SIDE,
        Label("wires (not drawn) cross\nhere, in a loose loop", (0.0, dorsal, ends[0])),
        Label("still loose\nwhen bent", (0.0, dorsal, ends[-1])),
    )
