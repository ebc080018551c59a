"""Evaluation of points: only what the outputs need is computed,
and what points share is computed once.
"""

from __future__ import annotations

import itertools
import math
import os
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.verify import verify
from fingertip.design import Design
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import ELECTRONIC_TABLES
from fingertip.design.rules.ruleset import Rule, find_violations
from fingertip.design.search import ELECTRONIC_RULES, PART_RULES, RULES
from fingertip.foundation.errors import DesignError, Issue
from fingertip.lab.campaign.campaign import Case
from fingertip.lab.campaign.run import TrialResult
from fingertip.models.parts import PARTS, parts_by_name
from fingertip.sweep import compute
from fingertip.sweep.compute import PointContext
from fingertip.sweep.designs import (
    CachedEvaluator,
    DesignBuilder,
    LruCache,
    restrict_kernel_to_one_thread,
)
from fingertip.sweep.outputs import GROUPS, SET_GROUPS, load_outputs
from fingertip.sweep.point_evaluator import PointEvaluator
from tests.approved import check_figures
from tests.sweep.examples import make_plan

COARSE_MM = 0.1
"""Tolerance of the meshes, coarse because only their reuse matters here [mm]."""


def run_checks(design: Design, evaluator: MeshEvaluator) -> tuple[Check, ...]:
    return verify(design, parts_by_name(design), ("stl",), evaluator).checks


def count_group_calls(monkeypatch: pytest.MonkeyPatch) -> dict[str, int]:
    calls = dict.fromkeys(compute.GROUP_FUNCTIONS, 0)

    def wrap(name: str, function: Any) -> Any:
        def count(context: PointContext) -> Any:
            calls[name] += 1
            return function(context)

        return count

    for name, function in list(compute.GROUP_FUNCTIONS.items()):
        monkeypatch.setitem(compute.GROUP_FUNCTIONS, name, wrap(name, function))
    return calls


