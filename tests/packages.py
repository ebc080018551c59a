"""Packages that pyproject.toml asks for, and the lists of their
versions that `sh tools/lock` writes.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.conftest import ROOT

CONSTRAINTS = ROOT / "constraints.txt"
LEVELS = ("core", "mesh", "usual", "all", "test")
"""Each has its list and holds those before it. install.sh takes all
but `mesh`, which the GitHub action installs.
"""


def list_path(level: str) -> Path:
    return ROOT / "requirements" / f"{level}.txt"


def read_pyproject() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def read_list(path: Path) -> list[Requirement]:
    """Read the requirements that stand in a list itself, not in the one that it names."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return [Requirement(line.removesuffix(" \\")) for line in lines if line[0] not in "#- "]


def read_level(level: str) -> list[Requirement]:
    """Read the requirements of a level's list and of those below it."""
    return [one for each in LEVELS[: LEVELS.index(level) + 1] for one in read_list(list_path(each))]


def read_pins() -> dict[str, str]:
    """Read the pinned version of each package."""
    return {
        canonicalize_name(one.name): str(one.specifier).removeprefix("==")
        for one in read_list(CONSTRAINTS)
    }


def asked_by(project: dict[str, Any], lines: Iterable[str]) -> Iterator[Requirement]:
    """Go through requirements, with those of an extra in place of its name."""
    for line in lines:
        requirement = Requirement(line)
        if requirement.name != project["name"]:
            yield requirement
        for extra in sorted(requirement.extras) if requirement.name == project["name"] else ():
            yield from asked_by(project, project["optional-dependencies"][extra])


def asked_by_level(level: str) -> list[Requirement]:
    """List what a level asks for directly: what builds fingertip,
    its own dependencies, and those of an extra.
    """
    table = read_pyproject()
    project = table["project"]
    lines = [*table["dependency-groups"]["build"], *project["dependencies"]]
    if level != "core":
        lines.append(f"{project['name']}[{level}]")
    return list(asked_by(project, lines))
