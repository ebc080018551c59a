"""Runs of tests on changed modules.

A server process imports and collects all tests once. For each mutant it forks, gives the changed
functions their new code, empties the caches of functions, and runs the tests that reach the change,
the most promising first, until one fails. A change outside functions (a constant, a class, a loop
that numba compiles) needs the module to be imported anew: these mutants run in a fresh process,
whose import hook gives the module its changed source.
"""

from __future__ import annotations

import functools
import gc
import json
import math
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import CodeType, FunctionType
from typing import IO, Any

import pytest

from tools.mutation.mutants import ROOT, Mutant

START = Path(__file__).resolve().parent / "start"
TESTS_VARIABLE = "FINGERTIP_MUTATION_TESTS"
"""Variable that names a file with the tests of a fresh process, in the order in which they run."""
_PATIENCE = 5.0
_MIN_LIMIT_S = 30.0
"""CPU time limit of a mutant, as a multiple of the time that its
tests take, above a smallest one [s].
"""


@dataclass(frozen=True)
class Job:
    """Mutant and the tests that can notice it."""

    mutant: Mutant
    tests: Sequence[str]
    expected_s: float
    """CPU time of these tests without any change [s]."""
    is_fresh: bool
    """True if the module must be imported anew."""

    accused: tuple[Job, Outcome] | None = None
    """Job whose failed test runs here on the unchanged source, and its outcome."""

    @property
    def limit_s(self) -> int:
        """Limit of the CPU time [s]. A process that waits is ended after five times as long."""
        return math.ceil(_MIN_LIMIT_S + _PATIENCE * self.expected_s)


@dataclass(frozen=True)
class Outcome:
    """Result of a job."""

    noticed: bool
    test: str = ""
    """Test that failed; empty if none did, or the process was ended."""


Make = Callable[[Collection[str], Counter[str]], Iterator[Job]]
"""Generator of jobs.
It gets the first set of tests, and reads how many mutants each test has noticed so far.
"""


class Server:
    """Plugin of pytest that runs jobs in place of the collected tests.

    A test that notices a mutant is run on the unchanged source too. If it fails there, it counts
    for nothing.
    """

    def __init__(self, make: Make, report: Callable[[Job, Outcome], None], at_once: int) -> None:
        self._make = make
        self._report = report
        self._at_once = at_once
        self._kills = Counter[str]()
        self._reliable = dict[str, bool]()
        self._running: dict[int, tuple[Job, IO[bytes], float]] = {}

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: Any) -> bool:
        """Run the jobs, several at once."""
        from tests.first_set import select

        items = {item.nodeid: item for item in session.items}
        gc.collect()
        gc.freeze()  # what the forks share stays shared
        jobs = self._make({item.nodeid for item in select(session.items)}, self._kills)
        urgent = list[Job]()

        while True:
            while len(self._running) < self._at_once and (
                job := urgent.pop() if urgent else next(jobs, None)
            ):
                self._start(session, [items[test] for test in job.tests if test in items], job)

            if not self._running:
                return True

            urgent += self._judge(*self._wait())

    def _start(self, session: Any, items: Sequence[Any], job: Job) -> None:
        answer = tempfile.TemporaryFile()  # noqa: SIM115 (closed when the job has ended)
        process = os.fork()
        if process == 0:
            _become_run(session, items, job, answer.fileno())

        self._running[process] = (job, answer, time.monotonic() + 5 * job.limit_s)

    def _wait(self) -> tuple[Job, Outcome]:
        """Wait until one of the running jobs has ended, and end those that take too long."""
        while True:
            for process, (job, answer, end_s) in list(self._running.items()):
                done, status = os.waitpid(process, os.WNOHANG)
                if done or time.monotonic() > end_s:
                    if not done:
                        os.killpg(process, signal.SIGKILL)
                        os.waitpid(process, 0)

                    del self._running[process]
                    answer.seek(0)
                    with answer:
                        return job, Outcome(not done or status != 0, answer.read().decode())

            time.sleep(0.02)

    def _judge(self, job: Job, outcome: Outcome) -> list[Job]:
        """Report a job, or return the one that has to run before that is possible."""
        if job.accused is not None:
            self._reliable[job.tests[0]] = not outcome.noticed
            job, outcome = job.accused
        elif outcome.test and outcome.test not in self._reliable:
            unchanged = replace(
                job.mutant, code=(ROOT / job.mutant.path).read_text(encoding="utf-8")
            )
            return [replace(job, mutant=unchanged, tests=[outcome.test], accused=(job, outcome))]

        if not self._reliable.get(outcome.test, True):
            return [
                replace(job, tests=[test for test in job.tests if self._reliable.get(test, True)])
            ]

        self._kills[outcome.test] += bool(outcome.test)
        self._report(job, outcome)
        return []


