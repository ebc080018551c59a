"""Scenes of a joint: the finger on the stub of a hand, with pin, tendon and rubber band."""

from __future__ import annotations

import math

import numpy as np

from fingertip.cad.kernel.mesh import Mesh
from fingertip.casting.sheet import CastingSheet
from fingertip.models.hand_stub import BAND_NOTCH_MM, BAR_MM, NOTCH_DEPTH_MM, NOTCHES_MM, bars
from fingertip.models.joint import Joint, TendonAnchor
from fingertip.models.parts import PARTS
from fingertip.models.solids import Box, Prism, cylinder
from fingertip.pictures.labelled_scene import Arrow, Label, PaintedMesh, Scene
from fingertip.pictures.raster import Camera
from fingertip.pictures.workbench import Workbench

_FROM_BACK = Camera.from_angles(28, 30)
_FROM_PALM = Camera.from_angles(28, -35)
_LINE = (0.20, 0.30, 0.65)
_BAND = (0.75, 0.35, 0.30)
_APART_MM = 18.0
_BAND_MM = 2.0
"""Distance of the stub from the finger before it is pinned, and width of the band [mm]."""


def _joint(workbench: Workbench) -> Joint:
    assert workbench.dims.joint, "only a clevis has these steps"
    return workbench.dims.joint


def _anchor(workbench: Workbench) -> TendonAnchor:
    assert workbench.dims.anchor, "only a tendon has these steps"
    return workbench.dims.anchor


def _finger(workbench: Workbench, *, bent_deg: float = 0.0) -> list[PaintedMesh]:
    """Show the finished finger, turned about the pin towards the palm."""
    joint = _joint(workbench)
    turn = math.radians(bent_deg)
    middle = np.array((0.0, joint.axis_y, joint.axis_z))
    rotation = np.array(
        (
            (1.0, 0.0, 0.0),
            (0.0, math.cos(turn), -math.sin(turn)),
            (0.0, math.sin(turn), math.cos(turn)),
        )
    )
    parts = (*workbench.assembled_bone(), workbench.part("skin"))

    return [
        PaintedMesh(
            Mesh((part.mesh.vertices - middle) @ rotation.T + middle, part.mesh.triangles),
            part.colour,
        )
        for part in parts
    ]


def _pin(workbench: Workbench, out_mm: float = 0.0) -> PaintedMesh:
    joint = _joint(workbench)
    half = workbench.dims.pin_length / 2
    shaft = cylinder(
        "x",
        centre=(joint.axis_y, joint.axis_z),
        low=-half,
        high=half,
        radius=joint.pin_radius,
    )
    return workbench.solid(shaft, PARTS["pin"].colour, (-out_mm, 0.0, 0.0))


def _end_z(workbench: Workbench) -> float:
    return _joint(workbench).low_z - BAR_MM


def _pull(workbench: Workbench) -> tuple[list[PaintedMesh], list[Label | Arrow]]:
    """Show the loop of the tendon behind the stub, and the pull at it."""
    x = _anchor(workbench).strand_x
    y = _anchor(workbench).y
    end = _end_z(workbench) - 8.0
    strands = (
        cylinder(
            "z",
            centre=(side, y),
            low=end,
            high=end + 8.0,
            radius=0.5,
        )
        for side in (-x, x)
    )
    knot = cylinder(
        "x",
        centre=(y, end),
        low=-x,
        high=x,
        radius=0.5,
    ).union(
        cylinder(
            "x",
            centre=(y, end),
            low=-1.5,
            high=1.5,
            radius=1.5,
        ),
        *strands,
    )
    label = Label("knot close behind\nthe stub: pull here", (0.0, y, end))

    return [workbench.solid(knot, _LINE)], [
        label,
        Arrow((0.0, y - 3.0, end), (0.0, y - 3.0, end - 12.0)),
    ]


def _tendon(workbench: Workbench) -> PaintedMesh:
    """Show the tendon: across the back, down both sides, and along both palmar corners."""
    anchor = _anchor(workbench)
    back = workbench.dims.bone_outline.section.dorsal
    radius = _anchor(workbench).line / 2
    across = anchor.strand_x
    sides = (-anchor.strand_x, anchor.strand_x)
    down = (
        cylinder(
            "y",
            centre=(anchor.z, x),
            low=anchor.y,
            high=back,
            radius=radius,
        )
        for x in sides
    )
    along = (
        cylinder(
            "z",
            centre=(x, anchor.y),
            low=_end_z(workbench) - 8.0,
            high=anchor.z,
            radius=radius,
        )
        for x in sides
    )

    return workbench.solid(
        cylinder(
            "x",
            centre=(back, anchor.z),
            low=-across,
            high=across,
            radius=radius,
        ).union(*down, *along),
        _LINE,
    )


