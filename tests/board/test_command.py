"""`fingertip board` in fresh processes: output, errors, files, and what it does not import."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.board.test_netlist import FILES
from tests.conftest import run_fingertip, run_python

FORBIDDEN = ("cadquery", "OCP", "trimesh", "vtk", "numba", "scipy", "matplotlib", "numpy", "manifold3d")


def test_table_and_files(tmp_path: Path) -> None:
    run = run_fingertip("board", "--out", tmp_path / "deep" / "pcb")
    assert run.returncode == 0
    for figure in ("2375.4", "1187.7", "4750.9", "2.4k", "1.2k", "4.7k", "67.2505", "0.989529", "67.67 (36.61 dB)"):
        assert figure in run.stdout
    assert run.stderr.count("wrote ") == len(FILES)
    assert sorted(p.name for p in (tmp_path / "deep" / "pcb").iterdir()) == FILES


def test_json_and_quiet(tmp_path: Path) -> None:
    design = tmp_path / "mine.toml"
    design.write_text('[board]\nseries = "E12"\n')
    run = run_fingertip("board", design, "--out", tmp_path, "--json", "--quiet", "--set", "board.series=E96")
    assert (run.returncode, run.stderr) == (0, "")
    data = json.loads(run.stdout)
    assert {"ideal", "preferred", "achieved", "findings", "files"} <= set(data)
    assert data["preferred"]["r1_ohm"] == 2370.0
    assert round(data["achieved"]["cutoff_hz"], 2) == 67.06
    assert all({"subject", "says", "right"} == set(finding) for finding in data["findings"])
    assert sorted(Path(name).name for name in data["files"]) == FILES
    assert all(Path(name).is_file() for name in data["files"])
    kept = json.loads((tmp_path / "values.json").read_text())
    assert kept["parameters"]["series"] == "E96"
    assert all(kept[key] == data[key] for key in ("ideal", "preferred", "achieved", "findings"))


def test_default_folder_is_pcb(tmp_path: Path) -> None:
    run = run_fingertip("board", "--quiet", PWD=str(tmp_path))
    assert run.returncode == 0
    assert (tmp_path / "pcb" / "slip_filter.net").is_file()


def test_bad_input_says_everything_and_touches_nothing(tmp_path: Path) -> None:
    (tmp_path / "slip_filter.net").write_text("mine")
    changes = ("board.capacitor_uf=1000", "board.series=E6", "board.gain=5", "board.supply_v=nan")
    run = run_fingertip("board", "--out", tmp_path, "--json", *(a for c in changes for a in ("--set", c)))
    assert run.returncode == 2
    lines = run.stderr.splitlines()
    fields = {"board.capacitor_uf", "board.series", "board.gain", "board.supply_v"}
    assert {line.split(": ")[1] for line in lines} == fields
    assert len(lines) == 4
    assert {issue["field"] for issue in json.loads(run.stdout)["issues"]} == fields
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("slip_filter.net", "mine")]


def test_missing_design_file(tmp_path: Path) -> None:
    run = run_fingertip("board", tmp_path / "none.toml", "--out", tmp_path / "out")
    assert run.returncode == 2
    assert "none.toml: cannot be read" in run.stderr
    assert not (tmp_path / "out").exists()


def test_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    run = run_fingertip("board", "--out", tmp_path / "file" / "pcb")
    assert run.returncode == 2
    assert "choose another folder with --out" in run.stderr
    assert len(run.stderr.splitlines()) == 1


@pytest.mark.parametrize("arguments", [["board", "--out", "OUT"], ["board", "--out", "OUT", "--json"]])
def test_heavy_modules_stay_out(tmp_path: Path, arguments: list[str]) -> None:
    script = (
        "import sys, contextlib, io\n"
        "from fingertip.cli import app\n"
        "with contextlib.redirect_stdout(io.StringIO()):\n"
        "    app(sys.argv[1:], standalone_mode=False)\n"
        f"print([name for name in {FORBIDDEN!r} if name in sys.modules])\n"
    )
    run = run_python("-c", script, *(a.replace("OUT", str(tmp_path)) for a in arguments))
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip() == "[]"
    assert (tmp_path / "values.json").is_file()


LOUD = ("board.variant=precision", "board.passband_gain=300", "board.gain_bandwidth_hz=1e7")
SHORT = ("board.variant=comparator", "detector.sample_rate_hz=10000", "detector.window_samples=60")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ((*LOUD, "detector.threshold_v=0.004"), ["rest at 10.9 mV, and detector.threshold_v is 4 mV"]),
        (LOUD, []),
        (SHORT, ["detector.window_samples of 60 at 10000 Hz last 6 ms"]),
        (SHORT[:1], []),
    ],
)
def test_what_a_board_does_badly_is_warned_of(tmp_path: Path, changes: tuple[str, ...], words: list[str]) -> None:
    run = run_fingertip("board", "--out", tmp_path, "--json", *(a for c in changes for a in ("--set", c)))
    assert run.returncode == 0
    told = [line for line in run.stderr.splitlines() if line.startswith("warning: ")]
    assert len(told) == len(words)
    assert all(part in line for part, line in zip(words, told, strict=True))
    assert [f"warning: {sentence}" for sentence in json.loads(run.stdout)["warnings"]] == told
