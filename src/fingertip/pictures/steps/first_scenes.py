"""Scenes of a first finger, whose skin is cast in a cup around a core that is lowered into it.

The cup stands on its foot, tip down: distal (z) points down in all pictures of it.
"""

from __future__ import annotations

import math

from fingertip.cad.printing.orientations import print_orientations
from fingertip.cad.printing.overhang import bed_pose
from fingertip.cad.printing.print_files import arrange
from fingertip.cad.printing.settings import FDM
from fingertip.cad.shapes.insert import cavity
from fingertip.design.geometry.cup_layout import BELT_MM, GAP_MM, LIP_MM, PLATE_MM
from fingertip.design.geometry.dimensions import TIE_DEPTH_MM, TIE_WIDTH_MM
from fingertip.design.geometry.solids import Box, Solid, cylinder, difference, intersection, scaled, union
from fingertip.design.interfaces.interface import middle_y
from fingertip.design.interfaces.rigid import Post
from fingertip.pictures.raster import Camera
from fingertip.pictures.steps.objects import CUP_RADIUS_MM, Bench
from fingertip.pictures.steps.scene import Arrow, Data, Label, Paint, Scene, Shown, View, given

_UP = (0.0, 0.0, -1.0)
_STANDING = Camera.looking_from((0.5, -1.0, -0.45), _UP)
"""Camera on the half marked PAD of the standing cup, and on the plate."""
_CUT = Camera.looking_from((-1.0, -0.35, -0.3), _UP)
"""Camera on a section of the standing cup, the half marked PAD at the left."""
_FROM_PALM = Camera.from_angles(28, -42)
_VARNISH, _WOOD, _BAND, _BOARD = (0.93, 0.80, 0.35), (0.80, 0.66, 0.45), (0.75, 0.35, 0.30), (0.20, 0.45, 0.30)
_COAT_MM, _LIFT_MM, _TAB_PITCH_MM = 0.9, 20.0, 2.54
"""Thickness with which a coat is drawn at the tip, height of the core above the cup, and pitch of the legs [mm]."""


def print_(bench: Bench, data: Data) -> Scene:
    """Show the plate as it is printed, with the names of its parts."""
    names = {
        "bone": "bone", "stand": "stand", "core": "core: a plate with\nthree ridges and a\nfinger",
        "mold_palmar": "cup, half\nmarked PAD", "mold_dorsal": "cup, other half",
    }  # fmt: skip
    lies, printer = print_orientations(bench.design), bench.design.printer
    parts = {name: bench.part(name) for name in lies}
    poses = {name: bed_pose(parts[name].mesh, lies[name].rotate_x_deg) for name in lies}
    sizes = {name: pose.size(parts[name].mesh) for name, pose in poses.items()}
    footprints = {name: size[:2] for name, size in sizes.items()}
    shown, labels = [], []
    for placed in arrange(footprints, (printer.bed_x_mm, printer.bed_y_mm), FDM.gap_mm)[0]:
        pose, part = poses[placed.name], parts[placed.name]
        pose = (pose.turned() if placed.is_turned else pose).on_bed(part.mesh, placed.x, placed.y)
        shown.append(Shown(pose.apply(part.mesh), part.colour))
        middle = placed.x + placed.width / 2, placed.y + placed.depth / 2
        labels.append(Label(names[placed.name], (*middle, sizes[placed.name][2] - 1.0)))
    return Scene(shown, Camera.looking_from((-0.35, -1.0, 0.9), (0.0, 0.0, 1.0)), *labels)


def _bands(bench: Bench) -> list[Shown]:
    m, (height, depth) = bench.design.cup_layout, BELT_MM
    shown = []
    for z in m.belts_z:
        low, high = z - 0.4 * height, z + 0.4 * height
        inner = Box((-m.half_width + depth, depth - m.palmar_height, low - 1.0),
                    (m.half_width - depth, m.dorsal_height - depth, high + 1.0))  # fmt: skip
        outer = Box((-m.half_width, -m.palmar_height, low), (m.half_width, m.dorsal_height, high))
        shown.append(bench.solid(difference(outer, inner), _BAND))
    return shown


