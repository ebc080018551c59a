"""Import hook of mutation testing. Python imports this module at its start wherever its folder is on PYTHONPATH.

So every process that a test starts has it too. What it does is said by two variables of the environment:

FINGERTIP_MUTANT        path of a JSON file with `name`, `path` and `code`: that module gets this source
FINGERTIP_REACH         folder: each function of fingertip records the blocks that it enters (`tools.mutation.reach`)
FINGERTIP_REACH_FILE    file to which this process adds the numbers of these blocks, four bytes each
"""

from __future__ import annotations

import ast
import builtins
import json
import os
import struct
import sys
from importlib.abc import MetaPathFinder, SourceLoader
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import spec_from_file_location
from types import CodeType, ModuleType
from typing import Any

PACKAGE = "fingertip"
LOOPS = "CompiledLoop"
"""Word in the source of modules that numba compiles: it cannot compile what a hook adds, so they record nothing."""


def number_blocks(tree: ast.Module) -> list[list[ast.stmt]]:
    """List the blocks of all functions of a module, in the order of the source."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    blocks = {}
    for function in functions:
        for node in ast.walk(function):
            bodies = [getattr(node, name, None) for name in ("body", "orelse", "finalbody")]
            for body in bodies:
                if isinstance(body, list) and body and isinstance(body[0], ast.stmt):
                    blocks[body[0].lineno, body[0].col_offset] = body
    return [blocks[place] for place in sorted(blocks)]


class _Recording(MetaPathFinder, SourceLoader):  # type: ignore[misc]  # as importlib's own classes combine them
    """Finder of fingertip's modules that lets each block record its number."""

    def __init__(self, first: dict[str, int]) -> None:
        self._first = first

    def find_spec(self, fullname: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
        """Find the modules that have blocks."""
        if fullname not in self._first:
            return None
        spec = PathFinder.find_spec(fullname, path)
        if spec is None or spec.origin is None:
            return None
        return spec_from_file_location(
            fullname, spec.origin, loader=self, submodule_search_locations=spec.submodule_search_locations
        )

    def get_filename(self, fullname: str) -> str:
        """Return the path of the module."""
        return str(sys.modules[fullname].__file__)

    def exec_module(self, module: ModuleType) -> None:
        """Run the module with its blocks recording."""
        with open(str(module.__file__), encoding="utf-8") as file:
            exec(self._record(file.read(), str(module.__file__), self._first[module.__name__]), module.__dict__)

    def get_data(self, path: Any) -> bytes:
        """Return the text of a file."""
        with open(path, "rb") as file:
            return file.read()

    def _record(self, source: str, path: str, first: int) -> CodeType:
        tree = ast.parse(source)
        for number, body in enumerate(number_blocks(tree), first):
            at = int(
                isinstance(body[0], ast.Expr)
                and isinstance(body[0].value, ast.Constant)
                and isinstance(body[0].value.value, str)
            )
            call = ast.parse(f"{number} in __seen__ or __reach__({number})").body[0]
            for node in ast.walk(call):
                ast.copy_location(node, body[0])
            body.insert(at, call)
        return compile(tree, path, "exec", dont_inherit=True)


class _Changed(MetaPathFinder, SourceLoader):  # type: ignore[misc]  # as importlib's own classes combine them
    """Finder of one module, to which it gives another source."""

    def __init__(self, name: str, path: str, code: str) -> None:
        self._name, self._path, self._code = name, path, code

    def find_spec(self, fullname: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
        """Find the changed module only."""
        if fullname != self._name:
            return None
        folders = [os.path.dirname(self._path)] if self._path.endswith("__init__.py") else None
        return spec_from_file_location(fullname, self._path, loader=self, submodule_search_locations=folders)

    def get_filename(self, fullname: str) -> str:
        """Return the path of the unchanged file."""
        return self._path

    def get_data(self, path: Any) -> bytes:
        """Return the changed source; there is no bytecode."""
        if path != self._path:
            raise OSError(path)
        return self._code.encode()


SEEN: set[int] = set()
"""Blocks entered by this process since the set was last emptied."""


def _reach(number: int) -> None:
    SEEN.add(number)
    name = os.environ.get("FINGERTIP_REACH_FILE")
    if name and str(os.getpid()) != os.environ.get("FINGERTIP_REACH_HOME"):
        handle = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        os.write(handle, struct.pack("<I", number))
        os.close(handle)


def change_module(name: str, path: str, code: str) -> None:
    """Give one module another source in this process."""
    sys.meta_path.insert(0, _Changed(name, path, code))


def record_blocks(folder: str) -> None:
    """Let the functions of this process record their blocks."""
    with open(os.path.join(folder, "first.json"), encoding="utf-8") as file:
        first = json.load(file)
    builtins.__seen__ = SEEN  # type: ignore[attr-defined]
    builtins.__reach__ = _reach  # type: ignore[attr-defined]
    sys.meta_path.insert(0, _Recording(first))


if "FINGERTIP_MUTANT" in os.environ:
    with open(os.environ["FINGERTIP_MUTANT"], encoding="utf-8") as _file:
        change_module(**json.load(_file))
if "FINGERTIP_REACH" in os.environ:
    record_blocks(os.environ["FINGERTIP_REACH"])
