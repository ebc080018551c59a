"""Composite action and pre-commit hooks for other repositories: their steps run as those services run them."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from tests.conftest import ROOT, run_fingertip
from tests.tools import require_module

ACTION = ROOT / ".github" / "actions" / "check" / "action.yml"
HOOKS = ROOT / ".pre-commit-hooks.yaml"


def read_yaml(path: Path) -> Any:
    return require_module("yaml").safe_load(path.read_text(encoding="utf-8"))


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """Repository of another lab: two designs and a board, and programs that stand for an installation."""
    for name in ("a", "b"):
        (tmp_path / f"{name}.toml").write_text(f'name = "{name}"\n')
    assert run_fingertip("board", "a.toml", "--out", "pcb", "--quiet", PWD=str(tmp_path)).returncode == 0
    programs = tmp_path / "bin"
    programs.mkdir()
    for name, line in (
        ("python3", 'echo "$@" >>"$PIP_LOG"'),
        ("fingertip", f'exec {shlex.quote(sys.executable)} -m fingertip "$@"'),
    ):
        (programs / name).write_text(f"#!/bin/sh\n{line}\n")
        (programs / name).chmod(0o755)
    return tmp_path


def run_action(repository: Path, **inputs: str) -> list[int]:
    """Run the steps of the action as a runner does, up to the first that fails; returns their exit codes."""
    action = read_yaml(ACTION)
    given = {
        name: inputs.get(name.replace("-", "_"), entry.get("default", "")) for name, entry in action["inputs"].items()
    }
    codes = []
    for step in action["runs"]["steps"]:
        environment = {
            name: re.sub(
                r"\$\{\{ (?:inputs\.([\w-]+)|(github\.action_path)) \}\}",
                lambda found: given[found[1]] if found[1] else str(ACTION.parent),
                value,
            )
            for name, value in step["env"].items()
        }
        assert step["shell"] == "bash"
        assert not any("${{" in text for text in (step["run"], *environment.values())), "no text becomes a program"
        path = f"{repository / 'bin'}{os.pathsep}{os.environ['PATH']}"
        done = subprocess.run(
            ["bash", "-e", "-o", "pipefail", "-c", step["run"]],
            cwd=repository,
            env=os.environ | environment | {"PATH": path, "PIP_LOG": str(repository / "pip.log")},
            check=False,
        )
        codes.append(done.returncode)
        if done.returncode:
            break
    return codes


@pytest.mark.full
def test_action_checks_designs_and_boards_and_is_documented(repository: Path) -> None:
    assert run_action(repository, designs="*.toml", boards="a.toml:pcb\n", tolerance_mm="0.05") == [0, 0, 0]
    suites = {suite.get("name") for suite in ElementTree.parse(repository / "fingertip.xml").iter("testsuite")}
    assert suites == {"a", "b"}
    (installed,) = (repository / "pip.log").read_text().splitlines()
    source = Path(installed.split()[-1].removesuffix("[mesh]"))
    assert (source / "pyproject.toml").samefile(ROOT / "pyproject.toml")
    (repository / "a.toml").write_text('name = "a"\n[board]\ncutoff_hz = 80\n')
    codes = run_action(repository, designs="b.toml", boards="a.toml:pcb\nb.toml:none\n", tolerance_mm="0.05")
    assert codes == [0, 0, 1], "a board of another design"
    (repository / "a.toml").write_text("[skin]\nwidth_mm = 3\n")
    assert run_action(repository, designs="a.toml") == [0, 2]
    page = (ROOT / "docs" / "ci.md").read_text()
    assert all(text in page for text in ("id: fingertip-check", "id: fingertip-board", ".github/actions/check"))


@pytest.mark.full
def test_hooks_run(repository: Path) -> None:
    hooks = {hook["id"]: hook for hook in read_yaml(HOOKS)}
    assert set(hooks) == {"fingertip-check", "fingertip-board"}
    assert all(hook["language"] == "python" for hook in hooks.values()), "pre-commit installs the package"

    def run(name: str, *more: str) -> int:
        program, *words = shlex.split(hooks[name]["entry"])
        assert program == "fingertip"
        return run_fingertip(*words, *more, PWD=str(repository)).returncode

    assert run("fingertip-check", "--tolerance-mm", "0.05", "a.toml") == 0
    assert run("fingertip-board", "a.toml", "--out", "pcb") == 0
    (repository / "a.toml").write_text('name = "a"\n[board]\ncutoff_hz = 80\n')
    assert run("fingertip-board", "a.toml", "--out", "pcb") == 1
    (repository / "a.toml").write_text("[skin]\nwidth_mm = 3\n")
    assert run("fingertip-check", "a.toml") == 2
