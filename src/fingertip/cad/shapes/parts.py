"""The registry of printable parts: name, expression, what its topology must be, and its colour in pictures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fingertip.cad.shapes import bone, core, mold, skin
from fingertip.cad.solids import Solid
from fingertip.design import Design


@dataclass(frozen=True)
class Part:
    """A part of the fingertip."""

    name: str
    describe: Callable[[Design], Solid]
    genus: Callable[[Design], int]
    """Number of through holes its solid must have."""
    colour: tuple[float, float, float]
    printed: bool
    """False for what is cast."""
    needed: Callable[[Design], bool] = lambda design: True
    """Whether a design has this part."""


def _bolts(design: Design) -> int:
    return 4


PARTS: dict[str, Part] = {
    part.name: part
    for part in (
        Part("bone", bone.bone, bone.genus, (0.93, 0.89, 0.80), True),
        Part("skin", skin.skin, lambda design: 0, (0.87, 0.62, 0.52), False),
        Part("mold_palmar", mold.mold_palmar, _bolts, (0.45, 0.58, 0.70), True),
        Part("mold_dorsal", mold.mold_dorsal, _bolts, (0.62, 0.72, 0.80), True),
        Part(
            "core", core.dummy_core, lambda design: 0, (0.70, 0.78, 0.62), True,
            needed=lambda design: design.mold.method == "sleeve",
        ),
    )
}  # fmt: skip


def parts_of(design: Design) -> dict[str, Part]:
    """The parts a design has, by name: all of `PARTS` but the core, which only a sleeve needs."""
    return {name: part for name, part in PARTS.items() if part.needed(design)}


def print_scale(design: Design, part: Part) -> float:
    """Size of a part's STL and 3MF against the design: the printer's compensation, one for what is cast."""
    return design.printer.scale_percent / 100.0 if part.printed else 1.0
