"""The registry of printable parts: name, expression, what its topology must be, and its colour in pictures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fingertip.cad import bone, mold, skin
from fingertip.cad.solids import Solid
from fingertip.design import Design


@dataclass(frozen=True)
class Part:
    """A part of the fingertip."""

    name: str
    describe: Callable[[Design], Solid]
    genus: int
    """Number of through holes: the strongest single sign that a channel broke through a wall."""
    colour: tuple[float, float, float]
    printed: bool
    """False for what is cast."""


PARTS: dict[str, Part] = {
    part.name: part
    for part in (
        Part("bone", bone.bone, 2, (0.93, 0.89, 0.80), True),  # cable channel, cross bolt
        Part("skin", skin.skin, 0, (0.87, 0.62, 0.52), False),
        Part("mold_palmar", mold.mold_palmar, 4, (0.45, 0.58, 0.70), True),  # the four bolts
        Part("mold_dorsal", mold.mold_dorsal, 4, (0.62, 0.72, 0.80), True),
    )
}