def _cup(bench: Bench, *, cut: bool = False) -> list[Shown]:
    return [bench.part("mold_palmar", cut=cut), bench.part("mold_dorsal", cut=cut)]


def _coated(bench: Bench) -> Solid:
    """Build a coat on the wall of the cavity, thick enough to be seen."""
    hollow = cavity(bench.design)
    return difference(hollow, scaled(hollow, 1.0 - _COAT_MM / bench.design.skin.length_mm))


def try_core(bench: Bench, data: Data) -> Scene:
    """Show the core above the cup, and beside it the core seated, with calipers over both."""
    m = bench.design.cup_layout
    beside, lift = 2 * m.half_width + 28.0, _LIFT_MM + 8.0
    x, y, top, foot = -m.half_width + 4.0, -m.palmar_height + 5.0, -PLATE_MM, m.foot_z
    beam = x - 14.0
    calipers = union(
        Box((beam - 6.0, y - 1.5, top - 16.0), (beam, y + 1.5, foot + 10.0)),
        Box((beam - 1.0, y - 1.5, top - 5.0), (x, y + 1.5, top)), Box((beam - 1.0, y - 1.5, foot), (x, y + 1.5, foot + 5.0)),
    )  # fmt: skip
    closed = [*_cup(bench), *_bands(bench)]
    return Scene(
        (
            *closed, bench.part("core"), bench.solid(calipers, Paint.STEEL),
            *(item.moved((beside, 0.0, 0.0)) for item in closed), bench.part("core", (beside, 0.0, -lift)),
        ),
        Camera.looking_from((0.4, -1.0, 0.12), _UP),
        Label(f"calipers, from the foot\nto the top of the plate:\n{m.overall_height:.1f} mm", (beam - 3.0, y, top - 10.0)),
        Label("the same narrow gap\nall around", (-m.half_width * 0.6, -m.palmar_height, GAP_MM / 2)),
        Label("foot", (-m.half_width * 0.5, -m.palmar_height, foot - 0.5)),
        Label("ridge, one of three", (beside + m.half_width - 1.0, 0.0, 1.0 - lift)),
        Label("its groove", (beside + m.half_width, -0.5, 1.5)),
        Label("two rubber bands", (beside + m.half_width / 2, -m.palmar_height, m.belts_z[0])),
        Arrow((beside, -m.palmar_height, -lift * 0.65), (beside, -m.palmar_height, -lift * 0.2)),
    )  # fmt: skip


def varnish(bench: Bench, data: Data) -> Scene:
    m = bench.design.cup_layout
    depth, z = m.palmar_height - bench.design.mold.wall_mm, bench.dims.sensor_z
    below = Box((-m.half_width, -2 * m.palmar_height, 0.5), (m.half_width, -0.1, 2 * m.foot_z))
    return Scene(
        (bench.part("mold_palmar"), bench.solid(intersection(_coated(bench), below), _VARNISH)), Camera.looking_from((0.35, 1.0, -0.35), _UP),
        Label("varnish on all\nof the hollow", (0.0, -depth, z)),
        Label("none on this\nflat face", (m.half_width - 3.0, 0.0, m.foot_z - 6.0)),
        Label("none in the grooves", (-m.half_width + 3.0, -1.0, 1.0)),
        Label("PAD stands on\nits outer side", (-m.half_width, -m.palmar_height / 2, m.foot_z / 2)),
    )  # fmt: skip


