"""Presets give way: each size that is wished or measured may move while what is derived follows."""

from __future__ import annotations

import random

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.strength import assess_strength
from fingertip.catalogues.file_kinds import DESIGN, list_bundled_files, read_file
from fingertip.design import Design
from fingertip.design.design_file import flatten
from fingertip.design.fit import fit_lengths
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS, find_kind
from fingertip.design.parameters.declaration import find_unit
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import RULES
from tests.first_set import FULL

PRESETS = list_bundled_files(DESIGN)
STATED = [path for path in PARAMETERS if find_kind(path) != "derived"]
LEAST = {"mm": 0.1, "degree": 0.5}
"""Smallest move: what a hand can be made to."""


def list_moves(name: str) -> list[tuple[str, float]]:
    """List each size that a preset states, moved down and up by 3
    %, and by 0.1 mm or 0.5 degrees at least.
    """
    design = Design.load(name)
    moves = list[tuple[str, float]]()
    others = tuple(
        f"bone.{one}_" for one in ("post", "socket", "flange") if one != design.bone.interface
    )
    for path, value in flatten(read_file(PRESETS[name], DESIGN)):
        unit = find_unit(PARAMETERS[path])
        if unit in LEAST and value and path in STATED and not path.startswith(others):
            step = max(0.03 * value, LEAST[unit])
            moves += [(path, round(value - step, 4)), (path, round(value + step, 4))]
    return moves


@pytest.mark.parametrize("name", PRESETS)
def test_each_size_moves_by_three_percent_and_derived_ones_follow(name: str) -> None:
    """All moves in the full set. In the first set some, drawn at random."""
    tables = DesignTables(**Design.load(name).model_dump())
    moves = list_moves(name)
    assert len(moves) >= 8
    for path, value in moves if FULL else random.Random(5).sample(moves, 2):
        fit = fit_lengths(tables.with_values({path: value}), STATED)
        assert not list(find_violations(RULES, fit.tables)), (path, value)
        assert {move.name for move in fit.moves} <= {*PARAMETERS} - {*STATED}


@pytest.mark.parametrize("name", PRESETS)
def test_loads_are_at_most_97_percent_of_what_the_bone_holds(name: str) -> None:
    design = Design.load(name)
    strength = assess_strength(design, MeshEvaluator(0.01))
    assert 0.97 * strength.grip_safety_factor >= design.strength.min_grip_factor
    assert 0.97 * strength.knock_safety_factor >= design.strength.min_knock_factor
