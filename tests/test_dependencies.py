"""Lists about dependencies: hashes of wheels and licences, compared with constraints.txt and with what is installed."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

import pytest

from tools.dependencies import hashes, licences, needs
from tools.dependencies.hashes import IndexFile, choose_wheels, read_html_page, read_json_page
from tools.dependencies.pins import (
    CONSTRAINTS,
    canonical,
    read_back_end,
    read_pins,
    read_project,
    supported_pythons,
    users_packages,
)

PYTHONS = [(3, 11), (3, 12), (3, 13)]
TARGETS = needs.list_targets(read_project())
PINS = read_pins(CONSTRAINTS.read_text(encoding="utf-8"))
HASHED = hashes.HASHES.read_text(encoding="utf-8")
PAGE = licences.PAGE.read_text(encoding="utf-8")


HASH = "    --hash=sha256:[0-9a-f]{64}"
PIN = re.compile(rf"^([\w.-]+)==([\w.]+)(?: ; (.+))? \\\n(?:{HASH} \\\n)*{HASH}\n", re.MULTILINE)


def chosen(*names: str, targets: list[needs.Target] = TARGETS) -> set[str]:
    """Names of the wheels of numpy 2.4.6 that are selected."""
    return {file.name for file in choose_wheels([IndexFile(name, name) for name in names], "numpy", "2.4.6", targets)}


def test_hashes_and_constraints_list_the_same_versions() -> None:
    pins = [(name, version) for name, version, _ in PIN.findall(HASHED)]
    assert dict(pins) == PINS, "run python -m tools.dependencies.hashes"
    assert len(pins) == len(PINS)
    assert [line for line in PIN.sub("", HASHED).splitlines() if not line.startswith("# ")] == []
    assert "://" not in HASHED
    assert supported_pythons(read_project()) == PYTHONS


def test_each_level_of_the_list_has_what_it_needs() -> None:
    as_pinned(name for name, _, marker in PIN.findall(HASHED) if "sys_platform" not in marker)
    project = read_project()
    levels = needs.list_levels(project, read_back_end())
    found = {
        canonical(name): (level, marker)
        for level, part in zip(levels, re.split("# end of .*\n", HASHED), strict=False)
        for name, _, marker in PIN.findall(part)
    }
    assert re.findall("# end of (.*)\n", HASHED) == list(levels)
    assert found == {
        name: (need.level, needs.format_marker(need, TARGETS))
        for name, need in needs.list_needs(levels, TARGETS).items()
    }, "run python -m tools.dependencies.hashes"


def test_wheels_of_supported_pythons_and_platforms_are_selected() -> None:
    wanted = {
        "numpy-2.4.6-cp311-cp311-manylinux_2_28_x86_64.whl",
        "numpy-2.4.6-cp313-cp313-macosx_12_0_arm64.whl",
        "numpy-2.4.6-1-cp312-cp312-manylinux2014_aarch64.manylinux_2_17_aarch64.whl",
        "numpy-2.4.6-cp39-abi3-macosx_10_9_universal2.whl",
        "numpy-2.4.6-py2.py3-none-any.whl",
        "numpy-2.4.6-py3-none-manylinux1_x86_64.whl",
    }
    unwanted = {
        "numpy-2.4.6-cp310-cp310-manylinux_2_28_x86_64.whl",
        "numpy-2.4.6-cp313-cp313t-manylinux_2_28_x86_64.whl",
        "numpy-2.4.6-cp314-abi3-manylinux_2_28_x86_64.whl",
        "numpy-2.4.6-pp311-pypy311_pp73-manylinux_2_28_x86_64.whl",
        "numpy-2.4.6-cp311-cp311-manylinux_2_32_x86_64.whl",
        "numpy-2.4.6-cp311-cp311-musllinux_1_2_x86_64.whl",
        "numpy-2.4.6-cp311-cp311-macosx_13_0_arm64.whl",
        "numpy-2.4.6-cp311-cp311-macosx_12_0_x86_64.whl",
        "numpy-2.4.6-cp311-cp311-win_amd64.whl",
        "numpy-2.4.6-py2-none-any.whl",
        "numpy-2.4.5-cp311-cp311-manylinux_2_28_x86_64.whl",
        "numpy_more-2.4.6-cp311-cp311-manylinux_2_28_x86_64.whl",
        "numpy-2.4.6.tar.gz",
    }
    assert chosen(*wanted, *unwanted) == wanted
    here, *_, elsewhere = TARGETS
    name = "numpy-2.4.6-cp311-cp311-manylinux_2_28_x86_64.whl"
    assert chosen(name, targets=[here]) == {name}
    with pytest.raises(SystemExit, match=r"no wheel of numpy 2\.4\.6 for cpython-313-darwin arm64"):
        chosen(name, targets=[here, elsewhere])


def test_both_forms_of_the_index_are_read() -> None:
    sha = "0123456789abcdef" * 4
    page = f'<a href="../a-1%2Blocal.whl#sha256={sha}" data-x="1">a</a><a href="b.whl">b</a>'
    data = json.dumps(
        {"files": [{"filename": "a-1+local.whl", "hashes": {"sha256": sha}}, {"filename": "b", "hashes": {}}]}
    )
    assert list(read_html_page(page)) == list(read_json_page(data)) == [IndexFile("a-1+local.whl", sha)]


def as_pinned(names: Iterable[str]) -> None:
    """Skip a test of a list where other versions than the pinned ones are installed."""
    pins = {canonical(name): version for name, version in PINS.items()}
    installed = {canonical(one.metadata["Name"]): one.version for one in metadata.distributions()}
    wrong = [name for name in map(canonical, names) if installed.get(name) != pins.get(name)]
    if wrong:
        pytest.skip(f"the list is about the pinned versions, and {wrong[0]} {installed.get(wrong[0])} is installed")


@pytest.mark.full
def test_licence_of_every_dependency_is_listed() -> None:
    as_pinned(needs.collect(users_packages(read_project())))
    found = licences.list_licences()
    assert set(users_packages(read_project())) <= {canonical(one.name) for one in found}
    rows = {line.split(" | ")[0][2:]: line for line in PAGE.splitlines() if line.startswith("| ")}
    missing = [one.name for one in found if not rows.get(one.name, "").endswith(f" | {one.text} |")]
    assert missing == [], "run python -m tools.dependencies.licences"
    names = {canonical(one.name) for one in found}
    mentioned = {name for name in names if licences.mentions_lgpl(name)}
    assert mentioned <= set(licences.COPYLEFT) <= names
    assert all(f"- **{metadata.metadata(name)['Name']}**: " in PAGE for name in licences.COPYLEFT)
    # The oldest Python brings the most packages, so the page is that one's.
    if sys.version_info[:2] == PYTHONS[0]:
        assert licences.format_page(found) == PAGE


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
