"""First set of tests: what runs without FINGERTIP_FULL=1, and what a test of it may cost.

The first set was chosen by what it notices in a second (`tools/mutation`): the whole suite notices more and takes ten
times as long. Tests marked `full` are left out of it. Of a test with many cases a few run, spread evenly, unless it is
marked `every_case`. A test that is named on the command line with all its cases (`FILE::TEST`) always runs.

The CPU time of each test is measured. Imports, compilations of loops and fixtures that tests share are counted apart:
which test pays for them depends on the order.
"""

from __future__ import annotations

import importlib
import os
import resource
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from fingertip.foundation.jit import CompiledLoop

FULL = bool(os.environ.get("FINGERTIP_FULL"))
"""True in `.ci/full`, where every test runs with all its cases."""
MOST_CASES = 4
"""Number of cases of a test of the first set."""
LIMIT_S = 2.0
"""Largest CPU time of a test of the first set [s], on a machine that counts as fast as `COUNTS_PER_S`."""
COUNTS_PER_S = 1.4e7
"""Additions per second of a processor's Python, one core: a slower machine, or a busy one, may take longer."""
SCATTER = 1.5
"""Ratio by which the CPU time of the same test varies between runs: a test is refused beyond it only."""
EXPENSIVE = {
    "tests/design/test_rules.py::test_a_refusal_is_the_approved_one_and_its_remedies_pass": "searches remedies",
    "tests/cad/test_volumes.py::test_dented_skin_breaks_the_cavity_balance": "exact solids of all parts",
    "tests/cli/test_coupon_and_calibrate.py::test_a_failed_check_is_named_and_no_design_is_written": (
        "checks a whole design"
    ),
    "tests/cad/test_files.py::test_files_of_both_processes_are_returned": "imports cadquery in two processes",
    "tests/sweep/test_report_files.py::test_reports_are_the_approved_ones": "lays out all plots of a sweep",
    "tests/sweep/test_failures.py::test_point_whose_worker_dies_once_is_computed_at_the_second_attempt": (
        "starts the processes of a sweep three times"
    ),
}
"""Tests that may take more, with the reason; at most ten."""

_apart_s = {"imports": 0.0, "compilations": 0.0, "shared fixtures": 0.0}
_running: list[str] = []
"""Kinds of work that are being counted apart, the innermost last."""
_begun_s = 0.0
_spent_s: list[float] = []
_sums: list[dict[str, list[float]]] = []
"""CPU times of each process that ran tests."""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is not in the first set."""
    if FULL or any("::" in word for word in config.args):
        return
    kept = select(items)
    config.hook.pytest_deselected(items=[item for item in items if item not in kept])
    items[:] = [item for item in items if item in kept]


def select(items: Iterable[pytest.Item]) -> set[pytest.Item]:
    """Select the first set among all tests."""
    families: dict[str, list[pytest.Item]] = {}
    for item in items:
        if not item.get_closest_marker("full"):
            families.setdefault(item.nodeid.partition("[")[0], []).append(item)
    kept = set[pytest.Item]()
    for family in families.values():
        step = 1 if family[0].get_closest_marker("every_case") else -(-len(family) // MOST_CASES)
        kept |= set(family[::step])
    return kept


def cpu_s() -> float:
    """Return the CPU time of this process and of those that it started and that have ended [s]."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


@contextmanager
def _apart(kind: str) -> Iterator[None]:
    """Count the work of a block apart from the test that happens to need it first."""
    begun_s = cpu_s()
    _running.append(kind)
    try:
        yield
    finally:
        _running.pop()
        if not _running:  # what is nested is counted once, as the outermost
            _apart_s[kind] += cpu_s() - begun_s


def _count_calls(owner: Any, name: str, kind: str) -> None:
    function: Callable[..., Any] = getattr(owner, name)

    def counted(*arguments: Any, **named: Any) -> Any:
        with _apart(kind):
            return function(*arguments, **named)

    setattr(owner, name, counted)


_count_calls(importlib._bootstrap, "_find_and_load", "imports")
_count_calls(CompiledLoop, "_run_first", "compilations")


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: Any) -> Iterator[None]:
    """Count fixtures that tests share apart."""
    if fixturedef.scope == "function":
        return (yield)
    with _apart("shared fixtures"):
        return (yield)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_setup() -> Iterator[None]:
    """Begin to measure a test."""
    global _begun_s
    _begun_s = cpu_s() - sum(_apart_s.values())
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """Refuse a test of the first set that takes too long."""
    result = yield
    spent_s = cpu_s() - sum(_apart_s.values()) - _begun_s
    _spent_s.append(spent_s)
    if spent_s > LIMIT_S and not FULL and item.nodeid.partition("[")[0] not in EXPENSIVE:
        most_s = LIMIT_S * SCATTER * max(1.0, _slowness())
        if spent_s > most_s:
            pytest.fail(f"took {spent_s:.1f} CPU s; at most {most_s:.1f} here: make it cheaper, or mark it full")
    return result


def _slowness() -> float:
    """Return how many times slower than the machine of the limit this one is now."""
    begun_s, total, count = time.process_time(), 0, 1_000_000
    for number in range(count):
        total += number * number
    return (time.process_time() - begun_s) * COUNTS_PER_S / count


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Hand the sums of a worker to the process that prints."""
    sums = {"tests": _spent_s} | {kind: [value] for kind, value in _apart_s.items()}
    getattr(session.config, "workeroutput", {})["cpu_s"] = sums
    if _spent_s:
        _sums.append(sums)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Take the sums of a worker."""
    _sums.append(getattr(node, "workeroutput", {}).get("cpu_s", {}))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Print the CPU times."""
    if any(sums.get("tests") for sums in _sums):
        totals = {kind: sum(sum(sums.get(kind, ())) for sums in _sums) for kind in ("tests", *_apart_s)}
        longest_s = max(value for sums in _sums for value in sums.get("tests", ()))
        words = ", ".join(f"{kind} {value:.0f} s" for kind, value in totals.items())
        terminalreporter.write_line(f"CPU time of {len(_sums)} processes: {words}; longest test {longest_s:.1f} s")
