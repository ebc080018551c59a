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


def format_expression(expression: Expression, indent: str = "") -> str:
    """Format an expression: on one line if it is short, else with each inner list on a line of its own."""
    flat = indent + _flat(expression)
    lists = [item for item in expression if not isinstance(item, str)]
    if len(flat) <= 110 or not lists:
        return flat
    words = [item for item in expression if isinstance(item, str)]
    if expression[: len(words)] != tuple(words):
        return flat  # the order of words and lists matters here
    inner = [format_expression(item, indent + "  ") for item in lists]
    return f"{indent}({' '.join(words)}\n" + "\n".join(inner) + ")"


def _flat(expression: Expression) -> str:
    return "(" + " ".join(item if isinstance(item, str) else _flat(item) for item in expression) + ")"
