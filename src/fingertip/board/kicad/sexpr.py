"""S-expressions as KiCad writes them: nested tuples of words to text."""

from __future__ import annotations

import json

Expression = tuple["str | Expression", ...]


def quoted(word: str) -> str:
    """A word in double quotes, escaped."""
    return json.dumps(word, ensure_ascii=False)


def number(value: float) -> str:
    """A length [mm] or an angle as KiCad prints it: six decimals at most, no trailing zeros, no minus zero."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def text(expression: Expression, indent: str = "") -> str:
    """On one line if it is short, else each list inside on its own line, after the words that lead."""
    flat = indent + _flat(expression)
    lists = [item for item in expression if not isinstance(item, str)]
    if len(flat) <= 110 or not lists:
        return flat
    words = [item for item in expression if isinstance(item, str)]
    if expression[: len(words)] != tuple(words):
        return flat  # a word after a list has its place
    inner = [text(item, indent + "  ") for item in lists]
    return f"{indent}({' '.join(words)}\n" + "\n".join(inner) + ")"


def _flat(expression: Expression) -> str:
    return "(" + " ".join(item if isinstance(item, str) else _flat(item) for item in expression) + ")"
