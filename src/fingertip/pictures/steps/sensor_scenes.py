"""Scenes at the bone: mount the sensor, keep silicone out, open the air vent, mount the finger on the hand."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.cad.shapes.bone import passage_seal, sensor_body, tape
from fingertip.design.geometry.features import TailFold
from fingertip.design.geometry.seat import tape_span_mm
from fingertip.design.geometry.solids import Box, Point3, Solid, cylinder, intersection, union
from fingertip.pictures.picture import HAND, place_on_hand
from fingertip.pictures.raster import Camera, Colour
from fingertip.pictures.steps.bench import HAND_COLOUR, SEAL, SENSOR, STEEL, TAPE, WIRE, Bench
from fingertip.pictures.steps.scene import (
    CUT_FROM_ABOVE,
    CUT_FROM_BELOW,
    DORSAL,
    PALMAR,
    SIDE,
    Arrow,
    Label,
    Scene,
    Shown,
)

Data = Mapping[str, Any]

_LIFT_MM = 10.0
_BEYOND_COLLAR_MM = 9.0
"""Length of the bone that is shown distal to the collar in a close view of it [mm]."""


def _fold(bench: Bench) -> TailFold:
    fold = bench.design.dimensions.fold
    assert fold
    return fold


def _head(bench: Bench) -> Point3:
    dims = bench.design.dimensions
    return 0.0, -dims.flat_depth, dims.sensor_z


def place_sensor(bench: Bench, data: Data) -> Scene:
    """Show the sensor on its way into pocket and slot, through the collar where its tail passes it."""
    dims, (x, y, z) = bench.design.dimensions, _head(bench)
    if dims.tail_passes_collar:
        out = 0.6 * (dims.sensor.length_mm - dims.sensor.head_diameter_mm)
        return Scene(
            (bench.part("bone"), bench.solid(sensor_body(bench.design), SENSOR, (0.0, -0.1, out))),
            PALMAR,
            (
                Label("head, stuck down last", (x, y, z + out)),
                Label("pocket", (x, y, z)),
                Label("passage through\nthe collar", (dims.tail_half_width, y - 0.4, 0.0)),
                Label("solder relief", (0.0, y + 1.0, dims.tail_end_z)),
            ),
            (Arrow((-8.0, y - 3.0, z + out), (-8.0, y - 3.0, z + 0.3 * out)),),
        )
    return Scene(
        (bench.part("bone"), bench.solid(sensor_body(bench.design), SENSOR, (0.0, -_LIFT_MM, 0.0))),
        PALMAR,
        (
            Label("head, adhesive film\non this side", (x, y - _LIFT_MM, z)),
            Label("pocket", (x, y, z + dims.sensor.head_diameter_mm / 2)),
            Label("slot of the tail", (0.0, y, dims.tail_end_z / 2 + z / 2)),
            Label("solder relief", (0.0, y, dims.tail_end_z)),
        ),
        (Arrow((x, y - 0.9 * _LIFT_MM, z), (x, y - 0.2 * _LIFT_MM, z)),),
    )


def _wire_radius(bench: Bench) -> float:
    """Radius of both wires together, as drawn in the cable channel [mm]."""
    return 0.35 * bench.design.bone.channel_diameter_mm


def wires(bench: Bench, data: Data) -> Scene:
    """Show the way of the wires through the channel, cut open."""
    dims = bench.design.dimensions
    return Scene(
        (
            bench.part("bone", cut=True), bench.solid(sensor_body(bench.design), SENSOR, cut=True),
            *bench.wires(_wire_radius(bench)),
        ),
        CUT_FROM_BELOW,
        (
            Label("solder here", (0.0, -dims.flat_depth, dims.tail_end_z)),
            Label("thread the wires\nin here first", (0.0, dims.bone_outline.section.dorsal, dims.channel_exit_z)),
            Label("tie them here", (0.0, dims.tie_hole_y, dims.tie_hole_z)),
            Label("sensor", _head(bench)),
        ),
    )  # fmt: skip


def _near_collar(bench: Bench, low_z: float, *more: tuple[Solid, Colour]) -> tuple[Shown, ...]:
    """Show bone and sensor around the collar, cut open along the finger and on both sides of it."""
    dims = bench.design.dimensions
    reach = 3 * (dims.collar.section.half_width + dims.collar.section.palmar + dims.collar.section.dorsal)
    near = Box((-reach, -reach, low_z - 4.0), (reach, reach, _BEYOND_COLLAR_MM))
    solids: list[tuple[Solid, Colour]] = [bench.part_solid("bone"), (sensor_body(bench.design), SENSOR), *more]
    if dims.fold:
        solids.append(bench.part_solid("lid"))
    return tuple(bench.solid(intersection(solid, near), colour, cut=True) for solid, colour in solids)


def _section(bench: Bench, *more: Shown, lid: bool = False, sensor: bool = True) -> tuple[Shown, ...]:
    """Show bone and folded sensor cut open."""
    shown = [bench.part("bone", cut=True)]
    if sensor:
        shown.append(bench.solid(sensor_body(bench.design), SENSOR, cut=True))
    if lid:
        shown.append(bench.part("lid", cut=True))
    return (*shown, *more)


def try_fold(bench: Bench, data: Data) -> Scene:
    """Show trough, nose, window and passage of the bone, cut open."""
    fold, y = _fold(bench), _head(bench)[1]
    return Scene(
        _section(bench, sensor=False),
        CUT_FROM_ABOVE,
        (
            Label("trough", (0.0, fold.floor_y, (fold.nose_z + fold.trough_end_z) / 2)),
            Label("window", (0.0, fold.nose_y, (fold.window_low_z + fold.nose_z - fold.radius) / 2)),
            Label("passage in\nthe collar", (0.0, y - 0.5, fold.nose_z / 2)),
            Label("nose", (0.0, fold.nose_y, fold.nose_z - fold.radius / 2)),
            Label("pocket", _head(bench)),
        ),
    )


def _straight_sensor(bench: Bench, length: float, width: float, shift: Point3) -> list[Shown]:
    """Show the sensor flat, with a wire at each tab."""
    dims, fold = bench.design.dimensions, _fold(bench)
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
    return [bench.solid(flat, SENSOR), bench.solid(union(*leads), WIRE)]


def _film_mm(bench: Bench) -> float:
    body = bench.design.dimensions.sensor
    return body.length_mm - body.head_diameter_mm / 2


def solder_tabs(bench: Bench, data: Data) -> Scene:
    """Show the flat sensor with its wires."""
    wire, film = data["fit"]["wire_mm"], _film_mm(bench)
    return Scene(
        tuple(_straight_sensor(bench, film, wire, (0.0, 0.0, 0.0))),
        Camera.from_angles(28, 50),
        (
            Label("head", (0.0, 0.0, 0.0)),
            Label(f"wires of {wire:g} mm,\nstraight out", (0.0, wire, -film - 12.0)),
            Label(f"joints at most\n{data['fit']['crimp_mm']:g} mm high,\nvarnished", (0.0, wire, -film)),
        ),
    )


def thread(bench: Bench, data: Data) -> Scene:
    """Show the tail on its way through the passage, from the pocket out below the base."""
    film, (_, y, z) = _film_mm(bench), _head(bench)
    wire = data["fit"]["wire_mm"]
    return Scene(
        (bench.part("bone", cut=True), *_straight_sensor(bench, film, wire, (0.0, y + 0.05, z + 0.35 * film))),
        CUT_FROM_BELOW,
        (
            Label("head comes last", (0.0, y, z + 0.35 * film)),
            Label("wires and tabs first", (0.0, y, z - 0.65 * film - 14.0)),
            Label("passage", (0.0, y, _fold(bench).nose_z / 2)),
        ),
        (Arrow((0.0, y - 6.0, z + 0.3 * film), (0.0, y - 6.0, z)),),
    )


def fold(bench: Bench, data: Data) -> Scene:
    """Show the folded tail around the nose, cut open."""
    course = _fold(bench)
    return Scene(
        _section(bench),
        CUT_FROM_ABOVE,
        (
            Label("around the nose,\nwithout a crease", (0.0, course.nose_y, course.nose_z - course.radius)),
            Label("end of the film\nin the trough", (0.0, course.floor_y, course.film_end_z)),
            Label("head", _head(bench)),
        ),
    )


def stick_head(bench: Bench, data: Data) -> Scene:
    """Show the head in its pocket, and the room at the end of the trough."""
    course, room = _fold(bench), data["fit"]["end_room_mm"] / 2
    return Scene(
        _section(bench),
        CUT_FROM_ABOVE,
        (
            Label(f"{room:g} mm must be free", (0.0, course.floor_y, course.tabs_end_z + room)),
            Label("head: adhesive film last", _head(bench)),
        ),
    )


def _folded_wires(bench: Bench, wire_mm: float) -> Shown:
    """Show the wires over the folded tail, out at the proximal end of the window."""
    course, dims = _fold(bench), bench.design.dimensions
    y = course.floor_y + dims.sensor.thickness_mm + bench.design.sensor.crimp_height_mm + wire_mm / 2
    low = dims.base_end_z - 8.0
    return bench.solid(cylinder("z", (0.0, y), low, course.tabs_end_z, wire_mm / 2), WIRE)


def bend_wires(bench: Bench, data: Data) -> Scene:
    """Show the wires over the tail, cut open."""
    course, wire = _fold(bench), data["fit"]["wire_mm"]
    way = "between the cheeks" if data["wires_between_cheeks"] else "in the groove"
    return Scene(
        _section(bench, _folded_wires(bench, wire)),
        CUT_FROM_ABOVE,
        (
            Label("loop, not pulled\nat the joints", (0.0, course.floor_y + wire, course.tabs_end_z)),
            Label(f"fix with adhesive here,\nthen {way}", (0.0, course.floor_y + wire, course.nose_z)),
        ),
    )


def stick_lid(bench: Bench, data: Data) -> Scene:
    """Show the lid above its trough."""
    course = _fold(bench)
    lid = bench.part("lid", (0.0, _LIFT_MM, 0.0))
    middle = (course.nose_z + course.trough_end_z) / 2
    return Scene(
        (*bench.assembled_bone(lid=False), lid),
        DORSAL,
        (
            Label("lid", (0.0, bench.design.dimensions.bone_outline.section.dorsal + _LIFT_MM, middle)),
            Label("bead of adhesive\nalong the edges", (0.0, course.floor_y, middle)),
        ),
        (Arrow((0.0, _LIFT_MM + 3.0, middle), (0.0, course.floor_y + 4.0, middle)),),
    )


def cover_sensor(bench: Bench, data: Data) -> Scene:
    """Show the tape over pocket and slot."""
    (_, y, z) = _head(bench)
    return Scene(
        (*bench.assembled_bone(), bench.solid(tape(bench.design), TAPE)),
        PALMAR,
        (
            Label("one strip of\npolyimide tape,\nedges pressed down", (0.0, y, z / 2)),
            Label("over the head", (0.0, y, z + 1.0)),
            Label("from the collar on", (0.0, y, 0.3)),
        ),
    )


def seal_passage(bench: Bench, data: Data) -> Scene:
    """Show the seal in the passage of the tail, cut open."""
    dims = bench.design.dimensions
    (plug,) = passage_seal(bench.design)
    y = -dims.flat_depth - 0.3
    beside = "window" if dims.fold else "tail"
    end = dims.fold.window_low_z + 1.0 if dims.fold else dims.tail_end_z
    return Scene(
        _near_collar(bench, end, (plug, SEAL)),
        CUT_FROM_BELOW,
        (
            Label("silicone adhesive,\nflush with the collar", (0.0, y, -0.3)),
            Label(f"leave the {beside} open", (0.0, 0.0 if dims.fold else y, end)),
        ),
    )


def _seat_label(bench: Bench) -> tuple[Label, ...]:
    """Label the tape around the seat; nothing without one."""
    span = tape_span_mm(bench.design)
    if span is None:
        return ()
    half = bench.design.dimensions.bone_outline.section.half_width
    return (Label("peel the tape off here,\nacross the finger", (-half, 0.0, -(span[0] + span[1]) / 2)),)


def peel_tape(bench: Bench, data: Data) -> Scene:
    """Show where the finished finger breathes."""
    dims = bench.design.dimensions
    if dims.fold:
        opening = (0.0, dims.fold.floor_y + 1.0, (dims.fold.window_low_z + dims.fold.nose_z) / 2)
    else:
        opening = (0.0, dims.bone_outline.section.dorsal, dims.channel_exit_z)
    return Scene(
        (*bench.assembled_bone(), bench.part("skin"), *bench.seat_tape()),
        DORSAL,
        (Label("must be open:\nair vent of the sensor", opening), *_seat_label(bench)),
    )


def _on_hand(bench: Bench) -> tuple[tuple[Shown, ...], list[Point3]]:
    """Show the finger on the hand, straight and bent; return also the dorsal edge of the hand in both places."""
    joint = bench.design.dimensions.joint
    assert joint
    colours: dict[str, Colour] = {"sensor": SENSOR, HAND: HAND_COLOUR}
    solids: dict[str, Solid] = {"sensor": sensor_body(bench.design)}
    for name in ("bone", "lid", "skin"):
        if name != "lid" or bench.design.dimensions.fold:
            solids[name], colours[name] = bench.part_solid(name)
    placed = place_on_hand(bench.design, joint, bench.evaluator, solids)
    hands = [mesh.vertices for name, mesh in placed if name == HAND]
    edges = [(0.0, float(corners[:, 1].max()), float(corners[:, 2].max())) for corners in hands]
    return tuple(Shown(mesh, colours[name]) for name, mesh in placed), edges


def pin(bench: Bench, data: Data) -> Scene:
    """Show the pin of the joint on its way in."""
    joint, half = bench.design.dimensions.joint, bench.design.dimensions.pin_length / 2
    assert joint
    out = 2.5 * half
    shaft = cylinder("x", (joint.axis_y, joint.axis_z), -half - out, half - out, joint.pin_radius)
    return Scene(
        (bench.part("bone"), bench.solid(shaft, STEEL)),
        DORSAL,
        (
            Label(f"pin of {data['joint']['pin_mm']:g} mm", (-half - out, joint.axis_y, joint.axis_z)),
            Label("ream this bore", (-half, joint.axis_y, joint.axis_z)),
        ),
        (Arrow((-half - 0.6 * out, joint.axis_y + 4.0, joint.axis_z), (-half, joint.axis_y + 4.0, joint.axis_z)),),
    )


def bend(bench: Bench, data: Data) -> Scene:
    """Show the finger on the hand at both stops."""
    shown, edges = _on_hand(bench)
    texts = ("straight:\nmust stop here", f"bent by {data['joint']['travel_deg']:g} degrees:\nmust stop here")
    return Scene(shown, SIDE, tuple(Label(text, edge) for text, edge in zip(texts, edges, strict=False)))


def try_anchor(bench: Bench, data: Data) -> Scene:
    """Show the anchor pin in its hole."""
    return _show_anchor(bench, "anchor pin: try it,\ntake it out again")


def anchor(bench: Bench, data: Data) -> Scene:
    """Show the anchor pin of the tendon."""
    return _show_anchor(bench, "anchor pin; the tendon\nis knotted here")


def _show_anchor(bench: Bench, text: str) -> Scene:
    """Show the anchor pin in the bone, cut open."""
    found = bench.design.dimensions.anchor
    assert found
    half = bench.design.dimensions.collar.section.half_width_at(found.y)
    wire = cylinder("x", (found.y, found.z), -half, half, 0.95 * found.radius)
    return Scene(
        (bench.part("bone", cut=True), bench.solid(wire, STEEL)),
        Camera.from_angles(30, -20),
        (Label(text, (0.0, found.y, found.z)),),
    )


def wire_loop(bench: Bench, data: Data) -> Scene:
    """Show where the wires cross the joint."""
    shown, edges = _on_hand(bench)
    return Scene(
        shown,
        SIDE,
        (Label("wires cross here,\nin a loose loop", edges[0]), Label("still loose\nwhen bent", edges[-1])),
    )