def test_axes_of_the_board_cause_no_new_meshes(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = count_group_calls(monkeypatch)
    plan = make_plan(
        outputs=["q", "skin_volume_mm3"],
        tolerance_mm=COARSE_MM,
        axes={"board.cutoff_hz": [60.0, 67.0, 80.0], "skin.width_mm": [17.0, 17.5]},
    )
    evaluator = PointEvaluator(plan)
    rows = [
        evaluator.evaluate(int(p), plan.point(int(p))) for p in plan.computing_order(0, plan.size)
    ]
    assert {row[1] for row in rows} == {"ok"}
    assert calls == dict.fromkeys(GROUPS, 0) | {"board": 3, "skin": 2}


SHARED_EVALUATOR = CachedEvaluator(COARSE_MM)
"""Evaluator whose caches fill up from test to test."""


@pytest.mark.full
@pytest.mark.parametrize(
    "changes", [["printer.scale_percent=101"], ["bone.interface=socket", "bone.base_length_mm=32"]]
)
def test_checks_with_caches_equal_those_without(changes: list[str]) -> None:
    design = Design.load(changes=changes)
    expected = run_checks(design, MeshEvaluator(COARSE_MM))
    for _ in range(2):
        assert run_checks(design, SHARED_EVALUATOR) == expected, (
            "after other designs, to the last bit"
        )


@pytest.mark.skipif(
    not hasattr(os, "sched_setaffinity"), reason="processors are chosen on Linux alone"
)
def test_mesh_kernel_starts_on_one_processor_of_this_process(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    calls: list[tuple[int, set[int]]] = []
    monkeypatch.setattr(
        os, "sched_setaffinity", lambda process, processors: calls.append((process, processors))
    )
    restrict_kernel_to_one_thread()
    allowed = os.sched_getaffinity(0)
    assert calls == [(0, {min(allowed)}), (0, allowed)]


def test_cache_evicts_the_least_recently_used_entries() -> None:
    cache: LruCache[str, int] = LruCache(10)
    made: list[str] = []

    def get(key: str, value: int, weight: float = 4) -> int:
        def make() -> int:
            made.append(key)
            return value

        return cache.get(key, make, lambda _: weight)

    assert [get("a", 1), get("b", 2), get("a", 0), get("c", 3)] == [1, 2, 1, 3]
    assert (len(cache), cache.weight, made) == (2, 8, ["a", "b", "c"])
    assert [get("c", 0), get("a", 0), get("b", 4)] == [3, 1, 4]  # b was evicted
    assert [get("d", 5, 99), get("d", 0)] == [5, 5]
    assert (len(cache), cache.weight, made) == (1, 99, ["a", "b", "c", "b", "d"])


class ForbiddenTable:
    def __getattr__(self, name: str) -> Any:
        raise AssertionError(f"reads {name}")


def test_rules_of_the_parts_read_no_electronic_table() -> None:
    tables = DesignTables().model_copy(update=dict.fromkeys(ELECTRONIC_TABLES, ForbiddenTable()))
    assert len(PART_RULES) > 20
    assert list(find_violations(PART_RULES, tables)) == []
    with pytest.raises(AssertionError, match="reads"):
        list(find_violations(RULES, tables))


def test_rules_of_the_electronics_read_no_table_of_the_parts() -> None:
    part_tables = set(DesignTables.model_fields) - {*ELECTRONIC_TABLES, "name"}
    tables = DesignTables().model_copy(update=dict.fromkeys(part_tables, ForbiddenTable()))
    assert len(ELECTRONIC_RULES) > 20
    assert list(find_violations(ELECTRONIC_RULES, tables)) == []


ELECTRONIC_AXES: dict[str, Any] = {
    "board.cutoff_hz": {"low": 10.0, "high": 300.0, "spacing": "logarithmic"},
    "board.capacitor_uf": [0.1, 0.22, 0.47, 1.0, 2.2],
    "board.envelope_cutoff_hz": {"low": 5.0, "high": 900.0, "spacing": "logarithmic"},
    "board.passband_gain": {"low": 10.0, "high": 200.0, "spacing": "logarithmic"},
    "board.supply_v": {"low": 3.1, "high": 5.5},
    "board.variant": ["article", "precision", "comparator"],
    "detector.sample_rate_hz": {"low": 1000.0, "high": 20000.0},
    "detector.window_samples": {"low": 1, "high": 10000},
    "detector.threshold_v": {"low": 0.001, "high": 9.0, "spacing": "logarithmic"},
}


LENGTH_AXES: dict[str, Any] = {
    "skin.width_mm": {"low": 16.5, "high": 19.0},
    "skin.thickness_palmar_mm": {"low": 2.5, "high": 3.5},
    "bone.channel_diameter_mm": {"low": 1.5, "high": 3.5},
    "mold.wall_mm": {"low": 2.0, "high": 6.0},
}


@pytest.mark.full
@pytest.mark.parametrize(
    ("axes", "rules"), [(ELECTRONIC_AXES, ELECTRONIC_RULES), (LENGTH_AXES, PART_RULES)]
)
def test_fast_path_gives_the_same_designs_and_messages(
    axes: dict[str, Any], rules: tuple[Rule, ...]
) -> None:
    plan = make_plan(sampling="latin_hypercube", points=150, seed=3, axes=axes, outputs=["q"])
    fast, complete = (DesignBuilder(plan) for _ in range(2))
    assert fast._rules == rules
    complete._only_electronics_vary = False
    complete._rules = RULES
    refused = 0
    for number in range(plan.size):
        changes = plan.point(number)
        results = []
        for builder in (fast, complete):
            try:
                results.append(builder.build(changes))
            except Exception as error:
                results.append(str(error))
        refused += isinstance(results[0], str)
        assert results[0] == results[1]
    assert 40 < refused < 150


@pytest.mark.parametrize(
    ("axes", "fit"), [(LENGTH_AXES | {"board.cutoff_hz": [60.0, 70.0]}, False), (LENGTH_AXES, True)]
)
def test_all_rules_are_checked_where_parts_and_board_vary_or_a_fit_repairs_the_base(
    axes: dict[str, Any], fit: bool
) -> None:
    plan = make_plan(sampling="latin_hypercube", points=8, axes=axes, outputs=["q"], fit=fit)
    assert DesignBuilder(plan)._rules == RULES


def test_outputs_have_the_units_of_their_names() -> None:
    """Lengths are those of the meshes; the rest follows by hand from
    values that stand in other units beside them.
    """
    design = Design()
    evaluator = CachedEvaluator(COARSE_MM)
    context = PointContext(design, None, make_plan().file, lambda: evaluator)
    values: dict[str, Any] = {}
    for group in ("lengths", "board", "bone", "mold", "casting"):
        values |= compute.GROUP_FUNCTIONS[group](context)
    halves = [
        evaluator.mesh(PARTS[f"mold_{half}"].solid(design)).vertices
        for half in ("palmar", "dorsal")
    ]
    width, height, _ = np.ptp(np.vstack([halves[0], halves[1][halves[1][:, 1] > 0]]), axis=0)
    assert [values["mold_width_mm"], values["mold_height_mm"]] == pytest.approx(
        [width, height], abs=1e-4
    )
    assert values["finger_length_mm"] == 34.0 + design.bone.base_length_mm, (
        "skin, and base of the bone"
    )
    assert 67.0 * (1 + values["cutoff_error_percent"] / 100) == pytest.approx(
        values["cutoff_3db_hz"]
    )
    assert 10 ** (values["gain_db"] / 20) == pytest.approx(values["gain"])
    assert values["envelope_pole_hz"] == pytest.approx(36.17), (
        "software has the pole that the design asks for"
    )
    assert math.isnan(values["board.r_lp_ohm"] + values["board.c_lp_uf"])
    comparator = Design(board={"variant": "comparator"})
    on_board = compute.GROUP_FUNCTIONS["board"](
        PointContext(comparator, None, make_plan().file, lambda: evaluator)
    )
    decay_s = on_board["board.r_lp_ohm"] * on_board["board.c_lp_uf"] * 1e-6
    assert on_board["envelope_decay_ms"] == pytest.approx(1e3 * decay_s)
    assert on_board["envelope_pole_hz"] == pytest.approx(1 / (2 * math.pi * decay_s))
    assert values["board.c_uf"] == design.board.capacitor_uf
    for mass, names in {"bone": ("bone",), "mold": ("mold_palmar", "mold_dorsal")}.items():
        volume_mm3 = sum(evaluator.mesh(PARTS[name].solid(design)).volume() for name in names)
        assert values[f"{mass}_mass_g"] == pytest.approx(volume_mm3 / 1000 * 1.2), "1.2 g/cm3"
    assert values["silicone_g"] > values["silicone_in_mold_g"], "a cup keeps some"


def test_outputs_of_a_design_are_the_approved_ones() -> None:
    """Every output but those of trials and checks, to four digits."""
    evaluator = CachedEvaluator(COARSE_MM)
    context = PointContext(Design.load("fsr400"), None, make_plan().file, lambda: evaluator)
    left_out = ("checks", "detection", *SET_GROUPS)
    groups = [name for name in compute.GROUP_FUNCTIONS if name not in left_out]
    outputs = {
        key: value
        for group in groups
        for key, value in compute.GROUP_FUNCTIONS[group](context).items()
    }
    lines = (f"{key}: {value:.4g}" for key, value in outputs.items())
    check_figures(Path(__file__).parent / "approved/outputs_fsr400.txt", lines, 1e-3, 1e-9)


def test_alarms_of_a_sweep_are_per_minute(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three trials of 10 s with an alarm each, and delays of 10, 20 and 90 ms."""
    delays = iter((0.01, 0.02, 0.09))

    def evaluate_trial(case: Case, *_: object, **__: object) -> list[TrialResult]:
        return [TrialResult(case, 10.0, 1, (next(delays),), 1.0, ("slip",))]

    monkeypatch.setattr("fingertip.lab.campaign.run.evaluate", evaluate_trial)
    plan = make_plan(
        outputs=["delay_ms"],
        scene=SHORT_SLIDE,
        trials=3,
        axes={"detector.window_samples": [20, 40]},
    )
    context = PointContext(Design(), plan.scene, plan.file, Any, lambda seed, record: Any)
    values = compute.compute_detection(context)
    assert (values["delay_ms"], values["delay_p90_ms"], values["found_share"]) == (20.0, 90.0, 1.0)
    assert values["false_alarms_per_min"] == pytest.approx(6.0)


@pytest.mark.full
@pytest.mark.parametrize(("variant", "detector"), [("precision", "fast"), ("comparator", "analog")])
def test_simulated_trials_are_shared_between_windows_and_thresholds(
    variant: str, detector: str
) -> None:
    plan = make_plan(
        outputs=["delay_ms", "found_share", "slips"],
        trials=1,
        detector=detector,
        scene={"slide": {"distance_m": 0.01, "speed_m_s": 0.08}, "hold": {"wait_s": 0.1}},
        design={"board": {"variant": variant}},
        axes={"detector.window_samples": [20, 90], "detector.threshold_v": [0.012, 0.03]},
    )
    evaluator = PointEvaluator(plan)
    shared = [evaluator.evaluate(i, plan.point(i)) for i in range(plan.size)]
    assert len(evaluator._trials) == 1
    separate = [PointEvaluator(plan).evaluate(i, plan.point(i)) for i in range(plan.size)]
    assert repr(shared) == repr(separate)
    assert {row[1] for row in shared} == {"ok"}
    assert {row[4][2] for row in shared} == {1.0}


SHORT_SLIDE: dict[str, Any] = {
    "slide": {"distance_m": 0.005, "speed_m_s": 0.05},
    "hold": {"wait_s": 0.1, "release": False, "min_force_n": 1.0, "max_force_n": 1.0},
}


@pytest.mark.full
def test_share_out_of_contact_is_an_output() -> None:
    axes = {"scene.surface.felt_um": [0.8, 40.0]}
    plan = make_plan(outputs=["out_of_contact_share"], trials=1, scene=SHORT_SLIDE, axes=axes)
    (smooth,), (rough,) = (PointEvaluator(plan).evaluate(i, plan.point(i))[4] for i in range(2))
    assert smooth == 0.0 < 0.1 < rough < 0.6


def test_refused_effect_of_a_scene_keeps_its_reason() -> None:
    axes = {"scene.contact.stick_slip": [True], "scene.contact.bristles": ["elasto_plastic"]}
    plan = make_plan(outputs=["found_share"], trials=1, scene=SHORT_SLIDE, axes=axes)
    _, status, field, _, _ = PointEvaluator(plan).evaluate(0, plan.point(0))
    assert (status, field) == ("refused", "scene.contact.stick_slip")


def test_an_error_of_a_point_is_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = make_plan(outputs=["q"], axes={"board.cutoff_hz": [60.0]})
    for error, start in (
        (DesignError(Issue("a", "is wrong.")), "a: is wrong."),
        (KeyError("x"), "KeyError: 'x' (in "),
    ):
        monkeypatch.setitem(compute.GROUP_FUNCTIONS, "board", Mock(side_effect=error))
        _, status, field, reason, _ = PointEvaluator(plan).evaluate(0, plan.point(0))
        assert (status, field, reason[: len(start)]) == ("failed", "", start)
        assert ("this is a bug in fingertip" in reason) == isinstance(error, KeyError)


def list_outputs(group: str) -> list[str]:
    return [output.name for output in load_outputs().values() if output.group == group]


@pytest.mark.parametrize(
    "group", ["lengths", "board", "noise", "pad", "skin", "bone", "mold", "core", "casting"]
)
def test_output_group_reads_only_its_declared_tables(group: str) -> None:
    base = Design()
    plan = make_plan(
        outputs=list_outputs(group), tolerance_mm=COARSE_MM, axes={"skin.width_mm": [17.0]}
    )

    def compute_outputs(design: Design) -> dict[str, float]:
        evaluator = CachedEvaluator(COARSE_MM)
        return compute.GROUP_FUNCTIONS[group](
            PointContext(design, None, plan.file, lambda: evaluator)
        )

    first = compute_outputs(base)
    assert set(first) == set(list_outputs(group))
    # Tables that it does not declare must not be read. Dimensions are derived before, from all
    # tables.
    _ = base.dimensions
    others = [name for name in DesignTables.model_fields if name not in GROUPS[group].reads]
    forbidden = base.model_copy(update={name: ForbiddenTable() for name in others})
    assert compute_outputs(forbidden) == first
    assert others


def test_computing_order_contains_every_point_and_varies_expensive_axes_slowest() -> None:
    plan = make_plan(
        outputs=["checks_failed", "q"],
        axes={
            "board.cutoff_hz": [60.0, 67.0],
            "skin.width_mm": [17.0, 18.0, 19.0],
            "mold.wall_mm": [4.0, 5.0],
        },
    )
    order = [int(p) for part in range(0, 12, 5) for p in plan.computing_order(part, part + 5)]
    assert sorted(order) == list(range(12))
    points = [plan.point(p) for p in order]
    for name, changes in (("skin.width_mm", 2), ("mold.wall_mm", 5)):
        assert sum(a[name] != b[name] for a, b in itertools.pairwise(points)) == changes
