"""The identities of the mold by the second kernel: exact volumes, no mesh, no tolerance but its own 1e-6."""

from __future__ import annotations

import pytest

from fingertip.cad.kernel import brep
from fingertip.cad.shapes import mold
from fingertip.cad.shapes.core import cast_around
from fingertip.cad.shapes.parts import parts_of
from fingertip.cad.shapes.skin import cavity
from fingertip.cad.solids import Box, difference, intersection, union
from fingertip.design import Design
from fingertip.design.mold_layout import lay_out

REL = 2e-6


class Exact:
    """Volumes of one design's expressions, each evaluated once."""

    def __init__(self, design: Design) -> None:
        self.design, self._brep = design, brep.Evaluator()
        self.part = {name: part.describe(design) for name, part in parts_of(design).items()}

    def __call__(self, expression: object) -> float:
        return brep.volume(self._brep.shape(expression))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def exact(design: Design) -> Exact:
    return Exact(design)


def test_cavity_less_core_is_skin_and_its_shrinkage(exact: Exact) -> None:
    design = exact.design
    growth = design.dimensions.shrinkage**3
    cast = exact(difference(cavity(design), cast_around(design)))
    skin = exact(exact.part["skin"])
    filled = exact(cavity(design)) / growth - skin  # the bone inside the skin
    assert cast == pytest.approx(growth * skin + (growth - 1) * filled, rel=REL)


def test_halves_and_hollows_are_the_block(exact: Exact) -> None:
    design = exact.design
    m = lay_out(design, design.dimensions)
    block = mold.block(design)
    engraved = (*mold.engraving(design, m, "palmar"), *mold.engraving(design, m, "dorsal"))
    cut = (*mold.bolts(design, m), *mold.nut_traps(design, m), *mold.pry_slots(design, m), *engraved)
    hollow = exact(intersection(union(mold.openings(design), *cut), block))
    assert isinstance(block, Box)
    below = Box(block.low, (block.high[0], 0.0, block.high[2]))
    gap = design.mold.key_clearance_mm
    for socket, key in zip(mold.keys(design, m, gap), mold.keys(design, m), strict=True):
        hollow += exact(intersection(socket, below)) - exact(intersection(key, below))
    halves = exact(exact.part["mold_palmar"]) + exact(exact.part["mold_dorsal"])
    size = [b - a for a, b in zip(block.low, block.high, strict=True)]
    assert halves + hollow == pytest.approx(size[0] * size[1] * size[2], rel=REL)


@pytest.mark.parametrize("pair", [("bone", "mold_palmar"), ("bone", "mold_dorsal"), ("skin", "bone")], ids="-".join)
def test_parts_do_not_overlap(exact: Exact, pair: tuple[str, str]) -> None:
    assert abs(exact(intersection(*(exact.part[name] for name in pair)))) < 1e-3
