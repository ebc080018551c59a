"""S-expressions as nested lists: a reader that shares nothing with the package."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

Expression = list[Any]


def parse(text: str) -> Expression:
    """An s-expression as nested lists of words."""
    stack: list[Expression] = [[]]
    for quoted, bracket, word in re.findall(r'"((?:[^"\\]|\\.)*)"|([()])|([^\s()"]+)', text):
        if bracket == "(":
            stack.append([])
        elif bracket == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(word or quoted)
    return stack[0][0]  # type: ignore[no-any-return]


def children(expression: Expression, head: str) -> Iterator[Expression]:
    return (item for item in expression if isinstance(item, list) and item and item[0] == head)


def everywhere(expression: Expression, head: str) -> Iterator[Expression]:
    for item in expression:
        if isinstance(item, list):
            if item and item[0] == head:
                yield item
            yield from everywhere(item, head)
