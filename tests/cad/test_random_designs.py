"""Designs nobody drew: whatever the rules let through must build, in both kernels, and pass every check."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Iterator

import pytest

from fingertip.cad.files.step import Exact
from fingertip.cad.kernel import brep
from fingertip.cad.kernel.mesh import Evaluator
from fingertip.cad.shapes.parts import parts_of
from fingertip.cad.verification import checks
from fingertip.design import Design
from fingertip.design.document import parameters
from fingertip.errors import DesignError
from tests.conftest import DESIGNS, design_file

TOLERANCE = 0.03
VARIED = [p.path for p in parameters() if p.path.startswith(("sensor.", "bone.", "skin.", "mold.")) and p.unit]


def accepted(seed: int) -> Iterator[Design]:
    """Endless designs: a bundled one with a few parameters scaled by 0.5 to 2, as far as the rules accept it."""
    rng = random.Random(seed)
    while True:
        file = design_file(rng.choice(DESIGNS))
        base = Design.load(file)
        changes = []
        for path in rng.sample(VARIED, rng.randint(3, 12)):
            section, key = path.split(".")
            changes.append(f"{path}={getattr(getattr(base, section), key) * rng.uniform(0.5, 2.0)}")
        changes.append(f"bone.base_length_mm={rng.uniform(8, 45)}")
        changes.append(f"mold.method={rng.choice(('overmold', 'sleeve'))}")
        changes.append(f"bone.interface={rng.choice(('plain', 'socket'))}")
        with contextlib.suppress(DesignError):
            yield Design.load(file, changes=changes)


@pytest.mark.parametrize("seed", range(20))
def test_meshes_of_a_random_design_pass_every_check(seed: int) -> None:
    design, evaluator = next(accepted(seed)), Evaluator(TOLERANCE)
    parts = parts_of(design)
    found = list(checks.of_assembly(design, evaluator, {name: part.describe(design) for name, part in parts.items()}))
    for part in parts.values():
        found += checks.of_file(design, part, evaluator.mesh(part.describe(design)), "mesh")
    assert [check for check in found if not check.passed] == []


@pytest.mark.parametrize("seed", range(100, 105))
def test_both_kernels_agree_on_a_random_design(seed: int) -> None:
    design, evaluator, exact = next(accepted(seed)), Evaluator(TOLERANCE), brep.Evaluator()
    for part in parts_of(design).values():
        expression = part.describe(design)
        solid = exact.solid(expression)
        measured = Exact(brep.volume(solid), brep.genus(solid))
        found = checks.of_brep(design, part, evaluator.mesh(expression), measured, 1.0, TOLERANCE)
        assert [check for check in found if not check.passed] == []
