"""Lists about dependencies: hashes of wheels and licences, compared with constraints.txt and with what is installed."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from tools.dependencies import hashes, licences
from tools.dependencies.hashes import IndexFile, choose_files, read_html_page, read_json_page
from tools.dependencies.pins import CONSTRAINTS, canonical, read_pins, read_project, supported_pythons, users_packages

PYTHONS = [(3, 11), (3, 12), (3, 13)]
PINS = read_pins(CONSTRAINTS.read_text(encoding="utf-8"))
HASHED = hashes.HASHES.read_text(encoding="utf-8")
PAGE = licences.PAGE.read_text(encoding="utf-8")


def chosen(*names: str, package: str = "numpy", version: str = "2.4.6") -> set[str]:
    """Names of the files that are selected for a version."""
    return {file.name for file in choose_files([IndexFile(name, name) for name in names], package, version, PYTHONS)}


def test_hashes_and_constraints_list_the_same_versions() -> None:
    pins = re.findall(r"^(\S+)==(\S+) \\$", HASHED, re.MULTILINE)
    assert dict(pins) == PINS, "run python -m tools.dependencies.hashes"
    assert len(pins) == len(PINS)


def test_hashes_are_nothing_but_pins_and_sha256() -> None:
    lines = [line for line in HASHED.splitlines() if not line.startswith("#")]
    wrong = [
        line
        for line in lines
        if not re.fullmatch(r"[A-Za-z0-9][\w.-]*==[\w.]+ \\|    --hash=sha256:[0-9a-f]{64}( \\)?", line)
    ]
    assert wrong == []
    assert "://" not in HASHED
    # Each pin goes on to a hash, and the last hash of each pin ends it.
    blocks = re.findall(r"^\S+==\S+ \\\n(?:    --hash=\S+ \\\n)*    --hash=\S+\n", HASHED, re.MULTILINE)
    assert len(blocks) == len(PINS)


def test_supported_pythons_are_those_of_the_classifiers() -> None:
    assert supported_pythons(read_project()) == PYTHONS


def test_wheels_of_supported_pythons_are_selected_on_every_platform() -> None:
    wanted = {
        "numpy-2.4.6-cp311-cp311-manylinux_2_28_x86_64.whl",
        "numpy-2.4.6-cp313-cp313-win_amd64.whl",
        "numpy-2.4.6-1-cp312-cp312-macosx_14_0_arm64.whl",
        "numpy-2.4.6-cp39-abi3-musllinux_1_2_aarch64.whl",
        "numpy-2.4.6-py2.py3-none-any.whl",
        "numpy-2.4.6-py3-none-manylinux1_x86_64.whl",
    }
    unwanted = {
        "numpy-2.4.6-cp310-cp310-win_amd64.whl",
        "numpy-2.4.6-cp313-cp313t-win_amd64.whl",
        "numpy-2.4.6-cp314-abi3-win_amd64.whl",
        "numpy-2.4.6-pp311-pypy311_pp73-win_amd64.whl",
        "numpy-2.4.6-py2-none-any.whl",
        "numpy-2.4.5-cp311-cp311-win_amd64.whl",
        "numpy_more-2.4.6-cp311-cp311-win_amd64.whl",
        "numpy-2.4.6.tar.gz",
    }
    assert chosen(*wanted, *unwanted) == wanted


def test_source_archive_is_selected_where_there_is_no_wheel() -> None:
    files = ["A_b.c-1.0.tar.gz", "a-b-c-1.0.1.tar.gz", "a-b-c-1.0-cp310-cp310-win_amd64.whl"]
    assert chosen(*files, package="a-b-c", version="1.0") == {"A_b.c-1.0.tar.gz"}


def test_both_forms_of_the_index_are_read() -> None:
    sha = "0123456789abcdef" * 4
    page = f'<a href="../a-1%2Blocal.whl#sha256={sha}" data-x="1">a</a><a href="b.whl">b</a>'
    data = json.dumps(
        {"files": [{"filename": "a-1+local.whl", "hashes": {"sha256": sha}}, {"filename": "b", "hashes": {}}]}
    )
    assert list(read_html_page(page)) == list(read_json_page(data)) == [IndexFile("a-1+local.whl", sha)]


def as_pinned() -> None:
    """Skip a test of the page where other versions than the pinned ones are installed."""
    pins = {canonical(name): version for name, version in PINS.items()}
    for name in licences.collect(users_packages(read_project())):
        if metadata.version(name) != pins.get(name):
            pytest.skip(f"the page is about the pinned versions, and {name} {metadata.version(name)} is installed")


def test_licence_of_every_dependency_is_listed() -> None:
    as_pinned()
    found = licences.list_licences()
    assert set(users_packages(read_project())) <= {canonical(one.name) for one in found}
    rows = {line.split(" | ")[0][2:]: line for line in PAGE.splitlines() if line.startswith("| ")}
    missing = [one.name for one in found if not rows.get(one.name, "").endswith(f" | {one.text} |")]
    assert missing == [], "run python -m tools.dependencies.licences"
    # The oldest Python brings the most packages, so the page is that one's.
    if sys.version_info[:2] == PYTHONS[0]:
        assert licences.format_page(found) == PAGE


def test_every_package_that_mentions_the_lgpl_is_named() -> None:
    as_pinned()
    found = {canonical(one.name) for one in licences.list_licences()}
    mentioned = {name for name in found if licences.mentions_lgpl(name)}
    assert mentioned <= set(licences.COPYLEFT) <= found
    assert all(f"- **{metadata.metadata(name)['Name']}**: " in PAGE for name in licences.COPYLEFT)


@pytest.mark.parametrize(
    ("packages", "status"),
    [
        ([{"name": "a", "version": "1", "vulns": []}], 0),
        ([{"name": "a", "version": "1", "vulns": [{"id": "X-1"}]}, {"name": "b", "skip_reason": "not found"}], 1),
        ([{"name": "a", "version": "1", "vulns": []}, {"name": "b", "skip_reason": "not found"}], 3),
        ([], 3),
        (None, 3),
    ],
)
def test_audit_that_nobody_answered_is_no_pass(
    tmp_path: Path, packages: list[dict[str, object]] | None, status: int
) -> None:
    report = tmp_path / "report.json"
    if packages is not None:
        report.write_text(json.dumps({"dependencies": packages}), encoding="utf-8")
    script = CONSTRAINTS.with_name(".ci") / "audit.py"
    assert subprocess.run([sys.executable, str(script), str(report)], check=False).returncode == status