def solder(bench: Bench, data: Data) -> Scene:
    dims = bench.dims
    (_, y, z), end, tabs = bench.head, dims.tail_end_z, bench.design.sensor.tab_length_mm
    half, radius = _TAB_PITCH_MM / 2, 0.5
    flat = union(
        cylinder("y", (z, 0.0), y, y + 0.3, dims.sensor.head_diameter_mm / 2),
        Box((-dims.sensor.tail_width_mm / 2, y, end), (dims.sensor.tail_width_mm / 2, y + 0.3, z)),
    )
    legs = union(*(Box((x - 0.3, y, end - tabs), (x + 0.3, y + 0.4, end + 1.5)) for x in (-half, half)))
    leads = union(*(cylinder("z", (x, y + radius), end - tabs - 16.0, end - tabs + 2.5, radius) for x in (-half, half)))
    lengths, heads = (" to ".join(f"{size:g}" for size in data[key]) for key in ("length_mm", "head_mm"))
    return Scene(
        (bench.solid(flat, Paint.SENSOR), bench.solid(legs, Paint.STEEL), bench.solid(leads, Paint.WIRE)),
        Camera.from_angles(20, 55),
        Label(f"head: {heads} mm wide", (0.0, y, z)),
        Label(f"film: {lengths} mm long,\nhead and tail", (0.0, y, (z + end) / 2)),
        Label("solder here,\non the metal leg", (half, y, end - tabs + 1.5)),
        Label("wire, straight on", (-half, y, end - tabs - 12.0)),
    )


def lay_in(bench: Bench, data: Data) -> Scene:
    """Show the sensor above its bed, and the cable tie where it holds the wires."""
    dims, lift, (x, y, z) = bench.dims, 12.0, bench.head
    section, (low, _) = dims.bone_outline.section, given(dims.tie_span)
    sizes = (
        (section.half_width - TIE_DEPTH_MM + more, dims.base_flat_depth + more, section.dorsal + more)
        for more in (0, 1)
    )
    inner, outer = (
        Box((-half, -palmar, low - 1 + more), (half, dorsal, low + TIE_WIDTH_MM + 1 - more))
        for more, (half, palmar, dorsal) in enumerate(sizes)
    )
    lead = cylinder("z", (0.0, section.dorsal + 0.6), low - 14.0, dims.channel_exit_z, 0.6)
    return Scene(
        (bench.part("bone"), bench.sensor((0.0, -lift, 0.0)), bench.solid(difference(outer, inner), Paint.PAPER), bench.solid(lead, Paint.WIRE)),
        _FROM_PALM,
        Label("sensor, paper peeled\noff its other side", (x, y - lift, z)),
        Label("round bed", (x, y, z + dims.sensor.head_diameter_mm / 2)),
        Label("trough", (0.0, y + 1.0, dims.tail_end_z / 2)),
        Label("hole to the back,\nfor both wires", (0.0, y + 1.0, dims.channel_exit_z + 1.0)),
        Label("cable tie, over the wires\nat the back, in a notch\nat each side", (0.0, -dims.base_flat_depth - 1.0, low + 1.0)),
        Arrow((x, y - 0.85 * lift, z), (x, y - 0.2 * lift, z)),
    )  # fmt: skip


def mix(bench: Bench, data: Data) -> Scene:
    batch, (first, second) = data["batch"], data["batch"]["components"]
    level = 1000.0 * batch["total_g"] / 1.08 / (math.pi * CUP_RADIUS_MM**2)
    share, scale = batch["a_g"] / batch["total_g"], Box((-40.0, -35.0, -10.0), (40.0, 35.0, 0.0))
    return Scene(
        (*bench.cup(level), bench.solid(scale, Paint.STEEL), _stick(bench, (8.0, 10.0), 2.0, 90.0)),
        Camera.looking_from((0.15, -1.0, 0.22), (0.0, 0.0, 1.0)),
        Label(f"then {batch['b_g']:g} g of {second}:\n{batch['total_g']:g} g in all", (CUP_RADIUS_MM, 0.0, level)),
        Label(f"first {batch['a_g']:g} g of {first}", (-CUP_RADIUS_MM, 0.0, share * level)),
        Label("scale, set to zero\nwith the empty cup", (40.0, -35.0, -5.0)),
        Label("stir for three minutes", (8.0, 10.0, 60.0)),
    )


def _stick(bench: Bench, at: tuple[float, float], low: float, high: float) -> Shown:
    return bench.solid(cylinder("z", at, low, high, 1.2), _WOOD)