def _become_run(session: Any, items: Sequence[Any], job: Job, answer: int) -> None:
    """Turn this fork into a run of some tests on a mutant."""
    status = 1
    try:
        os.setpgid(0, 0)
        silent = os.open(os.devnull, os.O_RDWR)
        for stream in range(3):
            os.dup2(silent, stream)

        with tempfile.TemporaryDirectory(prefix="fingertip-mutant-") as folder:
            if job.is_fresh:
                status = _run_fresh(job, Path(folder), answer)
            else:
                resource.setrlimit(resource.RLIMIT_CPU, (job.limit_s, job.limit_s))
                os.environ |= _environment(job.mutant, Path(folder))
                change_functions(job.mutant)
                status = _run_here(session, items, answer)
    finally:
        os._exit(status)


def _run_here(session: Any, items: Sequence[Any], answer: int) -> int:
    for item, following in zip(items, [*items[1:], None], strict=True):
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        if session.testsfailed:
            os.pwrite(answer, item.nodeid.encode(), 0)
            return 1

    return 0


def _run_fresh(job: Job, folder: Path, answer: int) -> int:
    tests = folder / "tests.json"
    tests.write_text(json.dumps([*job.tests]), "utf-8")
    files = dict.fromkeys(test.partition("::")[0] for test in job.tests)
    failed = folder / "failed"
    # Loops are compiled anew if they are what was changed: numba's cache looks at the file on disk
    # only.
    loops = {"NUMBA_CACHE_DIR": str(folder / "numba")} if "CompiledLoop" in job.mutant.code else {}
    environment = {
        **os.environ,
        **_environment(job.mutant, folder),
        **loops,
        TESTS_VARIABLE: str(tests),
        f"{TESTS_VARIABLE}_FAILED": str(failed),
    }
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-x",
        "-q",
        "-p",
        "no:cacheprovider",
        "-p",
        __name__,
        *files,
    ]
    limit = (job.limit_s, job.limit_s)
    done = subprocess.run(
        words,
        cwd=ROOT,
        env=environment,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, limit),
    )
    if failed.exists():
        os.pwrite(answer, failed.read_bytes(), 0)

    return int(done.returncode != 0)


def _environment(mutant: Mutant, folder: Path) -> dict[str, str]:
    """Return what gives a process that a test starts the changed module."""
    file = folder / "mutant.json"
    changed = {"name": mutant.module, "code": mutant.code}
    file.write_text(json.dumps(changed), "utf-8")
    paths = [str(START), str(ROOT), str(ROOT / "src")]

    return {"FINGERTIP_MUTANT": str(file), "PYTHONPATH": os.pathsep.join(paths)}


def change_functions(mutant: Mutant) -> None:
    """Give every function of a module the code that it has in the
    changed source, and forget what functions cached.
    """
    path = str(ROOT / mutant.path)
    changed = {
        _place(code): code
        for code in _all_code(compile(mutant.code, path, "exec", dont_inherit=True))
    }
    gc.unfreeze()

    for one in gc.get_objects():
        if isinstance(one, FunctionType) and one.__code__.co_filename == path:
            code = changed.get(_place(one.__code__))
            if code is not None and code.co_freevars == one.__code__.co_freevars:
                one.__code__ = code
        elif isinstance(one, functools._lru_cache_wrapper) and one.__module__.startswith(
            ("fingertip", "tests")
        ):
            one.cache_clear()


def _all_code(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _all_code(constant)


def _place(code: CodeType) -> tuple[str, int]:
    return code.co_qualname, code.co_firstlineno


def pytest_collection_modifyitems(items: list[Any]) -> None:
    """Keep, in a fresh process, the tests of the job in its order."""
    if TESTS_VARIABLE in os.environ:
        order = {
            test: i
            for i, test in enumerate(json.loads(Path(os.environ[TESTS_VARIABLE]).read_bytes()))
        }
        items[:] = sorted(
            (item for item in items if item.nodeid in order), key=lambda item: order[item.nodeid]
        )


def pytest_runtest_logreport(report: Any) -> None:
    """Note the test that failed in a fresh process."""
    name = os.environ.get(f"{TESTS_VARIABLE}_FAILED")
    if name and report.failed:
        Path(name).write_text(report.nodeid, "utf-8")
