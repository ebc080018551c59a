"""Functions of the program as text for scripts: they, what they call, and the constants that they read.

Annotations are left out, and of a docstring all but its first line. Names lose the underscore of what is private, and
classes of solids are written as the functions of `cad.kernel.cadquery_primitives` that make them.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from types import GenericAlias, ModuleType
from typing import Any

PRIMITIVES = Path(__file__).parents[1] / "kernel" / "cadquery_primitives.py"
"""Module that scripts carry whole. It is read, not imported: it would load cadquery."""
_SOLIDS = "fingertip.design.geometry.solids"


class Carried:
    """Functions, each after those that it calls, but for those of another module of scripts."""

    def __init__(self, functions: Iterable[Callable[..., Any]], beside: Carried | None = None, name: str = "") -> None:
        self.functions: dict[str, str] = {}
        self.constants: dict[str, str] = {}
        self.imports: set[str] = set()
        self._beside, self._name = beside, name
        for function in functions:
            self._add(function)

    def _add(self, function: Any) -> None:
        name, tree = function.__name__.strip("_"), ast.parse(inspect.getsource(function))
        if name in self.functions:
            return
        if self._beside and name in self._beside.functions:
            self.imports.add(f"from {self._name} import {name}")
            return
        for node in ast.walk(tree):
            if isinstance(node, ast.arg):
                node.annotation = None
            elif isinstance(node, ast.FunctionDef | ast.ClassDef):
                if text := ast.get_docstring(node):
                    node.body[0] = ast.Expr(ast.Constant(text.partition("\n")[0]))
                if isinstance(node, ast.FunctionDef):
                    node.returns = None
        self.functions[name] = ""  # it may call itself
        for each in dict.fromkeys(node.id for node in ast.walk(tree) if isinstance(node, ast.Name)):
            self._need(each, vars(sys.modules[function.__module__]).get(each))
        del self.functions[name]
        text = re.sub(r"(?<![\w.])_(?=[A-Za-z])", "", ast.unparse(ast.fix_missing_locations(tree)))
        self.functions[name] = re.sub(r"\b(Box|Cone|Prism)\(", lambda found: found[0].lower(), text)

    def _need(self, name: str, found: Any) -> None:
        module = getattr(found, "__module__", "")
        if isinstance(found, ModuleType):
            self.imports.add(f"import {name}")
        elif isinstance(found, float | int | GenericAlias):
            text = self.constants.setdefault(name.strip("_"), repr(found))
            assert text == repr(found), "two modules have constants of one name"
        elif module.startswith("fingertip") and module != _SOLIDS:
            self._add(found)
        elif callable(found) and module not in ("builtins", _SOLIDS):
            self.imports.add(f"from {module} import {name}")

    def write(self) -> list[str]:
        """Write lines: constants, then functions."""
        lines = [f"{name} = {text}" for name, text in self.constants.items()]
        return [*lines, *(line for text in self.functions.values() for line in ("", "", *text.splitlines()))]


def settle(names: dict[str, Any], table: dict[str, tuple[float, float, float]]) -> Callable[[bool, str], None]:
    """Take CHANGES, keep parameters within their bounds, and return what refuses those that need other statements."""
    paths = {path.replace(".", "_").removeprefix("custom_"): path for path in table}
    refusal = names.get("REFUSAL") or (SystemExit if names.get("__name__") == "__main__" else ValueError)
    names |= (changes := names.get("CHANGES", {}))
    wrong = [f"CHANGES: this script has no parameter {name}" for name in changes if name not in paths]
    wrong += [f"{name} = {names[name]} is not within {table[path][0]} to {table[path][2]}"
              for name, path in paths.items() if not table[path][0] <= names[name] <= table[path][2]]  # fmt: skip
    if wrong:
        raise refusal("\n".join(wrong))

    def require(holds: bool, condition: str) -> None:
        if not holds:
            changed = [name for name, path in paths.items() if names[name] != table[path][1]]
            is_bought = any(paths[name].startswith("custom_") for name in changed)
            sets = [f"--set {path}={names[name]}" for name, path in paths.items()
                    if name in changed or (is_bought and path.startswith("custom_"))]  # fmt: skip
            remedy = " ".join(["design.toml --formats cq", *["--set sensor.model=custom"] * is_bought, *sets])
            said = f"{', '.join(changed)}: {condition} does not hold; write a new script"
            raise refusal(f"{said}: fingertip build {remedy}")

    return require
