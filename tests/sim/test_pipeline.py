"""Stages of a scene: which ones run, what they integrate, and that omitted stages do not change the others."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.sim import SceneFile, run_scene

DESIGN = Design()
SLIDE = {"slide": {"distance_m": 0.01}, "hold": {"wait_s": 0.1, "release": False}}
STILL = {"hold": {"wait_s": 0.1, "release": False}}


def run(tables: dict, outputs: list[str]):
    """Result of a scene, and its stages by name."""
    found = run_scene(DESIGN, SceneFile(**tables, outputs=outputs), 3)
    return found, {stage.name: stage for stage in found.stages}


@pytest.mark.parametrize(
    ("tables", "outputs", "stages"),
    [
        (SLIDE, ["slip"], ["load", "carriage", "friction", "slip"]),
        (SLIDE, ["shear_m"], ["load", "carriage", "friction", "shear"]),
        (SLIDE, ["force_n"], ["load", "carriage", "friction", "profile", "contact", "force"]),
        (STILL, ["force_n"], ["load", "contact", "force"]),
        (STILL, ["slip"], ["load", "no motion"]),
        (STILL, ["voltage_v"], ["load", "contact", "sensor", "bridge", "ADC"]),
        (STILL, ["envelope_v"], ["load", "contact", "sensor", "bridge", "board noise", "filter board"]),
        (STILL | {"tap": {"force_n": 1.0}}, ["force_n"], ["load", "disturbances", "contact", "force"]),
        (
            STILL | {"cable": {"hum_v": 0.1}},
            ["tactile_v"],
            ["load", "contact", "sensor", "bridge", "interference", "board noise"],
        ),
        (
            SLIDE | {"contact": {"feedback": True}},
            ["force_n", "slip"],
            ["load", "carriage", "coupled contact", "force", "slip"],
        ),
    ],
    ids=str,
)
def test_only_needed_stages_run(tables, outputs, stages):
    found, by_name = run(tables, outputs)
    assert list(by_name) == stages
    assert list(found.columns) == outputs


def test_states_and_evaluations_count_needed_stages_only():
    _, slip_only = run(SLIDE, ["slip"])
    _, everything = run(SLIDE, ["voltage_v", "force_n", "slip", "envelope_v"])
    steps = everything["friction"].evaluations // 2
    assert sum(stage.states for stage in slip_only.values()) == 3
    assert sum(stage.evaluations for stage in slip_only.values()) == 2 * steps
    assert sum(stage.states for stage in everything.values()) == 3 + 1 + 2 + 1 + 4
    assert everything["contact"].evaluations == steps
    _, still = run(STILL, ["voltage_v", "force_n", "slip"])
    assert sum(stage.states for stage in still.values()) == 2 + 1


@pytest.mark.parametrize("tables", [SLIDE, STILL | {"motor": {"force_n": 0.05}}], ids=["slide", "motor"])
def test_outputs_do_not_depend_on_the_other_outputs(tables):
    every = ["voltage_v", "force_n", "slip", "velocity_m_s", "shear_m", "tactile_v", "filtered_v", "envelope_v"]
    full, _ = run(tables, every)
    for name in every:
        alone, _ = run(tables, [name])
        assert np.array_equal(alone.columns[name], full.columns[name]), name
