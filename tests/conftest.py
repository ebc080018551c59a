"""Designs and builds that many tests look at: made once a session, read from disk by each."""

from __future__ import annotations

import contextlib
import functools
import os
import signal
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TypeVar

import hypothesis
import pytest
import typer
from typer.testing import CliRunner

from fingertip.cad.build_result import Build
from fingertip.cli import app
from fingertip.design import Design
from fingertip.foundation import extras, jit
from fingertip.tasks.build import build
from tests import first_set
from tests.first_set import FULL

# How long an example takes depends on the machine; no test asserts it. `benchmarks/` measures.
hypothesis.settings.register_profile("fingertip", deadline=None)
hypothesis.settings.load_profile("fingertip")

# Making the commands takes longer than most of them do in a test, so they are made once.
typer.testing.__dict__["_get_command"] = functools.cache(typer.main.get_command)

ROOT = Path(__file__).resolve().parent.parent
DESIGNS = ("fsr400", "fsr402", "first_finger")


Case = TypeVar("Case")


def pytest_configure(config: pytest.Config) -> None:
    """Select the tests that run."""
    config.pluginmanager.register(first_set)
    # A process in the background of a shell ignores Ctrl-C, and so would the commands that tests
    # interrupt.
    signal.signal(signal.SIGINT, signal.default_int_handler)


def some_of(cases: Iterable[Case], *kept: Case) -> list[Case]:
    """Select the cases of a shared fixture: those kept, or every one in `.ci/full`."""
    return [case for case in cases if FULL or case in kept]


def run_python(
    *arguments: str, given: str | None = None, **environment: str
) -> subprocess.CompletedProcess[str]:
    """A fresh Python process, with its output as text; `given` is its standard input."""
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        input=given,
        text=True,
        env=os.environ | {"PYTHONSAFEPATH": ""} | environment,  # `main`, called by a test, sets it
        cwd=environment.get("PWD"),
        check=False,
        timeout=300,
    )


def run_fingertip(
    *arguments: object, given: str | None = None, fresh: bool = False, **environment: str
) -> subprocess.CompletedProcess[str]:
    """The command line, `given` on standard input, in this process: a `fresh` one takes half a
    second to start.

    Changes of the environment start one too, but for `PWD`, the folder to run in.
    """
    words = [str(argument) for argument in arguments]
    if fresh or environment.keys() - {"PWD"}:
        return run_python("-m", "fingertip", *words, given=given, **environment)
    with contextlib.chdir(environment.get("PWD", os.getcwd())):
        done = CliRunner().invoke(app, words, input=given, prog_name="fingertip")
    if done.exception and not isinstance(done.exception, SystemExit):
        raise done.exception
    return subprocess.CompletedProcess(words, done.exit_code, done.stdout, done.stderr)


def design_file(name: str) -> Path:
    """A bundled design."""
    return ROOT / "params" / f"{name}.toml"


@pytest.fixture(scope="session", params=some_of(DESIGNS, "fsr400", "first_finger"))
def design(request: pytest.FixtureRequest) -> Design:
    """Each bundled design in turn, of which two stand for all outside `.ci/full`."""
    return Design.load(design_file(request.param))


@pytest.fixture(scope="session")
def built(design: Design, tmp_path_factory: pytest.TempPathFactory) -> Build:
    """All parts of a bundled design in all formats, on disk."""
    return build(design, tmp_path_factory.mktemp(design.name))


@pytest.fixture
def core(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The packages of all extras cannot be found, and `pip` on the PATH is that of this Python."""
    monkeypatch.setattr(extras, "find_pip", lambda: "pip install")
    for module in extras.EXTRAS:
        monkeypatch.setitem(sys.modules, module, None)
    jit.available.cache_clear()
    yield
    jit.available.cache_clear()
