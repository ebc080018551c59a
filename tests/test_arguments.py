"""Errors in Python speak of arguments, and those of the command line of options."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fingertip
from fingertip import Design, FingertipError, Trace
from fingertip.foundation.arguments import as_arguments
from fingertip.foundation.errors import Issue


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("use --rate-hz 1000 to adapt its filters.", "use rate_hz=1000 to adapt its filters."),
        ("with --rate-hz 2e3 --column time_s=none;", 'with rate_hz=2e3, columns={"time_s": "none"};'),
        ("use --set a.b=precision --set c.d=3.3", 'use changes={"a.b": "precision", "c.d": 3.3}'),
        ("--set a.b=true or --set c.d='x y', both", "changes={\"a.b\": True} or changes={\"c.d\": 'x y'}, both"),
        ("add --time-scale ms.", "add time_scale=1e-3."),
        ("choose --calibrate 0:0.5; leave --fab out", "choose calibrate_s=(0, 0.5); leave fab out"),
        ("another folder with --out, or add --force", "another folder with out, or add force=True"),
        ("use --formats stl,3mf.", 'use formats=["stl", "3mf"].'),
        ("`fingertip board DESIGN --bringup` writes --out", "`fingertip board DESIGN --bringup` writes out"),
        ("uv pip install --python /bin/python; a--b", "uv pip install --python /bin/python; a--b"),
    ],
)  # fmt: skip
def test_options_become_arguments(typed: str, said: str) -> None:
    assert as_arguments(typed) == said
    issue = Issue("--speed-m-s", typed)
    assert (issue.typed, str(issue)) == (f"--speed-m-s: {typed}", f"speed_m_s: {said}")


def stated() -> Design:
    return Design.load(changes={"detector.sample_rate_hz": 2000})


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda folder: fingertip.detect(Trace(np.arange(999) / 1e3, np.zeros(999)), stated()), "use rate_hz=1000"),
        (lambda folder: fingertip.detect(np.zeros(999), detector="slow", rate_hz=2e3), "detector: 'slow'"),
        (lambda folder: fingertip.read_trace(folder / "t.csv", columns={"volts": "a"}), "columns: 'volts'"),
        (lambda folder: fingertip.read_trace(folder / "t.csv", rate_hz=-1.0), "rate_hz: -1 Hz"),
        (lambda folder: fingertip.detect_file(folder / "t.csv"), "rate_hz"),
        (lambda folder: fingertip.detect_file("t.csv", columns={"voltage_v": "force_n"}), "calibrate_s: is missing"),
        (lambda folder: fingertip.Trial(speed_m_s=-1.0, seed=-1), "speed_m_s: -1 m/s is refused"),
        (lambda folder: fingertip.build(Design(), formats=["obj"]), "formats: 'obj'"),
        (lambda folder: fingertip.build(Design(), folder, parts=["core"]), 'changes={"mold.method": "sleeve"}'),
        (lambda folder: fingertip.write_board(Design(), folder / "t.csv"), "choose another folder with out"),
        (lambda folder: fingertip.check(Design(), tolerance_mm=9.0), "tolerance_mm: 9 mm"),
        (lambda folder: Design.load(changes=["bone"]), "changes bone: is not of the form"),
        (lambda folder: fingertip.CampaignPlan(0, 0.0), "negative_minutes: 0 min"),
        (lambda folder: fingertip.validate(Design(), first_seed=7), "seed: 7 is refused"),
        (lambda folder: fingertip.calibrate_sensor(Design(), fingertip.read_weighings(folder / "t.csv")), "t.csv"),
        (lambda folder: fingertip.read_readings(folder / "t.csv", Design()), "t.csv"),
    ],
)  # fmt: skip
def test_functions_name_their_arguments(call: Callable[[Path], Any], said: str, tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("voltage_v,force_n\n1,2\n1,2\n", encoding="utf-8")
    with pytest.raises(FingertipError, match=re.escape(said)) as refused:
        call(tmp_path)
    assert not re.search(r"(?m)(?:^|\s)--[a-z]", str(refused.value))
