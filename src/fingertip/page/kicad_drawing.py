"""Reader of KiCad's files: their S-expressions as nested tuples, and access to the lists within."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from fingertip.board.kicad.sexpr import Expression

_TOKEN = re.compile(r'"((?:[^"\\]|\\.)*)"|([()])|([^\s()"]+)')
_ESCAPE = re.compile(r"\\(.)")


def parse(text: str) -> Expression:
    """Parse the one expression of a file."""
    stack: list[list[str | Expression]] = [[]]
    for quoted, bracket, word in _TOKEN.findall(text):
        if bracket == "(":
            stack.append([])
        elif bracket == ")":
            done = tuple(stack.pop())
            stack[-1].append(done)
        else:
            stack[-1].append(word or _ESCAPE.sub(r"\1", quoted))
    (whole,) = stack[0]
    assert isinstance(whole, tuple)
    return whole


def lists(expression: Expression, *names: str) -> Iterator[Expression]:
    """Yield the lists of an expression that begin with one of the names."""
    for item in expression:
        if isinstance(item, tuple) and item and item[0] in names:
            yield item


def first(expression: Expression, name: str) -> Expression:
    """Return the first list that begins with a name; an empty one if there is none."""
    return next(lists(expression, name), ())


def words(expression: Expression) -> list[str]:
    """Return the words of a list after its name."""
    return [item for item in expression[1:] if isinstance(item, str)]


def word(expression: Expression, name: str, default: str = "") -> str:
    """Return the first word of the first list that begins with a name."""
    return next(iter(words(first(expression, name))), default)


def numbers(expression: Expression) -> list[float]:
    """Return the words of a list after its name, as numbers."""
    return [float(item) for item in words(expression)]


def points(expression: Expression) -> list[tuple[float, float]]:
    """Return the points of a polygon or line."""
    return [(x, y) for x, y in (numbers(item)[:2] for item in lists(first(expression, "pts"), "xy"))]


def is_hidden(expression: Expression) -> bool:
    """Return whether a text is hidden."""
    return any(word(place, "hide", "no") == "yes" for place in (expression, first(expression, "effects")))


def turn(x: float, y: float, angle_deg: float) -> tuple[float, float]:
    """Turn a point counter-clockwise as seen, with y pointing down."""
    cos, sin = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return x * cos + y * sin, y * cos - x * sin
