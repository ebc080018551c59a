"""Registry of the fingertip's parts: solid, expected topology and colour."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fingertip.cad.shapes import bone, insert, mold, skin
from fingertip.cad.solids import Solid
from fingertip.design import Design
from fingertip.filling.mold_filling import place_vents


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