def coat(bench: Bench, data: Data) -> Scene:
    m, dims, (_, y, z) = bench.design.cup_layout, bench.dims, bench.head
    lift = _LIFT_MM + m.foot_z
    groove = bench.design.bone.groove_distance_mm + bench.design.bone.groove_width_mm / 2
    return Scene(
        (
            *_cup(bench, cut=True), bench.solid(_coated(bench), Paint.SILICONE, cut=True),
            bench.part("core", (0.0, 0.0, -lift)),
            _stick(bench, (0.5, 3.0), -24.0, m.foot_z - bench.design.mold.wall_mm - 2.0),
        ),
        Camera.looking_from((-1.0, -0.5, 0.12), _UP),
        Label("thin coat on all\nof the hollow", (0.0, -m.palmar_height + bench.design.mold.wall_mm, z)),
        Label("second stick", (0.5, 3.0, -20.0)),
        Label("round dent: coat it", (0.0, y, z - lift)),
        Label("ring groove: coat it", (-dims.bone_outline.section.half_width + 0.8, 1.0, groove - lift)),
    )  # fmt: skip


def _silicone(bench: Bench, level: float, *inside: Solid) -> Shown:
    """Show the silicone in the cup up to a level, around what is in it."""
    held = intersection(cavity(bench.design), Box((-99.0, -99.0, level), (99.0, 99.0, 99.0)))
    return bench.solid(difference(held, *inside), Paint.SILICONE, cut=True)


def pour(bench: Bench, data: Data) -> Scene:
    m, dorsal = bench.design.cup_layout, bench.dims.outer.section.dorsal
    z = m.pour_z * bench.dims.shrinkage
    stream = cylinder("z", (0.5, 0.6 * dorsal), -35.0, z + 0.5, 0.8)
    return Scene(
        (*_cup(bench, cut=True), _silicone(bench, z), bench.solid(stream, Paint.SILICONE)), _CUT,
        Label("thin stream, from a\nhand's breadth above", (0.5, 0.6 * dorsal, -25.0)),
        Label("up to this line", (m.pour_mark_x, -0.2, z)),
        Label("half marked PAD", (0.0, -m.palmar_height, m.foot_z / 2)),
    )  # fmt: skip


def lower(bench: Bench, data: Data) -> Scene:
    m, core = bench.design.cup_layout, bench.part_solid("core")[0]
    top = -PLATE_MM
    return Scene(
        (*_cup(bench), *_bands(bench), bench.part("core"), *_drops(bench)), _STANDING,
        Label("silicone comes out\nof all four notches", (m.notch_x, -m.palmar_height, GAP_MM + 1.0)),
        Label("lower it by\nboth lips", (m.half_width + LIP_MM, 0.0, top + 1.0)),
        Label("each ridge in its groove", (-m.half_width, 0.0, GAP_MM + 0.8)),
        Arrow((0.0, 0.0, top - 16.0), (0.0, 0.0, top - 3.0)),
    )  # fmt: skip


def _drops(bench: Bench) -> list[Shown]:
    m = bench.design.cup_layout
    faces = (-m.palmar_height - 0.4, m.dorsal_height + 0.4)
    drops = [cylinder("z", (x, y), GAP_MM, GAP_MM + 3.5, 1.1) for x in (-m.notch_x, m.notch_x) for y in faces]
    return [bench.solid(union(*drops), Paint.SILICONE)]


def open_(bench: Bench, data: Data) -> Scene:
    m, apart = bench.design.cup_layout, 16.0
    low, lifted, edge = -m.palmar_height - apart, (0.0, 0.0, -6.0), m.foot_z + 3.0
    return Scene(
        (
            bench.part("mold_palmar", (0.0, -apart, 0.0)), bench.part("mold_dorsal", (0.0, apart / 2, 0.0)),
            bench.part("core", lifted), bench.part("skin", lifted),
        ),
        Camera.looking_from((1.0, -0.4, -0.25), _UP),
        Label("skin, still on the core", (0.0, -2.0, m.foot_z - bench.design.mold.wall_mm - 7.0)),
        Label("1: half marked PAD,\nstraight off", (m.half_width, low + 5.0, m.foot_z / 2)),
        Label("2: lift the core\nout of the groove", (m.half_width, m.dorsal_height, -PLATE_MM / 2 - 6.0)),
        Arrow((0.0, low + 4.0, edge), (0.0, low - 10.0, edge)),
        Arrow((0.0, 0.0, -PLATE_MM - 8.0), (0.0, 0.0, -PLATE_MM - 18.0)),
    )  # fmt: skip


