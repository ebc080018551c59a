"""Registry of the fingertip's parts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .bone import bone
from .core import core
from .encapsulation import plug
from .hand_stub import hand_stub
from .holder import holder
from .making import is_encapsulated
from .mold import mold_dorsal, mold_palmar
from .pin import pin
from .skin import skin
from .solids import Solid
from .stand import stand

if TYPE_CHECKING:
    from .program_types import Finger


def _is_in_every_design(finger: Finger) -> bool:
    return True


def _has_core(finger: Finger) -> bool:
    return not is_encapsulated(finger)


def _has_post(finger: Finger) -> bool:
    return finger.bone.interface == "post"


def _has_joint(finger: Finger) -> bool:
    return finger.bone.interface == "clevis"


def _has_printed_pin(finger: Finger) -> bool:
    return _has_joint(finger) and finger.hand.pin == "printed"


@dataclass(frozen=True)
class Part:
    """Part that is printed or cast."""

    name: str
    solid: Callable[[Finger], Solid]
    """Function that builds the part for a finger."""
    colour: tuple[float, float, float]
    """Red, green and blue in pictures and STEP files, 0 to 1."""
    is_printed: bool
    """True if it is printed, false if it is cast."""
    exists_in: Callable[[Finger], bool] = _is_in_every_design
    """Function that tells whether a design has this part."""
    is_in_finger: bool = False
    """True for what a finished finger consists of; the others serve to make it."""
    is_tool: bool = False
    """True for what helps to assemble the finger, and lies nowhere in it or in its mold."""

    @property
    def note(self) -> str:
        """Note in the part's files: a skin must not go to the printer."""
        return "" if self.is_printed else "cast in silicone, not to be printed"


_ALL_PARTS = (
    Part(
        name="bone",
        solid=bone,
        colour=(0.93, 0.89, 0.80),
        is_printed=True,
        is_in_finger=True,
    ),
    Part(
        name="skin",
        solid=skin,
        colour=(0.87, 0.62, 0.52),
        is_printed=False,
        is_in_finger=True,
    ),
    Part(
        name="mold_palmar",
        solid=mold_palmar,
        colour=(0.45, 0.58, 0.70),
        is_printed=True,
    ),
    Part(
        name="mold_dorsal",
        solid=mold_dorsal,
        colour=(0.62, 0.72, 0.80),
        is_printed=True,
    ),
    Part(
        name="core",
        solid=core,
        colour=(0.70, 0.78, 0.62),
        is_printed=True,
        exists_in=_has_core,
    ),
    Part(
        name="holder",
        solid=holder,
        colour=(0.70, 0.78, 0.62),
        is_printed=True,
        exists_in=is_encapsulated,
    ),
    Part(
        name="plug",
        solid=plug,
        colour=(0.58, 0.66, 0.50),
        is_printed=True,
        exists_in=is_encapsulated,
        is_in_finger=True,
    ),
    Part(
        name="stand",
        solid=stand,
        colour=(0.78, 0.72, 0.58),
        is_printed=True,
        exists_in=_has_post,
        is_tool=True,
    ),
    Part(
        name="pin",
        solid=pin,
        colour=(0.88, 0.80, 0.45),
        is_printed=True,
        exists_in=_has_printed_pin,
        is_tool=True,
    ),
    Part(
        name="hand_stub",
        solid=hand_stub,
        colour=(0.74, 0.74, 0.70),
        is_printed=True,
        exists_in=_has_joint,
        is_tool=True,
    ),
)
"""Parts of all designs, in the order in which they are listed and built."""
PARTS: dict[str, Part] = {part.name: part for part in _ALL_PARTS}
"""Parts of all designs by name, in the same order."""


def parts_by_name(finger: Finger) -> dict[str, Part]:
    """Select the parts that a finger has, by name."""
    return {name: part for name, part in PARTS.items() if part.exists_in(finger)}


def print_scale(finger: Finger, part: Part) -> float:
    """Return the scale of a part's STL and 3MF files.

    It is the compensation of the printer for a printed part, and 1 for a cast one.
    """
    return finger.printer.scale_percent / 100.0 if part.is_printed else 1.0
