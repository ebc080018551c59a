"""Versions that constraints.txt pins, and packages that the extras of pyproject.toml ask for."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
CONSTRAINTS = ROOT / "constraints.txt"


def canonical(name: str) -> str:
    """Return the name of a package in the form that compares."""
    return re.sub(r"[-_.]+", "-", name).lower()


def read_pins(text: str) -> dict[str, str]:
    """Read the version of each package from constraints, by the name that stands there."""
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    return dict(line.split("==") for line in lines)


def read_project() -> dict[str, Any]:
    """Read the table `project` of pyproject.toml."""
    table: dict[str, Any] = _read_pyproject()["project"]
    return table


def read_back_end() -> list[str]:
    """List the packages that pyproject.toml names for building, in canonical form."""
    return names_of(_read_pyproject()["build-system"]["requires"])


def _read_pyproject() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def supported_pythons(project: dict[str, Any]) -> list[tuple[int, int]]:
    """List the Python versions that the classifiers of pyproject.toml name."""
    found = (re.fullmatch(r"Programming Language :: Python :: 3\.(\d+)", line) for line in project["classifiers"])
    return [(3, int(match[1])) for match in found if match]


def names_of(requirements: Iterable[str]) -> list[str]:
    """List the packages of requirements, in canonical form."""
    return [canonical(re.split(r"[^\w.-]", requirement)[0]) for requirement in requirements]


def users_packages(project: dict[str, Any]) -> list[str]:
    """List what the core and the extras for users ask for directly."""
    return names_of([*project["dependencies"], *_lines_of(project, "all")])


def usual_packages(project: dict[str, Any]) -> list[str]:
    """List what the core and the extra `usual` ask for directly."""
    return names_of([*project["dependencies"], *_lines_of(project, "usual")])


def _lines_of(project: dict[str, Any], extra: str) -> list[str]:
    """List the requirements of an extra, those of the extras that it names in place of them."""
    found = []
    for line in project["optional-dependencies"][extra]:
        named = re.fullmatch(rf"{project['name']}\[(.+)\]", line)
        found += [each for name in named[1].split(",") for each in _lines_of(project, name)] if named else [line]
    return found
