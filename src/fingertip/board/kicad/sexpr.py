"""S-expressions as KiCad writes them: text from nested tuples of words."""

from __future__ import annotations

import json

Expression = tuple["str | Expression", ...]


def quote(word: str) -> str:
    """Return a word in double quotes, escaped."""
    return json.dumps(word, ensure_ascii=False)


def number(value: float) -> str:
    """Format a length [mm] or an angle as KiCad does: at most six decimals, no trailing zeros, no minus zero."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


MAX_LINE = 110
"""Length above which an expression is divided into lines."""


def format_expression(expression: Expression, indent: str = "") -> str:
    """Format an expression: on one line if it is short, else with each inner list on a line of its own."""
    return "\n".join(_lines(expression, indent)[1])


def _lines(expression: Expression, indent: str) -> tuple[str, list[str]]:
    """Text of an expression on one line, and its lines. Both come from one pass: layouts have thousands of lists."""
    words = [item for item in expression if isinstance(item, str)]
    if len(words) == len(expression):
        flat = f"({' '.join(words)})"
        return flat, [indent + flat]
    inner = [(item, []) if isinstance(item, str) else _lines(item, indent + "  ") for item in expression]
    flat = f"({' '.join(text for text, _ in inner)})"
    # Where words follow a list, their order matters.
    if len(indent) + len(flat) <= MAX_LINE or expression[: len(words)] != tuple(words):
        return flat, [indent + flat]
    lines = [f"{indent}({' '.join(words)}"]
    for _, lines_of_item in inner:
        lines += lines_of_item
    lines[-1] += ")"
    return flat, lines
