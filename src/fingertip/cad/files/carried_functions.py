"""Functions of the program as text for scripts: they, what they call, and the constants that they read.

Their modules are read, not imported: some would load cadquery. Annotations are left out, and of a docstring all but its
first line.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path

_SOURCES = Path(__file__).parents[2]
PRIMITIVES, _SOLIDS = "fingertip.cad.kernel.cadquery_primitives", "fingertip.design.geometry.solids"
"""Modules of the functions that make solids in a script, and in the program."""


class Carried:
    """Functions, each after those that it calls; `wrap` breaks a line, and those `beside` are in a module `name`."""

    def __init__(
        self, wrap: Callable[[str, str], Iterable[str]], beside: Carried | None = None, name: str = ""
    ) -> None:  # fmt: skip
        self.functions: dict[str, str] = {}
        self.constants: dict[str, str] = {}
        self._imports: dict[str, dict[str, None]] = {}
        self._wrap, self._beside, self._name = wrap, beside, name

    def write(self) -> str:
        imports = (f"{head} {', '.join(sorted(names))}".strip() for head, names in sorted(self._imports.items()))
        constants = [f"{name} = {value}" for name, value in self.constants.items()]
        return "\n".join(self._break([*imports, "", *constants, "", *"\n\n".join(self.functions.values()).split("\n")]))

    def add(self, name: str, module: str) -> None:
        """Add what a module calls so, with all that it needs."""
        module, name = (PRIMITIVES, name.lower()) if module == _SOLIDS else (module, name)
        found, bare = _read_module(module)[name], name.strip("_")
        if self._beside and bare in self._beside.functions:
            self._imports.setdefault(f"from {self._name} import", {})[bare] = None
        elif isinstance(found, ast.Import | ast.ImportFrom):
            alias = next(each for each in found.names if name in (each.asname, each.name))
            if isinstance(found, ast.Import):
                self._imports[f"import {ast.unparse(alias)}"] = {}
            elif (found.module or "").startswith("fingertip"):
                self.add(alias.name, found.module or "")
            else:
                self._imports.setdefault(f"from {found.module} import", {})[name] = None
        elif isinstance(found, ast.expr):
            text = ast.unparse(found)
            assert self.constants.setdefault(bare, text) == text, "two modules have constants of one name"
        elif bare not in self.functions:
            tree = _Plain().visit(ast.parse(ast.unparse(found)))
            self.functions[bare] = ""  # it may call itself
            for each in dict.fromkeys(node.id for node in ast.walk(tree) if isinstance(node, ast.Name)):
                if each in _read_module(module):
                    self.add(each, module)
            del self.functions[bare]
            self.functions[bare] = ast.unparse(ast.fix_missing_locations(_Bare().visit(tree)))

    def _break(self, lines: Iterable[str]) -> Iterable[str]:
        for line in lines:
            yield from self._wrap(line.lstrip(), line[: len(line) - len(line.lstrip())]) if line else ("",)


@cache
def _read_module(module: str) -> dict[str, ast.stmt | ast.expr]:
    """Read a module: name -> its definition, the import that brings it, or the value of a constant."""
    path = _SOURCES.joinpath(*module.split(".")[1:]).with_suffix(".py")
    found: dict[str, ast.stmt | ast.expr] = {}
    for statement in ast.parse(path.read_text(encoding="utf-8")).body:
        match statement:
            case ast.FunctionDef(name) | ast.ClassDef(name):
                found[name] = statement
            case ast.Import(names) | ast.ImportFrom(_, names):
                found |= {each.asname or each.name: statement for each in names}
            case ast.Assign([ast.Name(name)], value):
                found[name] = value
            case ast.Assign([ast.Tuple(targets)], ast.Tuple(values)):
                found |= dict(zip(map(ast.unparse, targets), values, strict=True))
    return found


class _Plain(ast.NodeTransformer):
    """Strips annotations and all but the first line of docstrings."""

    def generic_visit(self, node: ast.AST) -> ast.AST:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and (text := ast.get_docstring(node)):
            node.body[0] = ast.Expr(ast.Constant(text.partition("\n")[0]))
        if isinstance(node, ast.FunctionDef | ast.arg):
            setattr(node, "returns" if isinstance(node, ast.FunctionDef) else "annotation", None)
        if isinstance(node, ast.ClassDef):
            for each in node.body:
                if isinstance(each, ast.AnnAssign):
                    each.annotation = ast.Name("object", ast.Load())
            node.body = [self.visit(each) if isinstance(each, ast.FunctionDef) else each for each in node.body]
            return node
        if isinstance(node, ast.AnnAssign) and node.value:
            node = ast.Assign([node.target], node.value, lineno=0)
        return super().generic_visit(node)


class _Bare(ast.NodeTransformer):
    """Writes private names without their underscores, and functions of primitives for their classes."""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.name = node.name.strip("_")
        return self.generic_visit(node)

    def visit_Name(self, node: ast.Name) -> ast.AST:
        is_primitive = node.id in _read_module(_SOLIDS) and node.id.lower() in _read_module(PRIMITIVES)
        return ast.Name(node.id.lower() if is_primitive else node.id.strip("_") or "_", node.ctx)


def require(holds: bool, condition: str, *names: str) -> None:
    """Refuse a number with which a script would need other statements."""
    if not holds:
        remedy = f"fingertip build design.toml --formats cq --set {'=VALUE or '.join(names)}=VALUE"
        raise AssertionError(f"{condition} does not hold; write a new script: {remedy}")
