"""Development container: the one of CI, with the tools that its scripts install."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.conftest import ROOT
from tests.tools import require_tool

CONTAINER: dict[str, Any] = json.loads(
    (ROOT / ".devcontainer/devcontainer.json").read_text(encoding="utf-8")
)
JOB: dict[str, Any] = yaml.safe_load(
    (ROOT / ".github/workflows/ci.yml").read_text(encoding="utf-8"),
)["jobs"]["run"]


def test_it_has_the_system_and_the_python_of_ci() -> None:
    assert CONTAINER["image"] == JOB["container"]
    assert CONTAINER["remoteUser"] == "root"

    header = (ROOT / ".ci/run").read_text(encoding="utf-8").partition("set -e")[0]
    release = re.search(r'"\$\{VERSION_CODENAME:-\}" = (\w+) \]', read_script("install-kicad"))
    python = re.search(r"Debian 12 with Python (\d+\.\d+)", header)
    assert python
    assert release
    assert CONTAINER["image"] == f"python:{python[1]}-{release[1]}"


def test_it_has_the_packages_that_ci_installs_before_its_scripts() -> None:
    (step,) = [step["run"] for step in JOB["steps"] if "apt-get" in step.get("run", "")]
    assert list_packages(CONTAINER["onCreateCommand"]) == list_packages(step) == ["git"]


def test_it_trusts_the_checkout(tmp_path: Path) -> None:
    require_tool("git", "apt-get install git")
    write_script(tmp_path / "bin/apt-get", "exit 0")

    done = run_command(CONTAINER["onCreateCommand"], tmp_path)

    assert done.returncode == 0, done.stderr
    trusted = run_command("git config --global --get-all safe.directory", tmp_path)
    assert trusted.stdout == f"{tmp_path}\n"


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("broken", "called"),
    [
        (None, ["install.sh test", "install-a", "install-b"]),
        ("install-a", ["install.sh test", "install-a"]),
        ("install.sh", ["install.sh test"]),
    ],
)
def test_it_runs_every_script_that_installs_a_tool_and_stops_at_a_failure(
    broken: str | None,
    called: list[str],
    tmp_path: Path,
) -> None:
    for name in ("install.sh", ".ci/install-a", ".ci/install-b", ".ci/run"):
        path = tmp_path / name
        status = 3 if path.name == broken else 0
        write_script(path, f'echo {path.name} "$@"; exit {status}')

    done = run_command(CONTAINER["postCreateCommand"], tmp_path)

    assert [line.strip() for line in done.stdout.splitlines()] == called
    assert done.returncode == (3 if broken else 0)


def read_script(name: str) -> str:
    """Text of a script of CI."""
    return (ROOT / ".ci" / name).read_text(encoding="utf-8")


def list_packages(command: str) -> list[str]:
    """List the packages that a command installs with apt-get."""
    words = re.search(r"apt-get install ([^&;|\n]+)", command)
    assert words
    return [word for word in words[1].split() if not word.startswith("-")]


def write_script(path: Path, text: str) -> None:
    """Write a script for sh that can be run."""
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
    path.chmod(0o755)


def run_command(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command of the container in a folder that is its home, with the programs in `bin`."""
    return subprocess.run(
        ["sh", "-c", command],
        cwd=folder,
        env={"PATH": f"{folder}/bin:/usr/local/bin:/usr/bin:/bin", "HOME": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
