"""Touches that the board's texts describe, compared with the
simulation of contact, sensor and board.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

from fingertip.board.analysis.board_values import TOUCHES, board_values
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from tests.conftest import ROOT
from tests.designs import ARTICLE


def simulate_filtered_v(scene: str, **changes: object) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and filtered voltages [V] of a scene on the default board with ideal amplifiers."""
    settings = [f"{table}={value}" for table, value in changes.items()]
    path = ROOT / "params" / "scenes" / f"{scene}.toml"
    result = run_scene(ARTICLE, SceneFile.load(path, changes=[*settings, *IDEAL]))
    return result.time_s, result.columns["filtered_v"]


IDEAL = ('sensing.amplifiers="ideal"', 'outputs=["filtered_v"]')
PRESSES = re.findall(r"to (-\d\.\d) V (?:if the force rises )?within (\d+) ms", TOUCHES)


@pytest.mark.parametrize(("stated_v", "rise_ms"), PRESSES)
def test_presses_drive_the_filter_as_far_down_as_stated(stated_v: str, rise_ms: str) -> None:
    force = {"hold.min_force_n": 1.5, "hold.max_force_n": 1.5, "hold.close_s": float(rise_ms) / 1e3}
    time_s, volts = simulate_filtered_v("contact", **{"hold.mode": "grasp", **force})
    assert volts.min() == pytest.approx(float(stated_v), abs=0.06)
    limits = board_values(ARTICLE).voltage_limits
    is_slow = rise_ms == "200"
    # An ordinary press stays within what the data sheet guarantees.
    assert (volts.min() < -limits.filter_guaranteed_trough_v) != is_slow
    below_s = np.count_nonzero(volts < -limits.filter_trough_v) * float(np.diff(time_s).mean())
    assert (0 < below_s < 0.005) != is_slow


def test_knock_drives_the_filter_as_far_down_as_stated() -> None:
    held = {"hold.min_force_n": 1.0, "hold.max_force_n": 1.0}
    held |= {"pose.tilt_deg": 2.0, "pose.tilt_spread_deg": 0.0, "pose.roll_spread_deg": 0.0}
    _, volts = simulate_filtered_v("hard_tap", **held, **{"tap.force_n": 0.25, "tap.rise_s": 0.004})
    assert volts.min() == pytest.approx(-3.0, abs=0.06)
    assert volts.min() < -board_values(ARTICLE).voltage_limits.filter_trough_v
