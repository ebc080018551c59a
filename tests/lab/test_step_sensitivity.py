"""Study of the time step: shifts of delays, errors of signals, and what counts against the goal."""

from __future__ import annotations

import math

import pytest

from fingertip.design import Design
from fingertip.lab.campaign.plan import Case
from fingertip.lab.report import robustness
from fingertip.lab.studies.steps import (
    SIGNALS,
    DelayShift,
    SignalError,
    StepSensitivity,
    _find_shift_s,
    _pool_shifts,
    compare_grids,
    study_steps,
)
from fingertip.sim import SceneFile
from tests.designs import ARTICLE
from tests.lab.test_assumptions import page_items

SHORT = SceneFile(
    scene="sliding_finger",
    hold={"wait_s": 0.1, "release": False},
    slide={"distance_m": 0.005, "speed_m_s": 0.05},
)


@pytest.mark.parametrize(
    ("coarse", "fine", "shift"),
    [((0.01,), (0.012,), 0.002), ((0.01, 0.02), (0.01, 0.017), 0.003), ((0.01,), (), math.inf), ((), (), math.nan)],
)
def test_shift_is_that_of_the_slip_that_moves_most(
    coarse: tuple[float, ...], fine: tuple[float, ...], shift: float
) -> None:
    assert _find_shift_s(coarse, fine) == pytest.approx(shift, nan_ok=True)


def test_slip_found_with_one_step_only_counts_as_beyond_a_sample() -> None:
    pooled = _pool_shifts("fast", [0.0] * 18 + [1.0, math.inf, math.nan], 2000.0)
    assert (pooled.trials, pooled.beyond_sample, pooled.one_grid_only) == (20, 1, 1)
    assert pooled.meets_goal
    assert pooled.median_s == 0.0
    assert pooled.worst_s == math.inf
    worse = _pool_shifts("fast", [0.0] * 18 + [2.0, math.inf], 2000.0)
    assert not worse.meets_goal
    empty = _pool_shifts("analog", [math.nan], 2000.0)
    assert (empty.trials, empty.worst_s) == (0, 0.0)


def test_a_finer_step_changes_little() -> None:
    found = compare_grids(Design(), Case("slip", SHORT, 3), ("fast",), 4)
    assert set(found.errors) == set(SIGNALS)
    assert 0.0 < found.errors["force_n"] < 1e-4
    assert found.errors["voltage_v"] < 2 * 20 / 65536
    assert 0.0 < found.errors["envelope_v"] < 2e-3
    assert found.shifts_samples["fast"] <= 1.0
    same = compare_grids(Design(), Case("slip", SHORT, 3), ("fast",), 1)
    assert set(same.errors.values()) == {0.0}


def test_table_and_remarks_name_a_missed_goal() -> None:
    shifts = (DelayShift("fast", 20, 1, 0, 0.0, 0.0, 0.001), DelayShift("digital", 20, 4, 1, 0.0, 0.008, math.inf))
    steps = StepSensitivity(20, 16, shifts, (SignalError("force_n", 1e-5, 2e-5, 4e-5),))
    text, remarks = "\n".join(robustness.step_table(steps)), page_items("Time step", steps=steps)
    assert "0.040 mN" in text
    assert text.count("MISSED") == 1
    assert "digital 4 of 20 (worst not found)" in remarks[0]
    assert "missed by digital" in remarks[0]
    assert remarks[1] == "Found with one step only: digital 1."
    assert robustness.steps_as_data(steps)["delay_shifts"][1]["worst_s"] is None


@pytest.mark.full
def test_delays_of_the_articles_trials_do_not_depend_on_the_step() -> None:
    steps = study_steps(ARTICLE, 16)
    assert steps.trials == 16
    assert all(row.meets_goal for row in steps.shifts)
    worst = {row.signal: row.worst for row in steps.errors}
    assert worst["force_n"] < 1e-4
    assert worst["envelope_v"] < 3e-3
