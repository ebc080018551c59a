"""Scenes of a joint: the finished finger on the stub of a hand, with its pin, its tendon and its rubber band."""

from __future__ import annotations

import math

import numpy as np

from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.shapes.bench import BAR_MM
from fingertip.cad.shapes.parts import PARTS
from fingertip.casting.sheet import CastingSheet
from fingertip.design.geometry.joint import Joint, TendonAnchor
from fingertip.design.geometry.solids import Box, cylinder, difference, union
from fingertip.pictures.raster import Camera
from fingertip.pictures.scene import Arrow, Bench, Label, Scene, Shown

_FROM_BACK, _FROM_PALM = Camera.from_angles(28, 30), Camera.from_angles(28, -35)
_LINE, _BAND = (0.20, 0.30, 0.65), (0.75, 0.35, 0.30)
_APART_MM, _BAND_MM = 18.0, 2.0
"""Distance of the stub from the finger before it is pinned, and width of the band [mm]."""


def _joint(bench: Bench) -> Joint:
    assert bench.dims.joint, "only a clevis has these steps"
    return bench.dims.joint


def _anchor(bench: Bench) -> TendonAnchor:
    assert bench.dims.anchor, "only a tendon has these steps"
    return bench.dims.anchor


def _finger(bench: Bench, *, bent_deg: float = 0.0) -> list[Shown]:
    """Show the finished finger, turned about the pin towards the palm."""
    joint, turn = _joint(bench), math.radians(bent_deg)
    middle = np.array((0.0, joint.axis_y, joint.axis_z))
    rows = ((1.0, 0.0, 0.0), (0.0, math.cos(turn), -math.sin(turn)), (0.0, math.sin(turn), math.cos(turn)))
    parts = (*bench.assembled_bone(), bench.part("skin"))
    return [
        Shown(Mesh((p.mesh.vertices - middle) @ np.array(rows).T + middle, p.mesh.triangles), p.colour) for p in parts
    ]


def _pin(bench: Bench, out_mm: float = 0.0) -> Shown:
    joint, half = _joint(bench), bench.dims.pin_length / 2
    shaft = cylinder("x", (joint.axis_y, joint.axis_z), -half, half, joint.pin_radius)
    return bench.solid(shaft, PARTS["pin"].colour, (-out_mm, 0.0, 0.0))


def _end_z(bench: Bench) -> float:
    return _joint(bench).low_z - BAR_MM


def _tendon(bench: Bench) -> Shown:
    """Show the tendon: across the back, down both sides, and along both palmar corners past the end of the stub."""
    anchor, back, radius = _anchor(bench), bench.dims.bone_outline.section.dorsal, _anchor(bench).line / 2
    lines = [cylinder("x", (back, anchor.z), -anchor.strand_x, anchor.strand_x, radius)]
    for x in (-anchor.strand_x, anchor.strand_x):
        lines.append(cylinder("y", (anchor.z, x), anchor.y, back, radius))
        lines.append(cylinder("z", (x, anchor.y), _end_z(bench) - 8.0, anchor.z, radius))
    return bench.solid(union(*lines), _LINE)


def _band(bench: Bench, notch_mm: float) -> Shown:
    """Show the band from the tendon at the bone's back along the stub to a pair of notches."""
    back, half, low = bench.dims.bone_outline.section.dorsal + 1.0, 3.0, _joint(bench).low_z - notch_mm
    high, into = _anchor(bench).z + 1.0, _BAND_MM
    outer = Box((-half - 1.0, back, low), (half + 1.0, back + into, high))
    return bench.solid(
        difference(outer, Box((-half, back - 1.0, low + 1.0), (half, back + into + 1.0, high - 1.0))), _BAND
    )


