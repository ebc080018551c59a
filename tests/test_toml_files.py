"""Kinds of TOML files: identified by the names they hold, refused where
another kind is expected, and their schemas.
"""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest

from fingertip.catalogues.file_kinds import (
    DESIGN,
    KINDS,
    MANIPULATION,
    SCENE,
    SET,
    SURFACE,
    SWEEP,
    find_file,
    identify_kind,
    list_bundled_files,
    read_file,
    split_changes,
)
from fingertip.cli.design import KINDS as SCHEMA_KINDS
from fingertip.cli.design import make_schema
from fingertip.design import Design
from fingertip.design.finger_set import SetFile
from fingertip.foundation.errors import TomlFileError
from fingertip.sim.contact.surface_files import SurfaceFile
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sweep.sweep_file import SweepFile
from tests.approved import check_text
from tests.conftest import ROOT, run_fingertip
from tests.tools import require_module


def test_names_of_each_kind_are_those_of_its_model() -> None:
    models = {
        DESIGN: Design,
        SET: SetFile,
        SCENE: SceneFile,
        MANIPULATION: ManipulationFile,
        SWEEP: SweepFile,
    }
    models |= {SURFACE: SurfaceFile}
    assert set(models) == set(KINDS)
    for kind, model in models.items():
        assert kind.names == set(model.model_fields), kind.name


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ('scene = "x"', SCENE),
        ("[skin]", DESIGN),
        ('name = "mine"', DESIGN),
        ("", None),
        ("[nonsense]", None),
        ("[slide]", SCENE),
        ("[surface]", SURFACE),
        ("[surface]\n[sensing]", SCENE),
        ("[surface]\n[grasp]", MANIPULATION),
        ("[sensing]", SCENE),
        ("[grasp]", MANIPULATION),
        ("[sensing]\n[grasp]", MANIPULATION),
        ("[axes]", SWEEP),
        ("[axes]\n[design]\n[scene]\n", SWEEP),
        ("[skin\n", None),
    ],
)
def test_kind_follows_from_the_names_at_the_top_level(
    tmp_path: Path, text: str, kind: object
) -> None:
    (tmp_path / "a.toml").write_text(text)
    assert identify_kind(tmp_path / "a.toml") == kind


def test_a_file_that_is_no_text_or_is_shared_by_kinds(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(TomlFileError, match="is not UTF-8 text"):
        read_file(path, DESIGN)
    path.write_text("outputs = []\n")  # a name that scenes and sweeps share
    assert read_file(path, SWEEP) == {"outputs": []}


def test_files_as_windows_saves_them(tmp_path: Path) -> None:
    """With a byte order mark, and a carriage return at the end of each line."""
    for kind, name in (
        (DESIGN, "fsr402"),
        (SCENE, "hard_tap"),
        (MANIPULATION, "real_manipulation"),
        (SWEEP, "board"),
    ):
        path = tmp_path / f"{name}.toml"
        bundled = find_file(name, kind)
        path.write_bytes(b"\xef\xbb\xbf" + bundled.read_bytes().replace(b"\n", b"\r\n"))
        assert read_file(path, kind) == read_file(bundled, kind)


def test_changes_go_to_the_file_that_knows_their_name() -> None:
    changes = ["tap.force_n=1", "knock.at_s=1", "outputs=[]"]
    assert split_changes([*changes, "mold.wall_mm=5"], [SCENE]) == (changes, ["mold.wall_mm=5"])
    others = ["cable.hum_v=1", *changes[1:]]
    assert split_changes([*others, "mold.wall_mm=5"], [MANIPULATION]) == (
        others,
        ["mold.wall_mm=5"],
    )
    assert split_changes(changes, [SCENE, MANIPULATION]) == (changes, [])
    # A manipulation has a table `hand` too: without one, the name is the design's.
    assert split_changes([*changes, "hand.width_mm=6"], []) == (changes, ["hand.width_mm=6"])
    assert split_changes(["tap.force_n=1", "skin.width_mm=18"], [SCENE]) == (
        ["tap.force_n=1"],
        ["skin.width_mm=18"],
    )
    unknown = ["tp.force_n=1", "skn.width_mm=18", "x=1"]
    assert split_changes(unknown, [SCENE]) == (unknown[:1], unknown[1:])


# Schemas


SCHEMAS = ROOT / "params" / "schemas"
FILES = sorted((ROOT / "params").rglob("*.toml"))
KIND_OF_FOLDER = {
    "scenes": "scene",
    "sets": "set",
    "surfaces": "surface",
    "sweeps": "sweep",
    "hands": "design",
    "params": "design",
}


def schema_of(path: Path) -> Path:
    first = path.read_text(encoding="utf-8").split("\n", 1)[0]
    assert first.startswith("#:schema "), "editors read the first line"
    return (path.parent / first.removeprefix("#:schema ")).resolve()


@pytest.mark.every_case
@pytest.mark.parametrize("kind", SCHEMA_KINDS)
def test_schemas_are_current(kind: str) -> None:
    check_text(SCHEMAS / f"{kind}.json", json.dumps(make_schema(kind), indent=2) + "\n")


def test_command_prints_what_is_bundled_and_refuses_an_unknown_kind() -> None:
    assert {path.stem for path in SCHEMAS.iterdir()} == set(SCHEMA_KINDS)
    done = run_fingertip("schema", "sweep")
    assert (done.returncode, done.stdout) == (0, (SCHEMAS / "sweep.json").read_text())
    done = run_fingertip("schema", "desing")
    assert done.returncode == 2
    assert "KIND: 'desing' is no kind of file; did you mean design?" in done.stderr


def test_bundled_files_agree_with_the_schemas_of_their_kinds() -> None:
    kinds = {path: KIND_OF_FOLDER[path.parent.name] for path in FILES}
    kinds |= dict.fromkeys(list_bundled_files(MANIPULATION).values(), "manipulation")
    assert {path: schema_of(path) for path in FILES} == {
        path: SCHEMAS / f"{kind}.json" for path, kind in kinds.items()
    }
    jsonschema = require_module("jsonschema")
    wrong = []
    for path in FILES:
        tables: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        validator = jsonschema.Draft202012Validator(json.loads(schema_of(path).read_text()))
        wrong += [(path.stem, error.message) for error in validator.iter_errors(tables)]
        if not list(validator.iter_errors({**tables, "no_such_table": {}})):
            wrong.append((path.stem, "unknown names are accepted"))
    assert wrong == []
