"""Hash of what figures rest on: program text without its comments,
docstrings and layout, tables, and presets.
"""

from __future__ import annotations

import ast
import functools
import hashlib
from collections.abc import Iterable
from pathlib import Path


def hash_basis(root: Path, paths: Iterable[str], presets: Iterable[str]) -> str:
    """Hash files and folders below a root, and the values of designs by their names or files.

    Raises FileNotFoundError for a path that is neither a file nor a folder.
    """
    whole = hashlib.sha256()
    for path in paths:
        for file in _list_files(root / path):
            whole.update(f"{file.relative_to(root).as_posix()} {_hash_file(file)}\n".encode())

    for preset in presets:
        whole.update(f"preset {preset} {_describe_preset(preset)}\n".encode())

    return whole.hexdigest()


def describe_source(text: str) -> str:
    """Describe what a Python source does: the same for each layout,
    comment and docstring, and for each Python.
    """
    parts = list[str]()
    _describe(ast.parse(text), parts)
    return "".join(parts)


def _list_files(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    if not path.is_dir():
        raise FileNotFoundError(f"{path} is neither a file nor a folder")

    return sorted(
        file for file in path.rglob("*") if file.is_file() and "__pycache__" not in file.parts
    )


@functools.cache
def _hash_file(path: Path) -> str:
    content = path.read_bytes()
    if path.suffix == ".py":
        content = describe_source(content.decode()).encode()

    return hashlib.sha256(content).hexdigest()


@functools.cache
def _describe_preset(name: str) -> str:
    """Describe the values of a design, with the defaults and what it derives."""
    from fingertip.design import Design

    return Design.load(name).model_dump_json()


def _describe(value: object, parts: list[str]) -> None:
    """Append the text of a node of a syntax tree, or of a field of
    one; fields that are empty are left out.
    """
    if isinstance(value, ast.Constant):
        parts.append(repr(value.value))
    elif isinstance(value, ast.AST):
        parts.append(f"{type(value).__name__}(")
        for name in value._fields:
            field = getattr(value, name, None)
            if field is not None and field != [] and name not in ("ctx", "type_comment"):
                parts.append(f"{name}=")
                _describe(field, parts)

        parts.append(")")
    elif isinstance(value, list):
        for item in value:
            if not _is_docstring(item):
                parts.append("[")
                _describe(item, parts)
                parts.append("]")
    else:
        parts.append(repr(value))


def _is_docstring(item: object) -> bool:
    """Tell whether a statement is a text alone, which documents what stands before or around it."""
    return (
        isinstance(item, ast.Expr)
        and isinstance(item.value, ast.Constant)
        and isinstance(item.value.value, str)
    )
