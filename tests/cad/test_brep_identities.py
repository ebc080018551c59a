"""The identities of the mold by the second kernel: exact volumes, no mesh, no tolerance but its own 1e-6."""

from __future__ import annotations

import pytest

from fingertip.cad.files.step import Exact
from fingertip.cad.kernel import brep
from fingertip.cad.shapes.parts import parts_of
from fingertip.cad.solids import Box, Solid, cylinder, difference, intersection
from fingertip.cad.verification.exact import hollows, of_volumes
from fingertip.design import Design


class Brep:
    """Volumes of one design's expressions, each evaluated once."""

    def __init__(self, design: Design) -> None:
        self.design, self._brep = design, brep.Evaluator()
        self.part = {name: part.describe(design) for name, part in parts_of(design).items()}

    def __call__(self, expression: Solid) -> float:
        return brep.volume(self._brep.shape(expression))


@pytest.fixture(scope="module")
def exact(design: Design) -> Brep:
    return Brep(design)


def failures(exact: Brep, **changed: Solid) -> set[str]:
    """Identities that do not hold on exact volumes, some parts being other solids than they should."""
    design = exact.design
    parts = {name: Exact(exact(changed.get(name, solid)), 0) for name, solid in exact.part.items()}
    volumes = {name: exact(solid) for name, solid in hollows(design, parts)}
    return {check.name for check in of_volumes(design, parts, volumes) if not check.passed}


def test_the_molds_identities_hold_on_exact_volumes(exact: Brep) -> None:
    assert len(list(hollows(exact.design, exact.part))) == 3
    assert failures(exact) == set()


def test_a_skin_with_a_dent_breaks_one(exact: Brep) -> None:
    dent = cylinder("y", (20.0, 0.0), 6.5, 20.0, 0.3)
    assert failures(exact, skin=difference(exact.part["skin"], dent)) == {"step.cavity_less_core_is_skin"}


def test_a_half_that_is_chipped_breaks_the_other(exact: Brep) -> None:
    chip = Box((15.0, 9.0, 0.0), (30.0, 30.0, 0.1))
    broken = failures(exact, mold_dorsal=difference(exact.part["mold_dorsal"], chip))
    assert broken == {"step.halves_and_hollows_are_block"}


def test_what_is_not_built_needs_no_hollow(exact: Brep) -> None:
    assert [name for name, _ in hollows(exact.design, ["bone", "skin"])] == ["cavity", "core_in_cavity"]
    assert [name for name, _ in hollows(exact.design, ["mold_palmar", "mold_dorsal"])] == ["openings"]
    assert hollows(exact.design, ["bone", "mold_palmar"]) == ()


@pytest.mark.parametrize("pair", [("bone", "mold_palmar"), ("bone", "mold_dorsal"), ("skin", "bone")], ids="-".join)
def test_parts_do_not_overlap(exact: Brep, pair: tuple[str, str]) -> None:
    assert abs(exact(intersection(*(exact.part[name] for name in pair)))) < 1e-3
