"""Real manipulation: hand, object, sensors, and a controller that sees no more than a real one would."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.errors import TraceError
from fingertip.sim import FixedGrip, ManipulationFile, run_manipulation

DESIGN = Design()
QUICK = {"close_s": 0.3, "settle_s": 0.2, "after_s": 1.0}


def scene(**tables) -> ManipulationFile:
    tables = {name: dict(table) if isinstance(table, dict) else table for name, table in tables.items()}
    tables["grasp"] = QUICK | tables.get("grasp", {})
    tables["object"] = {"friction_spread": 0.0} | tables.get("object", {})
    return ManipulationFile(**tables)


def test_stepping_changes_no_bit():
    """One step over everything, and a controller that looks on every 10 ms but does nothing."""
    outputs = ["voltage_v", "force_n", "slip", "object_m", "closing_m", "pin_n"]
    tables = scene(grasp={"margin_most": 1.15}, outputs=outputs)
    at_once, stepped = run_manipulation(DESIGN, tables, None, 3), run_manipulation(DESIGN, tables, FixedGrip(), 3)
    assert at_once.lost_s is not None
    for name, signal in at_once.signals.items():
        assert np.array_equal(signal, stepped.signals[name]), name


def test_a_grip_at_the_margin_is_knocked_loose_and_one_well_beyond_it_holds():
    loose, firm = (
        run_manipulation(
            DESIGN, scene(grasp={"margin_least": m, "margin_most": m}, outputs=["slip", "object_m"]), None, 1
        )
        for m in (1.15, 1.6)
    )
    assert loose.lost_s > loose.plan.knock_s
    assert firm.lost_s is None
    assert firm.signals["object_m"][-1] < 0.02
    for run in (loose, firm):
        onset = run.time_s[run.signals["slip"][0]][0]
        assert run.plan.knock_s < onset < run.plan.knock_s + 0.03


class Tighter:
    """Closes by 2 cm at a given moment."""

    def __init__(self, at_s: float) -> None:
        self.at_s = at_s

    def step(self, seen):
        return seen.planned_m + (0.02 if seen.time_s >= self.at_s else 0.0)


def test_a_hand_told_in_time_holds_what_it_would_lose():
    tables = scene(grasp={"margin_most": 1.15})
    lost = run_manipulation(DESIGN, tables, FixedGrip(), 2)
    held = run_manipulation(DESIGN, tables, Tighter(lost.plan.knock_s + 0.05), 2)
    late = run_manipulation(DESIGN, tables, Tighter(lost.lost_s + 0.05), 2)
    assert (held.lost_s, late.lost_s) == (None, lost.lost_s)
    gain = held.signals["force_n"][:, -1] - held.plan.force_n
    assert gain[0] == pytest.approx(gain[1:].sum(), abs=0.1)
    assert gain[0] > 1.0


def test_what_a_controller_is_handed():
    seen = []

    class Looks:
        def step(self, now):
            seen.append(now)
            return now.planned_m

    made = run_manipulation(DESIGN, scene(grasp={"kind": "pinch"}), Looks(), 1)
    voltage = np.concatenate([now.voltage_v for now in seen], axis=1)
    assert np.array_equal(voltage, made.signals["voltage_v"][:, : voltage.shape[1]])
    assert {now.voltage_v.shape for now in seen[1:]} == {(2, 20)}
    assert [now.time_s for now in seen[:3]] == [0.0, 0.01, 0.02]
    assert set(vars(seen[0])) == {"time_s", "voltage_v", "closing_m", "planned_m"}


@pytest.mark.parametrize(("answer", "words"), [([0.0], "shape (1,)"), ([0.0, float("nan")], "nan for finger 1")])
def test_a_command_that_is_none(answer, words):
    class Wrong:
        def step(self, seen):
            return np.array(answer)

    with pytest.raises(TraceError, match="controller") as caught:
        run_manipulation(DESIGN, scene(grasp={"kind": "pinch"}), Wrong())
    assert words in str(caught.value)
