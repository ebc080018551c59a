"""How each printed part lies on the printer's plate, and whether it fits there."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.cad.kernel.mesh import Mesh
from fingertip.design import Design


@dataclass(frozen=True)
class Orientation:
    """How a part lies on the plate."""

    turn_x_deg: float
    """Turned about the x axis of its file."""
    on_the_plate: str
    supports: bool


def orientations(design: Design) -> dict[str, Orientation]:
    """How each printed part lies on the plate: no support touches what the silicone or the sensor touches.

    The mold's halves lie on their outer faces, so their cavity opens upwards. Bone and core stand: their flat is then
    a wall, and no layer ends in it. Their collar's foot hangs in the air above the base, which takes supports; so does
    the base above a post.
    """
    post = design.bone.interface == "plain"
    parts = {
        "bone": Orientation(0.0, "the end of its post" if post else "the end with the socket", supports=True),
        "mold_palmar": Orientation(90.0, "its outer face, parting plane up", supports=False),
        "mold_dorsal": Orientation(-90.0, "its outer face, parting plane up", supports=False),
    }
    if design.mold.method == "sleeve":
        parts["core"] = Orientation(0.0, "the end without the tip", supports=True)
    return parts


def past_the_printer(design: Design, name: str, mesh: Mesh) -> float:
    """How far a printed part, lying as it should, reaches past the bed or the height [mm]; negative: so much is left.

    On the bed it may be turned by a quarter.
    """
    turn, printer = math.radians(orientations(design)[name].turn_x_deg), design.printer
    x, y, z = mesh.vertices.T
    depth, height = math.cos(turn) * y - math.sin(turn) * z, math.sin(turn) * y + math.cos(turn) * z
    footprint = sorted(float(along.max() - along.min()) for along in (x, depth))
    bed = sorted((printer.bed_x_mm, printer.bed_y_mm))
    excess = [size - room for size, room in zip(footprint, bed, strict=True)]
    return max(*excess, float(height.max() - height.min()) - printer.bed_z_mm)
