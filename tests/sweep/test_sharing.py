"""Only what the wanted outputs need is computed, and what points share is computed once."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from fingertip.board import board_values
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification.checks import Check
from fingertip.cad.verification.verify import as_data, verify
from fingertip.design import Design
from fingertip.design.parameters import DesignTables
from fingertip.design.rules import RULES
from fingertip.sweep import compute
from fingertip.sweep.design_builder import SIGNAL, Designs
from fingertip.sweep.point_evaluator import Bench
from fingertip.sweep.cache import Memory
from fingertip.sweep.outputs import OUTPUTS, STAGES
from fingertip.sweep.plan import Plan
from fingertip.sweep.cached_solids import MAX_TRIANGLES, CachedEvaluator
from tests.conftest import run_python
from tests.sweep.plans import plan

COARSE = 0.1


def checks_of(design: Design, evaluator: MeshEvaluator) -> tuple[Check, ...]:
    return verify(design, parts_by_name(design), ("stl",), evaluator).checks


def imported(outputs: str, axes: str) -> set[str]:
    """Packages a fresh process has loaded after computing one point."""
    program = f"""
import sys
from fingertip.sweep.point_evaluator import Bench
from fingertip.sweep.plan import Plan
plan = Plan.of({{"outputs": {outputs}, "tolerance_mm": {COARSE}, "axes": {axes}}})
outcome = Bench(plan).outcome(0, plan.point(0))
assert outcome[1] == "ok", outcome
print(*{{name.partition(".")[0] for name in sys.modules}})
"""
    ran = run_python("-c", program)
    assert ran.returncode == 0, ran.stderr
    return set(ran.stdout.split())


def test_boards_load_neither_kernel_nor_scipy_nor_plots() -> None:
    loaded = imported('["q", "board.r2_ohm"]', '{"board.cutoff_hz": [60.0]}')
    assert not loaded & {"manifold3d", "cadquery", "OCP", "scipy", "matplotlib", "numba", "distributed", "trimesh"}


def test_volumes_load_the_mesh_kernel_only() -> None:
    loaded = imported('["skin_volume_mm3"]', '{"skin.width_mm": [17.0]}')
    assert "manifold3d" in loaded
    assert not loaded & {"cadquery", "OCP", "scipy", "matplotlib", "numba", "distributed", "trimesh"}


def test_a_worker_s_kernel_computes_on_one_thread() -> None:
    program = """
