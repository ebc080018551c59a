"""Ways to make the skin, by the name in `skin.made`: what is lowered into the filled cup, and what
it leaves.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import core, encapsulation, holder
from .outline import skin_outline
from .solids import Solid

if TYPE_CHECKING:
    from .program_types import Finger


@dataclass(frozen=True)
class Making:
    """Way to make the skin."""

    hanger: str
    """Name of the part with the plate, whose ridges seat in the cup."""
    lowered: tuple[str, ...]
    """Names of the parts that are lowered into the cup together."""
    is_bonded: bool
    """True where the silicone cures on the bone, which it then follows without a gap; false where
    the skin is made apart, pulled over the bone, and lies on it.
    """
    interior: Callable[[Finger], Solid]
    """Function that builds what is open inside the skin at its design size."""
    in_cup: Callable[[Finger], Solid]
    """Function that builds what lies inside the silicone in the cup, and reaches into the plate."""
    scale: Callable[[Finger], float]
    """Function that finds the scale of what lies inside the silicone over its design size: a core
    is larger by the shrinkage, a bone is not.
    """
    silicone: Callable[[Finger, Solid], Solid]
    """Function that builds the silicone in the cup, which has not shrunk yet, of a finger and its
    skin.
    """
    lowering_s: float
    """Time in which it is lowered [s]: past the plug over the tail the silicone flows slowly."""
    top_z: Callable[[Finger], float]
    """Function that finds the height z of the face at the top, from which calipers measure."""
    top_y: Callable[[Finger], tuple[float, float]]
    """Function that finds both edges y of that face."""


def _find_shrinkage(finger: Finger) -> float:
    return finger.dimensions.shrinkage


def _do_not_scale(finger: Finger) -> float:
    return 1.0


def _silicone_around_core(finger: Finger, skin: Solid) -> Solid:
    return skin.scaled(finger.dimensions.shrinkage)


def _silicone_around_bone(finger: Finger, skin: Solid) -> Solid:
    """Build the silicone between the cavity, which is larger by the shrinkage, and the bone."""
    cavity = skin_outline(finger).scaled(finger.dimensions.shrinkage)
    return cavity.hollowed(encapsulation.embedded_bone(finger))


MAKINGS: Mapping[str, Making] = {
    "cast": Making(
        hanger="core",
        lowered=("core",),
        is_bonded=False,
        interior=core.core_hollow,
        in_cup=core.core_within_skin,
        scale=_find_shrinkage,
        silicone=_silicone_around_core,
        lowering_s=30.0,
        top_z=core.top_z,
        top_y=core.top_y,
    ),
    "encapsulated": Making(
        hanger="holder",
        lowered=("bone", "plug", "holder"),
        is_bonded=True,
        interior=encapsulation.embedded_bone,
        in_cup=encapsulation.embedded_bone,
        scale=_do_not_scale,
        silicone=_silicone_around_bone,
        lowering_s=60.0,
        top_z=holder.top_z,
        top_y=holder.top_y,
    ),
}


def making_of(finger: Finger) -> Making:
    return MAKINGS[finger.skin.made]


def is_encapsulated(finger: Finger) -> bool:
    return finger.skin.made == "encapsulated"
