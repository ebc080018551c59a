"""Counts of a module by its syntax tree: lines, tokens, and ways to put much into one line.

Tokens are those of the Python that runs this: from 3.12 on, an f-string has several. Compare counts
of the same Python.
"""

from __future__ import annotations

import ast
import io
import tokenize
from collections.abc import Iterable
from dataclasses import astuple, dataclass

MANY_ARGUMENTS = 6
"""Positional arguments from which on a call is counted."""
LAYOUT = (
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.COMMENT,
)
"""Kinds of tokens that are no code."""


@dataclass(frozen=True)
class Counts:
    """Counts of one module, or of several together."""

    modules: int = 0
    code_lines: int = 0
    """Lines without docstrings, imports, comments and blank lines."""
    tokens: int = 0
    packed_assignments: int = 0
    """Assignments of several values to as many names in one statement, such as `a, b = x, y`."""
    packed_of_three: int = 0
    """Packed assignments of three values or more."""
    walruses: int = 0
    format_skips: int = 0
    positional_calls: int = 0
    """Calls with six positional arguments or more."""
    nested_conditionals: int = 0
    functions: int = 0
    function_lines: int = 0


def add_up(counts: Iterable[Counts]) -> Counts:
    """Add the counts of several modules."""
    columns = zip(*(astuple(one) for one in counts), strict=True)
    return Counts(*(sum(column) for column in columns))


def count_module(text: str, path: str = "<module>") -> Counts:
    """Count what is in the source of a module; its path is for the message about a syntax error."""
    tree = ast.parse(text, filename=path)
    nodes = list(ast.walk(tree))
    code_lines = find_code_lines(nodes, text)
    packed = [count_packed_names(node) for node in nodes]
    lengths = [count_function_lines(node) for node in nodes]

    return Counts(
        modules=1,
        code_lines=len(code_lines),
        tokens=count_tokens(text, code_lines),
        packed_assignments=sum(names > 0 for names in packed),
        packed_of_three=sum(names >= 3 for names in packed),
        walruses=sum(isinstance(node, ast.NamedExpr) for node in nodes),
        format_skips=sum("fmt: skip" in line or "fmt: off" in line for line in text.splitlines()),
        positional_calls=sum(has_many_arguments(node) for node in nodes),
        nested_conditionals=sum(is_nested_conditional(node) for node in nodes),
        functions=sum(length > 0 for length in lengths),
        function_lines=sum(lengths),
    )


def find_code_lines(nodes: Iterable[ast.AST], text: str) -> set[int]:
    """Find the numbers of the lines that are no docstring, import, comment or blank line."""
    others = set[int]()
    for node in nodes:
        if isinstance(node, ast.Import | ast.ImportFrom):
            others.update(list_lines(node))
        for statement in list_docstrings(node):
            others.update(list_lines(statement))

    return {
        number
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.strip().startswith("#") and number not in others
    }


def list_docstrings(node: ast.AST) -> list[ast.Expr]:
    """List the texts that stand as statements in the body of a node."""
    body = getattr(node, "body", None)
    if not isinstance(body, list):
        return []
    return [
        statement
        for statement in body
        if isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    ]


def list_lines(node: ast.stmt) -> range:
    """List the numbers of the lines of a statement."""
    return range(node.lineno, (node.end_lineno or node.lineno) + 1)


def count_tokens(text: str, code_lines: set[int]) -> int:
    """Count the tokens that begin in lines of code, without those of the layout."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return sum(token.start[0] in code_lines and token.type not in LAYOUT for token in tokens)


def count_packed_names(node: ast.AST) -> int:
    """Count the names of a packed assignment; 0 for anything else.

    An exchange of values is none, and neither is an assignment of constants.
    """
    if not isinstance(node, ast.Assign):
        return 0
    target = node.targets[0]
    if not isinstance(target, ast.Tuple) or not isinstance(node.value, ast.Tuple):
        return 0
    values = node.value.elts
    if len(target.elts) != len(values):
        return 0
    if all(isinstance(value, ast.Constant) for value in values):
        return 0

    read = {part.id for part in ast.walk(node.value) if isinstance(part, ast.Name)}
    written = {part.id for part in target.elts if isinstance(part, ast.Name)}
    return 0 if read & written else len(values)


def has_many_arguments(node: ast.AST) -> bool:
    """Return whether a node is a call with many positional arguments."""
    return isinstance(node, ast.Call) and len(node.args) >= MANY_ARGUMENTS


def is_nested_conditional(node: ast.AST) -> bool:
    """Return whether a node is a conditional expression whose `else` is another."""
    return isinstance(node, ast.IfExp) and isinstance(node.orelse, ast.IfExp)


def count_function_lines(node: ast.AST) -> int:
    """Count the lines of a function without its decorators; 0 for anything else."""
    if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        return 0
    return len(list_lines(node))