import os, time
from fingertip.sweep.point_evaluator import Bench
from fingertip.sweep.plan import Plan
plan = Plan.of({"outputs": ["checks_failed"], "tolerance_mm": 0.02, "axes": {"skin.width_mm": [17.0, 17.5]}})
before = os.sched_getaffinity(0)
Bench(plan).outcome(0, plan.point(0))
wall, cpu = time.perf_counter(), time.process_time()
Bench(plan).outcome(1, plan.point(1))
print((time.process_time() - cpu) / (time.perf_counter() - wall), os.sched_getaffinity(0) == before)
"""
    ran = run_python("-c", program)
    assert ran.returncode == 0, ran.stderr
    share, same = ran.stdout.split()
    assert float(share) < 1.1  # two threads: 1.7, where there are two processors that nobody else wants
    assert same == "True"


def counted(monkeypatch: pytest.MonkeyPatch) -> dict[str, int]:
    """How often each stage is computed from now on."""
    calls = dict.fromkeys(compute.COMPUTE, 0)

    def counting(name: str, compute: Any) -> Any:
        def called(asked: compute.Asked) -> Any:
            calls[name] += 1
            return compute(asked)

        return called

    for name, compute in list(compute.COMPUTE.items()):
        monkeypatch.setitem(compute.COMPUTE, name, counting(name, compute))
    return calls


def test_axes_of_the_board_mesh_nothing_again(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = counted(monkeypatch)
    made = plan(
        outputs=["q", "skin_volume_mm3"],
        tolerance_mm=COARSE,
        axes={"board.cutoff_hz": [60.0, 67.0, 80.0], "skin.width_mm": [17.0, 17.5]},
    )
    bench = Bench(made)
    rows = [bench.outcome(int(p), made.point(int(p))) for p in made.in_order(0, made.size)]
    assert {row[1] for row in rows} == {"ok"}
    assert calls == dict.fromkeys(STAGES, 0) | {"board": 3, "skin": 2}


def test_the_skin_alone_is_meshed_for_its_volume() -> None:
    design = Design()
    evaluator = CachedEvaluator(COARSE)
    made = plan(outputs=["skin_volume_mm3"], axes={"skin.width_mm": [17.0]})
    asked = compute.Asked(design, None, made.file, lambda: evaluator)
    compute.skin(asked)
    alone = evaluator.evaluated
    compute.skin(asked)
    assert evaluator.evaluated == alone
    compute.halves(asked)
    assert evaluator.evaluated > 3 * alone  # the halves would have been noticed


def test_the_bone_is_neither_meshed_nor_measured_while_the_mold_varies(monkeypatch: pytest.MonkeyPatch) -> None:
    import fingertip.cad.kernel.mesh as kernel

    meshed: list[int] = []
    original = kernel.to_manifold
    monkeypatch.setattr(kernel, "to_manifold", lambda v, t: meshed.append(len(v)) or original(v, t))
    evaluator = CachedEvaluator(COARSE)
    wider = [Design.load(changes=[f"mold.wall_mm={wall}"]) for wall in (4.0, 5.0, 5.5)]
    checks_of(wider[0], evaluator)
    first = len(meshed)
    checks_of(wider[1], evaluator)
    checks_of(wider[1], evaluator)
    assert len(meshed) < 2 * first  # the engraving and the block are others, the finger is not
    before = len(meshed)
    checks_of(wider[0], evaluator)
    assert len(meshed) == before


@pytest.mark.parametrize(
    "changes",
    [
        [],
        ["mold.wall_mm=5"],
        ["printer.scale_percent=101", "mold.method=sleeve"],
        ["bone.interface=socket", "bone.base_length_mm=32"],
        ["mold.wall_mm=4.5", "bone.channel_diameter_mm=2"],
    ],
)
def test_checks_on_the_memory_are_those_of_verify(changes: list[str]) -> None:
    design = Design.load(changes=changes)
    alone = [as_data(check) for check in verify(design, parts_by_name(design), ("stl",), MeshEvaluator(COARSE)).checks]
    assert [as_data(check) for check in checks_of(design, EVALUATOR)] == alone  # after other designs
    evaluated = EVALUATOR.evaluated
    assert [as_data(check) for check in checks_of(design, EVALUATOR)] == alone
    assert EVALUATOR.evaluated == evaluated  # all of it remembered
    # What was computed after other designs is what it is by itself, to the last bit.
    assert checks_of(design, EVALUATOR) == checks_of(design, CachedEvaluator(COARSE))


EVALUATOR = CachedEvaluator(COARSE)


def test_the_memory_forgets_what_was_not_used_for_longest() -> None:
    memory: Memory[str, int] = Memory(10)
    memory.put("a", 1, 4)
    memory.put("b", 2, 4)
    assert memory.get("a") == 1
    memory.put("c", 3, 4)
    assert (memory.get("a"), memory.get("b"), memory.get("c")) == (1, None, 3)
    memory.put("d", 4, 99)
    assert (len(memory), memory.get("d"), memory.weight) == (1, 4, 99)
    memory.put("d", 5, 1)
    assert (memory.get("d"), memory.weight) == (5, 1)


def test_evaluated_solids_stay_within_their_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    evaluator = CachedEvaluator(COARSE)
    evaluator._solids.maximum = 20_000
    assert MAX_TRIANGLES > 20_000
    made = plan(outputs=["skin_volume_mm3"], axes={"skin.width_mm": [17.0]})
    for i in range(40):
        design = Design.load(changes=[f"skin.width_mm={17 + i / 100}"])
        compute.skin(compute.Asked(design, None, made.file, lambda: evaluator))
    assert evaluator._solids.weight <= 20_000
    assert evaluator.evaluated > len(evaluator._solids)


class Poison:
    """Whoever reads a table that it did not announce is caught."""

    def __getattr__(self, name: str) -> Any:
        raise AssertionError(f"reads {name}")


def test_rules_of_the_finger_do_not_read_the_signal() -> None:
    without = DesignTables().model_copy(update=dict.fromkeys(SIGNAL, Poison()))
    kept = [rule for rule in RULES if not any(name.partition(".")[0] in SIGNAL for name in rule.reads)]
    assert len(kept) > 20
    for rule in kept:
        rule.check(without)
    with pytest.raises(AssertionError, match="reads"):
        [rule.check(without) for rule in RULES]


AWKWARD: dict[str, Any] = {
    "board.cutoff_hz": {"low": 1.0, "high": 9000.0, "spacing": "logarithmic"},
    "board.capacitor_uf": {"low": 1e-5, "high": 900.0, "spacing": "logarithmic"},
    "board.envelope_cutoff_hz": {"low": 1.0, "high": 9000.0, "spacing": "logarithmic"},
    "board.passband_gain": {"low": 1.01, "high": 9000.0, "spacing": "logarithmic"},
    "board.supply_v": {"low": 5.0, "high": 6.0},
    "board.variant": ["article", "precision", "comparator"],
    "detector.sample_rate_hz": {"low": 1000.0, "high": 20000.0},
    "detector.window_samples": {"low": 1, "high": 10000},
    "detector.threshold_v": {"low": 0.001, "high": 9.0, "spacing": "logarithmic"},
}


def test_the_quick_way_refuses_what_the_whole_design_refuses_in_the_same_words() -> None:
    made = plan(sampling="latin_hypercube", points=150, seed=3, axes=AWKWARD, outputs=["q"])
    quick, whole = Designs(made), Designs(made)
    assert quick._quick
    whole._quick = False
    refused = 0
    for number in range(made.size):
        changes = made.point(number)
        results = []
        for way in (quick, whole):
            try:
                results.append(way.design(changes))
            except Exception as error:
                results.append(str(error))
        refused += isinstance(results[0], str)
        assert results[0] == results[1]
    assert 40 < refused < 150


def test_boards_are_those_that_the_board_itself_computes() -> None:
    names = ["board.r1_ohm", "board.r2_ohm", "board.r3_ohm", "board.r4_ohm", "board.r5_ohm", "board.r_lp_ohm"]
    made = plan(
        sampling="latin_hypercube",
        points=80,
        seed=5,
        outputs=[*names, "board.c_uf", "q", "gain", "cutoff_3db_hz", "envelope_decay_ms"],
        axes={
            "board.cutoff_hz": {"low": 20.0, "high": 400.0, "spacing": "logarithmic"},
            "board.passband_gain": {"low": 5.0, "high": 300.0, "spacing": "logarithmic"},
            "board.capacitor_uf": {"low": 0.1, "high": 2.0, "spacing": "logarithmic"},
            "board.capacitor_series": ["given", "E12"],
            "board.series": ["E12", "E24", "E96"],
        },
    )
    bench, compared = Bench(made), 0
    for number in range(made.size):
        changes = made.point(number)
        _, status, _, _, outputs = bench.outcome(number, changes)
        if status == "ok":
            values = board_values(Design.load(changes=[f"{name}={value}" for name, value in changes.items()]))
            fitted, achieved = values.preferred, values.achieved
            expected = [getattr(fitted, name.partition(".")[2]) for name in names]
            expected += [1e6 * fitted.c_f, achieved.section_quality, achieved.passband_gain, achieved.cutoff_hz]
            assert outputs == tuple(round(value, 6) for value in [*expected, 1e3 * achieved.envelope_decay_s])
            compared += 1
    assert compared > 60


@pytest.mark.parametrize(("variant", "detector"), [("precision", "fast"), ("comparator", "analog")])
def test_what_is_simulated_does_not_depend_on_the_decision(variant: str, detector: str) -> None:
    made = plan(
        outputs=["delay_ms", "found_share", "slips"],
        trials=1,
        detector=detector,
        scene={"slide": {"distance_m": 0.01, "speed_m_s": 0.08}, "hold": {"wait_s": 0.1}},
        design={"board": {"variant": variant}},
        axes={"detector.window_samples": [20, 90], "detector.threshold_v": [0.012, 0.03]},
    )
    bench = Bench(made)
    together = [bench.outcome(i, made.point(i)) for i in range(made.size)]
    assert len(bench._traces) == 1
    alone = [Bench(made).outcome(i, made.point(i)) for i in range(made.size)]
    assert repr(together) == repr(alone)
    assert {row[1] for row in together} == {"ok"}
    assert {row[4][2] for row in together} == {1.0}


def everything(stage: str) -> list[str]:
    return [output.name for output in OUTPUTS.values() if output.stage == stage]


@pytest.mark.parametrize("stage", ["lengths", "board", "noise", "skin", "bone", "halves", "thickness", "casting"])
def test_a_stage_depends_on_no_table_it_does_not_announce(stage: str) -> None:
    base = Design()
    made = plan(outputs=everything(stage), tolerance_mm=COARSE, axes={"skin.width_mm": [17.0]})

    def figures(design: Design) -> dict[str, float]:
        evaluator = CachedEvaluator(COARSE)
        return compute.COMPUTE[stage](compute.Asked(design, None, made.file, lambda: evaluator))

    first = figures(base)
    assert set(first) == set(everything(stage))
    # The tables it does not announce, replaced by poison: dimensions are derived before.
    _ = base.dimensions
    others = [name for name in DesignTables.model_fields if name not in STAGES[stage].reads]
    poisoned = base.model_copy(update={name: Poison() for name in others})
    assert figures(poisoned) == first
    assert others


def test_every_output_has_a_stage_that_gives_it() -> None:
    assert {output.stage for output in OUTPUTS.values()} == set(STAGES) == set(compute.COMPUTE)


def test_neighbours_share_the_dear_stages_and_no_point_is_left_out() -> None:
    made = plan(
        outputs=["checks_failed", "q"],
        axes={"board.cutoff_hz": [60.0, 67.0], "skin.width_mm": [17.0, 18.0, 19.0], "mold.wall_mm": [4.0, 5.0]},
    )
    order = [int(p) for part in range(0, 12, 5) for p in made.in_order(part, part + 5)]
    assert sorted(order) == list(range(12))
    points = [made.point(p) for p in order]
    for name, changes in (("skin.width_mm", 2), ("mold.wall_mm", 5)):
        assert sum(a[name] != b[name] for a, b in itertools.pairwise(points)) == changes


def test_a_plan_reads_back_as_it_was_written() -> None:
    made = plan(scene={"slide": {"distance_m": 0.04}}, minimise=["q"], design={"skin": {"width_mm": 18}})
    again = Plan.from_toml(made.to_toml())
    assert again.to_toml() == made.to_toml()
    assert [again.point(i) for i in range(made.size)] == [made.point(i) for i in range(made.size)]
    assert again.design.skin.width_mm == 18.0
