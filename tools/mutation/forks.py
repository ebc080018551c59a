"""Runs of pytest on a changed module, each in a fork of this process, which has imported what does not change."""

from __future__ import annotations

import importlib
import json
import math
import os
import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from importlib.abc import MetaPathFinder, SourceLoader
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
_OWN = ("fingertip", "tests", "conftest")
"""Packages of the repository."""
_NEVER_EARLY = ("tests", "conftest", "_pytest", "pytest", "__")
"""Packages that pytest must import itself."""


@dataclass(frozen=True)
class Target:
    """Module under test, and the arguments of pytest that test it."""

    path: Path
    arguments: tuple[str, ...]

    @property
    def name(self) -> str:
        """Dotted name of the module."""
        return ".".join(self.path.relative_to("src").with_suffix("").parts)

    @property
    def source(self) -> str:
        """Text of the unchanged module."""
        return (ROOT / self.path).read_text(encoding="utf-8")


@dataclass(frozen=True)
class Outcome:
    """Result of a run of the tests."""

    passed: bool
    failed: str = ""
    """Test that failed; empty if none did, or the fork ended before."""
    imported: tuple[str, ...] = ()
    """Modules that the run imported; empty if the fork ended before."""
    cpu_s: float = 0.0
    """CPU time of the run [s]."""


def import_early(target: Target, names: Iterable[str]) -> None:
    """Import what the tests of a module need, but nothing that imports the module itself, and no test."""
    for name in [name for name in sys.modules if name.split(".")[0] in _OWN]:
        del sys.modules[name]
    blocked = _Blocked(target.name)
    sys.meta_path.insert(0, blocked)
    for name in names:
        if not name.startswith(_NEVER_EARLY):
            # What cannot be imported early, for any reason, is imported in each fork.
            with suppress(Exception):
                importlib.import_module(name)
    sys.meta_path.remove(blocked)


def run_tests(target: Target, code: str, limit_s: float, kills: Counter[str] | None = None) -> Outcome:
    """Run the tests of a module in a fork that imports it with this code, those with the most kills first.

    Parameters
    ----------
    target
        The module and its tests.
    code
        Text of the changed module.
    limit_s
        CPU time after which the fork is ended [s]. One that waits is ended after ten times as long.
    kills
        Number of mutants that each test noticed so far.
    """
    with tempfile.TemporaryFile() as report:
        process = os.fork()
        if process == 0:
            _become_test_run(target, code, kills or Counter(), report.fileno(), limit_s)
        end_s = time.monotonic() + 10 * limit_s
        while time.monotonic() < end_s:
            done, status, usage = os.wait4(process, os.WNOHANG)
            if done:
                report.seek(0)
                text = report.read()
                failed, imported = json.loads(text) if text else ("", [])
                return Outcome(status == 0, failed, tuple(imported), usage.ru_utime + usage.ru_stime)
            time.sleep(0.02)
    os.killpg(process, signal.SIGKILL)
    os.waitpid(process, 0)
    return Outcome(passed=False)


def _become_test_run(target: Target, code: str, kills: Counter[str], report: int, limit_s: float) -> None:
    """Turn this fork into a run of pytest."""
    os.setpgid(0, 0)
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit_s), math.ceil(limit_s)))
    os.chdir(ROOT)
    silent = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(silent, stream)
    status, order = 1, _Order(kills)
    try:
        import hypothesis
        import pytest

        # A failure need not be made simple, and the same examples each time give the same result.
        phases = (hypothesis.Phase.explicit, hypothesis.Phase.generate)
        hypothesis.settings.register_profile("mutation", phases=phases, derandomize=True, database=None)
        hypothesis.settings.load_profile("mutation")
        sys.meta_path.insert(0, _Changed(target.name, str(ROOT / target.path), code))
        words = ["-x", "-q", "-o", "addopts=", "-p", "no:cacheprovider", "--tb=no", *target.arguments]
        status = int(pytest.main(words, plugins=[order]))
        os.pwrite(report, json.dumps([order.failed, list(sys.modules)]).encode(), 0)
    finally:
        os._exit(status)


class _Order:
    """Plugin of pytest that runs the tests with the most kills first, and remembers which failed."""

    def __init__(self, kills: Counter[str]) -> None:
        self._kills, self.failed = kills, ""

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        """Sort the tests; those with the same number stay in their order."""
        items.sort(key=lambda item: -self._kills[item.nodeid])

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Remember a test that failed."""
        if report.failed:
            self.failed = report.nodeid


class _Blocked(MetaPathFinder):
    """Import hook that refuses one module."""

    def __init__(self, name: str) -> None:
        self._name = name

    def find_spec(self, fullname: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
        """Refuse the module."""
        if fullname == self._name:
            raise ImportError(fullname)
        return None


class _Changed(MetaPathFinder, SourceLoader):  # type: ignore[misc]  # as importlib's own classes combine them
    """Import hook that gives one module another source."""

    def __init__(self, name: str, path: str, code: str) -> None:
        self._name, self._path, self._code = name, path, code

    def find_spec(self, fullname: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
        """Find the changed module only."""
        return spec_from_file_location(fullname, self._path, loader=self) if fullname == self._name else None

    def get_filename(self, fullname: str) -> str:
        """Return the path of the unchanged file."""
        return self._path

    def get_data(self, path: Any) -> bytes:
        """Return the changed source; there is no bytecode."""
        if path != self._path:
            raise OSError(path)
        return self._code.encode()
