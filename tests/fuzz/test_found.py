"""What the fuzzer found, each case by name.

It gave a traceback once, and is a sentence or a result now.
"""

from __future__ import annotations

import sqlite3
from pathlib import Path

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import DesignError, SweepError, TraceError
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sweep.axes import Axis, round_significant
from fingertip.sweep.sweep_plan import SweepPlan
from tests.conftest import run_fingertip
from tools.fuzz import originals


@pytest.mark.parametrize("refuse", [SceneFile, ManipulationFile])
def test_a_parameter_named_self(refuse: type[SceneFile], tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("self = 1\n")
    with pytest.raises(TraceError, match="self: there is no such parameter"):
        refuse.load(tmp_path / "a.toml")
    with pytest.raises(TraceError, match=r"tap\.self|grasp\.self"):
        refuse(**{"tap" if refuse is SceneFile else "grasp": {"self": 1}})
    with pytest.raises(DesignError, match="self: there is no such parameter"):
        Design(**{"self": 1})


@pytest.mark.parametrize("least", [5e-324, 1e-320, 2.5e-308, 1e-300])
def test_an_axis_of_the_smallest_numbers(least: float) -> None:
    values = round_significant(np.array([least, -least, 0.0, 1.0]))
    assert values == pytest.approx([least, -least, 0.0, 1.0], rel=1e-8, abs=1e-307)


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        (
            "UPDATE meta SET value = '= 1' WHERE key = 'plan'",
            "the description of its sweep cannot be read",
        ),
        ("CREATE TABLE other (a)", "it holds other tables than a sweep"),
        ("UPDATE meta SET value = '[' || hex(zeroblob(3000)) WHERE key = 'plan'", "cannot be read"),
        ("UPDATE rows SET point = 99 WHERE point = 2", "row 99 is damaged"),
        ("UPDATE rows SET status = 'odd'", "row 0 is damaged"),
        ("UPDATE rows SET reason = 5", ""),
        ("UPDATE rows SET cutoff_3db_hz = 'x'", "row 0 holds what is no number"),
        ('UPDATE rows SET "board.cutoff_hz" = NULL', "row 0 holds what is no number"),
        (
            "UPDATE rows SET reason = CAST(x'1bff' AS TEXT)",
            "a text in it cannot be read (Could not decode to UTF-8",
        ),
        ("UPDATE rows SET field = hex(zeroblob(400))", "row 0 is damaged"),
        (
            "UPDATE rows SET cutoff_3db_hz = -1e308",
            "cutoff_3db_hz is beyond 1e+100, or nearer to 0 than 1e-100",
        ),
        ("UPDATE rows SET cutoff_3db_hz = 1e-320", "cutoff_3db_hz is beyond 1e+100"),
        (
            "UPDATE meta SET value = 'scene = 5' || char(10) || value WHERE key = 'plan'",
            "(scene: 5 is not a table",
        ),
    ],
)
def test_a_damaged_database_of_a_sweep(tmp_path: Path, statement: str, message: str) -> None:
    (tmp_path / "sweep.sqlite").write_bytes(originals.sweep_database())
    with sqlite3.connect(tmp_path / "sweep.sqlite") as connection:
        connection.execute(statement)
    connection.close()
    done = run_fingertip("sweep", "--show", "--out", tmp_path, "--csv", tmp_path / "a.csv")
    assert done.returncode == (2 if message else 0), done.stderr
    if message:
        assert "is damaged: " in done.stderr
        assert message in done.stderr
        assert "restore it from a copy, or run the sweep again in another folder." in done.stderr


def test_taps_of_days_are_refused_with_a_value_that_passes() -> None:
    taps = {"force_n": 1.0, "count": 1000, "interval_s": 600.0}
    with pytest.raises(
        TraceError, match=r"lets 1000 taps last more than 3600 s; at most 3\.6 s"
    ) as caught:
        SceneFile(tap=taps)
    most = float(str(caught.value).rpartition("at most ")[2].removesuffix(" s."))
    SceneFile(tap=taps | {"interval_s": most})


def test_the_shortest_knock_that_a_message_names_passes() -> None:
    for speed_m_s in np.linspace(0.06, 0.2, 141).round(3).tolist():
        with pytest.raises(TraceError, match="too short to stop") as caught:
            ManipulationFile(
                scene="s", knock={"speed_m_s": speed_m_s, "stroke_m": 1e-9 + 0.4 * speed_m_s**2}
            )
        least = float(str(caught.value).rpartition("at least ")[2].removesuffix(" m."))
        ManipulationFile(scene="s", knock={"speed_m_s": speed_m_s, "stroke_m": least})


def test_no_change_of_load_ends_no_contact_of_the_smallest_share() -> None:
    assert SceneFile(hold={"share": 0.001}, load_change={"by_n": 0.0}).load_change.by_n == 0.0


def test_a_grid_of_many_axes_is_refused_before_their_values_are_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[str] = []
    monkeypatch.setattr(Axis, "values", property(lambda axis: made.append(axis.name) or ()))
    steps = {"low": 14.0, "high": 14.5, "steps": 100_000}
    tables = {
        "outputs": [],
        "axes": {name: steps for name in ("skin.width_mm", "skin.length_mm", "mold.wall_mm")},
    }
    with pytest.raises(
        SweepError, match=r"make a grid of 1000000000000000 points; give at most 100000000"
    ):
        SweepPlan.from_tables(tables)
    assert made == []


def test_a_converter_whose_steps_would_be_zero() -> None:
    with pytest.raises(
        DesignError, match=r"detector\.adc_range_v: 5e-324 V is too small; at least 0\.01 V"
    ):
        Design(detector={"adc_range_v": 5e-324})
    for low_v, high_v, least_v in ((99.99, 5.0, 100.0), (0.0, 5e-324, 0.01)):
        with pytest.raises(TraceError, match=rf"above converter\.low_v; at least {least_v:g} V\."):
            SceneFile(converter={"bits": 12, "low_v": low_v, "high_v": high_v})
        SceneFile(converter={"bits": 12, "low_v": low_v, "high_v": least_v})


def test_a_range_to_an_integer_beyond_every_float() -> None:
    with pytest.raises(SweepError, match="is not a finite number"):
        SweepPlan.from_tables(
            {"outputs": [], "axes": {"skin.width_mm": {"low": 14, "high": 10**400, "steps": 3}}}
        )
