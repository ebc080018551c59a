"""JSON schemas of the TOML files: current, named in every bundled file, and in agreement with what is accepted."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest

from fingertip.cli.design import KINDS, format_schema
from tests.conftest import ROOT, run_fingertip
from tests.tools import require_module

SCHEMAS = ROOT / "params" / "schemas"
FILES = sorted((ROOT / "params").rglob("*.toml"))
KIND_OF_FOLDER = {"scenes": "scene", "sweeps": "sweep", "hands": "design", "params": "design"}


def schema_of(path: Path) -> Path:
    first = path.read_text(encoding="utf-8").split("\n", 1)[0]
    assert first.startswith("#:schema "), "editors read the first line"
    return (path.parent / first.removeprefix("#:schema ")).resolve()


def test_schemas_are_current() -> None:
    old = [kind for kind in KINDS if (SCHEMAS / f"{kind}.json").read_text() != format_schema(kind) + "\n"]
    assert not old, "renew each: fingertip schema KIND > params/schemas/KIND.json"


def test_command_prints_what_is_bundled_and_refuses_an_unknown_kind() -> None:
    assert {path.stem for path in SCHEMAS.iterdir()} == set(KINDS)
    done = run_fingertip("schema", "sweep")
    assert (done.returncode, done.stdout) == (0, (SCHEMAS / "sweep.json").read_text())
    done = run_fingertip("schema", "desing")
    assert done.returncode == 2
    assert "KIND: 'desing' is no kind of file; did you mean design?" in done.stderr


def test_bundled_files_agree_with_the_schemas_of_their_kinds() -> None:
    kinds = {path: KIND_OF_FOLDER[path.parent.name] for path in FILES}
    kinds[ROOT / "params" / "scenes" / "real_manipulation.toml"] = "manipulation"
    assert {path: schema_of(path) for path in FILES} == {path: SCHEMAS / f"{kind}.json" for path, kind in kinds.items()}
    jsonschema = require_module("jsonschema")
    wrong = []
    for path in FILES:
        tables: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        validator = jsonschema.Draft202012Validator(json.loads(schema_of(path).read_text()))
        wrong += [(path.stem, error.message) for error in validator.iter_errors(tables)]
        if not list(validator.iter_errors({**tables, "no_such_table": {}})):
            wrong.append((path.stem, "unknown names are accepted"))
    assert wrong == []


@pytest.mark.parametrize(("kind", "tables"), [
    ("design", {"skin": {"width_mm": 1000}}),
    ("design", {"board": {"variant": "none"}}),
    ("scene", {"scene": "x", "tap": {"force_n": "much"}}),
    ("sweep", {"outputs": [], "axes": {}, "sampling": "none"}),
])  # fmt: skip
def test_schema_refuses_what_the_program_refuses(kind: str, tables: dict[str, Any]) -> None:
    jsonschema = require_module("jsonschema")
    assert not jsonschema.Draft202012Validator(json.loads(format_schema(kind))).is_valid(tables)