def pin(bench: Bench, sheet: CastingSheet) -> Scene:
    joint, half, back = _joint(bench), bench.dims.pin_length / 2, bench.dims.bone_outline.section.dorsal
    out = 2 * half + 10.0
    return Scene(
        (*_finger(bench), bench.part("hand_stub", (0.0, 0.0, -_APART_MM)), _pin(bench, out)), _FROM_BACK,
        Label("pin", (-half - out, joint.axis_y, joint.axis_z)),
        Label("stub", (0.0, back, joint.low_z - _APART_MM - 20.0)),
        Label("wires (not drawn) leave\nhere, in a loose loop", (0.0, back, bench.dims.channel_exit_z)),
        Arrow((-half - 0.8 * out, joint.axis_y + 4.0, joint.axis_z), (-half - 2.0, joint.axis_y + 4.0, joint.axis_z)),
        Arrow((0.0, joint.axis_y + 9.0, joint.low_z - _APART_MM), (0.0, joint.axis_y + 9.0, joint.low_z - 3.0)),
    )  # fmt: skip


def tendon(bench: Bench, sheet: CastingSheet) -> Scene:
    anchor, back = _anchor(bench), bench.dims.bone_outline.section.dorsal
    x = anchor.strand_x
    return Scene(
        (*_finger(bench), bench.part("hand_stub"), _pin(bench), _tendon(bench), _band(bench, 8.0)), _FROM_BACK,
        Label("tendon in its groove,\nthrough the band", (0.0, back, anchor.z)),
        Label("down the side, around\nthe round shoulder", (-x, (back + anchor.y) / 2, anchor.z)),
        Label("through the hole\nof the stub", (-x, anchor.y, _joint(bench).low_z)),
        Label("out along the slot", (-x, anchor.y, _end_z(bench) - 5.0)),
    )  # fmt: skip


def band(bench: Bench, sheet: CastingSheet) -> Scene:
    back = bench.dims.bone_outline.section.dorsal
    return Scene(
        (*_finger(bench), bench.part("hand_stub"), _pin(bench), _tendon(bench), _band(bench, 28.0)), _FROM_BACK,
        Label("band, over the back\nof the joint", (0.0, back + _BAND_MM, _joint(bench).axis_z)),
        Label("around the stub, in a\npair of notches", (0.0, back, _joint(bench).low_z - 28.0)),
        Arrow((0.0, back + 8.0, _joint(bench).axis_z), (0.0, back + 8.0, _joint(bench).axis_z - 18.0)),
    )  # fmt: skip


def zero(bench: Bench, sheet: CastingSheet) -> Scene:
    x, y, end = _anchor(bench).strand_x, _anchor(bench).y, _end_z(bench) - 8.0
    knot = bench.solid(union(cylinder("x", (y, end), -x, x, 0.5), cylinder("x", (y, end), -1.5, 1.5, 1.5)), _LINE)
    return Scene(
        (*_finger(bench), bench.part("hand_stub"), _pin(bench), _tendon(bench), knot), _FROM_PALM,
        Label("held straight", bench.head),
        Label("knot close behind the stub", (0.0, y, end)),
        Label(f"pull here, with at most\n{sheet.mount.pull_n:g} N", (0.0, y, end - 1.0)),
        Arrow((0.0, y, end - 3.0), (0.0, y, end - 14.0)),
    )  # fmt: skip


def travel(bench: Bench, sheet: CastingSheet) -> Scene:
    joint, end, shown = _joint(bench), _end_z(bench), _finger(bench, bent_deg=sheet.mount.travel_deg)
    bent = f"bent by {sheet.mount.travel_deg:g} degrees:\nmust stop here"
    return Scene(
        (*shown, bench.part("hand_stub"), _pin(bench)), Camera.from_angles(0, 0),
        Label(bent, (0.0, joint.axis_y - joint.radius, joint.low_z)),
        Label("comes back by\nits band (not drawn)", (0.0, joint.axis_y + joint.radius, joint.axis_z)),
        Arrow((0.0, joint.axis_y - joint.radius, end - 2.0), (0.0, joint.axis_y - joint.radius, end - 14.0)),
    )  # fmt: skip


JOINT_SCENES = {"pin": pin, "tendon": tendon, "band": band, "zero": zero, "travel": travel}
"""Scenes of the steps of a joint by the names of these steps."""
