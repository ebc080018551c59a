"""Shapes of the interface to the proximal phalanx, by the name in `bone.interface`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from . import adapter, clevis, flange, post, socket
from .solids import Shapes

if TYPE_CHECKING:
    from .program_types import Finger

SHAPES: Mapping[str, Callable[[Finger], Shapes]] = {
    "post": post.shapes,
    "socket": socket.shapes,
    "flange": flange.shapes,
    "clevis": clevis.shapes,
    "file": adapter.shapes,
}


def shapes_of(finger: Finger) -> Shapes:
    """Build what the interface adds to the filled bone, and what it removes."""
    return SHAPES[finger.bone.interface](finger)
