"""Places at each printed part where supports may stand, as regions of air and in words, and where none may touch."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.cad.printing.orientations import LID_ON_FEET_DEG, Orientation, print_orientations
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.chaplet import facet_cut
from fingertip.cad.solids import Box, Solid, difference, scaled
from fingertip.design import Design

_PAST_END_MM = 0.1
"""Length by which a place reaches past the face above it [mm]."""


@dataclass(frozen=True)
class Supports:
    """Supports of a part in its print orientation."""

    places: tuple[Solid, ...]
    """Regions of air in which they may stand, in the part's own coordinates; none for a part without supports."""
    may_stand: str
    """Places in words."""
    none_on: str
    """Surfaces that none may touch, in words."""

    @property
    def note(self) -> str:
        """Both in one sentence each."""
        return f"Supports: {self.may_stand}. None on: {self.none_on}."


def supports_by_part(design: Design) -> dict[str, Supports]:
    """Return the supports of each printed part of a design."""
    dims, orientations = design.dimensions, print_orientations(design)
    every = {
        "bone": _bone(design),
        "mold_palmar": _mold("hollows, which silicone, bone, keys and nuts touch"),
        "mold_dorsal": _mold("hollows, which silicone, bone, screw and syringe touch"),
        "core": Supports(
            (_everywhere(design, top=0.0), *_facet(design, design.mold.sleeve_interference_mm, dims.shrinkage)),
            f"under the foot of the collar, outside{_rim(design)}",
            "anything else above the collar",
        ),
    }
    if lies := orientations.get("lid"):
        every["lid"] = _lid(design, lies)
    return {name: every[name] for name in orientations}


def _bone(design: Design) -> Supports:
    """Supports of the bone: proximal to the skin on the outside, and where a lid covers them."""
    under = "under the foot of the collar and the end of the base, outside"
    if design.bone.interface == "clevis":
        under = "under the foot of the collar; around the eyes of the joint"
    under += _rim(design)
    if design.bone.interface == "socket":
        under += "; inside the socket"
    none_on = "anything else above the collar; the seat of the sensor"
    dims, fold = design.dimensions, design.dimensions.fold
    below = _everywhere(design, top=0.0)
    if not fold:
        outside = difference(below, bone.sensor_recess(design), bone.cable_channel(design))
        return Supports((outside, *_facet(design)), under, f"{none_on}; the channel of the cables")
    # Around the film, in the passage and on the nose, nothing may stand; the rest of its window is open on both sides.
    half, floor, end = dims.tail_half_width, dims.pocket_depth - dims.flat_depth, fold.trough_end_z
    film = Box(
        (-half, floor - dims.passage_height, fold.window_low_z), (half, fold.floor_y + fold.tabs_space_mm, 0.0)
    )  # fmt: skip
    # At its distal end the trough is open to the dorsal side, and neither the film nor the lid reaches the end.
    trough_end = Box((-half, fold.floor_y, fold.film_end_z), (half, 2 * _reach(design), end + _PAST_END_MM))
    return Supports(
        (difference(below, film), trough_end, *_facet(design)),
        f"{under}; at the distal end of the trough",
        f"{none_on}; the passage of its film; the nose",
    )


def _lid(design: Design, lies: Orientation) -> Supports:
    """Supports of the lid of a folded tail."""
    none_on = "the dorsal side, on which the skin lies"
    if not lies.needs_supports:
        return Supports((), "nowhere", f"{none_on}; the space for tabs and film")
    if lies.rotate_x_deg == LID_ON_FEET_DEG:
        where = "under its thin sides, beside which it stands on its feet"
        return Supports((_everywhere(design, top=_reach(design)),), where, none_on)
    return Supports(
        (_everywhere(design, top=0.0),), "under the foot of the collar", f"{none_on}; the space for tabs and film"
    )


def _rim(design: Design) -> str:
    """Name the rim of the chaplet's facet, which may be a ledge; silicone covers it, and nothing else touches it."""
    return "; at the distal rim of the facet" if design.dimensions.chaplet else ""


def _facet(design: Design, inset_mm: float = 0.0, growth: float = 1.0) -> tuple[Solid, ...]:
    """Build the air that the facet of the chaplet leaves; none without one."""
    return tuple(scaled(cut, growth) for cut in facet_cut(design, inset_mm))


def _mold(hollows: str) -> Supports:
    """Supports of a mold half: none, because all its ceilings are short bridges."""
    return Supports((), "nowhere: all ceilings are short bridges", hollows)


def _reach(design: Design) -> float:
    """Length that exceeds the width and the height of bone and core [mm]."""
    section = design.dimensions.collar.section
    return 2 * max(section.half_width, section.palmar + section.dorsal, design.bone.flange_width_mm)


def _everywhere(design: Design, top: float) -> Box:
    """Build the air around a part below a height of the finger, down past its proximal end."""
    reach = _reach(design)
    return Box((-reach, -reach, -design.bone.base_length_mm - design.bone.post_length_mm - reach), (reach, reach, top))
