"""Files of another kind than a command takes, files as Windows saves them, and results that cannot be written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from fingertip.cli import app
from tests.conftest import ROOT, design_file, run_python

PARAMS = ROOT / "params"
SWEEP, SCENE = PARAMS / "sweeps" / "board.toml", PARAMS / "scenes" / "hard_tap.toml"
HAND = PARAMS / "scenes" / "real_manipulation.toml"
OF_HAND = "is a manipulation file, not a design file; give one such as fsr400 (`fingertip simulate`"


def run(*words: object) -> Any:
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.mark.parametrize(
    ("command", "file", "answer"),
    [
        ("build", SWEEP, "is a sweep file, not a design file; give one such as fsr400 (`fingertip sweep` takes"),
        ("check", SCENE, "is a scene file, not a design file; give one such as fsr400 (`fingertip simulate` takes"),
        *((command, HAND, OF_HAND) for command in ("sheet", "params", "picture", "drawing", "board", "validate")),
    ],
)
def test_a_file_of_another_kind_is_named_with_its_command(command: str, file: Path, answer: str) -> None:
    done = run(command, file)
    assert done.exit_code == 2
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"error: {file}: {answer}")


def test_commands_that_take_other_kinds_name_the_kind_too() -> None:
    for words, answer in (
        (("simulate", SWEEP), "is a sweep file, not a design file"),
        (("simulate", SCENE, "--design", HAND), "is a manipulation file, not a design file"),
        (("detect", "t.csv", "--design", SCENE), "is a scene file, not a design file"),
        (("sweep", HAND), "is a manipulation file, not a sweep file"),
        (
            ("sweep", design_file("fsr400")),
            "is a design file, not a sweep file; give one such as board (`fingertip build` takes",
        ),
    ):
        done = run(*words)
        assert done.exit_code == 2
        assert len(done.stderr.splitlines()) == 1
        assert answer in done.stderr


def test_a_design_with_an_unknown_name_is_not_taken_for_another_kind(tmp_path: Path) -> None:
    (tmp_path / "d.toml").write_text("[skin]\nwidht_mm = 18\n")
    assert "did you mean skin.width_mm?" in run("params", tmp_path / "d.toml").stderr
    assert run("params", design_file("fsr400"), "--set", "tap.force_n=2").stderr.count("is a scene") == 0


@pytest.mark.full
def test_files_with_a_byte_order_mark(tmp_path: Path) -> None:
    def marked(file: Path) -> Path:
        path = tmp_path / file.name
        path.write_bytes(b"\xef\xbb\xbf" + file.read_bytes().replace(b"\n", b"\r\n"))
        return path

    assert run("params", marked(design_file("fsr402"))).exit_code == 0
    for file in (SCENE, HAND):
        shown = run("simulate", marked(file), "--parameters")
        assert shown.stdout == run("simulate", file, "--parameters").stdout
    sweep = tmp_path / "s.toml"
    sweep.write_text('\ufeffname = "s"\noutputs = ["gain"]\n[axes]\nboard.series = ["E24"]\n')
    assert run("sweep", sweep, "--out", tmp_path / "rows", "--jobs", 1, "--quiet").exit_code == 0


def test_long_values_are_shown_in_full() -> None:
    shown = run("params", "--set", "detector.threshold_v=1.23456789e-05", "--set", "name=a_rather_long_name").stdout
    assert "a_rather_long_name " in shown
    assert "1.23456789e-05  V" in shown
    assert "fsr402_short " in run("params", design_file("fsr402")).stdout
    assert '["voltage_v", "force_n", "slip"] ' in run("simulate", HAND, "--parameters").stdout


def test_params_gives_a_design_as_text_in_json() -> None:
    plain, as_json = run("params", "--toml").stdout, run("params", "--toml", "--json").stdout
    assert json.loads(as_json) == {"toml": plain}


def test_a_speed_is_refused_where_nothing_slides() -> None:
    done = run("simulate", SCENE, "--speed-m-s", "0.05")
    assert done.exit_code == 2
    assert "--speed-m-s: 0.05 m/s has no effect, because nothing slides here; leave it out" in done.stderr
    slides = run("simulate", SCENE, "--speed-m-s", "0.05", "--set", "slide.distance_m=0.04", "--parameters")
    assert slides.exit_code == 0


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full disk to offer")
@pytest.mark.parametrize("words", [("params",), ("params", "--json"), ("params", "--schema"), ("--version",)])
def test_results_that_cannot_be_written(words: tuple[str, ...]) -> None:
    script = (
        "import os, sys\nos.dup2(os.open('/dev/full', os.O_WRONLY), 1)\n"
        "from fingertip.cli import app\napp(sys.argv[1:])\n"
    )
    done = run_python("-c", script, *words)
    assert done.returncode == 2
    assert (
        done.stderr == "error: standard output: cannot be written (No space left on device); redirect it elsewhere.\n"
    )


def test_empty_design_file_is_noted(tmp_path: Path) -> None:
    (tmp_path / "empty.toml").write_text("")
    done = run("params", tmp_path / "empty.toml")
    assert done.exit_code == 0
    assert "empty.toml sets no parameter: this is the default design" in done.stderr
    assert not run("params", tmp_path / "empty.toml", "--quiet").stderr


@pytest.mark.parametrize(
    ("change", "answer"),
    [
        ("skin=18", "skin: 18 is not a table; set its parameters one by one, such as skin.width_mm=17."),
        ("skin.width_mm=18,mold.draft_deg=2", "holds several changes; give --set once for each of them."),
        ("skin.width_mm=18 mm", "'18 mm' is not a number; write the number in mm, without its unit."),
        ("name=5", 'name: 5 is not text; write it in quotes, such as "5".'),
        ("sensor.modle=x", "did you mean sensor.model?"),
        ("skin.colour=1", "there is no such parameter; known names: width_mm, "),
    ],
)
def test_change_that_cannot_be_used_is_refused_with_a_remedy(change: str, answer: str) -> None:
    done = run("params", "--set", change)
    assert done.exit_code == 2
    assert answer in done.stderr
