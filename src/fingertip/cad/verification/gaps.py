"""Gaps between solids: the thinnest place of a wall is the least gap between what lies on both sides of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fingertip.cad.kernel.mesh import Evaluator
from fingertip.cad.solids import Box, Solid, difference
from fingertip.cad.verification.checks import Check

if TYPE_CHECKING:
    from manifold3d import Manifold


def apart(name: str, first: Manifold, second: Manifold, min_mm: float) -> Check:
    """The gap between two solids must be at least `min_mm`.

    Gaps beyond twice that are not searched for (the search costs with its radius): the value then is twice the limit.
    """
    return Check(name, first.min_gap(second, 2.0 * min_mm), min_mm, "mm", "at least")


def around(evaluator: Evaluator, solid: Solid) -> Manifold:
    """Everything but the solid, in a box that is wider than it by its own size."""
    inner = evaluator.manifold(solid)
    low_x, low_y, low_z, high_x, high_y, high_z = inner.bounding_box()
    past = high_x - low_x
    room = Box((low_x - past, low_y - past, low_z - past), (high_x + past, high_y + past, high_z + past))
    return evaluator.manifold(difference(room, solid))
