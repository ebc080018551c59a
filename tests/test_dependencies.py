"""Lists about dependencies: hashes of wheels and licences, compared with constraints.txt and with what is installed."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from importlib import metadata

import pytest

from tools.dependencies import hashes, licences, needs
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
    rows = dict(re.findall(r"^- ([^:]+): (.*)$", PAGE, re.MULTILINE))
    missing = [one.name for one in found if one.name not in re.sub(r" \(\w+\)", "", rows[one.text]).split(", ")]
    assert missing == [], "run python -m tools.dependencies.licences"
    names = {canonical(one.name) for one in found}
    mentioned = {name for name in names if licences.mentions_lgpl(name)}
    assert mentioned <= set(licences.COPYLEFT) <= names
    assert all(f"- **{metadata.metadata(name)['Name']}**: " in PAGE for name in licences.COPYLEFT)
    # The oldest Python brings the most packages, so the page is that one's.
    if sys.version_info[:2] == PYTHONS[0]:
        assert licences.format_page(found) == PAGE
