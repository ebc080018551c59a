"""Scenes, trials, boards and contacts that cannot be: what their errors say, whole and approved.

After a change that is meant, `FINGERTIP_APPROVE=1 pytest tests/sim/test_refusals.py` writes them;
then read them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import FingertipError
from fingertip.sim.contact.friction import Friction
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.filter_board import AnalogStream, simulate_board
from fingertip.sim.simulation import Trial, load_simulation
from tests.approved import check_text
from tests.conftest import ROOT, design_file
from tests.designs import ARTICLE

BOARD = AnalogBoard.from_design(ARTICLE)
PINCH = ManipulationFile(grasp={"kind": "pinch"})


def at_7(value: float, count: int = 20) -> np.ndarray:
    return np.where(np.arange(count) == 7, value, 0.0)


class Commands:
    """Controller that always returns the same command, or the planned closing in millimetres."""

    def __init__(self, command: list[float] | None = None) -> None:
        self.command = command

    def step(self, observation: Any) -> Any:
        return observation.planned_m * 1000 if self.command is None else np.array(self.command)


def load(scene: str, *changes: str, **options: Any) -> Any:
    return load_simulation(ROOT / f"params/scenes/{scene}.toml", changes=[*changes], **options)


FAMILIES: dict[str, list[Callable[[], object]]] = {
    "scenes": [
        *(
            lambda tables=tables: SceneFile(**tables)
            for tables in (
                {"contact": {"surface": "woood"}},
                {"tap": {"forc_n": 1.0}},
                {"slid": {}},
                {"slide": {"distance_m": 0.5}},
                {"slide": {"speed_m_s": 0.0}},
                {"hold": {"min_force_n": 3.0}},
                {"outputs": ["volt_v"]},
                {"outputs": []},
                {"outputs": ["slip", "slip"]},
                {"load_change": {"by_n": -0.5}},
                {"hold": {"wait_s": float("nan")}},
                {"tap": {"force_n": 1.0, "count": 2, "interval_s": 0.01, "rise_s": 0.01}},
                {
                    "tap": {"forc_n": 1.0},
                    "slide": {"distance_m": 0.5, "speed_m_s": 9.0},
                    "outputs": ["volts"],
                },
                {"converter": {"bits": 10, "low_v": 5.0}},
                {"converter": {"bits": 3}},
                {"converter": {"bits": 25}},
            )
        ),
        lambda: run_scene(ARTICLE, SceneFile(outputs=["sampled_filtered_v"])),
        lambda: run_scene(ARTICLE, SceneFile(outputs=["slip_pin_v"])),
        lambda: load(
            "motor_vibration", "motor.frequency_hz=500.0", "detector.sample_rate_hz=1000.0"
        ).run(),
        lambda: load("sliding_finger", "slide.acceleration_m_s2=0.05", speed_m_s=0.2),
        lambda: load("sliding_finger", "slide.distance_m=3.5e-6", "contact.length_m=3.5e-6"),
        lambda: load("load_change", "load_change.by_n=-4"),
        lambda: load("sliding_finger", "converter.high_v=3.3"),
        lambda: load("sliding_finger", "outputs=voltage_v"),
        lambda: load("contact", "tap.rise_s=9", "skin.width_mm=1", speed_m_s=0.05, seed=-1),
        lambda: load_simulation(
            design_file("fsr400"), design_file("fsr402"), changes=["tap.force_n=1"]
        ),
        *(
            lambda values=values: Trial(**values)
            for values in (
                {"surface": "woood"},
                {"speed_m_s": -0.04},
                {"speed_m_s": math.nan},
                {"force_n": -1.0},
                {"force_n": math.inf},
                {"seed": -1},
            )
        ),
        lambda: run_scene(ARTICLE, ManipulationFile()),
        lambda: run_scene("fsr400", SceneFile()),
        lambda: run_scene(ARTICLE, SceneFile(), grid=16),
        lambda: SceneFile(mount={"mass_kg": 1e-6, "stiffness_n_per_m": 9.9}),
        lambda: load("sliding_finger", surface="woood", speed_m_s=-1.0, force_n=-1.0),
    ],
    "manipulations": [
        *(
            lambda tables=tables: ManipulationFile(**tables)
            for tables in (
                {"object": {"mass_kg": 0.0}},
                {"object": {"surface": "ice"}},
                {"grasp": {"min_margin": 2.0}},
                {"knock": {"stroke_m": 0.002}},
                {"hand": {"lag_s": 0.0}},
                {"sensing": {"jitter_s": 1e-3}},
                {"outputs": ["shear_m"]},
                {"knok": {}},
            )
        ),
        lambda: run_manipulation(ARTICLE, ManipulationFile(outputs=["slip_pin_v"])),
        lambda: run_manipulation(ARTICLE, ManipulationFile(outputs=["sampled_filtered_v"])),
        lambda: run_manipulation(ARTICLE, SceneFile()),
        lambda: run_manipulation(ARTICLE, ManipulationFile(), "fast"),
        *(
            lambda command=command: run_manipulation(Design(), PINCH, Commands(command))
            for command in (None, [0.0], [0.0, math.nan])
        ),
        *(
            lambda changes=changes: load("tri_digital", *changes).run()
            for changes in (
                ["grasp.min_force_n=4"],
                ["knock.stroke_m=0.001"],
                ["knock.speed_m_s=0.001"],
                ["object.stiffness_n_per_m=1"],
                ["hand.max_force_n=2"],
            )
        ),
        lambda: load("tri_digital", surface="ice", speed_m_s=1.0, force_n=-1.0),
    ],
    "boards": [
        *(
            lambda volts=volts: AnalogStream(BOARD, 5e-4).process(volts)
            for volts in (
                at_7(math.inf) + at_7(math.nan),
                at_7(math.nan, 60)[:30],
                at_7(1e300),
                at_7(1e15),
                at_7(-1.1e4),
            )
        ),
        lambda: AnalogStream(BOARD, 5e-4).process(np.zeros(20), at_7(1e15)),
    ],
    "contacts": [
        *(
            lambda values=values: Friction(**({"mu_s": 0.6, "mu_c": 0.48} | values))
            for values in (
                {"sigma0": -1.0},
                {"sigma0": math.nan},
                {"mu_c": 0.7},
                {"stribeck_m_s": 0.0},
                {"sigma1": 300.0},
                {"elastic": 1.0},
                {"mu_s": 101.0},
            )
        ),
    ],
}


@pytest.mark.every_case
@pytest.mark.parametrize("family", FAMILIES)
def test_errors_are_the_approved_ones(family: str) -> None:
    told = []
    for number, attempt in enumerate(FAMILIES[family], start=1):
        with pytest.raises(FingertipError) as caught:
            attempt()
        issues = (
            f"{issue.field}: {issue.message}".replace(f"{ROOT}/", "")
            for issue in caught.value.issues
        )
        told.append("\n".join([f"{number}:", *issues]))
    check_text(
        Path(__file__).with_name("approved") / f"refusals_{family}.txt", "\n\n".join(told) + "\n"
    )


def test_bounds_that_errors_name_are_accepted() -> None:
    assert load(
        "motor_vibration", "motor.frequency_hz=499.0", "detector.sample_rate_hz=1000.0"
    ).run()
    assert load("sliding_finger", "slide.acceleration_m_s2=0.05", speed_m_s=0.0447)
    assert load("load_change", "load_change.by_n=0", "hold.release=true")
    assert load("sliding_finger", "converter.high_v=3.3", "converter.bits=12")
    assert load("sliding_finger", "outputs=[voltage_v, envelope_v]").scene.outputs == [
        "voltage_v",
        "envelope_v",
    ]
    assert np.isfinite(simulate_board(BOARD, 5e-4, at_7(1e4)).envelope_v).all()
