"""Sweeps of a set: its fingers change together, and what the
whole set takes is computed for each point.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.verify import verify
from fingertip.casting.mixture import measure_poured_cm3, mix
from fingertip.design.finger_set import load_set
from fingertip.foundation.errors import SweepError
from fingertip.models.parts import PARTS, parts_by_name
from fingertip.sweep.database import SweepDatabase
from fingertip.sweep.outputs import GROUPS, SET_GROUPS, load_outputs
from fingertip.sweep.point_evaluator import PointEvaluator
from fingertip.sweep.report.report_files import write_report
from fingertip.sweep.sweep_plan import SweepPlan
from tests.conftest import ROOT

HAND = ROOT / "params" / "sweeps" / "hand.toml"
COARSE_MM = 0.3
"""Tolerance of the meshes, coarse because only sums matter here [mm]."""


def load_plan(*changes: str) -> SweepPlan:
    return SweepPlan.load(HAND, [f"tolerance_mm={COARSE_MM}", *changes])


def evaluate(plan: SweepPlan, point: int) -> dict[str, Any]:
    _, status, field, reason, outputs = PointEvaluator(plan).evaluate(point, plan.point(point))
    return {
        "status": status,
        "field": field,
        "reason": reason,
        **dict(zip(plan.outputs, outputs, strict=True)),
    }


def test_set_may_stand_beside_the_sweep_with_a_design_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text('name = "own"\nskin.width_mm = 17\n')
    (tmp_path / "mine.toml").write_text(
        'name = "mine"\nside = "left"\n[fingers.ring]\ndesign = "own.toml"\n'
    )
    (tmp_path / "sweep.toml").write_text(
        'design = "mine.toml"\noutputs = ["set_forms"]\n[axes]\nmold.wall_mm = [4]\n'
    )
    plan = SweepPlan.load(tmp_path / "sweep.toml")
    assert (plan.file.design["side"], list(plan.designs), plan.designs["ring"].skin.width_mm) == (
        "left",
        ["ring"],
        17,
    )
    (tmp_path / "mine.toml").write_text('name = "mine"\n[fingers.ring]\ndesign = "../own.toml"\n')
    with pytest.raises(SweepError, match="is no name of a file beside the set"):
        SweepPlan.load(tmp_path / "sweep.toml")


def test_outputs_of_a_set_and_of_one_finger_are_told_apart() -> None:
    for base, output in (("adult_hand", "q"), ("adult_finger", "set_days")):
        plan = [
            f"design={base}",
            f'outputs=["set_forms", "skin_area_mm2", "{output}"]',
            "minimise=[]",
        ]
        with pytest.raises(
            SweepError, match=rf"outputs: \w+(_mm2)?, {output} can be computed|{output} can be"
        ) as error:
            load_plan(*plan)
        (issue,) = error.value.issues
        name = issue.message.rpartition(" = ")[2].strip('".')
        assert load_plan(f"design={name}", f'outputs=["{output}"]', "minimise=[]").outputs == (
            output,
        )


def test_an_axis_or_a_change_of_one_finger_leaves_the_others_alone() -> None:
    axes = (
        "axes.silicone.product=[ecoflex_00_30]",
        "axes.mold.wall_mm=[4]",
        "axes.fingers.thumb.mold.wall_mm=[5]",
    )
    evaluator = PointEvaluator(load_plan(*axes, "fingers.ring.mold.engraving_depth_mm=0.4"))
    _, fingers, _ = evaluator._build_inputs(evaluator.plan.point(0))
    assert fingers
    assert {name: design.mold.wall_mm for name, design in fingers.designs.items()} == {
        "thumb": 5.0,
        "index": 4.0,
        "middle": 4.0,
        "ring": 4.0,
        "little": 4.0,
    }
    assert (
        fingers.designs["ring"].mold.engraving_depth_mm
        == 0.4
        != fingers.designs["index"].mold.engraving_depth_mm
    )
    # A board of its own parts a finger from its form, though no part depends on the board.
    assert GROUPS["set"].depends_on("fingers.ring.board.cutoff_hz")
    assert not GROUPS["set"].depends_on("board.cutoff_hz")
    for broken in (
        {"fingers": 5},
        {"name": "x", "fingers": {"thumb": 5}},
        {"side": "up", "fingers": {}},
    ):
        with pytest.raises(SweepError, match=r"(?m)^design\."):
            SweepPlan.from_tables(
                {"outputs": ["set_forms"], "axes": {"mold.wall_mm": [4.0]}, "design": broken}
            )
    with pytest.raises(SweepError, match=r"axes\.fingers\.tumb\..*did you mean thumb\?"):
        load_plan("axes.fingers.tumb.mold.wall_mm=[4]")
    with pytest.raises(SweepError, match="has no finger tumb; did you mean thumb"):
        load_plan("fingers.tumb.mold.wall_mm=4")
    with pytest.raises(SweepError, match="fsr400 is no set of fingers"):
        SweepPlan.load(
            ROOT / "params" / "sweeps" / "geometry.toml", ["fingers.thumb.mold.wall_mm=4"]
        )
    with pytest.raises(
        SweepError, match=r"fingers\.thumb\..*names a finger that design does not have; name a set"
    ):
        SweepPlan.load(
            ROOT / "params" / "sweeps" / "geometry.toml", ["axes.fingers.thumb.mold.wall_mm=[4]"]
        )
    with pytest.raises(SweepError, match="is a table of a set"):
        SweepPlan.load(
            ROOT / "params" / "sweeps" / "pad.toml", ["design={fingers={thumb={name='x'}}}"]
        )


@pytest.mark.full
def test_rule_that_one_finger_breaks_names_it() -> None:
    axes = "axes={mold.wall_mm=[4, 5]}"
    with pytest.raises(SweepError) as error:
        load_plan("skin.thickness_palmar_mm=2.5", axes)
    assert {issue.field.split(".")[2] for issue in error.value.issues} >= {"thumb"}
    plan = load_plan("axes.skin.thickness_palmar_mm=[2.5, 3.65]", "axes.mold.wall_mm=[4]")
    refused = next(
        row
        for row in map(lambda k: evaluate(plan, k), range(plan.size))
        if row["status"] == "refused"
    )
    assert refused["field"].startswith("fingers.thumb: ")


@pytest.fixture(scope="module")
def row() -> dict[str, Any]:
    every = [name for name, output in load_outputs().items() if output.group in SET_GROUPS]
    return evaluate(
        load_plan(
            f"outputs={every}", "axes.mold.wall_mm=[4]", 'axes.silicone.product=["ecoflex_00_30"]'
        ),
        0,
    )


@pytest.mark.full
def test_figures_of_a_set_are_the_sums_of_its_parts(row: dict[str, Any]) -> None:
    fingers = load_set("adult_hand", ["silicone.product=ecoflex_00_30", "mold.wall_mm=4"])
    assert (row["status"], row["set_forms"], row["set_mixtures"], row["set_days"]) == (
        "ok",
        5,
        1,
        3,
    )
    evaluator = MeshEvaluator(COARSE_MM)
    poured_cm3 = 0.0
    masses = {"fingers": 0.0, "molds": 0.0}
    checks = list[Any]()
    for design in fingers.designs.values():
        for part, shape in parts_by_name(design).items():
            if shape.is_printed:
                group = "fingers" if PARTS[part].is_in_finger else "molds"
                masses[group] += 1.2e-3 * evaluator.mesh(shape.solid(design)).volume()
        checks += verify(design, parts_by_name(design), ("stl",), MeshEvaluator(COARSE_MM)).checks
        poured_cm3 += measure_poured_cm3(design, evaluator)
    assert (row["set_fingers_g"], row["set_molds_g"]) == pytest.approx(
        tuple(masses.values()), abs=0.02
    )
    failed = sum(not check.passed for check in checks)
    assert (row["set_checks_failed"], row["set_checks_run"]) == (failed, len(checks))
    silicone = fingers.forms[0].design.silicone.material
    assert row["set_silicone_g"] == pytest.approx(mix(silicone, poured_cm3).total_g, abs=0.5)


@pytest.mark.full
def test_best_set_is_a_file_that_makes_its_row_again(tmp_path: Path) -> None:
    plan = load_plan("axes.mold.wall_mm=[3, 4, 5]")
    with SweepDatabase.create(tmp_path / "sweep", plan) as database:
        for number in range(plan.size):
            point = plan.point(number)
            wall_mm = point["mold.wall_mm"]
            known = {"set_molds_g": wall_mm, "set_checks_failed": float(wall_mm == 3.0)}
            database.add(
                [
                    (
                        number,
                        "ok",
                        "",
                        "",
                        *point.values(),
                        *(known.get(name, 0.0) for name in plan.outputs),
                    )
                ]
            )
        report = write_report(database, tmp_path)
    assert report["feasible"] == 6, "a set that fails checks cannot be made"
    # Silicones change no mass: the two others tie with the first.
    told = "2 other points have the same value of every objective; add one to choose among them."
    assert report["best_summary"].endswith(told)
    assert "try a tolerance_mm below 0.3." in report["text"]
    best = load_set(tmp_path / "best.toml")
    changes = [f"{name}={value}" for name, value in plan.point(1).items()]
    assert best == replace(load_set("adult_hand", changes), name="hand_best")
