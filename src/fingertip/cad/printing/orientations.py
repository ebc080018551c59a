"""Orientation of each printed part on the build plate, and the places where its supports may stand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.printing.overhang import MAX_UNSUPPORTED_MM2, bed_pose, find_ceilings
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Solid, difference
from fingertip.design.interfaces import interface_of

LID_UPRIGHT_DEG, LID_ON_FEET_DEG = 0.0, 90.0
"""Rotations of the lid about x [degrees]: on its proximal end, or on its feet. In others, supports touch the skin."""
_LID_FACES = {LID_UPRIGHT_DEG: "the proximal end", LID_ON_FEET_DEG: "the face towards the tail"}
_COARSE_MM = 0.1
"""Tolerance of the mesh whose overhangs are compared [mm]."""


@dataclass(frozen=True)
class Orientation:
    rotate_x_deg: float
    """Rotation about the x axis of the part's file [degrees]."""
    face_on_plate: str
    needs_supports: bool


def print_orientations(design: Design) -> dict[str, Orientation]:
    """Choose the orientation of each printed part, such that no support touches a surface for silicone or sensor.

    The halves of the cup stand on their foot, the core on its plate. The bone stands upright: its palmar flat is then a
    wall, on which no layer ends.
    """
    standing = Orientation(180.0, "the foot, rim up", needs_supports=False)
    orientations = {
        "bone": Orientation(0.0, interface_of(design).face_on_plate, not design.prints_without_supports),
        "mold_palmar": standing,
        "mold_dorsal": standing,
        "core": Orientation(0.0, "the plate, with its name", needs_supports=False),
    }
    if design.dimensions.insert:
        orientations["sensor_insert"] = Orientation(90.0, "the face away from the sensor", needs_supports=False)
        orientations["insert_jig"] = Orientation(90.0, "the face around the hole", needs_supports=False)
    if PARTS["stand"].exists_in(design):
        orientations["stand"] = Orientation(-90.0, "a flat side", needs_supports=False)
    if PARTS["hand_stub"].exists_in(design):
        orientations["hand_stub"] = Orientation(-90.0, "its back, the tendon's slots up", needs_supports=False)
    if design.dimensions.fold:
        orientations["lid"] = _orient_lid(design)
    return orientations


@lru_cache(maxsize=8)
def _orient_lid(design: Design) -> Orientation:
    """Choose the orientation of the lid with the least overhang that no short bridge and no short ledge covers."""
    mesh, areas = MeshEvaluator(_COARSE_MM).mesh(PARTS["lid"].solid(design)), {}
    for rotation in _LID_FACES:
        areas[rotation] = [each.unsupported_mm2() for each in find_ceilings(bed_pose(mesh, rotation).apply(mesh))]
    # On a finer mesh an area can be twice as large.
    best = min(areas, key=lambda rotation: round(sum(areas[rotation]), 2))
    return Orientation(best, _LID_FACES[best], any(area > MAX_UNSUPPORTED_MM2 / 2 for area in areas[best]))


def build_volume_excess(design: Design, mesh: Mesh, rotate_x_deg: float = 0.0) -> float:
    """Measure how far a part, turned on the bed or not, exceeds the build volume [mm]; negative if it fits."""
    printer, (x, y, height) = design.printer, bed_pose(mesh, rotate_x_deg).size(mesh)
    bed = sorted((printer.bed_x_mm, printer.bed_y_mm))
    excess = [size - limit for size, limit in zip(sorted((x, y)), bed, strict=True)]
    return max(*excess, height - printer.bed_z_mm)


_PAST_END_MM = 0.1
"""Length by which a place reaches past the face above it [mm]."""


@dataclass(frozen=True)
class Supports:
    places: tuple[Solid, ...]
    """Regions of air in which they may stand, in the part's own coordinates; none for a part without supports."""
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
    if not design.prints_without_supports:
        every["bone"] = _bone(design)
    if lies := orientations.get("lid"):
        every["lid"] = _lid(design, lies)
    return every


def _bone(design: Design) -> Supports:
    """Supports of the bone: proximal to the skin on the outside, and where a lid covers them."""
    interface = interface_of(design)
    under = interface.supports_below + interface.supports_inside
    none_on = "anything else above the collar; the seat of the sensor"
    dims, fold = design.dimensions, design.dimensions.fold
    below = _everywhere(design, top=0.0)
    if not fold:
        outside = difference(below, bone.sensor_recess(design), bone.cable_channel(design))
        return Supports((outside,), under, f"{none_on}; the channel of the cables")
    # Around the film, in the passage and on the nose, nothing may stand; the rest of its window is open on both sides.
    half, floor, end = dims.tail_half_width, dims.pocket_depth - dims.flat_depth, fold.trough_end_z
    film = Box(
        (-half, floor - dims.passage_height, fold.window_low_z), (half, fold.floor_y + fold.tabs_space_mm, 0.0)
    )  # fmt: skip
    # At its distal end the trough is open to the dorsal side, and neither the film nor the lid reaches the end.
    trough_end = Box((-half, fold.floor_y, fold.film_end_z), (half, 2 * _reach(design), end + _PAST_END_MM))
    return Supports(
        (difference(below, film), trough_end),
        f"{under}; at the distal end of the trough",
        f"{none_on}; the passage of its film; the nose",
    )


def _lid(design: Design, lies: Orientation) -> Supports:
    none_on = "the dorsal side, on which the skin lies"
    if not lies.needs_supports:
        return Supports((), "nowhere", f"{none_on}; the space for tabs and film")
    if lies.rotate_x_deg == LID_ON_FEET_DEG:
        where = "under its thin sides, beside which it stands on its feet"
        return Supports((_everywhere(design, top=_reach(design)),), where, none_on)
    rims = design.dimensions.lips_top_y is not None
    top, where = (design.sensor.clearance_mm + _PAST_END_MM, " and of its rims") if rims else (0.0, "")
    where = f"under the foot of the collar{where}"
    return Supports((_everywhere(design, top=top),), where, f"{none_on}; the space for tabs and film")


def _reach(design: Design) -> float:
    """Length that exceeds the width and the height of bone and core [mm]."""
    section = design.dimensions.collar.section
    return 2 * max(section.half_width, section.palmar + section.dorsal, design.bone.flange_width_mm)


def _everywhere(design: Design, top: float) -> Box:
    """Build the air around a part below a height of the finger, down past its proximal end."""
    reach = _reach(design)
    return Box((-reach, -reach, -design.bone.base_length_mm - design.bone.post_length_mm - reach), (reach, reach, top))
