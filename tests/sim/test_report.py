"""Short simulations with every effect: compiled and plain loops give
the same bits, and what is said is approved.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.catalogues.file_kinds import MANIPULATION, SCENE, list_bundled_files
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.pad.touch import Pose
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.sim.runs.scene import SceneRecord, run_scene
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.signal.grid import STAGES
from fingertip.sim.simulation import load_simulation
from fingertip.sim.simulation_plot import draw
from fingertip.sim.simulation_summary import as_data, as_text
from fingertip.sim.stages import plan_simulation
from fingertip.sim.trace_file import encode_trace
from fingertip.slip.traces.truth import intervals
from tests.approved import check_figures, check_text
from tests.designs import ARTICLE
from tests.figures import describe_figure, keep_figures, list_words

BOARDS = {"comparator": Design.load(changes=VARIANT_CHANGES["comparator"]), "article": ARTICLE}
EVERYTHING: dict[str, Any] = {
    "noise": {"pink_v": 1e-4, "hand_v": 2e-4, "hum_v": 1e-3},
    "cable": {"step_v": 0.02, "hum_v": 0.005, "at_s": 0.2},
    "drift": {"share_per_decade": 0.05, "volt_per_s": 0.001},
    "sensing": {"jitter_s": 2e-5},
    "converter": {"bits": 12},
}
SLIDE: dict[str, Any] = {"hold": {"wait_s": 0.05}, "slide": {"distance_m": 0.004}}
EVENTS: dict[str, Any] = {
    "hold": {"mode": "grasp", "min_s": 0.3, "close_s": 0.2, "wait_s": 0.05},
    "tap": {"force_n": 1.0, "count": 2, "interval_s": 0.1, "at_s": 0.05},
    "load_change": {"by_n": 0.5, "at_s": 0.2, "rise_s": 0.05},
    "motor": {"force_n": 0.05, "at_s": 0.1, "duration_s": 0.1},
}
CONTACT = ["force_n", "slip", "velocity_m_s", "shear_m"]
STICKY = {"patch_average": True, "stick_slip": True, "surface": "wood"}
SCENES: dict[str, tuple[str, dict[str, Any]]] = {
    "slide with everything": (
        "comparator",
        SLIDE | EVERYTHING | {"outputs": [*SceneFile.known_outputs()]},
    ),
    "slide with feedback": (
        "article",
        SLIDE | {"contact": {"feedback": True, "bristles": "elasto_plastic"}, "outputs": CONTACT},
    ),
    "slide with stick-slip": (
        "article",
        SLIDE | {"contact": STICKY, "outputs": [*CONTACT, "envelope_v"]},
    ),
    "events": ("article", EVENTS | {"scene": "events"}),
}
QUICK = {"close_s": 0.1, "settle_s": 0.05, "let_go_s": 0.1, "after_s": 0.15}
HANDS: dict[str, dict[str, Any]] = {
    "pinch that is knocked": {
        "grasp": {"kind": "pinch", **QUICK},
        "knock": {"at_s": 0.05},
        **EVERYTHING,
    },
    "power grasp": {
        "outputs": ["voltage_v", "force_n", "slip", "object_m"],
        "grasp": QUICK,
        "knock": {"speed_m_s": 0.0, "at_s": 0.05},
        "object": {"mass_kg": 0.3},
    },
}


def describe(result: Any, **grips: Any) -> str:
    record = getattr(result, "record", result)
    with keep_figures() as figures:
        draw(result, "title")
    table = encode_trace(result.time_s, result.columns, Path("t.csv")).decode().splitlines()
    every = len(table) // 10
    data = json.dumps(as_data(record, **grips))
    figure = figures[-1]  # of many outputs only its words and lines
    drawn = describe_figure(figure) if len(figure.axes) < 6 else list_words([figure])
    parts = (as_text(record, **grips), [data], drawn, table[:1] + table[1::every])
    return "\n\n".join("\n".join(part) for part in parts)


@pytest.mark.every_case
@pytest.mark.parametrize("name", [*SCENES, *HANDS])
def test_simulation_is_the_approved_one_compiled_or_not(name: str) -> None:
    grips: dict[str, Any] = {}
    if name in SCENES:
        board, tables = SCENES[name]
        run = run_scene
        scene = SceneFile(**tables)
    else:
        board = "comparator"

        def run(design: Any, hand: Any, seed: int) -> Any:
            return run_manipulation(design, hand, None, seed)

        scene = ManipulationFile(**({"outputs": [*ManipulationFile.known_outputs()]} | HANDS[name]))
        grips = {"grips_s": (0.25, 0.5) if "pinch" in name else ()}
    plain = run(BOARDS[board], scene, 4)
    with compiled():
        fast = run(BOARDS[board], scene, 4)
    assert all(
        plain.columns[column].tobytes() == fast.columns[column].tobytes()
        for column in plain.columns
    )
    text = describe(plain, **grips)
    path = Path(__file__).with_name("approved") / f"{name.replace(' ', '_')}.txt"
    check_figures(path, text.splitlines(), 1e-3, 1e-9)


STILL: dict[str, Any] = {"hold": {"wait_s": 0.1, "release": False}}
KINDS_OF_SCENES: dict[str, dict[str, Any]] = {
    "slide": STILL | {"slide": {"distance_m": 0.01}},
    "motor_and_cable": STILL | {"motor": {"force_n": 0.05}, "cable": {"hum_v": 0.1}},
    "feedback": STILL | {"slide": {"distance_m": 0.004}, "contact": {"feedback": True}},
    "still": STILL,
}


@pytest.mark.parametrize("kind", [*KINDS_OF_SCENES, "hand"])
def test_only_the_stages_that_an_output_needs_run_and_it_does_not_depend_on_others(
    kind: str,
) -> None:
    names = [
        name for name in SceneFile.known_outputs() if not name.startswith(("sampled", "slip_pin"))
    ]
    names = ["slip", "object_m", "force_n", "voltage_v"] if kind == "hand" else names

    def run(outputs: list[str]) -> Any:
        if kind == "hand":
            scene = ManipulationFile(**HANDS["power grasp"] | {"outputs": outputs})
            return run_manipulation(Design(), scene, None, 4)
        return run_scene(Design(), SceneFile(**KINDS_OF_SCENES[kind], outputs=outputs), 3)

    told = []
    with compiled():
        full = run(names)
        for name in names:
            alone = run([name])
            assert np.array_equal(alone.columns[name], full.columns[name]), name
            told.append(
                f"{name}: {', '.join(f'{stage.name} {stage.states}' for stage in alone.stages)}"
            )
    check_text(Path(__file__).with_name("approved") / f"stages_{kind}.txt", "\n".join(told) + "\n")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in ("contact", "tri_digital") else pytest.mark.full)
        for name in sorted(list_bundled_files(SCENE, MANIPULATION))
    ],
)
def test_plan_names_the_stages_and_evaluations_of_the_simulation(name: str) -> None:
    simulation = load_simulation(name)
    plan = plan_simulation(simulation)
    planned, run = (
        {stage.name: stage for stage in stages} for stages in (plan.stages, simulation.run().stages)
    )
    assert list(planned) == list(run)
    for stage in run.values():
        assert planned[stage.name].evaluations == pytest.approx(stage.evaluations, rel=0.02)
        assert planned[stage.name].states == stage.states
    assert {*planned, *plan.left_out} == {*STAGES}
    assert all(
        f"{stage.name} " in text
        for stage, text in zip(plan.stages, plan.as_text()[2:], strict=False)
    )


def test_summary_merges_slips_as_detection_does() -> None:
    time = np.arange(2000) / 2000
    slip = (
        ((time >= 0.1) & (time < 0.2))
        | ((time >= 0.24) & (time < 0.3))
        | ((time >= 0.5) & (time < 0.6))
    )
    scene = SceneFile(scene="events", outputs=["slip"])
    result = SceneRecord(scene, 0, 1.0, len(time), intervals(time, slip), (), 2000.0, Pose(), 0.6)
    assert as_text(result)[2:] == [
        "gross slip from 0.1000 s to 0.3000 s",
        "gross slip from 0.5000 s to 0.6000 s",
    ]
    assert len(as_data(result)["slips"]) == 3


def test_plan_says_what_a_coupled_contact_holds_and_when_a_trigger_is_found() -> None:
    plan = plan_simulation(load_simulation("sliding_finger", changes=["contact.feedback=true"]))
    assert not {"friction", "profile", "contact"} & {*plan.left_out}
    assert "trigger" not in plan.as_text()[-1]
    assert (
        "until trigger_v is reached"
        in plan_simulation(load_simulation("sliding_surface")).as_text()[-1]
    )


def test_knock_on_an_object_that_has_left_is_not_reported() -> None:
    grasp = {
        "kind": "pinch",
        "force_n": 5.0,
        "close_s": 0.1,
        "settle_s": 0.0,
        "let_go_s": 0.05,
        "after_s": 0.1,
    }
    with compiled():
        result = run_manipulation(
            Design(),
            ManipulationFile(object={"mass_kg": 2.0}, grasp=grasp, outputs=["object_m"]),
            None,
            1,
        )
    lines = as_text(result)
    assert not any(line.startswith("knock at") for line in lines)
    assert "left the fingers" in lines[-1]