def _band(workbench: Workbench, end_z: float, end_half: float) -> Prism:
    """Build the band from the tendon over the back to a height where it is so wide."""
    low = bars(workbench.design)[1].high[1]
    begin = _anchor(workbench).z + 1.0
    half = 4.0
    side = 1.0
    outer = (end_z, -end_half), (begin, -half), (begin, half), (end_z, end_half)
    z = end_z + side
    top = begin - side
    x = end_half - side
    y = half - side

    return Prism(
        axis="y",
        corners=outer,
        low=low,
        high=low + _BAND_MM,
        holes=(((z, x), (top, y), (top, -y), (z, -x)),),
    )


def pin(workbench: Workbench, sheet: CastingSheet) -> Scene:
    joint = _joint(workbench)
    half = workbench.dims.pin_length / 2
    back = workbench.dims.bone_outline.section.dorsal
    out = 2 * half + 10.0

    return Scene(
        (
            *_finger(workbench),
            workbench.part("hand_stub", (0.0, 0.0, -_APART_MM)),
            _pin(workbench, out),
        ),
        _FROM_BACK,
        Label("pin", (-half - out, joint.axis_y, joint.axis_z)),
        Label("stub", (0.0, back, joint.low_z - _APART_MM - 20.0)),
        Label(
            "wires (not drawn) leave\nhere, in a loose loop",
            (0.0, back, workbench.dims.channel_exit_z),
        ),
        Arrow(
            (-half - 0.8 * out, joint.axis_y + 4.0, joint.axis_z),
            (-half - 2.0, joint.axis_y + 4.0, joint.axis_z),
        ),
        Arrow(
            (0.0, joint.axis_y + 9.0, joint.low_z - _APART_MM),
            (0.0, joint.axis_y + 9.0, joint.low_z - 3.0),
        ),
    )


def tendon(workbench: Workbench, sheet: CastingSheet) -> Scene:
    anchor = _anchor(workbench)
    back = workbench.dims.bone_outline.section.dorsal
    x = anchor.strand_x
    loose = workbench.solid(_band(workbench, _joint(workbench).low_z - 8.0, 4.0), _BAND)

    return Scene(
        (
            *_finger(workbench),
            workbench.part("hand_stub"),
            _pin(workbench),
            _tendon(workbench),
            loose,
        ),
        _FROM_BACK,
        Label("tendon in its groove,\nthrough the band", (-0.8 * x, back, anchor.z)),
        Label("down the side, around\nthe round shoulder", (-x, (back + anchor.y) / 2, anchor.z)),
        Label("through the hole\nof the stub", (-x, anchor.y, _joint(workbench).low_z)),
        Label("out along the slot", (-x, anchor.y, _end_z(workbench) - 5.0)),
    )


def band(workbench: Workbench, sheet: CastingSheet) -> Scene:
    half, back, _ = bars(workbench.design)[1].high
    low = bars(workbench.design)[1].low[1]
    z = _joint(workbench).low_z - NOTCHES_MM[0] - BAND_NOTCH_MM / 2
    begin = _anchor(workbench).z
    into = half - NOTCH_DEPTH_MM
    around = Box((-half - 0.5, low - 1.0, z - 1.0), (half + 0.5, back + _BAND_MM, z + 1.0))
    within = Box((-into, low, z - 2.0), (into, back + 2 * _BAND_MM, z + 2.0))
    stretched = workbench.solid(_band(workbench, z - 1.0, half).union(around.cut(within)), _BAND)

    return Scene(
        (
            *_finger(workbench),
            workbench.part("hand_stub"),
            _pin(workbench),
            _tendon(workbench),
            stretched,
        ),
        _FROM_BACK,
        Label(
            "band, over the back\nof the joint",
            (-0.5 * half - 1.0, back + _BAND_MM, (begin + z) / 2),
        ),
        Label("around the stub, in a\npair of notches", (-half - 0.5, 0.0, z)),
        Arrow((0.0, back + 8.0, begin - 10.0), (0.0, back + 8.0, begin - 28.0)),
    )


def zero(workbench: Workbench, sheet: CastingSheet) -> Scene:
    knot, pull = _pull(workbench)
    meshes = (
        *_finger(workbench),
        workbench.part("hand_stub"),
        _pin(workbench),
        _tendon(workbench),
        *knot,
    )
    return Scene(meshes, _FROM_PALM, Label("held straight", workbench.head), *pull)


def travel(workbench: Workbench, sheet: CastingSheet) -> Scene:
    joint = _joint(workbench)
    knot, pull = _pull(workbench) if workbench.dims.anchor else ([], [])
    meshes = (
        *_finger(workbench, bent_deg=sheet.mount.travel_deg),
        workbench.part("hand_stub"),
        _pin(workbench),
        *knot,
    )
    stop = "must stop here" if sheet.mount.travel_deg else "must turn freely"

    return Scene(
        meshes, Camera.from_angles(0, 0), Label(stop, (0.0, joint.axis_y - 1.0, joint.low_z)), *pull
    )


JOINT_SCENES = {
    "pin": pin,
    "tendon": tendon,
    "band": band,
    "zero": zero,
    "travel": travel,
}
"""Scenes of the steps of a joint by the names of these steps."""
