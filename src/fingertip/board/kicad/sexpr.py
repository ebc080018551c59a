"""S-expressions as KiCad writes them: text from nested tuples of words."""

from __future__ import annotations

import json

Expression = tuple["str | Expression", ...]


def quote(word: str) -> str:
    """Return a word in double quotes, escaped."""
    if word.isprintable() and '"' not in word and "\\" not in word:
        return f'"{word}"'
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
    flats: list[str] = []
    inner: list[list[str]] = []
    words = 0
    for item in expression:
        if isinstance(item, str):
            flats.append(item)
            words += not inner  # words before the first list
        else:
            flat, lines = _lines(item, indent + "  ")
            flats.append(flat)
            inner.append(lines)
    flat = f"({' '.join(flats)})"
    # Where words follow a list, their order matters.
    if not inner or len(indent) + len(flat) <= MAX_LINE or words + len(inner) < len(flats):
        return flat, [indent + flat]
    divided = [f"{indent}({' '.join(flats[:words])}"]
    for lines in inner:
        divided += lines
    divided[-1] += ")"
    return flat, divided
