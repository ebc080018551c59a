"""Left out is not paid for: which stages run, what they integrate, and that the rest is the same to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.sim import SceneFile, run_scene
from fingertip.sim.stages.stages import Stage, on_the_way, run
from tests.conftest import run_python

DESIGN = Design()
SLIDE = {"slide": {"distance_m": 0.01}, "hold": {"wait_s": 0.1, "release": False}}
STILL = {"hold": {"wait_s": 0.1, "release": False}}


def ran(tables: dict, outputs: list[str]):
    found = run_scene(DESIGN, SceneFile(**tables, outputs=outputs), 3)
    return found, {stage.name: stage for stage in found.ran}


@pytest.mark.parametrize(
    ("tables", "outputs", "stages"),
    [
        (SLIDE, ["slip"], ["load", "stage", "friction", "slip"]),
        (SLIDE, ["shear_m"], ["load", "stage", "friction", "shear"]),
        (SLIDE, ["force_n"], ["load", "stage", "friction", "profile", "contact", "force"]),
        (STILL, ["force_n"], ["load", "contact", "force"]),
        (STILL, ["slip"], ["load", "still"]),
        (STILL, ["voltage_v"], ["load", "contact", "sensor", "bridge", "converter"]),
        (STILL, ["envelope_v"], ["load", "contact", "sensor", "bridge", "board noise", "filter board"]),
        (STILL | {"tap": {"force_n": 1.0}}, ["force_n"], ["load", "shaking", "contact", "force"]),
        (
            STILL | {"cable": {"hum_v": 0.1}},
            ["tactile_v"],
            ["load", "contact", "sensor", "cable", "bridge", "board noise"],
        ),
        (
            SLIDE | {"contact": {"feedback": True}},
            ["force_n", "slip"],
            ["load", "stage", "coupled contact", "force", "slip"],
        ),
    ],
    ids=str,
)
def test_only_what_is_needed_runs(tables, outputs, stages):
    found, by_name = ran(tables, outputs)
    assert list(by_name) == stages
    assert list(found.columns) == outputs


def test_states_and_evaluations_are_those_of_the_needed_stages():
    _, slip_only = ran(SLIDE, ["slip"])
    _, everything = ran(SLIDE, ["voltage_v", "force_n", "slip", "envelope_v"])
    steps = everything["friction"].evaluations // 2
    assert sum(stage.states for stage in slip_only.values()) == 3
    assert sum(stage.evaluations for stage in slip_only.values()) == 2 * steps
    assert sum(stage.states for stage in everything.values()) == 3 + 1 + 2 + 1 + 4
    assert everything["contact"].evaluations == steps + 1
    _, still = ran(STILL, ["voltage_v", "force_n", "slip"])
    assert sum(stage.states for stage in still.values()) == 2 + 1


@pytest.mark.parametrize("tables", [SLIDE, STILL | {"motor": {"force_n": 0.05}}], ids=["slide", "motor"])
def test_shared_outputs_are_the_same_to_the_last_bit(tables):
    every = ["voltage_v", "force_n", "slip", "velocity_m_s", "shear_m", "tactile_v", "filtered_v", "envelope_v"]
    full, _ = ran(tables, every)
    for name in every:
        alone, _ = ran(tables, [name])
        assert np.array_equal(alone.columns[name], full.columns[name]), name


def test_what_is_left_out_costs_nothing():
    """CPU time of a run without a stage: within a tenth of the full run's less that stage, best of five."""
    ran(SLIDE, ["voltage_v", "envelope_v"])
    ratios = []
    for _ in range(5):
        _, full = ran(SLIDE, ["voltage_v", "envelope_v"])
        _, less = ran(SLIDE, ["voltage_v"])
        expected = sum(stage.cpu_s for name, stage in full.items() if name != "filter board")
        ratios.append(sum(stage.cpu_s for stage in less.values()) / expected)
    assert min(ratios) < 1.1


def test_a_scene_without_its_needs_loads_nothing_for_them(tmp_path):
    code = (
        "import sys; from fingertip.design import Design; from fingertip.sim import *\n"
        "run_scene(Design(), SceneFile(outputs=['slip'], hold={'wait_s': 0.1}))\n"
        "heavy = {'scipy', 'numba', 'cadquery', 'matplotlib', 'trimesh'}\n"
        "print(sorted({name.split('.')[0] for name in sys.modules} & heavy))"
    )
    assert run_python("-c", code).stdout.strip() == "[]"


def test_order_follows_the_needs():
    log: list[str] = []

    def stage(name: str, needs: tuple[str, ...], gives: tuple[str, ...]) -> Stage[None]:
        return Stage(name, needs, gives, lambda _, given: log.append(name) or dict.fromkeys(gives, name))

    parts = [stage("c", ("b1", "a"), ("c",)), stage("b", ("a",), ("b1", "b2")), stage("a", (), ("a",))]
    parts.append(stage("d", ("c",), ("d",)))
    values, _ = run(parts, None, ["c"])
    assert log == ["a", "b", "c"]
    assert set(values) == {"a", "b1", "b2", "c"}
    with pytest.raises(KeyError):
        on_the_way(parts, ["nothing"])
    with pytest.raises(KeyError, match="x needs itself"):
        on_the_way([stage("x", ("y",), ("x",)), stage("y", ("x",), ("y",))], ["x"])
