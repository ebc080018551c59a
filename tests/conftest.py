"""Designs and builds that many tests look at: made once a session, read from disk by each."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fingertip.design import Design
from fingertip.kit import Build, build

ROOT = Path(__file__).resolve().parent.parent
DESIGNS = ("fsr400", "fsr402")


def run_python(*arguments: str, given: str | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    """A fresh Python process, with its output as text; `given` is its standard input."""
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        input=given,
        text=True,
        env=os.environ | environment,
        cwd=environment.get("PWD"),
        check=False,
        timeout=300,
    )


def run_fingertip(*arguments: object, given: str | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    """The command line in a fresh process."""
    return run_python("-m", "fingertip", *map(str, arguments), given=given, **environment)


def design_file(name: str) -> Path:
    """A bundled design."""
    return ROOT / "params" / f"{name}.toml"


@pytest.fixture(scope="session", params=DESIGNS)
def design(request: pytest.FixtureRequest) -> Design:
    """Each bundled design in turn."""
    return Design.load(design_file(request.param))


@pytest.fixture(scope="session")
def built(design: Design, tmp_path_factory: pytest.TempPathFactory) -> Build:
    """All parts of a bundled design in all formats, on disk."""
    return build(design, tmp_path_factory.mktemp(design.name))
