"""Command `python -m tools.mutation.reach`: record which blocks of src each test enters, and its
CPU time.

Every other argument goes to pytest. A block is the body of a function, of a loop or of a branch.
What a fixture of a module or session enters counts for every test that asks for it, and what a
function enters whose results are kept (`functools.cache`) for every test that calls it. The result
is out/mutation/reach.pickle. Exit code 1: a test failed, or less than `MIN_PERCENT` of the blocks
of a package were entered.
"""

from __future__ import annotations

import ast
import functools
import json
import os
import pickle
import resource
import struct
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from tools.mutation.mutants import REACH, ROOT, list_modules

MIN_PERCENT = 90.0
COMPILERS = ("CompiledLoop", "compile_for_process")
"""Names of what gives functions to numba, which cannot compile what the hook adds to them."""

START = Path(__file__).resolve().parent / "start"
sys.path.insert(0, str(START))

import sitecustomize as start  # type: ignore[import-not-found]  # noqa: E402


@dataclass
class Record:
    """Cost of a test or of a fixture, and the blocks that it enters."""

    cpu_s: float = 0.0
    blocks: set[int] = field(default_factory=set)
    fixtures: set[str] = field(default_factory=set)
    """Fixtures of a test that other tests share."""


def list_blocks() -> tuple[dict[str, int], list[tuple[str, int, int]]]:
    """List the blocks of all modules.

    Returns
    -------
    first
        Module -> number of its first block.
    blocks
        Module, first and last line of each block.
    """
    first: dict[str, int] = {}
    blocks: list[tuple[str, int, int]] = []

    trees = {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in list_modules()}
    compiled = {module for tree in trees.values() for module in find_inlined(tree)}

    for name, tree in trees.items():
        if name in compiled or calls_compiler(tree):
            continue

        first[name] = len(blocks)
        for body in start.number_blocks(tree):
            blocks.append((name, body[0].lineno, body[-1].end_lineno or body[-1].lineno))

    return first, blocks


def list_compiler_calls(tree: ast.Module) -> list[ast.Call]:
    """List the calls that give functions to numba."""
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    return [call for call in calls if getattr(call.func, "id", "") in COMPILERS]


def calls_compiler(tree: ast.Module) -> bool:
    """Return whether functions of a module are compiled."""
    names = [getattr(node, "name", getattr(node, "id", "")) for node in ast.walk(tree)]
    return any(name in COMPILERS for name in names)


def find_inlined(tree: ast.Module) -> set[str]:
    """Find the modules whose functions a loop of this one inlines."""
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    homes = {alias.name: str(node.module) for node in imports for alias in node.names}
    arguments = [value for call in list_compiler_calls(tree) for value in call.args]
    names = {value.id for value in arguments if isinstance(value, ast.Name)}
    return {home for name, home in homes.items() if name in names}