def pull_on(bench: Bench, data: Data) -> Scene:
    dims, bone, (_, y, z) = bench.dims, bench.design.bone, bench.head
    out, groove = bench.design.skin.length_mm * 1.15, bone.groove_distance_mm + bone.groove_width_mm / 2
    return Scene(
        (*bench.assembled_bone(), bench.part("skin", (0.0, 0.0, out), cut=True)), View.CUT_FROM_BELOW,
        Label("inner rib, comes to lie\nin the ring groove", (0.0, dims.bone_outline.section.dorsal - 0.4, out + groove)),
        Label("bump, comes to lie\non the sensor's head", (0.0, y, out + z)),
        Label("skin, cut open here", (0.0, dims.outer.section.dorsal - 0.5, out + z)),
        Label("ring groove", (-dims.bone_outline.section.half_width + 0.8, 1.0, groove)),
        Label("step, where the\nedge of the skin ends", (-dims.collar.section.half_width, 0.0, 0.0)),
        Label("keep the sensor dry", (0.0, y, z - 5.0)),
        Arrow((0.0, 15.0, out + 4.0), (0.0, 15.0, out - 12.0)),
    )  # fmt: skip


def connect(bench: Bench, data: Data) -> Scene:
    """Show the finger in its stand, pad up, beside a controller with the resistor."""
    dims, z, post = bench.dims, bench.dims.channel_exit_z, bench.design.bone.post_width_mm / 2
    y, axis_y = dims.bone_outline.section.dorsal + 0.8, middle_y(dims)
    edge, (supply, ground, pin) = 30.0, (z, z - 12.0, z - 24.0)
    board = Box((edge, y, z - 45.0), (edge + 21.0, y + 1.6, z + 6.0))
    usb = Box((edge + 6.5, y - 2.6, z + 1.5), (edge + 14.5, y, z + 8.0))
    at = edge + 1.5
    pads = union(*(cylinder("y", (place, at), y - 0.3, y + 0.5, 1.0) for place in (supply, ground, pin)))
    red = cylinder("x", (y - 0.8, supply), 0.0, at, 0.6)
    beside = dims.collar.section.half_width + 4.0
    black = union(
        cylinder("x", (y - 0.8, pin), beside, at, 0.6), cylinder("z", (beside, y - 0.8), pin, z - 2.0, 0.6),
        cylinder("x", (y - 0.8, z - 2.0), 0.0, beside, 0.6),
    )  # fmt: skip
    body = cylinder("z", (at, y - 1.6), pin + 3.0, ground - 3.0, 1.4)
    bolt = cylinder("x", (axis_y, Post().cross_bolt_z(bench.design)), -post - 6.0, post + 6.0, 1.5)
    return Scene(
        (
            *bench.assembled_bone(), bench.part("skin"), bench.part("stand"), bench.solid(bolt, Paint.STEEL),
            bench.solid(board, _BOARD), bench.solid(usb, Paint.STEEL), bench.solid(pads, Paint.SENSOR),
            bench.solid(red, Paint.WIRE), bench.solid(black, (0.15, 0.15, 0.17)),
            bench.solid(cylinder("z", (at, y - 1.6), pin, ground, 0.4), Paint.STEEL), bench.solid(body, _WOOD),
        ),
        Camera.from_angles(18, -55),
        Label("3V3", (at, y - 0.5, supply)), Label("GND", (at, y - 0.5, ground)), Label("A0", (at, y - 0.5, pin)),
        Label(f"resistor, {data['divider_kohm']:g} kohm", (at, y - 3.0, (pin + ground) / 2)),
        Label("bolt with nut", (-post - 5.0, axis_y, Post().cross_bolt_z(bench.design))),
        Label("stand, its flat\nback on the table", (0.0, axis_y, z - 40.0)),
        Label("pad", (0.0, -dims.outer.section.palmar, dims.sensor_z)),
        Label("controller", (edge + 12.0, y, z - 35.0)),
    )  # fmt: skip
