"""Hands that are not steady: tremor, voluntary changes, servo steps, and slips with pauses."""

from __future__ import annotations

import random

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.sim.runs.scene import SceneRun, run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.runs.tremor_and_servo import HandMotion, Servo, Tremor, largest_factor

DESIGN = Design()
TIME_S = np.arange(40_000) * 1e-3
QUIET = {"mode": "grasp", "min_force_n": 1.0, "max_force_n": 1.0, "min_s": 3.0}


def draw(tremor: Tremor, servo: Servo | None = None) -> HandMotion:
    motion = HandMotion.draw(tremor, servo or Servo(), random.Random(1), 1.0, 0.7, 40.0)
    assert motion
    return motion


def test_a_steady_hand_has_no_motion() -> None:
    assert HandMotion.draw(Tremor(), Servo(), random.Random(1), 1.0, 0.7, 6.0) is None
    assert SceneRun(DESIGN, SceneFile(hold=QUIET)).hand_motion is None


@pytest.mark.parametrize(
    ("tremor", "share", "low_hz", "high_hz"),
    [(Tremor(share=0.03), 0.03, 8.0, 12.0), (Tremor(voluntary_share=0.05), 0.05, 0.48, 1.92)],
)
def test_tremor_has_its_level_and_its_band(
    tremor: Tremor, share: float, low_hz: float, high_hz: float
) -> None:
    factor = draw(tremor).factor(TIME_S) - 1.0
    assert factor.std() == pytest.approx(share, rel=0.1)
    power = np.abs(np.fft.rfft(factor * np.hanning(len(factor)))) ** 2
    frequency_hz = np.fft.rfftfreq(len(factor), 1e-3)
    inside = (frequency_hz > low_hz - 0.1) & (frequency_hz < high_hz + 0.1)
    assert power[inside].sum() > 0.99 * power.sum()
    assert np.abs(factor).max() + 1 <= largest_factor(tremor, Servo(), 1.0)


def test_points_of_a_tremor_are_close_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    tremor = Tremor(share=0.1, frequency_hz=14.0)
    coarse = draw(tremor).factor(TIME_S)
    monkeypatch.setattr("fingertip.sim.runs.tremor_and_servo._SPACING_S", 2e-4)
    assert coarse == pytest.approx(draw(tremor).factor(TIME_S), abs=2e-6)


def test_a_servo_steps_up_and_down_in_turn() -> None:
    factor = draw(Tremor(), Servo(step_n=0.2, rise_s=0.01, interval_s=0.3, at_s=0.5)).factor(TIME_S)
    middles = 0.7 + 0.5 + 0.3 * np.arange(20) + 0.15
    assert np.interp(middles, TIME_S, factor) == pytest.approx(1 + 0.2 * (np.arange(20) % 2 == 0))
    assert factor[TIME_S < 1.2] == pytest.approx(1.0)
    rate = np.abs(np.diff(factor)).max() / 1e-3
    assert rate == pytest.approx(1.5 * 0.2 / 0.01, rel=0.02)


def test_the_force_of_a_scene_follows_the_hand() -> None:
    scene = SceneFile(hold=QUIET, tremor={"share": 0.03}, outputs=["force_n", "slip"])
    steady = run_scene(DESIGN, SceneFile(hold=QUIET, outputs=["force_n", "slip"]), 2).columns[
        "force_n"
    ]
    found = run_scene(DESIGN, scene, 2).columns
    assert (found["force_n"] / np.where(steady > 0.5, steady, np.inf))[
        2000:7000
    ].std() == pytest.approx(0.03, rel=0.3)
    assert not found["slip"].any()
    assert np.array_equal(found["force_n"] == 0.0, steady == 0.0), (
        "a finger in the air does not tremble"
    )


def test_slips_with_pauses_are_as_many_as_moves() -> None:
    scene = SceneFile(
        slide={"distance_m": 0.04, "moves": 4, "pause_s": 0.3}, outputs=["slip", "velocity_m_s"]
    )
    run = SceneRun(DESIGN, scene, 3)
    assert run.timeline.slide
    moved = run.timeline.slide.position_m(
        np.array([run.timeline.slide.start_s, run.timeline.slide.end_s])
    )
    assert moved == pytest.approx([0.0, 0.04])
    speed = scene.slide.speed_m_s
    acceleration = scene.slide.acceleration_m_s2
    # A quarter of the way, ramps included, and the pause.
    period_s = 0.01 / speed + speed / acceleration + 0.3
    starts_s = [move.start_s - run.timeline.slide.start_s for move in run.timeline.slide.moves]
    assert starts_s == pytest.approx([0.0, period_s, 2 * period_s, 3 * period_s])
    result = run_scene(DESIGN, scene, 3)
    assert len([slip for slip in result.slips if slip.end_s - slip.onset_s > 0.1]) == 4


def test_bad_values_are_refused_with_what_passes() -> None:
    with pytest.raises(
        TraceError, match=r"servo.interval_s: 0.06 s lets steps overlap; at least 0.08 s"
    ):
        SceneFile(servo={"step_n": 0.1, "interval_s": 0.06, "rise_s": 0.08})
    SceneFile(servo={"step_n": 0.1, "interval_s": 0.08, "rise_s": 0.08})
    with pytest.raises(TraceError, match="is not reached within") as refused:
        SceneFile(slide={"distance_m": 0.04, "moves": 50, "speed_m_s": 0.04})
    speed = float(str(refused.value).rsplit("at most ", 1)[1].split()[0])
    SceneFile(slide={"distance_m": 0.04, "moves": 50, "speed_m_s": speed})
