"""Touches that the board's texts describe, compared with the simulation of contact, sensor and board."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.board import board_values
from fingertip.board.analysis.board_values import FAST_PRESSES, KNOCK, SLOW_PRESS, SimulatedTouch
from fingertip.sim import SceneFile, run_scene
from tests.conftest import ROOT
from tests.designs import ARTICLE


def simulate_filtered_v(scene: str, **changes: object) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and filtered voltages [V] of a scene on the default board with ideal amplifiers."""
    settings = [f"{table}={value}" for table, value in changes.items()]
    path = ROOT / "params" / "scenes" / f"{scene}.toml"
    result = run_scene(ARTICLE, SceneFile.load(path, changes=[*settings, 'outputs=["filtered_v"]']))
    return result.time_s, result.columns["filtered_v"]


def simulate_press(touch: SimulatedTouch) -> tuple[np.ndarray, np.ndarray]:
    force = {"hold.min_force_n": touch.force_n, "hold.max_force_n": touch.force_n}
    return simulate_filtered_v("contact", **{"hold.mode": "grasp", "hold.close_s": touch.rise_s, **force})


@pytest.mark.parametrize("press", [SLOW_PRESS, *FAST_PRESSES], ids=lambda press: f"{press.rise_s:g} s")
def test_presses_drive_the_filter_as_far_down_as_stated(press: SimulatedTouch) -> None:
    time_s, volts = simulate_press(press)
    assert volts.min() == pytest.approx(press.min_filtered_v, abs=0.06)
    limits = board_values(ARTICLE).voltage_limits
    # An ordinary press stays within what the data sheet guarantees.
    assert (volts.min() < -limits.filter_guaranteed_trough_v) == (press is not SLOW_PRESS)
    below_s = np.count_nonzero(volts < -limits.filter_trough_v) * float(np.diff(time_s).mean())
    assert (0 < below_s < 0.005) == (press is not SLOW_PRESS)


def test_knock_drives_the_filter_as_far_down_as_stated() -> None:
    held = {"hold.min_force_n": 1.0, "hold.max_force_n": 1.0}
    held |= {"pose.tilt_deg": 2.0, "pose.tilt_spread_deg": 0.0, "pose.roll_spread_deg": 0.0}
    _, volts = simulate_filtered_v("hard_tap", **held, **{"tap.force_n": KNOCK.force_n, "tap.rise_s": KNOCK.rise_s})
    assert volts.min() == pytest.approx(KNOCK.min_filtered_v, abs=0.06)
    assert volts.min() < -board_values(ARTICLE).voltage_limits.filter_trough_v
