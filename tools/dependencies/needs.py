"""Packages that each level of install.sh needs, on each Python version and system that constraints-hashes.txt covers.

They are read in the metadata of what is installed. Metadata names what other systems need too; a package that is not
installed here counts as one that needs nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from typing import Any

from packaging.requirements import Requirement
from packaging.tags import Tag, compatible_tags, cpython_tags, mac_platforms

from tools.dependencies.pins import canonical, names_of, supported_pythons, users_packages, usual_packages

PLATFORMS = {("Linux", "x86_64"): (2, 31), ("Linux", "aarch64"): (2, 31), ("Darwin", "arm64"): (12, 0)}
"""Systems and processors with a wheel of every pinned package, and the oldest glibc or macOS that suits all of them."""


@dataclass(frozen=True)
class Target:
    """CPython on a platform."""

    python: tuple[int, int]
    system: str
    machine: str

    @property
    def name(self) -> str:
        """Binary interface and processor, as install.sh asks Python for them."""
        where = f"{self.machine}-linux-gnu" if self.system == "Linux" else "darwin"
        return f"cpython-{self.python[0]}{self.python[1]}-{where} {self.machine}"

    @property
    def environment(self) -> dict[str, str]:
        """Values that the markers of requirements are compared with."""
        version = f"{self.python[0]}.{self.python[1]}"
        return {
            "python_version": version,
            "python_full_version": f"{version}.0",
            "sys_platform": self.system.lower(),
            "platform_system": self.system,
            "platform_machine": self.machine,
        }


@dataclass(frozen=True)
class Need:
    """First level that needs a package, and the targets on which this or a higher level does."""

    level: str
    targets: frozenset[Target]


@cache
def wheel_tags(target: Target) -> frozenset[Tag]:
    """List the tags of the wheels that a target can install."""
    release = PLATFORMS[target.system, target.machine]
    if target.system == "Linux":
        platforms = [f"manylinux_2_{minor}_{target.machine}" for minor in range(5, release[1] + 1)]
        platforms += [f"manylinux{old}_{target.machine}" for old in ("2014", "2010", "1")]
    else:
        platforms = list(mac_platforms(release, target.machine))
    interpreter = f"cp{target.python[0]}{target.python[1]}"
    return frozenset(cpython_tags(target.python, [interpreter], platforms)) | frozenset(
        compatible_tags(target.python, interpreter, platforms)
    )


def list_targets(project: dict[str, Any]) -> list[Target]:
    """List the targets: each supported Python version on each platform."""
    return [Target(python, *platform) for python in supported_pythons(project) for platform in PLATFORMS]


def list_levels(project: dict[str, Any], back_end: Iterable[str]) -> dict[str, list[str]]:
    """List what each level of install.sh asks for directly, the lowest first. Each holds those before it."""
    extras = [line for lines in project["optional-dependencies"].values() for line in lines]
    return {
        # hatchling asks for `editables` while it makes an editable installation, not in its metadata.
        "core": [*names_of(project["dependencies"]), *back_end, "editables"],
        "usual": usual_packages(project),
        "all": users_packages(project),
        "test": [name for name in names_of(extras) if name != project["name"]],
    }


def list_needs(levels: Mapping[str, Iterable[str]], targets: Iterable[Target]) -> dict[str, Need]:
    """List the packages that the levels need, with everything that those ask for, by name in canonical form."""
    found: dict[str, Need] = {}
    for level, names in levels.items():
        for target in targets:
            for name in collect(names, target.environment):
                known = found.get(name, Need(level, frozenset()))
                found[name] = Need(known.level, known.targets | {target})
    return found


def format_marker(need: Need, targets: Iterable[Target]) -> str:
    """Format the condition under which pip installs a package; empty if all targets need it."""
    every, conditions = list(targets), []
    for key in ("python_version", "sys_platform"):
        values = {target.environment[key] for target in need.targets}
        if values != {target.environment[key] for target in every}:
            conditions.append("(" + " or ".join(f'{key} == "{value}"' for value in sorted(values)) + ")")
    return " and ".join(conditions)


def collect(names: Iterable[str], environment: Mapping[str, str] | None = None) -> set[str]:
    """Collect packages with everything that they ask for, in canonical form; on this machine without an environment."""
    waiting = [(canonical(name), frozenset[str]()) for name in names]
    done: set[tuple[str, frozenset[str]]] = set()
    while waiting:
        name, extras = one = waiting.pop()
        if one in done:
            continue
        done.add(one)
        for requirement in _requirements(name):
            marker = requirement.marker
            if marker is None or any(
                marker.evaluate({**(environment or {}), "extra": extra}) for extra in extras or {""}
            ):
                waiting.append((canonical(requirement.name), frozenset(requirement.extras)))
    return {name for name, _ in done}


@cache
def _requirements(name: str) -> tuple[Requirement, ...]:
    """Requirements of an installed package."""
    try:
        return tuple(Requirement(line) for line in metadata.distribution(name).requires or ())
    except metadata.PackageNotFoundError:
        return ()
