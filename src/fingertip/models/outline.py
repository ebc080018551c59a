"""Outer surface of the skin, which the mold and all that lies in it are built around."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .conic import inset_body
from .solids import Solid, SuperconicSolid

if TYPE_CHECKING:
    from .program_types import Finger


def skin_outline(finger: Finger, inset_mm: float = 0.0) -> Solid:
    """Build the skin with all that lies in it, smaller by an inset."""
    return SuperconicSolid(inset_body(finger.dimensions.outer, inset_mm))
