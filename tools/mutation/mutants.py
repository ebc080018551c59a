"""Mutants: where each stands, which tests can notice it, and which of them no test can notice."""

from __future__ import annotations

import ast
import json
import pickle
import re
import subprocess
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(__file__).resolve().parent
REACH = ROOT / "out" / "mutation" / "reach.pickle"
OF_DECLARATIONS = (
    "tests/test_toml_files.py::test_schemas_are_current",
    "tests/test_public_api.py::test_every_public_name_is_documented_and_has_the_approved_defaults",
    "tests/test_public_api.py::test_what_is_left_out_is_the_same_in_all_functions_and_flags_are_off",
)
"""Tests that read what modules declare, such as bounds and defaults, and enter no block of them."""


@dataclass(frozen=True)
class Mutant:
    """Module with one change."""

    package: str
    path: str
    line: int
    operator: str
    before: str
    after: str
    code: str

    @property
    def module(self) -> str:
        """Dotted name of the module."""
        return ".".join(Path(self.path).relative_to("src").with_suffix("").parts).removesuffix(
            ".__init__"
        )

    def __str__(self) -> str:
        return f"{self.path}:{self.line} {self.operator}\n    - {self.before}\n    + {self.after}"


def draw_mutants(
    cosmic_ray: str, count: int, seed: int, packages: Sequence[str] = ()
) -> list[Mutant]:
    """Draw mutants over all lines of src, without those that are listed as equivalent."""
    words = [
        cosmic_ray,
        str(FOLDER / "changes.py"),
        str(count),
        str(seed),
        *([",".join(packages)] if packages else []),
    ]
    lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()
    listed = read_equivalent()

    return [
        mutant for line in lines if not is_equivalent(mutant := Mutant(**json.loads(line)), listed)
    ]


def read_equivalent() -> list[dict[str, str]]:
    """Read the changes that no test can notice."""
    table = tomllib.loads((FOLDER / "equivalent.toml").read_text(encoding="utf-8"))
    found: list[dict[str, str]] = table["mutant"]
    return found


def is_equivalent(mutant: Mutant, listed: Iterable[dict[str, str]]) -> bool:
    """Tell whether a mutant is listed: by its line before and after
    the change, or by the part of it that changes.
    """

    def fits(one: dict[str, str]) -> bool:
        if one.get("module", mutant.path) != mutant.path:
            return False

        part = one.get("part")
        if part:
            return (
                re.sub(part, "", mutant.before) == re.sub(part, "", mutant.after) != mutant.before
            )

        return bool(
            re.fullmatch(one["before"], mutant.before) and re.fullmatch(one["after"], mutant.after)
        )

    return any(map(fits, listed))


@dataclass(frozen=True)
class Reach:
    """Record that `tools.mutation.reach` made of the tests."""

    blocks: Sequence[tuple[str, int, int]]
    """Module, first and last line of each block."""
    cost_s: dict[str, float]
    """CPU time of each test, without the fixtures that it shares."""
    tests: dict[int, tuple[str, ...]]
    """Tests that enter each block."""
    fixtures: dict[str, tuple[str, ...]]
    """Shared fixtures that each test asks for."""
    fixture_cost_s: dict[str, float]
    """CPU time of each shared fixture."""

    @classmethod
    def read(cls) -> Reach:
        """Read the record."""
        blocks, records = pickle.loads(REACH.read_bytes())
        shared = {key: set(entered) for key, (_, entered, _) in records.items()}
        tests: dict[int, list[str]] = {}
        cost_s = {}
        fixtures = {}

        for key, (cpu_s, _, asked) in records.items():
            if "::test_" in key:
                cost_s[key] = cpu_s
                fixtures[key] = tuple(one for one in asked if one in shared)
                for block in set.union(shared[key], *(shared[one] for one in fixtures[key])):
                    tests.setdefault(block, []).append(key)

        fixture_cost_s = {key: cpu_s for key, (cpu_s, _, _) in records.items() if key not in cost_s}
        by_block = {block: tuple(found) for block, found in tests.items()}
        return cls(
            blocks=blocks,
            cost_s=cost_s,
            tests=by_block,
            fixtures=fixtures,
            fixture_cost_s=fixture_cost_s,
        )

    def is_in_function(self, mutant: Mutant) -> bool:
        """Tell whether a mutant lies in a block that records."""
        return self._innermost(mutant) is not None

    def candidates(self, mutant: Mutant) -> tuple[str, ...]:
        """List the tests that can notice a mutant.

        A change outside all blocks (a constant, a signature, a loop that numba compiles) reaches
        whoever uses the module: the tests that enter it, those of the modules that import it, and
        those that read declarations.
        """
        block = self._innermost(mutant)
        if block is not None:
            return self.tests.get(block, ())

        users = {mutant.module, *importers().get(mutant.module, ())}
        if not any(name in users and i in self.tests for i, (name, _, _) in enumerate(self.blocks)):
            users |= {other for one in list(users) for other in importers().get(one, ())}

        found = (
            self.tests.get(i, ()) for i, (name, _, _) in enumerate(self.blocks) if name in users
        )
        declared = [test for test in OF_DECLARATIONS if test in self.cost_s]
        return tuple(dict.fromkeys([*declared, *(test for tests in found for test in tests)]))

    def _innermost(self, mutant: Mutant) -> int | None:
        around = [
            (last - first, i)
            for i, (name, first, last) in enumerate(self.blocks)
            if name == mutant.module and first <= mutant.line <= last
        ]
        return min(around)[1] if around else None


@cache
def importers() -> dict[str, frozenset[str]]:
    """Map each module to the modules that import it."""
    found: dict[str, set[str]] = {}
    for name, path in list_modules():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                for one in (node.module, *(f"{node.module}.{alias.name}" for alias in node.names)):
                    found.setdefault(one, set()).add(name)

    return {one: frozenset(names) for one, names in found.items()}


def list_modules() -> Iterator[tuple[str, Path]]:
    """List the modules of src in the order of their paths."""
    for path in sorted((ROOT / "src").rglob("*.py")):
        yield (
            ".".join(path.relative_to(ROOT / "src").with_suffix("").parts).removesuffix(
                ".__init__"
            ),
            path,
        )
