"""Bundled designs, scenes and sweeps: found by bare name, from a checkout and from the wheel."""

from __future__ import annotations

import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest

from fingertip.catalogues.file_kinds import DESIGN, KINDS, SCENE, SET, SURFACE, SWEEP, find_file, list_bundled_files
from fingertip.design import Design
from fingertip.design.finger_set import load_set
from fingertip.design.proportions import fill_in
from fingertip.foundation.errors import FingertipError, SweepError
from fingertip.sim import ManipulationFile, SceneFile, load_simulation
from fingertip.sim.contact.materials import SURFACES, SurfaceFile
from fingertip.sweep.sweep_file import read_sweep_file, to_canonical_text
from tests.conftest import ROOT

PARAMS = ROOT / "params"
FILES = sorted(path for path in PARAMS.rglob("*.toml") if path.parent.name != "hands")  # found with --hand


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
    assert [kind.name for kind in KINDS if kind.example not in list_bundled_files(kind)] == [], "examples in messages"


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_name_gives_what_the_path_gives(kind: Any, folder: Path) -> None:
    wrong = []
    for name, path in list_bundled_files(kind).items():
        if kind is DESIGN:
            same = Design.load(name) == Design.load(path) and load_simulation(name) == load_simulation(path)
        elif kind is SWEEP:
            same = read_sweep_file(name) == read_sweep_file(path)
            same = same and str(ROOT) not in to_canonical_text(read_sweep_file(name))
        elif kind is SET:
            same = load_set(name).identity() == load_set(path).identity()
        elif kind is SURFACE:
            same = SURFACES[name] == SurfaceFile.load(path).surface
        else:
            model = SceneFile if kind is SCENE else ManipulationFile
            by_name, by_path = load_simulation(name, "fsr402"), load_simulation(path, PARAMS / "fsr402.toml")
            same = model.load(name) == model.load(path) and by_name == by_path
        if not same:
            wrong.append(name)
    assert wrong == []


def test_a_path_comes_before_a_name(folder: Path) -> None:
    (folder / "fsr400").write_text("[skin]\nwidth_mm = 18\n")
    assert Design.load("fsr400").skin.width_mm == 18
    assert Design.load("fsr402").skin.width_mm == 27.0
    (folder / "fsr402").mkdir()
    with pytest.raises(FingertipError, match="fsr402: is a folder, which comes before the bundled file of the same"):
        Design.load("fsr402")
    for given in ("fsr400.toml", "./fsr400", "../fsr400", "params/fsr400", "scenes/drift", "fsr400.", ""):
        assert find_file(given, DESIGN) == Path(given), "only a single word is a name"


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
    for name in ("../own.toml", str(folder / "own.toml"), "./own.toml", "x/own.toml"):  # sent by a stranger
        (beside / "outside.toml").write_text(text.format(name, "drift"))
        with pytest.raises(SweepError, match=r"is no name of a file beside the sweep file"):
            read_sweep_file("sweeps/outside.toml")
        typed = read_sweep_file("sweeps/outside.toml", [f"design={folder / 'own.toml'}"])
        assert typed["design"]["skin"]["width_mm"] == 18, "a path that the user types may lead anywhere"
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
    """The wheel, built as `pip install .` does."""
    made = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", str(made), str(ROOT)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    if "No matching distribution found for hatchling" in done.stderr:
        pytest.skip("hatchling, which builds the wheel, cannot be fetched: pip reaches no index")
    assert done.returncode == 0, done.stderr
    (path,) = made.glob("*.whl")
    return path


@pytest.mark.full
def test_the_wheel_holds_every_bundled_file(wheel: Path) -> None:
    package = ROOT / "src/fingertip"
    with zipfile.ZipFile(wheel) as archive:
        held = {name: archive.read(name) for name in archive.namelist() if name.startswith("fingertip/")}
    files = {
        f"fingertip/{path.relative_to(package).as_posix()}": path.read_bytes()
        for path in package.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    bundled = (path for path in PARAMS.rglob("*") if path.suffix in (".toml", ".json"))
    files |= {f"fingertip/params/{path.relative_to(PARAMS).as_posix()}": path.read_bytes() for path in bundled}
    assert held == files
