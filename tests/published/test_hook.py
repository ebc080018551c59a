"""The pre-commit hooks, in the environments that pre-commit makes for them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.published.conftest import BROKEN, VALID, Installation, make_repository, run

pytestmark = pytest.mark.full


@pytest.fixture(scope="module")
def pre_commit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program pre-commit, installed as CONTRIBUTING.md says."""
    venv = tmp_path_factory.mktemp("pre-commit") / "venv"
    run("python3", "-m", "venv", venv, cwd=venv.parent)
    run(venv / "bin" / "pip", "install", "--quiet", "pre-commit", cwd=venv.parent)
    return venv / "bin" / "pre-commit"


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder in which pre-commit keeps the environments of the hooks."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    """Repository of a lab with one design."""
    folder = tmp_path / "lab"
    (folder / "designs").mkdir(parents=True)
    (folder / "designs" / "index.toml").write_text(VALID)
    make_repository(folder)
    return folder


def try_hook(
    pre_commit: Path, cache: Path, lab: Path, source: Path, hook: str, *more: str
) -> subprocess.CompletedProcess[str]:
    return run(
        pre_commit,
        "try-repo",
        source,
        hook,
        "--verbose",
        *more,
        cwd=lab,
        check=False,
        PRE_COMMIT_HOME=str(cache),
    )


def test_designs_are_checked(pre_commit: Path, cache: Path, lab: Path, source: Path) -> None:
    done = try_hook(pre_commit, cache, lab, source, "fingertip-check", "--all-files")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "checks passed" in done.stdout

    (lab / "designs" / "index.toml").write_text(BROKEN)
    done = try_hook(pre_commit, cache, lab, source, "fingertip-check", "--all-files")
    assert done.returncode == 1
    assert "- exit code: 2" in done.stdout
    assert "skin.width_mm: 3" in done.stdout


def test_file_that_looks_like_an_option_renames_no_design(
    pre_commit: Path, cache: Path, lab: Path, source: Path
) -> None:
    (lab / "--set=name=x.toml").write_text(VALID)
    run("git", "add", "--all", cwd=lab)
    done = try_hook(pre_commit, cache, lab, source, "fingertip-check", "--all-files")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "index: all" in done.stdout


def test_boards_and_parts_are_compared(
    pre_commit: Path, cache: Path, lab: Path, source: Path, tmp_path: Path
) -> None:
    here = Installation(Path(sys.executable).parent, lab)
    design = "designs/index.toml"
    here.accepts("board", design, "--out", "pcb", "--quiet")
    here.accepts("build", design, "--formats", "stl", "--out", "parts", "--quiet")

    config = lab / ".pre-commit-config.yaml"
    revision = run("git", "rev-parse", "HEAD", cwd=source).stdout.strip()
    config.write_text(
        f"repos:\n- repo: {source}\n  rev: {revision}\n  hooks:\n"
        f"  - id: fingertip-board\n    args: [{design}, --out, pcb]\n"
        f"  - id: fingertip-parts\n    args: [{design}, --out, parts]\n"
    )
    run("git", "add", "--all", cwd=lab)
    words = (pre_commit, "run", "--all-files", "--verbose")
    done = run(*words, cwd=lab, check=False, PRE_COMMIT_HOME=str(cache))
    assert done.returncode == 0, done.stdout + done.stderr

    (lab / design).write_text(VALID + "[board]\ncutoff_hz = 80\n")
    done = run(*words, cwd=lab, check=False, PRE_COMMIT_HOME=str(cache))
    assert done.returncode == 1
    assert done.stdout.count("- exit code: 1") == 2
    assert "board.cutoff_hz: 80.0 in the design, 67.0 in the folder" in done.stdout
