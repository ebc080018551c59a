"""The wheel, the source, and environments made from them."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.conftest import ROOT

VALID = 'name = "index"\n'
BROKEN = 'name = "index"\n[skin]\nwidth_mm = 3\n'
FAULT = 70
"""Exit code of a fault of the program."""


def run(
    *words: str | Path, cwd: Path, check: bool = True, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run a program as a user does: nothing of the tests' own environment leads to the checkout."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("PYTHON", "VIRTUAL_ENV", "COVERAGE", "GIT_"))
    }
    done = subprocess.run(
        [str(word) for word in words],
        cwd=cwd,
        env=kept | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=1200,
    )
    if check:
        assert done.returncode == 0, f"{words}\n{done.stdout}\n{done.stderr}"
    return done


@dataclass(frozen=True)
class Installation:
    """Environment with fingertip in it, and an empty folder to work in."""

    bin: Path
    folder: Path

    def fingertip(
        self, *words: str | Path, check: bool = False
    ) -> subprocess.CompletedProcess[str]:
        """Run the command; no input may end with a fault of the program."""
        done = run(self.bin / "fingertip", *words, cwd=self.folder, check=check)
        assert done.returncode != FAULT, done.stderr
        return done

    def python(self, code: str) -> subprocess.CompletedProcess[str]:
        """Run Python code in the environment."""
        return run(self.bin / "python", "-c", code, cwd=self.folder)

    def accepts(self, *words: str | Path) -> str:
        """Run the command on valid input; returns what it prints."""
        return self.fingertip(*words, check=True).stdout

    def refuses(self, *words: str | Path, code: int = 2) -> str:
        """Run the command on input that it must refuse in sentences; returns them."""
        done = self.fingertip(*words)
        assert done.returncode == code, f"{done.stdout}\n{done.stderr}"
        assert "Traceback" not in done.stderr
        assert done.stderr.startswith("error: ") or done.stdout
        return done.stderr or done.stdout

    def write_designs(self) -> None:
        """Write a design that is valid, and one that is not."""
        (self.folder / "valid.toml").write_text(VALID)
        (self.folder / "broken.toml").write_text(BROKEN)


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from this source."""
    folder = tmp_path_factory.mktemp("wheel")
    run(
        sys.executable,
        "-m",
        "hatchling",
        "build",
        "--target",
        "wheel",
        "--directory",
        folder,
        cwd=ROOT,
    )
    (found,) = folder.glob("*.whl")
    return found


@pytest.fixture(scope="session")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Git repository with what git knows of this source, as a user clones it."""
    folder = tmp_path_factory.mktemp("source") / "fingertip"
    if not (ROOT / ".git").exists():
        pytest.fail(
            "this is no git checkout, from which a user's clone could be made", pytrace=False
        )
    listed = run(
        "git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", cwd=ROOT
    ).stdout
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    make_repository(folder)
    return folder


def make_repository(folder: Path) -> None:
    """Commit all files of a folder to a new git repository."""
    author = ("-c", "user.name=tester", "-c", "user.email=tester@example.org")
    run("git", "init", "--quiet", "--initial-branch", "main", cwd=folder)
    run("git", "add", "--all", cwd=folder)
    run("git", *author, "commit", "--quiet", "--message", "First", cwd=folder)


@pytest.fixture
def install(wheel: Path, tmp_path: Path) -> Iterator[Callable[..., Installation]]:
    """Function that makes a venv, and installs the wheel with an extra
    into it, as `pip install NAME[EXTRA]` does.
    """
    made = []

    def make(extra: str = "", *options: str) -> Installation:
        venv = tmp_path / "venv"
        run("python3", "-m", "venv", venv, cwd=tmp_path)
        requirement = f"{wheel}[{extra}]" if extra else str(wheel)
        run(venv / "bin" / "pip", "install", "--quiet", *options, requirement, cwd=tmp_path)
        made.append(venv)
        folder = tmp_path / "work"
        folder.mkdir()
        installation = Installation(venv / "bin", folder)
        installation.write_designs()
        return installation

    yield make
    for venv in made:
        shutil.rmtree(venv)  # some hold two gigabytes
