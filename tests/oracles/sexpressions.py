"""Oracle: a reader of s-expressions as nested lists that shares no code with the package."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

Expression = list[Any]


def parse(text: str) -> Expression:
    """Parse an s-expression into nested lists of words."""
    stack: list[Expression] = [[]]
    for quoted, bracket, word in re.findall(r'"((?:[^"\\]|\\.)*)"|([()])|([^\s()"]+)', text):
        if bracket == "(":
            stack.append([])
        elif bracket == ")":
            closed = stack.pop()
            stack[-1].append(closed)
        else:
            stack[-1].append(word or quoted)
    return stack[0][0]  # type: ignore[no-any-return]


def children(expression: Expression, head: str) -> Iterator[Expression]:
    """Direct children of an expression whose first word is `head`."""
    return (item for item in expression if isinstance(item, list) and item and item[0] == head)


def descendants(expression: Expression, head: str) -> Iterator[Expression]:
    """Descendants of an expression at any depth whose first word is `head`."""
    for item in expression:
        if isinstance(item, list):
            if item and item[0] == head:
                yield item
            yield from descendants(item, head)


def word(expression: Expression, head: str) -> str:
    """Word after the head of the first direct child whose first word is `head`."""
    return next(children(expression, head))[1]  # type: ignore[no-any-return]
