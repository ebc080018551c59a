"""Lists about dependencies: versions with hashes and licences,
compared with uv's and with what is installed.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.conftest import ROOT
from tests.packages import (
    CONSTRAINTS,
    LEVELS,
    asked_by_level,
    list_path,
    read_level,
    read_list,
    read_pins,
    read_pyproject,
)
from tests.tools import leave_out, require_tool
from tools import licences

LISTS = [CONSTRAINTS, *map(list_path, LEVELS)]
PYTHONS = ["3.11", "3.12", "3.13"]
PLATFORMS = ["x86_64-manylinux_2_31", "aarch64-manylinux_2_31", "aarch64-apple-darwin"]
OLDEST_MACOS = "12.0"
HASH = re.compile(r"^    --hash=sha256:[0-9a-f]{64}( \\)?\n", re.MULTILINE)
RENEW = "run sh tools/lock"


def without_hashes(path: Path) -> str:
    return HASH.sub("", path.read_text(encoding="utf-8"))


def hashes(path: Path) -> set[str]:
    return set(re.findall("sha256:[0-9a-f]{64}", path.read_text(encoding="utf-8")))


def names(requirements: Iterable[Requirement]) -> set[str]:
    """Names of the packages that requirements ask for on this machine."""
    return {
        canonicalize_name(one.name)
        for one in requirements
        if one.marker is None or one.marker.evaluate()
    }


def test_lists_hold_the_pinned_versions_and_name_no_place() -> None:
    pins = read_pins()
    for level in LEVELS:
        listed = read_list(list_path(level))
        assert {str(one.specifier) for one in listed} == {
            f"=={pins[canonicalize_name(one.name)]}" for one in listed
        }
    assert {canonicalize_name(one.name) for one in read_level("test")} == set(pins), RENEW
    assert [path.name for path in LISTS if "://" in path.read_text(encoding="utf-8")] == []


@pytest.mark.parametrize("level", LEVELS)
def test_each_line_of_a_list_is_a_pin_with_hashes_or_names_the_list_below(level: str) -> None:
    text = list_path(level).read_text(encoding="utf-8")
    below = [f"-r {lower}.txt" for lower in LEVELS[: LEVELS.index(level)][-1:]]
    left = re.sub(
        rf"^[\w-]+==[\w.]+( ; [^\\]+)? \\\n({HASH.pattern})+", "", text, flags=re.MULTILINE
    )
    assert [line for line in left.splitlines() if line[0] != "#"] == below


@pytest.mark.parametrize("level", LEVELS)
def test_level_lists_exactly_what_it_needs_on_this_machine(level: str) -> None:
    as_pinned(names(read_level(level)))
    assert names(read_level(level)) == licences.collect(map(str, asked_by_level(level))), RENEW


def test_each_dependency_has_a_lowest_version() -> None:
    operators = {
        one.name: [each.operator for each in one.specifier] for one in asked_by_level("test")
    }
    assert {name for name, used in operators.items() if ">=" not in used} == set()
    asked = read_pyproject()["build-system"]["requires"]
    assert set(asked) <= set(read_pyproject()["dependency-groups"]["build"]), (
        "install.sh builds with these"
    )


@pytest.fixture(scope="module")
def uv() -> str:
    """Program uv, where it reaches an index of packages."""
    program = str(require_tool("uv", "pip install uv"))
    command = [program, "pip", "compile", "--quiet", "--no-cache", "-"]
    done = subprocess.run(command, input="packaging", capture_output=True, text=True, check=False)
    if done.returncode:
        leave_out(f"uv REACHES NO INDEX OF PACKAGES, THIS IS NOT TESTED: {done.stderr}")
    return program


@pytest.mark.full
@pytest.mark.usefixtures("uv")
def test_uv_finds_the_same_versions_and_hashes(tmp_path: Path) -> None:
    (tmp_path / "tools").mkdir()
    for name in ("pyproject.toml", "constraints.txt", "tools/lock"):
        (tmp_path / name).write_bytes((ROOT / name).read_bytes())
    subprocess.run(["sh", str(tmp_path / "tools/lock")], check=True)
    for path in LISTS:
        found = tmp_path / path.relative_to(ROOT)
        assert without_hashes(found) == without_hashes(path), RENEW
        assert hashes(path) <= hashes(found), (
            "files may be added to a release; those that are there do not change"
        )


@pytest.mark.full
@pytest.mark.every_case
@pytest.mark.parametrize("python", PYTHONS)
@pytest.mark.parametrize("platform", PLATFORMS)
def test_each_level_has_a_wheel_of_every_package(
    uv: str, platform: str, python: str, tmp_path: Path
) -> None:
    where = ["--python", sys.executable, "--python-version", python, "--python-platform", platform]
    for level in LEVELS:
        command = [uv, "pip", "install", "--quiet", "--dry-run", "--target", str(tmp_path), *where]
        command += ["--require-hashes", "--only-binary", ":all:", "-r", str(list_path(level))]
        environment = {**os.environ, "MACOSX_DEPLOYMENT_TARGET": OLDEST_MACOS}
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, ""), level


def test_lists_are_tried_for_the_supported_pythons() -> None:
    classifiers = read_pyproject()["project"]["classifiers"]
    assert [
        found[1] for one in classifiers if (found := re.search(r":: (3\.\d+)$", one))
    ] == PYTHONS


def as_pinned(needed: Iterable[str]) -> None:
    """Skip a test of a list where other versions than the pinned ones are installed."""
    pins = read_pins()
    installed = {
        canonicalize_name(one.metadata["Name"]): one.version for one in metadata.distributions()
    }
    wrong = [name for name in sorted(needed) if installed.get(name) != pins.get(name)]
    if wrong:
        pytest.skip(
            f"the list is about the pinned versions, and {wrong[0]} {installed.get(wrong[0])} is "
            "installed"
        )


@pytest.mark.full
def test_licence_of_every_dependency_is_listed() -> None:
    as_pinned(names(read_level("all")))
    page = licences.PAGE.read_text(encoding="utf-8")
    found = licences.list_licences()
    asked = {canonicalize_name(one.name) for one in asked_by_level("all")}
    listed = {canonicalize_name(one.name) for one in found}
    assert asked - listed == {"editables", "hatchling"}, (
        "these build fingertip; nobody passes them on"
    )

    rows = dict(re.findall(r"^- ([^:]+): (.*)$", page, re.MULTILINE))
    missing = [
        one.name
        for one in found
        if one.name not in re.sub(r" \(\w+\)", "", rows[one.text]).split(", ")
    ]
    assert missing == [], "run python -m tools.licences"

    mentioned = {name for name in listed if licences.mentions_lgpl(name)}
    assert mentioned <= set(licences.COPYLEFT) <= listed
    assert all(f"- **{metadata.metadata(name)['Name']}**: " in page for name in licences.COPYLEFT)

    # The oldest Python brings the most packages, so the page is that one's.
    if "{}.{}".format(*sys.version_info[:2]) == PYTHONS[0]:
        assert licences.format_page(found) == page
