"""Orientations of the printed parts on the printer's build plate."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.printing.overhang import MAX_UNSUPPORTED_MM2, find_ceilings
from fingertip.cad.printing.pose import bed_pose
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design

LID_UPRIGHT_DEG, LID_ON_FEET_DEG = 0.0, 90.0
"""Rotations of the lid about x [degrees]: on its proximal end, or on its feet. In others, supports touch the skin."""
_LID_FACES = {LID_UPRIGHT_DEG: "the proximal end", LID_ON_FEET_DEG: "the face towards the tail"}
_COARSE_MM = 0.1
"""Tolerance of the mesh whose overhangs are compared [mm]."""


@dataclass(frozen=True)
class Orientation:
    """Orientation of a part on the build plate."""

    rotate_x_deg: float
    """Rotation about the x axis of the part's file [degrees]."""
    face_on_plate: str
    """Face that lies on the build plate, in words."""
    needs_supports: bool


def print_orientations(design: Design) -> dict[str, Orientation]:
    """Choose the orientation of each printed part, such that no support touches a surface for silicone or sensor.

    The mold halves lie on their outer faces, with the cavity facing up. Bone and core stand upright: their palmar flat
    is then a wall, on which no layer ends. The foot of their collar overhangs the base and needs supports. So does the
    base above a post. The lid lies as it overhangs least.
    """
    face = {
        "post": "the end of the post", "socket": "the proximal end, with the socket", "flange": "the flange",
        "clevis": "the eyes of the joint",
    }  # fmt: skip
    orientations = {
        "bone": Orientation(0.0, face[design.bone.interface], needs_supports=True),
        "mold_palmar": Orientation(90.0, "the outer face, parting plane up", needs_supports=False),
        "mold_dorsal": Orientation(-90.0, "the outer face, parting plane up", needs_supports=False),
    }
    if design.dimensions.fold:
        orientations["lid"] = _orient_lid(design)
    if design.mold.method == "sleeve":
        orientations["core"] = Orientation(0.0, "the flat proximal end", needs_supports=True)
    return orientations


@lru_cache(maxsize=8)
def _orient_lid(design: Design) -> Orientation:
    """Choose the orientation of the lid with the least overhang that no short bridge and no short ledge covers."""
    mesh, areas = MeshEvaluator(_COARSE_MM).mesh(PARTS["lid"].solid(design)), {}
    for rotation in _LID_FACES:
        areas[rotation] = [each.unsupported_mm2() for each in find_ceilings(bed_pose(mesh, rotation).apply(mesh))]
    best = min(areas, key=lambda rotation: round(sum(areas[rotation]), 2))
    return Orientation(best, _LID_FACES[best], any(area > MAX_UNSUPPORTED_MM2 for area in areas[best]))


def build_volume_excess(design: Design, name: str, mesh: Mesh) -> float:
    """Measure how far a part in its print orientation exceeds the printer's build volume [mm]; negative if it fits.

    The part may be rotated by 90 degrees on the bed.
    """
    rotation, printer = math.radians(print_orientations(design)[name].rotate_x_deg), design.printer
    x, y, z = mesh.vertices.T
    depth, height = (
        math.cos(rotation) * y - math.sin(rotation) * z,
        math.sin(rotation) * y + math.cos(rotation) * z,
    )
    footprint = sorted(float(along.max() - along.min()) for along in (x, depth))
    bed = sorted((printer.bed_x_mm, printer.bed_y_mm))
    excess = [size - limit for size, limit in zip(footprint, bed, strict=True)]
    return max(*excess, float(height.max() - height.min()) - printer.bed_z_mm)
