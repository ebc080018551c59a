"""Random designs: each one that the rules accept must build in both kernels and pass every check.

`.ci/long` makes 300 of them, `FINGERTIP_RANDOM_DESIGNS`.
"""

from __future__ import annotations

import contextlib
import os
import random
from collections.abc import Iterator

import pytest

from benchmarks.fit_near_presets import draw
from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.printing import check_brep_solid
from fingertip.cad.verification.verify import verify
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.design import Design
from fingertip.design.design_file import list_parameters
from fingertip.fitting.fitting import fit_finger
from fingertip.foundation.errors import DesignError
from fingertip.models.parts import parts_by_name
from tests.conftest import DESIGNS, design_file

TOLERANCE = 0.03
MANY = int(os.environ.get("FINGERTIP_RANDOM_DESIGNS", "12"))
FITTED = int(os.environ.get("FINGERTIP_FITTED_DESIGNS", "5"))
TABLES = ("sensor.", "bone.", "hand.", "skin.", "mold.")
VARIED = [p.path for p in list_parameters() if p.path.startswith(TABLES) and p.unit]
NOT_GEOMETRY = ("build_volume_excess", "pad.rest_force", "pad.turn_on_force")
UNLIMITED = ["strength.min_grip_factor=0", "strength.min_knock_factor=0"]


def generate_accepted(seed: int) -> Iterator[Design]:
    """Generate designs that the rules accept: a bundled one, some of
    whose parameters are scaled by 0.5 to 2.
    """
    rng = random.Random(seed)
    while True:
        file = design_file(rng.choice((*DESIGNS, *PRESETS)))
        base = Design.load(file)
        near = rng.choice((1.03, 1.2, 2.0))
        changes = [*UNLIMITED]
        for path in rng.sample(VARIED, rng.randint(3, 12)):
            changes.append(f"{path}={base.value(path) * rng.uniform(1.0 / near, near)}")
        if rng.random() < 0.7:
            changes.append(f"bone.base_length_mm={rng.uniform(8, 45)}")
            changes.append(f"bone.interface={rng.choice(('post', 'socket', 'flange', 'clevis'))}")
        with contextlib.suppress(DesignError):
            yield Design.load(file, changes=changes)


@pytest.mark.full
@pytest.mark.parametrize("seed", range(MANY))
def test_random_design_passes_every_check_in_both_kernels(seed: int) -> None:
    assert list(find_faults(next(generate_accepted(seed)), NOT_GEOMETRY)) == []


@pytest.mark.full
@pytest.mark.parametrize("number", range(FITTED))
def test_fitted_design_passes_every_check_in_both_kernels(number: int) -> None:
    """Sizes near those of a bundled design, which a fit has made valid."""
    with contextlib.suppress(DesignError):
        fit = fit_finger(*draw(number, "begun", 7))
        assert list(find_faults(Design(**fit.tables.model_dump()), NOT_GEOMETRY[:1])) == []


def find_faults(design: Design, left_out: tuple[str, ...]) -> Iterator[Check]:
    """Find the checks that a design fails in both kernels, but for
    those that are no errors of the geometry.
    """
    from fingertip.cad.kernel import brep

    evaluator = MeshEvaluator(TOLERANCE)
    exact = brep.BrepEvaluator()
    parts = parts_by_name(design)
    found = [*verify(design, list(parts), ("stl",), evaluator).checks]
    for part in parts.values():
        solid = part.solid(design)
        brep_solid = exact.solid(solid)
        measured = BrepMeasurements(brep.volume(brep_solid), brep.genus(brep_solid))
        found += check_brep_solid(design, part, evaluator.mesh(solid), measured, 1.0, TOLERANCE)
    # A part that exceeds the printer, and a pad whose bump is too high or too low, are no errors of
    # the geometry.
    return (check for check in found if not check.passed and not check.name.endswith(left_out))
