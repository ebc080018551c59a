"""Bundled designs, scenes and sweeps: found by bare name, from a checkout and from the wheel."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer

from fingertip.catalogues.file_kinds import (
    DESIGN,
    KINDS,
    SCENE,
    SET,
    SURFACE,
    SWEEP,
    find_file,
    identify_kind,
    list_bundled_files,
    parse_source,
)
from fingertip.cli import app
from fingertip.design import Design
from fingertip.design.finger_set import load_set
from fingertip.design.hand_sizes import find_hand
from fingertip.design.proportions import fill_in
from fingertip.foundation.errors import FingertipError, SweepError
from fingertip.foundation.output_set import SetWriter
from fingertip.sim.contact.surface_files import SURFACES, SurfaceFile
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.simulation import load_simulation
from fingertip.sweep.sweep_file import read_sweep_file, to_canonical_text
from tests.conftest import ROOT, run_fingertip
from tests.tools import require_module

PARAMS = ROOT / "params"
# Found with --hand.
FILES = sorted(path for path in PARAMS.rglob("*.toml") if path.parent.name != "hands")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_file_has_a_name_of_its_own() -> None:
    assert list_bundled_files() == {path.stem: path for path in FILES}
    assert len({path.stem for path in FILES}) == len(FILES)
    by_kind = [list_bundled_files(kind) for kind in KINDS]
    assert all(by_kind)
    assert sum(map(len, by_kind)) == len(FILES)
    assert [kind.name for kind in KINDS if kind.example not in list_bundled_files(kind)] == [], (
        "examples in messages"
    )


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_name_gives_what_the_path_gives(kind: Any, folder: Path) -> None:
    wrong = []
    for name, path in list_bundled_files(kind).items():
        if kind is DESIGN:
            same = Design.load(name) == Design.load(path) and load_simulation(
                name
            ) == load_simulation(path)
        elif kind is SWEEP:
            same = read_sweep_file(name) == read_sweep_file(path)
            same = same and str(ROOT) not in to_canonical_text(read_sweep_file(name))
        elif kind is SET:
            same = load_set(name).identity() == load_set(path).identity()
        elif kind is SURFACE:
            same = SURFACES[name] == SurfaceFile.load(path).surface
        else:
            model = SceneFile if kind is SCENE else ManipulationFile
            by_name = load_simulation(name, "fsr402")
            by_path = load_simulation(path, PARAMS / "fsr402.toml")
            same = model.load(name) == model.load(path) and by_name == by_path
        if not same:
            wrong.append(name)
    assert wrong == []


def test_a_file_comes_before_a_name_and_a_folder_does_not(folder: Path) -> None:
    (folder / "fsr400").write_text("[skin]\nwidth_mm = 18\n")
    assert Design.load("fsr400").skin.width_mm == 18
    assert Design.load("fsr402").skin.width_mm == 27.0
    (folder / "fsr402").mkdir()
    assert Design.load("fsr402").skin.width_mm == 27.0
    with pytest.raises(
        FingertipError, match=r"^fsr402: is a folder, not a regular file; give the path of a design"
    ):
        Design.load("./fsr402")
    for given in (
        "fsr400.toml",
        "./fsr400",
        "../fsr400",
        "params/fsr400",
        "scenes/drift",
        "fsr400.",
        "",
    ):
        assert find_file(given, DESIGN) == Path(given), "only a single word is a name"


def test_a_folder_hides_no_bundled_file_of_its_name(folder: Path) -> None:
    """Folders of all bundled names lie in the working folder, and
    beside a set and a sweep that name designs.
    """
    text = {
        "set": 'name = "two"\n[fingers.index]\ndesign = "adult_finger"\n',
        "sweep": 'design = "fsr402"\n',
    }
    text["sweep"] += 'scene = "drift"\noutputs = ["delay_ms"]\n[axes]\nskin.width_mm = [24.4]\n'
    (folder / "two.toml").write_text(text["set"])
    (folder / "map.toml").write_text(text["sweep"])
    before = load_set("two.toml"), read_sweep_file("map.toml"), find_hand("amazing_hand")
    bundled = list_bundled_files()
    for name in (*bundled, "amazing_hand", "unknown"):
        (folder / name).mkdir()

    for name, path in bundled.items():
        kind = identify_kind(path)
        assert kind
        assert find_file(name, kind) == path
        assert parse_source(f"./{name}", kind) == parse_source(f"{name}/", kind) == folder / name
        assert parse_source(name, kind) == Path(name)
        others = [other for other in KINDS if other is not kind]
        assert parse_source(f"./{name}", *others) == Path(name), (
            "no file of these kinds has this name"
        )
    assert (load_set("two.toml"), read_sweep_file("map.toml"), find_hand("amazing_hand")) == before
    with pytest.raises(
        FingertipError, match=r"^\./amazing_hand: is a folder; give the path of a hand file"
    ):
        find_hand("./amazing_hand")
    with pytest.raises(FingertipError, match=r"^unknown: is a folder, not a regular file"):
        Design.load("unknown")


SOURCES = (
    "make",
    "check",
    "compare first_finger",
    "compare fsr400",
    "studio",
    "build",
    "calibrate printer --half-thickness-mm 10",
    "calibrate sensor w.csv",
    "board",
    "firmware",
    "simulate",
    "simulate drift --design",
    "detect t.csv --design",
    "validate",
    "record",
    "params",
    "pad",
    "accuracy",
    "accuracy budget",
    "robot",
    "page",
    "sheet",
    "acceptance",
    "picture",
    "drawing",
    "new own --from",
    "sweep",
)
"""Words of a command before a word that may be a bundled name."""
NO_SOURCE = {"trace", "readings", "kind", "shell", "name"}
"""Arguments that are no such word."""


def count_sources(group: Any, words: tuple[str, ...] = ()) -> Iterator[str]:
    for name, each in group.commands.items():
        if hasattr(each, "commands"):
            yield from count_sources(each, (*words, name))
        else:
            for one in each.params:
                is_argument = one.param_type_name == "argument" and one.name not in NO_SOURCE
                if is_argument or {"--design", "--from"}.intersection(one.opts):
                    yield " ".join((*words, name))


def test_every_command_takes_a_name_with_a_slash_as_that_of_the_folder(folder: Path) -> None:
    for name in ("adult_finger", "board"):
        (folder / name).mkdir()
    named = [re.match(r"calibrate \w+|\w+", words)[0] for words in SOURCES]  # type: ignore[index]
    assert sorted(named) == sorted(count_sources(typer.main.get_command(app)))
    for words in SOURCES:
        name = "board" if words == "sweep" else "adult_finger"
        for typed in (f"./{name}", f"{name}/"):
            done = run_fingertip(*words.split(), typed, PWD=str(folder))
            assert (done.returncode, done.stdout) == (2, ""), words
            if words.startswith("compare"):
                assert f"{folder / name}: is a folder without the report.json" in done.stderr
                continue
            said = (
                "has no manifest.json"
                if words == "check"
                else "is a folder, not a regular file; give the path of a"
            )
            assert done.stderr.startswith(f"error: {folder / name}: {said}"), words


def test_check_takes_a_bare_name_for_the_design_and_says_how_to_name_the_folder(
    folder: Path,
) -> None:
    for name in ("adult_finger", "board"):
        SetWriter(folder / name, "parts", name, "now").write({"bone.stl": b"bone"})
    done = run_fingertip("check", "adult_finger", "board", PWD=str(folder))
    assert re.match(
        r"adult_finger: all \d+ checks passed\n\nboard: holds the parts of .board., not of "
        r"adult_finger",
        done.stdout,
    )
    told = (
        "warning: adult_finger is the bundled design of this name; ./adult_finger names the "
        "folder\n"
    )
    assert done.stderr.count("warning") == done.stderr.count(told) == 1
    for typed in ("./adult_finger", "adult_finger/"):
        done = run_fingertip("check", typed, PWD=str(folder))
        assert (done.stdout, done.stderr) == (
            f"{folder / 'adult_finger'}: 1 file compared, all are as written\n",
            "",
        )


def test_a_sweep_file_names_bundled_files_and_files_beside_it(folder: Path) -> None:
    text = 'design = "{}"\nscene = "{}"\noutputs = ["delay_ms"]\n[axes]\nskin.width_mm = [24.4]\n'
    beside = folder / "sweeps"
    beside.mkdir()
    (beside / "by_name.toml").write_text(text.format("fsr402", "drift"))
    (beside / "own.toml").write_bytes((PARAMS / "fsr402.toml").read_bytes())
    (beside / "wind.toml").write_bytes((PARAMS / "scenes" / "drift.toml").read_bytes())
    (beside / "by_path.toml").write_text(text.format("own.toml", "wind.toml"))
    tables = read_sweep_file("sweeps/by_name.toml")
    assert tables["design"] == fill_in(tomllib.loads((PARAMS / "fsr402.toml").read_text()))
    assert tables == read_sweep_file("sweeps/by_path.toml")
    (beside / "fsr402").write_text("[skin]\nwidth_mm = 18\n")
    assert read_sweep_file("sweeps/by_name.toml")["design"]["skin"]["width_mm"] == 18
    (beside / "unknown.toml").write_text(text.format("fsr4", "map"))
    with pytest.raises(SweepError) as caught:
        read_sweep_file("sweeps/unknown.toml")
    assert [issue.field for issue in caught.value.issues] == ["fsr4", "map"]
    (folder / "own.toml").write_text("[skin]\nwidth_mm = 18\n")
    # Sent by a stranger.
    for name in (
        "../own.toml",
        str(folder / "own.toml"),
        "./own.toml",
        "x/own.toml",
    ):
        (beside / "outside.toml").write_text(text.format(name, "drift"))
        with pytest.raises(SweepError, match=r"is no name of a file beside the sweep file"):
            read_sweep_file("sweeps/outside.toml")
        typed = read_sweep_file("sweeps/outside.toml", [f"design={folder / 'own.toml'}"])
        assert typed["design"]["skin"]["width_mm"] == 18, (
            "a path that the user types may lead anywhere"
        )
    (beside / "outside.toml").write_text(text.format("link.toml", "drift"))
    (beside / "link.toml").symlink_to(folder / "own.toml")
    with pytest.raises(SweepError, match=r"link\.toml: is a link, not a regular file"):
        read_sweep_file("sweeps/outside.toml")
    assert read_sweep_file("board", ["design=own.toml"])["design"]["skin"]["width_mm"] == 18
    assert read_sweep_file("board", ["design=fsr402"])["design"]["name"] == "fsr402"
    with pytest.raises(SweepError, match=r"^none\.toml: "):
        read_sweep_file("board", ["design=none.toml"])


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built by the program that `pip install .` asks for it."""
    require_module("hatchling")
    made = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(made)]
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    (path,) = made.glob("*.whl")
    return path


@pytest.mark.full
def test_the_wheel_holds_every_bundled_file(wheel: Path) -> None:
    package = ROOT / "src/fingertip"
    with zipfile.ZipFile(wheel) as archive:
        held = {
            name: archive.read(name) for name in archive.namelist() if name.startswith("fingertip/")
        }
    files = {
        f"fingertip/{path.relative_to(package).as_posix()}": path.read_bytes()
        for path in package.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    bundled = (path for path in PARAMS.rglob("*") if path.suffix in (".toml", ".json"))
    files |= {
        f"fingertip/params/{path.relative_to(PARAMS).as_posix()}": path.read_bytes()
        for path in bundled
    }
    assert held == files
