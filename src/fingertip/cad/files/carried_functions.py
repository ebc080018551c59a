"""Functions of the program as text for scripts: they, what they call, and the constants that they read.

Their modules are read, not imported: some would load cadquery. Annotations are left out, and of a docstring all but its
first line.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable
from pathlib import Path

_SOURCES = Path(__file__).parents[2]
PRIMITIVES, _SOLIDS = "fingertip.cad.kernel.cadquery_primitives", "fingertip.design.geometry.solids"
"""Modules of the functions that make solids in a script, and in the program."""


class Carried:
    """Functions, each after those that it calls; `wrap` breaks a line with an indent."""

    def __init__(self, wrap: Callable[[str, str], Iterable[str]]) -> None:
        self._texts: dict[str, str] = {}
        self._constants: dict[str, str] = {}
        self._imports: dict[str, dict[str, None]] = {}
        self._wrap = wrap

    def write(self) -> str:
        imports = (f"{head} {', '.join(sorted(names))}".strip() for head, names in sorted(self._imports.items()))
        head = [line for text in imports for line in self._wrap(text, "")]
        constants = [f"{name} = {value}" for name, value in self._constants.items()]
        return "\n\n".join(["\n".join(head), "\n".join(constants), *self._texts.values()])

    def add(self, name: str, module: str = PRIMITIVES) -> str:
        """Add what a module calls so, with all that it needs, and return its name in the script."""
        module, name = (PRIMITIVES, name.lower()) if module == _SOLIDS else (module, name)
        statements, bare = _read_module(module), name.strip("_")
        found = statements[name]
        if isinstance(found, ast.Import | ast.ImportFrom):
            alias, source = next(each for each in found.names if name in (each.asname, each.name)), ""
            if isinstance(found, ast.ImportFrom):
                source = found.module or ""
                if source.startswith("fingertip"):
                    return self.add(alias.name, source)
            names = self._imports.setdefault(f"from {source} import" if source else f"import {ast.unparse(alias)}", {})
            names |= {alias.name: None} if source else {}
            return name
        if isinstance(found, ast.expr):
            self._constants[bare] = ast.unparse(found)
        elif bare not in self._texts:
            self._texts[bare] = ""  # it may call itself
            tree = _Plain(lambda each: self.add(each, module) if each in statements else each).visit(found)
            del self._texts[bare]
            self._texts[bare] = self._write(tree)
        return bare

    def _write(self, tree: ast.AST) -> str:
        lines: list[str] = []
        for line in ast.unparse(ast.fix_missing_locations(tree)).splitlines():
            indent = line[: len(line) - len(line.lstrip())]
            lines += self._wrap(line.lstrip(), indent) if line else [""]
        return "\n".join(lines)


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
                found |= {target.id: value for target, value in zip(targets, values, strict=True)
                          if isinstance(target, ast.Name)}  # fmt: skip
    return found


class _Plain(ast.NodeTransformer):
    """Strips annotations and all but the first line of docstrings, and resolves the names of the module."""

    def __init__(self, resolve: Callable[[str], str]) -> None:
        self._resolve = resolve

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.returns, node.name = None, node.name.strip("_")
        return self._visit_body(node)

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        for each in node.body:
            if isinstance(each, ast.AnnAssign):
                each.annotation = ast.Name("object", ast.Load())
        return self._visit_body(node)

    def _visit_body(self, node: ast.FunctionDef | ast.ClassDef) -> ast.AST:
        if text := ast.get_docstring(node):
            node.body[0] = ast.Expr(ast.Constant(text.partition("\n")[0]))
        self.generic_visit(node)
        return node

    def visit_arg(self, node: ast.arg) -> ast.AST:
        return ast.arg(node.arg)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        return self.generic_visit(ast.Assign([node.target], node.value, lineno=0) if node.value else node)

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return ast.Name(self._resolve(node.id), node.ctx)


def require(holds: bool, condition: str, *names: str) -> None:
    """Refuse a number with which a script would need other statements."""
    if not holds:
        remedy = f"fingertip build design.toml --formats cq --set {'=VALUE or '.join(names)}=VALUE"
        raise AssertionError(f"{condition} does not hold; write a new script: {remedy}")
