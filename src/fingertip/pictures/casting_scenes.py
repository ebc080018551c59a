"""Pictures of the casting steps, the skin cast around a core or the bone, and of the finished
finger.

The cup stands on its foot, tip down: distal (z) points down in all pictures of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from PIL import Image

from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.printing.orientations import print_orientations
from fingertip.cad.printing.overhang import bed_pose
from fingertip.cad.printing.settings import FDM
from fingertip.casting.sheet import CastingSheet
from fingertip.design import Design
from fingertip.design.interfaces.post_and_socket import Post, Socket
from fingertip.foundation.progress import Work
from fingertip.models.dimensions import KNOT_WIRES
from fingertip.models.holder import tower_sides
from fingertip.models.making import making_of
from fingertip.models.mold import cavity
from fingertip.models.mold_layout import (
    BELT_MM,
    GAP_MM,
    NOTCH_MM,
    PLATE_LEDGE_MM,
    PLATE_MM,
    STRAP_Y_MM,
)
from fingertip.models.solids import (
    Box,
    Point3,
    Solid,
    cylinder,
    extrude,
    union,
)
from fingertip.pictures import cameras, colours
from fingertip.pictures.joint_scenes import JOINT_SCENES
from fingertip.pictures.labelled_scene import Arrow, Label, PaintedMesh, Scene, draw_scene
from fingertip.pictures.raster import Camera, Canvas, bounds, to_png
from fingertip.pictures.workbench import CUP_RADIUS_MM, Workbench

_UP = (0.0, 0.0, -1.0)
_FROM_BELOW = Camera.looking_from((0.4, -1.0, 0.12), _UP)
"""Camera on the half marked PAD of the standing cup, on the ridges and on the foot."""
_CUT = Camera.looking_from((-1.0, -0.35, -0.3), _UP)
"""Camera on a section of the standing cup, the half marked PAD at the left."""
_FROM_PALM = Camera.from_angles(28, -42)
_VARNISH = (0.93, 0.80, 0.35)
_WOOD = (0.80, 0.66, 0.45)
_BAND = (0.75, 0.35, 0.30)
_BLACK = (0.15, 0.15, 0.17)
_COAT_MM = 0.9
_LIFT_MM = 20.0
_TAB_PITCH_MM = 2.54
_BAND_MM = 1.0
_ROW_MM = 50.0
"""Thickness with which a coat is drawn, height of the core above the cup, pitch of the legs,
thickness of a rubber band, and distance of two rows of parts [mm].
"""


def print_parts(workbench: Workbench, sheet: CastingSheet) -> Scene:
    """Show the printed parts, those of the mold in front, and name what the steps name of them."""
    layout = workbench.design.mold_layout
    bone = workbench.design.bone
    middle = workbench.dims.sensor_z
    _, head_y, head_z = workbench.head
    ring = (
        workbench.dims.bone_outline.section.half_width - bone.groove_depth_mm,
        0.0,
        bone.groove_distance_mm,
    )
    names: dict[str, dict[str, Point3]] = {
        "mold_palmar": {
            "cup, half\nmarked PAD": (-layout.half_width, -2.0, 0.8 * layout.foot_z),
            "hollow": (0.0, -6.0, middle),
            "notch of the rim": (-layout.notch_x, 3.0 - layout.palmar_height, GAP_MM + NOTCH_MM[1]),
            "foot": (-layout.half_width / 2, 0.0, layout.foot_z - 1.5),
        },
        "mold_dorsal": {
            "cup, other half": (0.9 * layout.half_width, layout.dorsal_height, 0.6 * layout.foot_z),
            "groove for a ridge": (0.0, layout.ridge_begins[1] + 2.0, GAP_MM),
        },
        "core": {
            "core: plate with\nthree ridges": (
                0.9 * layout.half_width,
                -layout.palmar_height,
                -PLATE_MM / 2,
            ),
            "ridge": (layout.half_width - 1.0, 0.0, 1.5),
            "ring groove": ring,
            "round dent": (0.0, head_y, head_z),
        },
        "holder": {
            "holder: plate with\nthree ridges": (
                0.9 * layout.half_width,
                -layout.palmar_height,
                -PLATE_MM / 2,
            ),
            "ridge": (layout.half_width - 1.0, 0.0, 1.5),
        },
        "plug": {"plug": (0.0, head_y, 0.0)},
        "bone": {"bone": (0.0, workbench.dims.bone_outline.section.dorsal, middle)},
        "stand": {"stand": (0.0, 0.0, -30.0)},
        "hand_stub": {"stub of a hand": (0.0, 0.0, -40.0)},
        "pin": {"pin of the joint": (0.0, 0.0, 0.0)},
    }
    meshes = list[PaintedMesh]()
    labels = list[Label]()
    ends = {True: 0.0, False: 30.0}

    for name, lies in print_orientations(workbench.design).items():
        part = workbench.part(name)
        front = name in ("mold_palmar", "mold_dorsal", making_of(workbench.design).hanger, "plug")
        pose = bed_pose(part.mesh, lies.rotate_x_deg).on_bed(part.mesh, ends[front])
        points = pose.apply(
            Mesh(np.array([*names[name].values()]), np.zeros((0, 3), dtype=np.int32))
        ).vertices
        back = np.array((0.0, 0.0 if front else _ROW_MM, 0.0))
        mesh = pose.apply(part.mesh)
        meshes.append(PaintedMesh(Mesh(mesh.vertices + back, mesh.triangles), part.colour))
        labels += [
            Label(text, tuple(point + back))
            for text, point in zip(names[name], points, strict=True)
        ]
        ends[front] += pose.size(part.mesh)[0] + FDM.gap_mm

    return Scene(meshes, Camera.looking_from((-0.35, -1.0, 0.9), (0.0, 0.0, 1.0)), *labels)


def _cup(workbench: Workbench, *, cut: bool = False) -> list[PaintedMesh]:
    return [workbench.part("mold_palmar", cut=cut), workbench.part("mold_dorsal", cut=cut)]


def _banded_cup(workbench: Workbench) -> list[PaintedMesh]:
    """Show the closed cup with its two rubber bands."""
    layout = workbench.design.mold_layout
    height, depth = BELT_MM
    meshes = _cup(workbench)
    x = layout.half_width
    low = -layout.palmar_height
    high = layout.dorsal_height

    for z in layout.belts_z:
        top = z - 0.4 * height
        end = z + 0.4 * height
        inner = Box((depth - x, low + depth, top - 1.0), (x - depth, high - depth, end + 1.0))
        meshes.append(workbench.solid(Box((-x, low, top), (x, high, end)).cut(inner), _BAND))

    return meshes


def _coated(workbench: Workbench) -> Solid:
    """Build a coat on the wall of the cavity, thick enough to be seen."""
    return cavity(workbench.design).cut(cavity(workbench.design, _COAT_MM))


def _stick(workbench: Workbench, at: tuple[float, float], low: float, high: float) -> PaintedMesh:
    return workbench.solid(
        cylinder(
            "z",
            centre=at,
            low=low,
            high=high,
            radius=1.2,
        ),
        _WOOD,
    )


def _lowered(workbench: Workbench, shift: Point3 = (0.0, 0.0, 0.0)) -> list[PaintedMesh]:
    """Show what is lowered into the cup: a core, or the bone in its holder."""
    making = making_of(workbench.design)
    parts = [workbench.part(name, shift) for name in making.lowered]
    return [*parts, workbench.sensor(shift)] if making.is_bonded else parts


def hang(workbench: Workbench, sheet: CastingSheet) -> Scene:
    """Show the bone with its plug below the holder, drawn cut."""
    dims = workbench.dims
    below = (0.0, 0.0, 0.9 * workbench.design.skin.length_mm)
    apart = (0.0, -8.0, below[2])
    top = making_of(workbench.design).top_z(workbench.design)
    y = dims.bone_outline.section.dorsal
    wire = cylinder("z", centre=(0.0, y + 0.8), low=top - 12.0, high=0.0, radius=0.6)

    return Scene(
        (
            workbench.part("holder", cut=True),
            workbench.part("bone", below),
            workbench.sensor(below),
            workbench.part("plug", apart),
            workbench.solid(wire, colours.WIRE),
        ),
        _CUT,
        Label("plug, over the tail", (0.0, -dims.flat_depth - 1.0 + apart[1], below[2])),
        Label("notch in the collar", (0.0, -dims.flat_depth, below[2] - 1.0)),
        Label("post, into the holder\n(drawn cut)", (0.0, 0.0, below[2] + top + 2.0)),
        Label("seat of the collar", (0.0, dims.collar.section.dorsal, -0.5)),
        Label("wires, out at the top", (0.0, y + 0.8, top - 8.0)),
        Label("bolt goes here", (0.0, dims.base_middle_y, Post().cross_bolt_z(workbench.design))),
        Arrow((0.0, 14.0, below[2] + 4.0), (0.0, 14.0, below[2] - 10.0)),
    )


def try_core(workbench: Workbench, sheet: CastingSheet) -> Scene:
    """Show the core or holder seated in the closed cup, and calipers over both."""
    layout = workbench.design.mold_layout
    making = making_of(workbench.design)
    top = making.top_z(workbench.design)
    top_name = "top of the tower" if making.is_bonded else "top of the plate"
    face = making.top_y(workbench.design)[0]
    foot = layout.foot_z
    x = 4.0 - layout.half_width
    low = face + 3.5
    high = face + 6.5
    least, most = sheet.height_mm
    beam = x - 14.0
    reading = f"{least:g} to {most:g} mm"
    calipers = Box((beam - 6.0, low, top - 16.0), (beam, high, foot + 10.0)).union(
        Box((beam - 1.0, low, top - 5.0), (x, high, top)),
        Box((beam - 1.0, low, foot), (x, high, foot + 5.0)),
    )

    return Scene(
        (*_banded_cup(workbench), *_lowered(workbench), workbench.solid(calipers, colours.STEEL)),
        _FROM_BELOW,
        Label(
            f"calipers, from the foot\nto the {top_name}:\n{reading}",
            (beam - 3.0, low, top - 10.0),
        ),
        Label("the same narrow gap\nall around", (-layout.half_width * 0.6, face, GAP_MM / 2)),
        Label("foot", (-layout.half_width * 0.5, face, foot - 0.5)),
        Label(f"{making.hanger}, by its plate", (layout.half_width, face, -PLATE_MM / 2)),
        Label("ridge in its groove,\none of three", (layout.half_width, 0.0, 1.2)),
        Label("two rubber bands", (layout.half_width / 2, face, layout.belts_z[0])),
    )


def varnish(workbench: Workbench, sheet: CastingSheet) -> Scene:
    layout = workbench.design.mold_layout
    depth = layout.palmar_height - workbench.design.mold.wall_mm
    below = Box(
        (-layout.half_width, -2 * layout.palmar_height, 0.5),
        (layout.half_width, -0.1, 2 * layout.foot_z),
    )
    return Scene(
        (
            workbench.part("mold_palmar"),
            workbench.solid(_coated(workbench).intersect(below), _VARNISH),
        ),
        Camera.looking_from((0.35, 1.0, -0.35), _UP),
        Label("varnish on all\nof the hollow", (0.0, -depth, workbench.dims.sensor_z)),
        Label(
            "PAD stands on\nits outer side",
            (-layout.half_width, -layout.palmar_height / 2, layout.foot_z / 2),
        ),
    )


def _legs(workbench: Workbench, y: float) -> Solid:
    end = workbench.dims.tail_end_z
    half = _TAB_PITCH_MM / 2
    length = workbench.design.sensor.tab_length_mm
    return union(
        *(Box((x - 0.3, y, end - length), (x + 0.3, y + 0.4, end + 1.5)) for x in (-half, half))
    )


def solder(workbench: Workbench, sheet: CastingSheet) -> Scene:
    dims = workbench.dims
    thickness = 0.3
    half = _TAB_PITCH_MM / 2
    wire = 0.5
    _, y, z = workbench.head
    end = dims.tail_end_z
    tail = dims.sensor.tail_width_mm / 2
    legs_end = end - workbench.design.sensor.tab_length_mm
    head = cylinder(
        "y",
        centre=(z, 0.0),
        low=y,
        high=y + thickness,
        radius=dims.sensor.head_diameter_mm / 2,
    )
    black, red = (
        cylinder(
            "z",
            centre=(x, y + wire),
            low=legs_end - 16.0,
            high=legs_end + 2.5,
            radius=wire,
        )
        for x in (-half, half)
    )
    lengths, heads = (
        " to ".join(f"{size:g}" for size in sizes) for sizes in (sheet.length_mm, sheet.head_mm)
    )

    return Scene(
        (
            workbench.solid(
                head.union(Box((-tail, y, end), (tail, y + thickness, z))), colours.SENSOR
            ),
            workbench.solid(_legs(workbench, y), colours.STEEL),
            workbench.solid(red, colours.WIRE),
            workbench.solid(black, _BLACK),
        ),
        Camera.from_angles(20, 55),
        Label(f"head:\n{heads} mm", (0.0, y, z)),
        Label(f"film, head and tail:\n{lengths} mm", (0.0, y, (z + end) / 2)),
        Label("wire, straight on", (half, y, legs_end - 12.0)),
        Label("solder here,\non the metal leg", (-half, y, legs_end + 3.0)),
    )


def lay_in(workbench: Workbench, sheet: CastingSheet) -> Scene:
    """Show the knot over its hole, and the sensor as far from its bed as the wires let it."""
    x, y, z = workbench.head
    half = _TAB_PITCH_MM / 2
    back = workbench.dims.pocket_depth
    dims = workbench.dims
    radius = KNOT_WIRES * workbench.design.sensor.wire_diameter_mm / 2
    knot_y = back - dims.flat_depth - radius
    knot_z = dims.channel_exit_z + radius
    low = (
        0.0,
        knot_y - sheet.knot_mm - back,
        knot_z - dims.tail_end_z + workbench.design.sensor.tab_length_mm,
    )
    red, black = (
        cylinder(
            "y",
            centre=(knot_z, side),
            low=knot_y - sheet.knot_mm,
            high=knot_y,
            radius=0.5,
        )
        for side in (-half, half)
    )
    knot = red.union(
        cylinder(
            "x",
            centre=(knot_y, knot_z),
            low=-radius,
            high=radius,
            radius=radius,
        )
    )

    return Scene(
        (
            workbench.part("bone"),
            workbench.sensor(low),
            workbench.solid(_legs(workbench, back), colours.STEEL, low),
            workbench.solid(knot, colours.WIRE),
            workbench.solid(black, _BLACK),
        ),
        _FROM_PALM,
        Label("legs apart, each\nwith either wire", (half, knot_y - sheet.knot_mm, knot_z + 2.0)),
        Label("sensor, paper peeled\noff its other side", (x, y + low[1], z + low[2])),
        Label("round bed", (x, y, z + dims.sensor.head_diameter_mm / 2)),
        Label("trough", (0.0, y + 1.0, dims.tail_end_z / 2)),
        Label("knot in both wires,\nover their hole\nto the back", (0.0, knot_y, knot_z)),
        Arrow((x, y + 0.85 * low[1], z + 0.85 * low[2]), (x, y + 0.2 * low[1], z + 0.2 * low[2])),
    )


def mix(workbench: Workbench, sheet: CastingSheet) -> Scene:
    first, second = sheet.batch.components
    batch = sheet.batch
    level = 1000.0 * batch.total_g / batch.density_g_cm3 / (math.pi * CUP_RADIUS_MM**2)
    first_level = batch.a_g / batch.total_g * level
    scale = Box((-40.0, -35.0, -10.0), (40.0, 35.0, 0.0))
    added = workbench.solid(
        cylinder(
            "z",
            centre=(0.0, 0.0),
            low=first_level,
            high=level,
            radius=CUP_RADIUS_MM - 0.5,
        ),
        colours.PAPER,
    )

    return Scene(
        (
            *workbench.mixing_cup(first_level),
            added,
            workbench.solid(scale, colours.STEEL),
            _stick(workbench, (8.0, 10.0), 2.0, 90.0),
        ),
        Camera.looking_from((0.15, -1.0, 0.22), (0.0, 0.0, 1.0)),
        Label(
            f"then {batch.b_g:g} g of {second}:\n{batch.total_g:g} g in all",
            (CUP_RADIUS_MM - 0.5, 0.0, level),
        ),
        Label(
            f"first {batch.a_g:g} g of {first}",
            (-CUP_RADIUS_MM / 2, 1.0 - CUP_RADIUS_MM, first_level / 2),
        ),
        Label("scale, set to zero\nwith the empty cup", (40.0, -35.0, -5.0)),
        Label("stir for three minutes", (8.0, 10.0, 60.0)),
    )


def coat(workbench: Workbench, sheet: CastingSheet) -> Scene:
    layout = workbench.design.mold_layout
    bone = workbench.design.bone
    wall = workbench.design.mold.wall_mm
    lift = _LIFT_MM + layout.foot_z
    is_bonded = making_of(workbench.design).is_bonded
    _, y, z = workbench.head
    waist = workbench.dims.bone_outline.section.half_width
    groove = (
        bone.groove_depth_mm - waist,
        1.0,
        bone.groove_distance_mm + bone.groove_width_mm / 2 - lift,
    )

    return Scene(
        (
            *_cup(workbench, cut=True),
            workbench.solid(_coated(workbench), colours.SILICONE, cut=True),
            *_lowered(workbench, (0.0, 0.0, -lift)),
            _stick(workbench, (0.5, 3.0), -24.0, layout.foot_z - wall - 2.0),
        ),
        Camera.looking_from((-1.0, -0.5, 0.12), _UP),
        Label(
            "thin coat on all of the\nhollow (cup drawn cut)", (0.0, wall - layout.palmar_height, z)
        ),
        Label("second stick", (0.5, 3.0, -20.0)),
        Label("sensor: coat it" if is_bonded else "round dent: coat it", (0.0, y, z - lift)),
        Label("ring groove: coat it", groove),
        Label("foot", (0.0, layout.dorsal_height / 2, layout.foot_z)),
    )


def pour(workbench: Workbench, sheet: CastingSheet) -> Scene:
    layout = workbench.design.mold_layout
    y = workbench.dims.outer.section.dorsal - 1.0
    z = layout.pour_z * workbench.dims.shrinkage
    far = 2 * layout.foot_z
    silicone = cavity(workbench.design).intersect(Box((-far, -far, z), (far, far, far)))
    stream = workbench.solid(
        cylinder(
            "z",
            centre=(0.5, y),
            low=-35.0,
            high=z + 0.5,
            radius=0.8,
        ),
        colours.SILICONE,
    )

    return Scene(
        (*_cup(workbench, cut=True), workbench.solid(silicone, colours.SILICONE, cut=True), stream),
        _CUT,
        Label("thin stream, down the\nhalf without PAD", (0.5, y, -25.0)),
        Label(f"until the scale reads\n{sheet.batch.in_cup_g:g} g more", (0.0, 0.0, z)),
        Label("half marked PAD\n(cup drawn cut)", (0.0, -layout.palmar_height, layout.foot_z / 2)),
    )


def lower(workbench: Workbench, sheet: CastingSheet) -> Scene:
    """Show what is seated under a third rubber band, and the silicone that comes out."""
    layout = workbench.design.mold_layout
    y = STRAP_Y_MM
    side = 0.4 * BELT_MM[0]
    depth = BELT_MM[1]
    x = layout.half_width + PLATE_LEDGE_MM - depth
    making = making_of(workbench.design)
    held = "tower" if making.is_bonded else "plate"
    top = making.top_z(workbench.design)
    foot = layout.foot_z - depth
    face = -layout.palmar_height
    band = _around(workbench, x, foot, _BAND_MM, side).cut(
        _around(workbench, x, foot, 0.0, 2 * side)
    )
    places = [
        (across, out)
        for across in (-layout.notch_x, layout.notch_x)
        for out in (face - 0.4, layout.dorsal_height + 0.4)
    ]
    drops = union(
        *(
            cylinder(
                "z",
                centre=place,
                low=GAP_MM,
                high=GAP_MM + 3.5,
                radius=1.1,
            )
            for place in places
        )
    )
    meshes = (
        *_lowered(workbench),
        workbench.solid(drops, colours.SILICONE),
        workbench.solid(band, _BAND),
    )

    return Scene(
        (*_banded_cup(workbench), *meshes),
        _FROM_BELOW,
        Label("silicone comes out\nof all four notches", (layout.notch_x, face, GAP_MM + 1.0)),
        Label("hold it here,\nat both ends", (x + depth, face / 2, -PLATE_MM / 2)),
        Label(f"third band, around\n{held} and foot", (-x / 2, y, foot + _BAND_MM)),
        Label("ridge in its groove,\nthree times", (layout.half_width, 0.0, 1.2)),
        Arrow((-8.0, -4.0, top - 18.0), (-8.0, -4.0, top - 3.0)),
    )


def _around(workbench: Workbench, x: float, foot: float, further_mm: float, side: float) -> Solid:
    """Build what a band around the seats of the lips, the top and the foot encloses, larger on all
    sides.
    """
    making = making_of(workbench.design)
    top = making.top_z(workbench.design)
    at_top = tower_sides(workbench.design)[0][1] if making.is_bonded else x
    right = (
        (foot + further_mm, x + further_mm),
        (-PLATE_MM, x + further_mm),
        (top - further_mm, at_top + further_mm),
    )
    left = [(z, -across) for z, across in reversed(right)]
    ring = [*right, *left] if top < -PLATE_MM else [right[0], right[2], left[0], left[2]]

    return extrude("y", ring, STRAP_Y_MM - side, STRAP_Y_MM + side)


def open_cup(workbench: Workbench, sheet: CastingSheet) -> Scene:
    making = making_of(workbench.design)
    top = making.top_z(workbench.design)
    layout = workbench.design.mold_layout
    apart = 16.0
    lifted = (0.0, 0.0, -6.0)
    low = -layout.palmar_height - apart
    edge = layout.foot_z + 3.0
    tip = layout.foot_z - workbench.design.mold.wall_mm
    seam = Box((-edge, -0.15, 2.0), (edge, 0.15, edge))
    hollow = cavity(workbench.design)
    fins = hollow.scaled(1.06).intersect(seam).cut(hollow)

    return Scene(
        (
            workbench.part("mold_palmar", (0.0, -apart, 0.0)),
            workbench.part("mold_dorsal", (0.0, apart / 2, 0.0)),
            *_lowered(workbench, lifted),
            workbench.part("skin", lifted),
            workbench.solid(fins, colours.SILICONE, lifted),
        ),
        Camera.looking_from((1.0, -0.4, -0.25), _UP),
        Label(f"skin, still on the {making.lowered[0]}", (0.0, -2.0, tip - 7.0)),
        Label("fin: cut it off", (layout.cavity_half_width + 0.4, 0.0, tip / 2 - 6.0)),
        Label(
            "1: half marked PAD,\nstraight off", (layout.half_width, low + 5.0, layout.foot_z / 2)
        ),
        Label("slot for the knife", (layout.half_width, -apart - 0.6, layout.foot_z - 3.0)),
        Label(
            f"2: lift the {making.hanger}\nout of the groove",
            (layout.half_width, layout.dorsal_height, -PLATE_MM / 2 - 6.0),
        ),
        Arrow((0.0, low + 4.0, edge), (0.0, low - 10.0, edge)),
        Arrow((0.0, 0.0, top - 8.0), (0.0, 0.0, top - 18.0)),
    )


def pull_on(workbench: Workbench, sheet: CastingSheet) -> Scene:
    dims = workbench.dims
    bone = workbench.design.bone
    _, y, z = workbench.head
    out = workbench.design.skin.length_mm * 1.15
    groove = bone.groove_distance_mm + bone.groove_width_mm / 2
    fold = groove + 2.5
    dorsal = dims.outer.section.dorsal
    section = dims.bone_outline.section
    rib = 0.0, 2.0 * dorsal - section.dorsal, out + 2.0 * fold - groove

    return Scene(
        (*workbench.assembled_bone(), *workbench.turned_up_skin(out + fold, out)),
        cameras.CUT_FROM_BELOW,
        Label("edge turned up\n(skin drawn cut)", (0.0, dorsal, out + fold)),
        Label("inner rib, comes to lie\nin the ring groove", rib),
        Label("bump, comes to lie\non the sensor's head", (0.0, y, out + z)),
        Label("ring groove", (bone.groove_depth_mm - section.half_width, 1.0, groove)),
        Label(
            "step, where the\nedge of the skin ends", (-dims.collar.section.half_width, 0.0, 0.0)
        ),
        Label("keep the sensor dry", (0.0, y, z - 5.0)),
        Arrow((0.0, 15.0, out + 4.0), (0.0, 15.0, out - 12.0)),
    )


def connect(workbench: Workbench, sheet: CastingSheet) -> Scene:
    """Show the finger as it is held, pad up, with its wires, which come out of the back."""
    z = workbench.dims.channel_exit_z
    dims = workbench.dims
    kohm = sheet.divider_kohm
    y = dims.bone_outline.section.dorsal
    far = dims.collar.section.half_width + 16.0
    red, black = (
        cylinder(
            "x",
            centre=(y, z + beside),
            low=0.0,
            high=far + 4.0 * beside,
            radius=0.6,
        )
        for beside in (1.2, -1.2)
    )
    black_to = f"black wire to A0 (GP26,\npin 31), {kohm or 0:g} kohm from\nthere to GND (pin 33)"
    mount, labels = _show_mount(workbench, sheet)
    finger = workbench.assembled_bone()
    pressed = workbench.head

    if making_of(workbench.design).is_bonded:
        finger = [workbench.part(name) for name in ("bone", "plug", "skin")]
        pressed = (0.0, -workbench.design.skin.semi_axis_palmar_mm, dims.sensor_z)

    return Scene(
        (
            *finger,
            *mount,
            workbench.solid(red, colours.WIRE),
            workbench.solid(black, _BLACK),
        ),
        Camera.from_angles(18, -55),
        Label(
            "red wire to 3V3 (Pico:\nADC_VREF, pin 35)" if kohm else "to the board",
            (far + 4.0, y, z + 1.2),
        ),
        *([Label(black_to, (far - 6.0, y, z - 1.2))] if kohm else []),
        *labels,
        Label("press here, to try it", pressed),
    )


def _show_mount(workbench: Workbench, sheet: CastingSheet) -> tuple[list[PaintedMesh], list[Label]]:
    """Show what holds the bone: a stand, or a plain part of the hand; nothing yet of a joint."""
    design = workbench.design
    bone = design.bone
    y = workbench.dims.base_middle_y
    end = -bone.base_length_mm
    half = workbench.dims.bone_outline.section.half_width

    match sheet.mount.interface:
        case "post":
            z = Post().cross_bolt_z(design)
            holder = workbench.part("stand")
            text = "stand, on the table"
            at = (0.0, y, end - bone.post_length_mm - 20.0)
            half = bone.post_width_mm / 2
        case "socket":
            z = Socket().cross_bolt_z(design)
            post = (end - 25.0, end + 6.0, sheet.mount.post_mm[0] / 2)
            holder = workbench.solid(cylinder("z", (0.0, y), *post), colours.PAPER)
            text = "post of your hand"
            at = (0.0, y, end - 20.0)
        case "flange":
            half = bone.flange_width_mm / 2
            deep = bone.flange_height_mm / 2
            low = end - 8.0
            top = end + 7.0
            x = bone.flange_spacing_x_mm / 2
            row = y - bone.flange_spacing_y_mm / 2
            heads = union(
                *(
                    cylinder(
                        "z",
                        centre=(side, row),
                        low=low,
                        high=top,
                        radius=2.5,
                    )
                    for side in (-x, x)
                )
            )
            plate = workbench.solid(
                Box((-half, y - deep, low), (half, y + deep, end)), colours.PAPER
            )
            labels = [Label("your hand", (0.0, y, low + 2.0)), Label("bolt", (-x, row, top))]
            return [plate, workbench.solid(heads, colours.STEEL)], labels
        case _:
            return [], []

    bolt = workbench.solid(
        cylinder(
            "x",
            centre=(y, z),
            low=-half - 6.0,
            high=half + 6.0,
            radius=1.5,
        ),
        colours.STEEL,
    )
    return [holder, bolt], [Label("bolt with nut", (-half - 5.0, y, z)), Label(text, at)]


SCENES: dict[str, Callable[[Workbench, CastingSheet], Scene]] = {
    "print": print_parts,
    "varnish": varnish,
    "solder": solder,
    "lay_in": lay_in,
    "hang": hang,
    "try_core": try_core,
    "mix": mix,
    "coat": coat,
    "pour": pour,
    "lower": lower,
    "open": open_cup,
    "connect": connect,
    "pull_on": pull_on,
    **JOINT_SCENES,
}
"""Scenes by the names of their steps."""


def draw_steps(
    design: Design,
    sheet: CastingSheet,
    names: Sequence[str],
    progress: Callable[[str], None] = lambda message: None,
) -> dict[str, bytes]:
    workbench = Workbench(design)
    pictures = dict[str, bytes]()
    work = Work("", {"pictures of the steps": 1.0}, progress)
    work.begin("pictures of the steps")

    for number, name in enumerate(names, 1):
        work.advance((number - 1) / len(names))
        pictures[f"{number:02}-{name}.png"] = draw_scene(SCENES[name](workbench, sheet))

    return pictures


_EDGE_PX = 4
"""Distance of the finished finger from the edge of its picture."""


def draw_finger(design: Design, width_px: int = 640) -> bytes:
    """Draw the finished finger from the back and below from the palm, on a clear ground."""
    workbench = Workbench(design)
    meshes = [*workbench.assembled_bone(), workbench.part("skin")]
    views = []

    for camera in (cameras.DORSAL, cameras.PALMAR):
        centre, size = bounds([item.mesh for item in meshes], camera)
        scale = (width_px - 2 * _EDGE_PX) / float(size[0])
        canvas = Canvas(width_px, int(size[1] * scale) + 2 * _EDGE_PX, scale, camera)
        for item in meshes:
            canvas.draw(item.mesh, item.colour, centre)

        views.append(np.dstack([canvas.image(), canvas.cover()]))

    return to_png(Image.fromarray(np.concatenate(views)))