def cpu_now_s() -> float:
    """Return the CPU time of this process and of those that it started and that have ended [s]."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


class Recorder:
    """Plugin of pytest that records costs and blocks."""

    def __init__(self, folder: Path) -> None:
        self._file = folder / f"sub-{os.getpid()}"
        self._folder = folder
        self._records: dict[str, Record] = {}
        self._recording: frozenset[str] = frozenset(
            json.loads((folder / "first.json").read_text("utf-8"))
        )
        os.environ |= {
            "FINGERTIP_REACH_FILE": str(self._file),
            "FINGERTIP_REACH_HOME": str(os.getpid()),
        }

    def _take(self) -> set[int]:
        """Return the blocks since the last call."""
        found = set(start.SEEN)
        start.SEEN.clear()

        if self._file.exists():
            found |= {number for (number,) in struct.iter_unpack("<I", self._file.read_bytes())}
            self._file.unlink()

        return found

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Iterator[None]:
        """Record a test.

        It finds no result of a function that another one left: it would miss what that enters.
        """
        for name, module in list(sys.modules.items()):
            if name in self._recording or name.startswith("tests."):
                for value in list(vars(module).values()):
                    if isinstance(value, functools._lru_cache_wrapper):
                        value.cache_clear()

        self._take()
        self._shared = set[int]()
        self._shared_s = 0.0
        begun_s = cpu_now_s()
        yield
        parameters = item.callspec.params if hasattr(item, "callspec") else {}
        fixtures = {
            self._name(one, parameters.get(one.argname))
            for definitions in item._fixtureinfo.name2fixturedefs.values()
            for one in definitions
            if one.scope != "function"
        }
        self._records[item.nodeid] = Record(
            cpu_now_s() - begun_s - self._shared_s, self._take(), fixtures
        )

    @staticmethod
    def _name(definition: Any, parameter: object) -> str:
        return f"{definition.baseid}::{definition.argname}" + (
            "" if parameter is None else f"[{parameter}]"
        )

    @pytest.hookimpl(hookwrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any, request: Any) -> Iterator[None]:
        """Record a fixture that tests share, apart from the test that happens to ask for
        it first.
        """
        if fixturedef.scope == "function":
            yield
            return

        before = self._take()
        begun_s = cpu_now_s()
        inner_s = self._shared_s
        yield
        name = self._name(fixturedef, getattr(request, "param", None))
        record = self._records.setdefault(name, Record())
        spent_s = cpu_now_s() - begun_s
        record.cpu_s += spent_s - (self._shared_s - inner_s)
        record.blocks |= self._take()
        self._shared_s = inner_s + spent_s
        start.SEEN |= before

    def pytest_sessionfinish(self) -> None:
        """Write what was recorded."""
        self._folder.joinpath(f"part-{os.getpid()}.pickle").write_bytes(pickle.dumps(self._records))


def pytest_configure(config: Any) -> None:
    """Record in each process of pytest that runs tests."""
    runs_tests = hasattr(config, "workerinput") or not config.getoption("numprocesses", None)
    if "FINGERTIP_REACH" in os.environ and runs_tests:
        config.pluginmanager.register(Recorder(Path(os.environ["FINGERTIP_REACH"])))


def main() -> None:
    """Run the tests and join what their processes recorded."""
    first, blocks = list_blocks()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "first.json").write_text(json.dumps(first), "utf-8")
        paths = [str(START), str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment = os.environ | {"FINGERTIP_REACH": name, "PYTHONPATH": os.pathsep.join(paths)}
        words = [sys.executable, "-m", "pytest", "-q", "-p", "tools.mutation.reach", *sys.argv[1:]]
        status = subprocess.run(words, cwd=ROOT, env=environment, check=False).returncode
        records: dict[str, Record] = {}

        for part in sorted(folder.glob("part-*.pickle")):
            for key, record in pickle.loads(part.read_bytes()).items():
                known = records.setdefault(key, Record())
                known.cpu_s = max(known.cpu_s, record.cpu_s)
                known.blocks |= record.blocks
                known.fixtures |= record.fixtures

    REACH.parent.mkdir(parents=True, exist_ok=True)
    plain = {
        key: (one.cpu_s, sorted(one.blocks), sorted(one.fixtures)) for key, one in records.items()
    }
    REACH.write_bytes(pickle.dumps((blocks, plain)))
    print(
        f"{len(records)} tests and fixtures, {len(blocks)} blocks; exit status of pytest {status}"
    )
    poor = print_entered(blocks, set.union(set(), *(one.blocks for one in records.values())))
    sys.exit(bool(status or poor))


def print_entered(blocks: Sequence[tuple[str, int, int]], entered: Collection[int]) -> list[str]:
    """Print the share of blocks that were entered, by package, and return the packages that have
    too few.

    The modules beside the packages count with the command line, which they start.
    """
    totals = Counter[str]()
    found = Counter[str]()

    for number, (name, _, _) in enumerate(blocks):
        package = (*name.split("."), "cli")[1].replace("__main__", "cli")
        totals[package] += 1
        found[package] += number in entered

    shares = {package: 100.0 * found[package] / total for package, total in sorted(totals.items())}
    for package, percent in shares.items():
        print(f"{package:14}{totals[package]:6} blocks{percent:7.1f} % entered")

    print(f"{'all':14}{len(blocks):6} blocks{100.0 * found.total() / len(blocks):7.1f} % entered")
    return [package for package, percent in shares.items() if percent < MIN_PERCENT]


if __name__ == "__main__":
    main()
