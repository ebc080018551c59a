"""`fingertip new` for a hand: a set and its designs from the sizes of the fingers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fingertip.design import Design
from fingertip.design.finger_set import load_set
from fingertip.fitting.new_set import fit_set, start_set, write_set_file
from fingertip.pad.survey import survey_pad
from tests.conftest import run_fingertip


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_everything_that_is_wrong_is_said_at_once_before_a_fit(folder: Path) -> None:
    (folder / "mine.toml").touch()
    sizes = ("toe=18x25", "index=18", "ring=5x25", "little=25x18", "thumb=22x27", "thumb=22x27")
    options = [word for size in sizes for word in ("--finger", size)]
    done = run_fingertip("new", "mine", *options, "--preset", "child", "--set", "skin.width_mm=18")
    assert done.returncode == 2
    begins = (
        "--preset: ",
        "--finger toe=18x25: 'toe' is no finger",
        "--finger index=18: ",
        "--finger ring=5x25: skin.width_mm: 5.0 mm is too small; at least 6 mm",
        "--finger little=25x18: is wider",
        "--finger thumb=22x27: is given twice",
        "--set skin.width_mm=18: ",
        "mine.toml: exists",
    )
    lines = done.stderr.splitlines()
    assert len(lines) == len(begins)
    assert all(
        line.startswith(f"error: {begin}") for line, begin in zip(lines, begins, strict=True)
    ), lines
    assert "--finger little=18x25" in done.stderr


def test_sizes_of_presets_give_a_set_of_presets_and_equal_fingers_one_form() -> None:
    sizes = ["ring=14.5x23", "index=14.5x23", "thumb=15.5x24"]
    forms = fit_set(start_set("mine", sizes, None, None, None, ()), print, [])
    assert [(form.fingers, form.file) for form in forms] == [
        (("thumb",), "child_thumb"),
        (("index", "ring"), "child_finger"),
    ]
    Path("mine.toml").write_text(write_set_file("mine", forms))
    assert [form.design for form in load_set("mine.toml").forms] == [
        form.design.design.model_copy(update={"name": form.file}) for form in forms
    ]


def test_a_longer_finger_feels_where_its_preset_does() -> None:
    (form,) = fit_set(start_set("mine", ["ring=18x26"], None, None, None, ()), print, [])
    assert {move.name: (move.before, move.after) for move in form.design.moves}[
        "sensor.distance_from_tip_mm"
    ] == (
        9.7,
        10.7,
    )
    assert survey_pad(form.design.design).worst_turn_on_n < 0.5


@pytest.mark.full
def test_a_set_of_sizes_shares_its_joint_and_passes() -> None:
    command = (
        "new",
        "mine",
        "--finger",
        "index=17x25",
        "--finger",
        "ring=17x25",
        "--finger",
        "little=15x24",
        "--json",
    )
    done = run_fingertip(*command, "--set", "skin.bump_height_mm=0.15")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert [(form["design"], form["fingers"]) for form in result["forms"]] == [
        ("mine_index.toml", ["index", "ring"]),
        ("mine_little.toml", ["little"]),
    ]
    index = Design.load("mine_index.toml")
    assert (index.skin.width_mm, index.skin.length_mm) == (17.0, 25.0)
    assert index.hand == Design.load("mine_little.toml").hand
    assert result["next"] == "fingertip make mine.toml"
    assert run_fingertip("check", "mine.toml").returncode == 0
