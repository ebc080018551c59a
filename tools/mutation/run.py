"""Command `python -m tools.mutation.run`: run the tests of some modules on their mutants, and list the survivors.

    python -m tools.mutation.run --cosmic-ray VENV/bin/python                   all modules of modules.toml
    python -m tools.mutation.run --cosmic-ray VENV/bin/python --count 60 NAME   at most 60 mutants of such modules

Each mutant runs in a fork of this process, which has imported what does not depend on the module. An import hook gives
the fork the changed module, and no file is edited. The tests that noticed most mutants run first. Loops run plain,
because numba caches compiled ones by file. A mutant whose tests ran before, unchanged, is not run again: out/mutation
has the results. Exit code 1: in one of the modules, fewer than `MIN_KILLED` of the mutants that are not listed as
equivalent were noticed.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from tools.mutation.forks import ROOT, Target, import_early, run_tests

FOLDER = Path(__file__).resolve().parent
RESULTS = ROOT / "out" / "mutation"
MIN_KILLED = 0.95
"""Share of a module's mutants that the tests must notice."""
MAX_MUTANTS = 100
"""Number of mutants of a module that are run, evenly spread over it."""
_PATIENCE, _MIN_LIMIT_S = 4.0, 4.0
"""CPU time limit of a mutant, as a multiple of the time of the unchanged module and at least [s]."""

Results = dict[str, tuple[str, bool]]
"""Tests that were run on each mutant, and whether they noticed it."""


@dataclass(frozen=True)
class Mutant:
    """Module with one change."""

    line: int
    column: int
    operator: str
    before: str
    after: str
    code: str


def main() -> None:
    """Run the mutants and report."""
    parser = argparse.ArgumentParser(description="Mutation testing of the modules of modules.toml.")
    parser.add_argument("modules", nargs="*", help="words of the paths of modules; all by default")
    parser.add_argument("--cosmic-ray", default=sys.executable, help="Python that has cosmic-ray")
    parser.add_argument("--count", type=int, default=MAX_MUTANTS, help="largest number of mutants of a module")
    parser.add_argument(
        "--trust", action="store_true", help="run no mutant again that other versions of the tests noticed"
    )
    options = parser.parse_args()
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    targets = [
        one for one in read_targets() if not options.modules or any(word in str(one.path) for word in options.modules)
    ]
    poor = [
        target.name
        for target in targets
        if not test_module(target, options.cosmic_ray, options.count, trusting=options.trust)
    ]
    if poor:
        sys.exit(f"mutation: below {MIN_KILLED:.0%} are {', '.join(poor)}; add tests, or list what no test can notice")


def read_targets() -> list[Target]:
    """Read the modules and their tests."""
    table = tomllib.loads((FOLDER / "modules.toml").read_text(encoding="utf-8"))
    return [Target(Path(path), tuple(arguments)) for path, arguments in table["modules"].items()]


def read_equivalent() -> list[dict[str, str]]:
    """Read the changes that no test can notice."""
    table = tomllib.loads((FOLDER / "equivalent.toml").read_text(encoding="utf-8"))
    found: list[dict[str, str]] = table["mutant"]
    return found


def is_equivalent(path: Path, mutant: Mutant, listed: Iterable[dict[str, str]]) -> bool:
    """Tell whether a mutant is listed, by the text of its line before and after the change."""
    return any(
        one["module"] == str(path)
        and re.fullmatch(one["before"], mutant.before)
        and re.fullmatch(one["after"], mutant.after)
        for one in listed
    )


def test_module(target: Target, cosmic_ray: str, count: int, *, trusting: bool) -> bool:
    """Run the mutants of a module, print the survivors, and return whether enough were noticed."""
    mutants = [
        one for one in list_mutants(target.path, cosmic_ray) if not is_equivalent(target.path, one, read_equivalent())
    ]
    total = len(mutants)
    mutants = [mutants[i * total // count] for i in range(count)] if total > count else mutants
    from_s = time.monotonic()
    first = run_tests(target, target.source, 600.0)
    if not first.passed:
        print(f"{target.name}: its tests fail without any change")
        return False
    import_early(target, first.imported)
    limit_s = max(_MIN_LIMIT_S, _PATIENCE * run_tests(target, target.source, 600.0).cpu_s)
    known, survivors, kills = read_results(target), [], Counter[str]()
    texts = b"".join((ROOT / word).read_bytes() for word in target.arguments if word.endswith(".py"))
    tests = hashlib.sha256(repr(target.arguments).encode() + texts).hexdigest()
    for mutant in mutants:
        key = hashlib.sha256(mutant.code.encode()).hexdigest()
        tests_then, noticed = known.get(key, ("", False))
        if tests_then != tests and not (noticed and trusting):
            outcome = run_tests(target, mutant.code, limit_s, kills)
            kills[outcome.failed] += bool(outcome.failed)
            noticed = not outcome.passed
            known[key] = (tests, noticed)
            write_results(target, known)
        if not noticed:
            survivors.append(mutant)
    share = 1 - len(survivors) / max(1, len(mutants))
    took_s = time.monotonic() - from_s
    print(f"{target.name}: {share:.1%} of {len(mutants)} mutants noticed ({total} in all), {took_s:.0f} s", flush=True)
    for one in survivors:
        print(f"  {target.path}:{one.line} {one.operator}\n    - {one.before}\n    + {one.after}", flush=True)
    return share >= MIN_KILLED


def read_results(target: Target) -> Results:
    """Read the results of earlier runs."""
    path = RESULTS / f"{target.name}.json"
    found: Results = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return found


def write_results(target: Target, known: Results) -> None:
    """Keep the results for later runs."""
    RESULTS.mkdir(parents=True, exist_ok=True)
    (RESULTS / f"{target.name}.json").write_text(json.dumps(known), encoding="utf-8")


def list_mutants(path: Path, cosmic_ray: str) -> Iterator[Mutant]:
    """List all mutants of a module."""
    command = [cosmic_ray, str(FOLDER / "changes.py"), str(ROOT / path)]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    for line in lines:
        yield Mutant(**json.loads(line))


if __name__ == "__main__":
    main()
