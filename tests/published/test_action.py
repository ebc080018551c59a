"""The GitHub action: its steps, read from its own file, run in order as a runner runs them."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from tests.conftest import ROOT
from tests.published.conftest import BROKEN, VALID, make_repository, run
from tests.tools import leave_out, require_module

pytestmark = pytest.mark.full

EXPRESSION = re.compile(r"\$\{\{ ([^}]+?) \}\}")
INSTALLED = {"success", "!cancelled() && steps.install.outcome == 'success'"}


@dataclass
class Runner:
    """Runner of one job in the repository of a lab, with what its steps print."""

    source: Path
    lab: Path
    temporary: Path
    python: str = "python3"
    printed: str = ""
    codes: dict[str, int] = field(default_factory=dict)

    @property
    def summary(self) -> str:
        """Text that the steps added to the summary of the job."""
        path = self.temporary / "summary.md"
        return path.read_text() if path.exists() else ""

    def run(self, **inputs: str) -> dict[str, int]:
        """Run the action; returns the exit code of each step that ran."""
        action = require_module("yaml").safe_load(
            (self.source / ".github/actions/check/action.yml").read_text()
        )
        given = {name: str(entry.get("default", "")) for name, entry in action["inputs"].items()}
        given |= {name.replace("_", "-"): value for name, value in inputs.items()}
        given = {name: "" if "github.event" in value else value for name, value in given.items()}

        self.codes = {}
        self.printed = ""
        for step in action["runs"]["steps"]:
            if "run" in step and self._is_due(step.get("if", "success"), given):
                self.codes[step["name"]] = self._run_step(step, given)
        return self.codes

    def _is_due(self, condition: str, given: dict[str, str]) -> bool:
        """Evaluate the few conditions that the action uses."""
        condition = condition.removeprefix("${{ ").removesuffix(" }}")
        terms = condition.split(" && ")
        has_failed = any(self.codes.values())
        values = {
            "success": not has_failed,
            "!cancelled()": True,
            "steps.install.outcome == 'success'": self.codes.get("Install fingertip") == 0,
            "inputs.base != ''": given["base"] != "",
        }
        return all(values[term] for term in terms)

    def _run_step(self, step: dict[str, Any], given: dict[str, str]) -> int:
        known = {
            "github.action_path": str(self.source / ".github/actions/check"),
            "runner.temp": str(self.temporary),
            **{f"inputs.{name}": value for name, value in given.items()},
        }
        environment = {
            name: EXPRESSION.sub(lambda found: known[found[1]], value)
            for name, value in step["env"].items()
        }
        assert step["shell"] == "bash"
        assert "${{" not in step["run"], "no text of a pull request becomes a program"
        done = run(
            "bash",
            "--noprofile",
            "--norc",
            "-eo",
            "pipefail",
            "-c",
            step["run"],
            cwd=self.lab,
            check=False,
            GITHUB_ACTIONS="true",
            GITHUB_STEP_SUMMARY=str(self.temporary / "summary.md"),
            PATH=f"{self.temporary / 'path'}{os.pathsep}{os.environ['PATH']}",
            **environment,
        )
        self.printed += done.stdout + done.stderr
        return done.returncode


@pytest.fixture(scope="module")
def runner(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Runner:
    """Runner that has installed fingertip; a lab with two designs, a board and a folder
    of parts.
    """
    lab = tmp_path_factory.mktemp("lab")
    (lab / "designs").mkdir()
    for name in ("a", "b"):
        (lab / "designs" / f"{name}.toml").write_text(f'name = "{name}"\n')
    made = Runner(source, lab, tmp_path_factory.mktemp("runner"))
    assert made.run(designs="designs/a.toml", tolerance_mm="0.05") == {
        "Install fingertip": 0,
        "Check designs": 0,
        "Compare boards with their designs": 0,
        "Compare parts with their designs": 0,
    }, made.printed
    fingertip = made.temporary / "fingertip" / "bin" / "fingertip"
    run(fingertip, "board", "designs/a.toml", "--out", "pcb", "--quiet", cwd=lab)
    run(fingertip, "build", "designs/a.toml", "--out", "parts", "--quiet", cwd=lab)
    make_repository(lab)
    return made


def restore(runner: Runner) -> None:
    run("git", "checkout", "--quiet", "--force", "main", cwd=runner.lab)
    run("git", "clean", "--quiet", "--force", "-d", cwd=runner.lab)


def test_valid_designs_boards_and_parts_pass(runner: Runner) -> None:
    codes = runner.run(
        designs="designs/*.toml",
        boards="designs/a.toml:pcb\n",
        parts="designs/a.toml:parts\n",
        tolerance_mm="0.05",
    )
    assert set(codes.values()) == {0}, runner.printed
    suites = {
        suite.get("name")
        for suite in ElementTree.parse(runner.lab / "fingertip.xml").iter("testsuite")
    }
    assert suites == {"a", "b"}
    assert (runner.lab / "fingertip.sarif").stat().st_size
    restore(runner)


def test_every_check_runs_though_a_design_is_refused(runner: Runner) -> None:
    (runner.lab / "designs" / "a.toml").write_text('name = "a"\n[board]\ncutoff_hz = 80\n')
    (runner.lab / "designs" / "b.toml").write_text(BROKEN)
    codes = runner.run(
        designs="designs/*.toml",
        boards="designs/a.toml:pcb\n",
        parts="designs/a.toml:parts\n",
        tolerance_mm="0.05",
    )
    assert codes == {
        "Install fingertip": 0,
        "Check designs": 2,
        "Compare boards with their designs": 1,
        "Compare parts with their designs": 1,
    }, runner.printed
    assert "::error file=designs/b.toml,line=3,title=skin.width_mm::" in runner.printed
    assert (runner.lab / "fingertip.xml").exists()
    restore(runner)


def test_pull_request_is_told_what_it_changes(runner: Runner) -> None:
    base = run("git", "rev-parse", "HEAD", cwd=runner.lab).stdout.strip()
    (runner.lab / "designs" / "b.toml").write_text('name = "b"\n[skin]\nwidth_mm = 17.4\n')
    codes = runner.run(designs="designs/*.toml", base=base, tolerance_mm="0.05")
    assert codes["Tell what changed"] == 0, runner.printed
    assert "| `skin.width_mm` | 17 mm | 17.4 mm |" in runner.summary
    assert "designs/a.toml" not in runner.summary, "it is as it was"
    assert (runner.temporary / "fingertip-comparison" / "1-b" / "comparison.png").stat().st_size
    restore(runner)


@pytest.mark.parametrize(
    "name",
    ["--set=name=x.toml", "a\n::stop-commands::x.toml", "a%0A::add-mask::b.toml", "a,title=x.toml"],
)
def test_name_of_a_file_is_no_command(runner: Runner, name: str) -> None:
    (runner.lab / name).write_text(BROKEN)
    codes = runner.run(designs="*.toml", tolerance_mm="0.05")
    assert codes["Check designs"] == 2, runner.printed
    commands = [line for line in runner.printed.splitlines() if line.startswith("::")]
    assert all(line.startswith("::error file=") for line in commands), commands
    assert "x: all" not in runner.printed, "the name of the file was an option"
    restore(runner)


def test_python_of_the_system_is_left_alone(source: Path, tmp_path: Path) -> None:
    """Debian refuses to install into its own Python, which the action therefore does not."""
    system = Path("/usr/bin/python3")
    marks = list(Path("/usr/lib").glob("python3.*/EXTERNALLY-MANAGED"))
    if (
        not system.exists()
        or not marks
        or subprocess.run([system, "-c", "import ensurepip"], check=False).returncode
    ):
        leave_out("NO PYTHON OF DEBIAN WITH venv, THIS IS NOT TESTED: apt-get install python3-venv")
    (tmp_path / "path").mkdir()
    (tmp_path / "path" / "python3").symlink_to(system)
    (tmp_path / "valid.toml").write_text(VALID)
    runner = Runner(source, tmp_path, tmp_path)
    codes = runner.run(designs="valid.toml", tolerance_mm="0.05")
    assert set(codes.values()) == {0}, runner.printed
    shutil.rmtree(tmp_path / "fingertip")


def test_actions_are_pinned_by_hash() -> None:
    files = [*(ROOT / ".github").rglob("*.yml")]
    used = [word for path in files for word in re.findall(r"uses: (\S+)", path.read_text())]
    assert used
    assert [word for word in used if not re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", word)] == []


def test_commit_of_the_manual_holds_action_and_hooks_as_they_are() -> None:
    """A commit stands in docs/ci.md until a release is tagged; after a
    change of the action, name the new one there.
    """
    page = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
    commits = set(re.findall(r"(?:actions/check@|rev: )(\w+)", page))
    assert len(commits) == 1, commits
    (commit,) = commits
    run("git", "merge-base", "--is-ancestor", commit, "HEAD", cwd=ROOT)
    for name in (".github/actions/check/action.yml", ".pre-commit-hooks.yaml"):
        then = run("git", "show", f"{commit}:{name}", cwd=ROOT).stdout
        assert then == (ROOT / name).read_text(encoding="utf-8"), name
