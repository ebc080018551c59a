"""What holds the halves together: bolts and keys, their walls, and that the mold closes in one way only."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fingertip.cad.kernel.mesh import Evaluator
from fingertip.cad.shapes import mold
from fingertip.cad.solids import union
from fingertip.cad.verification.checks import Check
from fingertip.cad.verification.gaps import apart, around
from fingertip.design import Design
from fingertip.design.mold_layout import lay_out

if TYPE_CHECKING:
    from manifold3d import Manifold

_OFF_MM = 0.02  # cuts lie off the planes where solids end
_KEYS = 2
_FELT_MM3 = 1.0
"""Less material in each other's way would give when the halves are pressed together the wrong way."""


def of_closing(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """Walls of bolts and keys, the number of keys, and what is in the way of a half turned round."""
    m = lay_out(design, design.dimensions)
    wall = design.printer.min_wall_mm - evaluator.tolerance_mm
    block = evaluator.manifold(mold.block(design))
    bolts = evaluator.manifold(union(*mold.bolts(design, m), *mold.nut_traps(design, m)))
    keys = evaluator.manifold(union(*mold.keys(design, m, design.mold.key_clearance_mm)))
    yield Check("mold.wall.bolts_to_outside", _sideways(bolts, block), wall, "mm", "at least")
    yield apart("mold.wall.keys_to_outside", keys, around(evaluator, mold.block(design)), wall)
    yield apart("mold.wall.keys_to_bolts", keys, bolts, wall)
    palmar, dorsal = (evaluator.manifold(half(design)) for half in (mold.mold_palmar, mold.mold_dorsal))
    standing = dorsal.trim_by_plane((0.0, -1.0, 0.0), _OFF_MM)
    yield Check("mold_dorsal.keys", len(standing.decompose()), _KEYS, "keys", "exactly")
    low, high = block.bounding_box()[:3], block.bounding_box()[3:]
    turned = standing.rotate((0.0, 180.0, 0.0)).translate((low[0] + high[0], 0.0, low[2] + high[2]))
    yield Check("mold.in_the_way_turned_round", (turned ^ palmar).volume(), _FELT_MM3, "mm3", "at least")


def _sideways(inner: Manifold, block: Manifold) -> float:
    """Least distance [mm] from what goes through the block to its four sides."""
    i, b = inner.bounding_box(), block.bounding_box()
    return float(min(i[0] - b[0], i[2] - b[2], b[3] - i[3], b[5] - i[5]))
