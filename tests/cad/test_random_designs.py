"""Designs nobody drew: whatever the rules let through must build, in both kernels, and pass every check."""

from __future__ import annotations

import contextlib
import os
import random
import time
from collections.abc import Iterator

import pytest

from fingertip.cad.files.step import Exact
from fingertip.cad.kernel import brep
from fingertip.cad.kernel.mesh import Evaluator
from fingertip.cad.shapes.parts import parts_of
from fingertip.cad.verification import checks
from fingertip.cad.verification.verify import verify
from fingertip.design import Design
from fingertip.design.document import parameters
from fingertip.errors import DesignError
from tests.conftest import DESIGNS, design_file

TOLERANCE = 0.03
MANY = int(os.environ.get("FINGERTIP_RANDOM_DESIGNS", "0"))
"""How many designs of each kind; without it, as many as a minute allows."""
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


@pytest.mark.parametrize("seed", range(MANY or 40))
def test_a_random_design_passes_every_check_of_its_meshes(seed: int) -> None:
    design = next(accepted(seed))
    found = verify(design, list(parts_of(design)), ("stl",), Evaluator(TOLERANCE)).checks
    names = {check.name.rsplit(".", 1)[-1] for check in found}
    assert {"open_edges", "thinnest_when_leaning", "undercut"} <= names
    # a bed of the user's own is no matter of the design's geometry
    assert [check for check in found if not check.passed and not check.name.endswith("past_the_printer")] == []


def test_random_designs_that_break_a_rule_are_refused_at_once() -> None:
    """With a sentence, never with anything else, and before any geometry is made: within 0.2 s each."""
    rng, slowest = random.Random(7), 0.0
    refused: list[DesignError] = []
    while len(refused) < 200:
        changes = [f"{path}={(10 ** rng.uniform(-3, 3)):g}" for path in rng.sample(VARIED, rng.randint(2, 8))]
        begun = time.process_time()
        try:
            Design.load(design_file(rng.choice(DESIGNS)), changes=changes)
        except DesignError as error:
            slowest = max(slowest, time.process_time() - begun)
            refused.append(error)
    assert all(len(issue.message) > 20 for error in refused for issue in error.issues)
    assert slowest < 0.2


@pytest.mark.parametrize("seed", range(100, 100 + (MANY or 5)))
def test_both_kernels_agree_on_a_random_design(seed: int) -> None:
    design, evaluator, exact = next(accepted(seed)), Evaluator(TOLERANCE), brep.Evaluator()
    for part in parts_of(design).values():
        expression = part.describe(design)
        solid = exact.solid(expression)
        measured = Exact(brep.volume(solid), brep.genus(solid))
        found = checks.of_brep(design, part, evaluator.mesh(expression), measured, 1.0, TOLERANCE)
        assert [check for check in found if not check.passed] == []
