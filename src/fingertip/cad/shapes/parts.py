"""Registry of the fingertip's parts: solid, expected topology, colour, and orientation on the printer's build plate."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fingertip.cad.shapes import bone, insert, mold, skin
from fingertip.cad.solids import Solid
from fingertip.design import Design
from fingertip.filling.mold_filling import place_vents

if TYPE_CHECKING:
    from fingertip.cad.kernel.mesh import Mesh


@dataclass(frozen=True)
class Part:
    """Part of the fingertip that is printed or cast."""

    name: str
    solid: Callable[[Design], Solid]
    """Function that builds the part for a design."""
    genus: Callable[[Design], int]
    """Function that counts the through holes the solid must have."""
    colour: tuple[float, float, float]
    """Red, green and blue in pictures and STEP files, 0 to 1."""
    is_printed: bool
    """True for printed parts, False for cast ones."""
    exists_in: Callable[[Design], bool] = lambda design: True
    """Function that tells whether a design has this part."""

    @property
    def note(self) -> str:
        """Note in the part's files: a skin must not go to the printer."""
        return "" if self.is_printed else "cast in silicone, not to be printed"


@dataclass(frozen=True)
class Orientation:
    """Orientation of a part on the build plate."""

    rotate_x_deg: float
    """Rotation about the x axis of the part's file [degrees]."""
    face_on_plate: str
    """Face that lies on the build plate, in words."""
    needs_supports: bool


def _bolt_hole_count(design: Design) -> int:
    return len(design.mold_layout.bolts)


def _dorsal_hole_count(design: Design) -> int:
    """Count the bolt holes, the vents through the dorsal half, its inlet, and the hole of the chaplet's screw."""
    layout = design.mold_layout
    vents = sum(vent.kind == "dorsal" for vent in place_vents(design))
    return len(layout.bolts) + vents + (layout.inlet is not None) + (design.dimensions.chaplet is not None)


PARTS: dict[str, Part] = {
    part.name: part
    for part in (
        Part("bone", bone.bone, bone.genus, (0.93, 0.89, 0.80), True),
        Part(
            "lid", bone.lid, lambda design: 0, (0.80, 0.74, 0.62), True,
            exists_in=lambda design: design.dimensions.fold is not None,
        ),
        Part("skin", skin.skin, lambda design: int(design.dimensions.chaplet is not None), (0.87, 0.62, 0.52), False),
        Part("mold_palmar", mold.mold_palmar, _bolt_hole_count, (0.45, 0.58, 0.70), True),
        Part("mold_dorsal", mold.mold_dorsal, _dorsal_hole_count, (0.62, 0.72, 0.80), True),
        Part(
            "core", insert.core, lambda design: 0, (0.70, 0.78, 0.62), True,
            exists_in=lambda design: design.mold.method == "sleeve",
        ),
    )
}  # fmt: skip
"""Every part, by name."""


def parts_by_name(design: Design) -> dict[str, Part]:
    """Return the parts of a design by name: all of `PARTS`, but the core only if the skin is a sleeve."""
    return {name: part for name, part in PARTS.items() if part.exists_in(design)}


def print_scale(design: Design, part: Part) -> float:
    """Return the scale of a part's STL and 3MF files: the printer's compensation, or 1 for cast parts."""
    return design.printer.scale_percent / 100.0 if part.is_printed else 1.0


def print_orientations(design: Design) -> dict[str, Orientation]:
    """Choose the orientation of each printed part, such that no support touches a surface for silicone or sensor.

    The mold halves lie on their outer faces, with the cavity facing up. Bone and core stand upright: their palmar flat
    is then a wall, on which no layer ends. The foot of their collar overhangs the base and needs supports. So does the
    base above a post.
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
        orientations["lid"] = Orientation(90.0, "the face towards the tail", needs_supports=True)
    if design.mold.method == "sleeve":
        orientations["core"] = Orientation(0.0, "the flat proximal end", needs_supports=True)
    return orientations


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
