"""Budget of errors: stated errors and intervals are found a second
time, by closed forms, finer ones or other code.
"""

from __future__ import annotations

import json
import random

import numpy as np
import pytest

from benchmarks.peers import trial
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import binomial_interval, quantile_ranks
from fingertip.lab.accuracy import accuracy_summary, budget
from fingertip.lab.accuracy.budget import Curve
from fingertip.lab.campaign.run import quantile_interval_s
from fingertip.models.parts import PARTS
from fingertip.pad import layer
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import Pose
from fingertip.sweep.outputs import load_outputs
from tests.conftest import run_fingertip

DESIGN = Design.load("fsr400")
GROUPS = {name: output.group for name, output in load_outputs().items()}


@pytest.mark.parametrize(("count", "total"), [(0, 12), (3, 30), (120, 120), (3998, 4000)])
def test_interval_of_a_share_is_scipys(count: int, total: int) -> None:
    stats = pytest.importorskip("scipy.stats")
    exact = stats.binomtest(count, total).proportion_ci(0.95, "exact")
    assert binomial_interval(count, total) == pytest.approx((exact.low, exact.high), abs=1e-9)


@pytest.mark.parametrize(("total", "fraction"), [(120, 0.5), (120, 0.9), (30, 0.9), (240, 0.5)])
def test_interval_of_a_delay_holds_the_true_one_in_95_of_100(total: int, fraction: float) -> None:
    """Of delays that are drawn from a known distribution."""
    rng = random.Random(total)
    drawn = [sorted(rng.random() for _ in range(total)) for _ in range(1000)]
    low, high = (rank + 1 for rank in quantile_ranks(total, fraction))
    spans = [([0.0, *one, np.inf][low], [0.0, *one, np.inf][high]) for one in drawn]
    assert 0.94 < sum(begin <= fraction <= end for begin, end in spans) / len(spans) < 0.995
    assert quantile_interval_s(drawn[0], total, fraction) == spans[0]
    if total == 120:
        narrower = sum(one[low] <= fraction <= one[high - 2] for one in drawn) / len(drawn)
        assert narrower < 0.955


@pytest.mark.full
def test_errors_of_meshes_and_the_pad_are_those_of_a_second_computation() -> None:
    """Volume of the skin: by Richardson from two other meshes.

    Share: on a grid of twice the reference's fineness.
    """
    volumes, sections = budget.refine_meshes(DESIGN)
    coarse, fine = (
        MeshEvaluator(mm).mesh(PARTS["skin"].solid(DESIGN)).volume() for mm in (0.004, 0.002)
    )
    # A mesh's volume is off in proportion to its tolerance.
    exact = fine + (fine - coarse) * 0.002 / (0.004 - 0.002)
    assert volumes.errors["skin_volume_mm3"][volumes.used] == pytest.approx(
        exact - volumes.values["skin_volume_mm3"], rel=0.15
    )
    (pad,) = budget.refine_pad(DESIGN)
    form = PadForm.of_design(DESIGN)
    fine_mm = layer.GRID_MM / 8
    shares = [
        layer.find_contacts(form, Pose(tilt), (1.0,), grid_mm=fine_mm)[0].share
        for tilt in (0.0, 2.0, 5.0, 10.0)
    ]
    assert pad.errors["pad_share"][1] == pytest.approx(
        abs(pad.values["pad_share"] - min(shares)), abs=4e-4
    )
    for curve in (volumes, pad, sections):
        assert all(errors[0] >= errors[2] for errors in curve.errors.values())
        assert min(curve.cpu_s) > 0.0


def test_text_names_each_output_once_in_the_table_or_by_its_kind() -> None:
    curve = Curve(
        "a [mm]",
        (3.0, 2.0, 1.0),
        1,
        (1, 2, 3),
        {"pad_share": 0.5},
        {"pad_share": (3e-3, 2e-3, 1e-3)},
    )
    found = accuracy_summary.list_kinds([curve], GROUPS)
    named = [name for names in found.values() for name in names]
    assert sorted([*named, "pad_share"]) == sorted(GROUPS)
    assert (
        "| pad_share | 0.5 | a [mm] | 3 / 2* / 1 | 3.0e-03 / 2.0e-03 / 1.0e-03 | 1 / 2 / 3 | - | "
        "±0.06 (0.011 rms)" in (accuracy_summary.budget_text("x", [curve], GROUPS))
    )


def test_word_and_design_are_told_apart() -> None:
    assert "fsr400 is one design too many" in run_fingertip("accuracy", "article", "fsr400").stderr


@pytest.mark.full
def test_command_states_25_outputs_within_their_intervals() -> None:
    done = run_fingertip("accuracy", "budget", "fsr400", "--json")
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    assert len({name for curve in data["curves"] for name in curve["errors"]}) == 25
    for curve in data["curves"]:
        assert curve["cpu_s"][0] < curve["cpu_s"][-1]  # each is of one run: neighbours may swap
        for name, spans in curve["intervals"].items():
            assert all(low <= curve["values"][name] <= (high or 1e9) for low, high in spans[1:2])


@pytest.mark.full
def test_error_of_the_step_is_that_against_equations_that_scipy_solves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a whole trial, from the pad to the envelope; the article's
    board misses where its amplifier reverses.
    """
    for name, value in {"VARIANTS": ("precision",), "_REFINEMENTS": (1,), "_ROUNDS": 1}.items():
        monkeypatch.setattr(trial, name, value)
    with compiled():
        found = trial.measure_trial()
    assert not found.misses_target, found.points
    between = found.reference_differences["precision"]
    assert (between["force_n"] < 2e-7, between["envelope_v"] < 2e-5) == (True, True), between
