"""Orientation of each printed part on the build plate, and the places for its supports."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.printing.overhang import MAX_BRIDGE_MM, bed_pose
from fingertip.design import Design
from fingertip.design.interfaces import interface_of
from fingertip.models import bone as bone_model
from fingertip.models import sensor_pocket
from fingertip.models.parts import PARTS, print_scale
from fingertip.models.solids import Box, Solid
from fingertip.models.stand import socket_ceiling_mm


@dataclass(frozen=True)
class Orientation:
    rotate_x_deg: float
    """Rotation about the x axis of the part's file [degrees]."""
    face_on_plate: str


def print_orientations(design: Design) -> dict[str, Orientation]:
    """Choose the orientation of each printed part, such that no support touches a surface for
    silicone or sensor.

    The halves of the cup stand on their foot, the core on its plate. The bone stands upright: its
    palmar flat is then a wall, on which no layer ends.
    """
    standing = Orientation(180.0, "the foot, rim up")
    orientations = {
        "bone": Orientation(0.0, interface_of(design).face_on_plate),
        "mold_palmar": standing,
        "mold_dorsal": standing,
    }
    if PARTS["core"].exists_in(design):
        orientations["core"] = Orientation(0.0, "the plate, with its name")
    else:
        orientations["holder"] = Orientation(0.0, "the end of its tower, ridges up")
        orientations["plug"] = Orientation(0.0, "its end, away from the tip")

    if PARTS["stand"].exists_in(design):
        lies = print_scale(design, PARTS["stand"]) * socket_ceiling_mm(design) <= MAX_BRIDGE_MM
        orientations["stand"] = (
            Orientation(-90.0, "a flat side") if lies else Orientation(0.0, "the end of its handle")
        )

    if PARTS["pin"].exists_in(design):
        orientations["pin"] = Orientation(0.0, "one end")
    if PARTS["hand_stub"].exists_in(design):
        orientations["hand_stub"] = Orientation(-90.0, "its back, the tendon's slots up")

    return orientations


def build_volume_excess(design: Design, mesh: Mesh, rotate_x_deg: float = 0.0) -> float:
    """Measure how far a part, turned on the bed or not, exceeds the build volume [mm].

    It is negative if the part fits.
    """
    printer = design.printer
    x, y, height = bed_pose(mesh, rotate_x_deg).size(mesh)
    bed = sorted((printer.bed_x_mm, printer.bed_y_mm))
    excess = [size - limit for size, limit in zip(sorted((x, y)), bed, strict=True)]

    return max(*excess, height - printer.bed_z_mm)


@dataclass(frozen=True)
class Supports:
    places: tuple[Solid, ...]
    """Regions of air in which they may stand, in the part's own coordinates.
    None for a part without supports.
    """
    may_stand: str
    """Places in words."""
    none_on: str
    """Surfaces that none may touch, in words."""

    @property
    def note(self) -> str:
        return f"Supports: {self.may_stand}. None on: {self.none_on}."


_NONE = Supports((), "nowhere: nothing overhangs", "any face")


def supports_by_part(design: Design) -> dict[str, Supports]:
    orientations = print_orientations(design)
    every = dict.fromkeys(orientations, _NONE)
    if design.dimensions.prints_without_supports:
        return every

    # Those of the bone: proximal to the skin, on the outside.
    interface = interface_of(design)
    under = interface.supports_below + interface.supports_inside
    section = design.dimensions.collar.section
    reach = 2 * max(
        section.half_width, section.palmar + section.dorsal, design.bone.flange_width_mm
    )
    below = interface.low_z(design) - design.bone.post_length_mm - reach
    outside = Box((-reach, -reach, below), (reach, reach, 0.0)).cut(
        sensor_pocket.sensor_recess(design), bone_model.cable_channel(design)
    )
    none_on = "anything else above the collar; the seat of the sensor; the channel of the cables"

    return every | {"bone": Supports((outside,), under, none_on)}
