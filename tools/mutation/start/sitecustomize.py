"""Import hook of mutation testing.

Python imports this module at its start wherever its folder is on PYTHONPATH.

So every process that a test starts has it too. What it does is said by two variables of the
environment:

FINGERTIP_MUTANT        path of a JSON file with `name` and `code`: that module gets this source
FINGERTIP_REACH         folder: each function of fingertip records the blocks that it enters
(`tools.mutation.reach`) FINGERTIP_REACH_FILE    file to which this process adds the numbers of
these blocks, four bytes each
"""

from __future__ import annotations

import ast
import builtins
import contextlib
import json
import os
import struct
import sys
from collections.abc import Callable, Mapping
from functools import partial
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from types import CodeType, ModuleType
from typing import Any


def number_blocks(tree: ast.Module) -> list[list[ast.stmt]]:
    """List the blocks of all functions of a module, in the order of the source."""
    functions = [
        node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    blocks = {}

    for function in functions:
        for node in ast.walk(function):
            bodies = [getattr(node, name, None) for name in ("body", "orelse", "finalbody")]
            for body in bodies:
                if isinstance(body, list) and body and isinstance(body[0], ast.stmt):
                    blocks[body[0].lineno, body[0].col_offset] = body

    return [blocks[place] for place in sorted(blocks)]


class _Source(SourceFileLoader):
    """Loader of a module whose source is changed on the way; it reads and writes no bytecode."""

    def __init__(self, name: str, path: str, change: Callable[[bytes], ast.Module | bytes]) -> None:
        super().__init__(name, path)
        self._change = change

    def get_code(self, fullname: str) -> CodeType:
        """Compile the changed source."""
        changed = self._change(self.get_data(self.path))
        return compile(changed, self.path, "exec", dont_inherit=True)


class _Finder(MetaPathFinder):
    """Finder of some modules, whose source it changes."""

    def __init__(self, changes: Mapping[str, Callable[[bytes], ast.Module | bytes]]) -> None:
        self._changes = changes

    def find_spec(
        self, fullname: str, path: Any = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find these modules only."""
        spec = PathFinder.find_spec(fullname, path) if fullname in self._changes else None
        if spec is not None and spec.origin is not None:
            spec.loader = _Source(fullname, spec.origin, self._changes[fullname])

        return spec


def _let_blocks_record(source: bytes, first: int) -> ast.Module:
    """Add to each block of a module the call that records its number."""
    tree = ast.parse(source)
    for number, body in enumerate(number_blocks(tree), first):
        has_text = isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant)
        call = ast.parse(f"{number} in __seen__ or __reach__({number})").body[0]
        for node in ast.walk(call):
            ast.copy_location(node, body[0])

        body.insert(int(has_text), call)

    return tree


SEEN: set[int] = set()
"""Blocks entered by this process since the set was last emptied."""


def _reach(number: int) -> None:
    SEEN.add(number)
    name = os.environ.get("FINGERTIP_REACH_FILE")
    if name and str(os.getpid()) != os.environ.get("FINGERTIP_REACH_HOME"):
        with contextlib.suppress(OSError):  # a test may take away the right to write, or all room
            handle = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
            os.write(handle, struct.pack("<I", number))
            os.close(handle)


def change_module(name: str, code: str) -> None:
    """Give one module another source in this process."""
    sys.meta_path.insert(0, _Finder({name: lambda source: code.encode()}))


def record_blocks(folder: str) -> None:
    """Let the functions of this process record their blocks."""
    with open(os.path.join(folder, "first.json"), encoding="utf-8") as file:
        first = json.load(file)

    builtins.__seen__ = SEEN  # type: ignore[attr-defined]
    builtins.__reach__ = _reach  # type: ignore[attr-defined]
    sys.meta_path.insert(
        0, _Finder({name: partial(_let_blocks_record, first=first[name]) for name in first})
    )


if "FINGERTIP_MUTANT" in os.environ:
    with open(os.environ["FINGERTIP_MUTANT"], encoding="utf-8") as _file:
        change_module(**json.load(_file))
if "FINGERTIP_REACH" in os.environ:
    record_blocks(os.environ["FINGERTIP_REACH"])
