"""Byte manifest: the versions it is for, the folders it covers, and that differences are seen."""

from __future__ import annotations

from pathlib import Path

from tests.conftest import ROOT
from tests.packages import read_pins
from tools.manifest.compare import list_differences, with_nested
from tools.manifest.outputs import Manifest, hash_folder, hash_outputs

RENEW = "run python -m tools.manifest.write"


def test_manifest_is_for_the_pinned_versions() -> None:
    pins = read_pins()
    versions = Manifest.read().versions
    assert versions == {name: pins[name] for name in versions}, RENEW


def test_committed_boards_are_those_of_the_manifest() -> None:
    folders = {
        name: Path(folder) for name, folder in with_nested({"pcb": str(ROOT / "pcb")}).items()
    }
    expected = {name: Manifest.read().files[name] for name in folders}
    assert list_differences(expected, hash_outputs(folders)) == [], RENEW


def test_every_kind_of_difference_is_listed(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    for path in ("kept", "changed", "sub/gone"):
        (tmp_path / path).write_text(path, encoding="utf-8")
    before = {"one": hash_folder(tmp_path)}
    assert list_differences(before, before) == []
    (tmp_path / "changed").write_text("otherwise", encoding="utf-8")
    (tmp_path / "sub/gone").unlink()
    (tmp_path / "sub/added").write_text("", encoding="utf-8")
    found = list_differences(before, {"one": hash_folder(tmp_path)})
    assert found == [
        "one: changed is different",
        "one: sub/added is new",
        "one: sub/gone is missing",
    ]
