"""`--fit`: what follows from a change moves, is listed before anything is written, and passes when
it is typed.
"""

from __future__ import annotations

import json
import pickle
import tomllib
from pathlib import Path

import pytest
import typer

from fingertip.cli import options
from fingertip.design import Design
from fingertip.fitting.fitting import fit_design
from fingertip.foundation.errors import DesignError, FingertipError, Issue
from tests.conftest import run_fingertip

CHANGE = "skin.thickness_palmar_mm=2.7"


def test_what_moved_is_listed_and_passes_when_it_is_typed(tmp_path: Path) -> None:
    with pytest.raises(DesignError):
        Design.load("adult_finger", changes=[CHANGE])
    words = (
        "build",
        "adult_finger",
        "--set",
        CHANGE,
        "--fit",
        "--parts=bone",
        "--formats=stl",
        "--out",
        tmp_path,
    )
    done = run_fingertip(*words, "--json")
    listed = json.loads(done.stdout)["fitted"]
    assert listed
    typed = [CHANGE, *(f"{move['parameter']}={move['is']}" for move in listed)]
    written = Design.load(tmp_path / "design.toml")
    assert written == Design.load("adult_finger", changes=typed)
    first = Design.load("adult_finger")
    for move in listed:
        assert (move["design"], move["was"]) == ("adult_finger", first.value(move["parameter"]))
        assert (
            f"# Fitted: {move['parameter']} was {move['was']}; "
            in (tmp_path / "design.toml").read_text()
        )
        assert all(
            word in done.stderr for word in (move["parameter"], str(move["is"]), move["why"])
        )
    with pytest.raises(DesignError):  # each was needed
        Design.load("adult_finger", changes=typed[:-1])
    quiet = run_fingertip(*words, "--quiet")
    assert quiet.stderr == ""
    assert (
        quiet.stdout.splitlines()[: len(listed) + 2] == done.stderr.splitlines()[: len(listed) + 2]
    )
    moves = fit_design(first, {"skin.thickness_palmar_mm": 2.7}).moves
    assert [(move.name, move.before, move.after) for move in moves] == [
        (move["parameter"], move["was"], move["is"]) for move in listed
    ]


@pytest.mark.full
def test_a_failed_check_offers_the_fit_that_mends_it() -> None:
    words = ("check", "adult_finger", "--set", "skin.bump_radius_mm=3")
    refused = run_fingertip(*words).stdout
    assert "pad.rest_force: change" in refused
    assert refused.endswith("  or add --fit, which moves skin.bump_height_mm\n")
    assert json.loads(run_fingertip(*words, "--json").stdout)["designs"][0]["fit_moves"] == [
        "skin.bump_height_mm"
    ]
    assert "all 100 checks passed" in run_fingertip(*words, "--fit").stdout


def test_a_design_that_passes_stays_and_a_design_file_on_stdout_can_be_read() -> None:
    done = run_fingertip("params", "adult_finger", "--fit", "--toml", "--quiet")
    assert Design(**tomllib.loads(done.stdout)) == Design.load("adult_finger")
    assert "passes as it is" in run_fingertip("params", "adult_finger", "--fit").stderr


def test_designs_of_the_same_values_are_equal_whatever_moved() -> None:
    fitted = fit_design(Design.load("adult_finger"), {"skin.thickness_palmar_mm": 2.7})
    stated = Design(**fitted.model_dump())
    assert fitted.moves
    assert not stated.moves
    assert fitted == stated
    assert hash(fitted) == hash(stated)
    assert pickle.loads(pickle.dumps(fitted)).moves == fitted.moves


def test_each_finger_of_a_set_is_fitted(tmp_path: Path) -> None:
    ring = 'design = "adult_finger"\nname = "adult_ring"\nskin.length_mm = 25.5'
    text = f'name = "two"\n[fingers.index]\ndesign = "adult_finger"\n[fingers.ring]\n{ring}\n'
    (tmp_path / "two.toml").write_text(text, encoding="utf-8")
    words = (
        "firmware",
        tmp_path / "two.toml",
        "--set",
        CHANGE,
        "--fit",
        "--json",
        "--out",
        tmp_path / "out",
    )
    listed = json.loads(run_fingertip(*words).stdout)["fitted"]
    assert {move["design"] for move in listed} == {"adult_finger", "adult_ring"}
    moves = fit_design(Design.load("adult_finger"), {"skin.thickness_palmar_mm": 2.7}).moves
    of_index = [
        (move["parameter"], move["is"]) for move in listed if move["design"] == "adult_finger"
    ]
    assert of_index == [(move.name, move.after) for move in moves]


@pytest.mark.parametrize(
    ("message", "told"),
    [
        (
            "9 mm is too wide; at most 8 mm, or add --fit, which moves a.b.",
            "9 mm is too wide; at most 8 mm.",
        ),
        (
            "9 mm is too wide; add --fit, which moves a.b.",
            "9 mm is too wide; `{}`, which moves a.b.",
        ),
        ("breaks a rule; --fit fixes all of this.", "breaks a rule; `{}` fixes all of this."),
    ],
)
def test_a_command_without_a_fit_offers_one_that_has_it(
    message: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    @options.command
    def refuse() -> None:
        raise FingertipError(Issue("skin.width_mm", message))

    with pytest.raises(typer.Exit):
        refuse()
    command = "fingertip params DESIGN --fit --toml > fitted.toml"
    assert capsys.readouterr().err == f"error: skin.width_mm: {told.format(command)}\n"
