"""S-expressions as KiCad writes them: text from nested tuples of words."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

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


# Editor of s-expressions: it reads a file of KiCad as lists that know their place in the text.
#
# A replaced word changes its own characters, and every other character of the file stays: spaces, line ends, the order
# of lists, and lists that this program does not know.

_TOKEN = re.compile(r'\s*(?:(?P<bracket>[()])|(?P<quoted>"(?:[^"\\]|\\.)*")|(?P<word>[^\s()"]+))', re.DOTALL)
_ESCAPE = re.compile(r"\\(.)", re.DOTALL)
_ESCAPED = {"n": "\n", "r": "\r", "t": "\t"}


@dataclass(frozen=True)
class Word:
    """Word of a list, without its quotes."""

    text: str
    start: int
    """Index of its first character in the file, a quote included."""
    end: int


@dataclass(frozen=True)
class Node:
    """List of words and lists."""

    items: list[Word | Node] = field(default_factory=list)

    @property
    def words(self) -> list[str]:
        """Texts of its words, from the first, which names the list."""
        return [item.text for item in self.items if isinstance(item, Word)]

    @property
    def head(self) -> str:
        """Name of the list; empty if it has none."""
        return self.words[0] if self.items and isinstance(self.items[0], Word) else ""

    def children(self, *heads: str) -> Iterator[Node]:
        """Yield the lists in it that have one of these names."""
        return (item for item in self.items if isinstance(item, Node) and item.head in heads)

    def word(self, head: str, index: int = 1) -> str:
        """Word of the first list of this name in it; empty if there is none."""
        found = next((child.words for child in self.children(head)), [])
        return found[index] if index < len(found) else ""


def read_expression(text: str) -> Node:
    """Read the first list of a text. Raises ValueError."""
    root, position = Node(), 0
    stack = [root]
    while match := _TOKEN.match(text, position):
        position = match.end()
        if match["bracket"] == "(":
            node = Node()
            stack[-1].items.append(node)
            stack.append(node)
        elif match["bracket"]:
            stack.pop()
            if len(stack) == 1:
                break
            if not stack:
                raise ValueError("a closing bracket has no opening one")
        elif match["quoted"]:
            stack[-1].items.append(Word(_unquote(match["quoted"]), match.start("quoted"), position))
        else:
            stack[-1].items.append(Word(match["word"], match.start("word"), position))
    first = next((item for item in root.items if isinstance(item, Node)), None)
    if len(stack) != 1 or first is None:
        raise ValueError("it has no complete list")
    return first


def replace_words(text: str, changes: dict[Word, str]) -> str:
    """Replace some words of a text, each by a quoted one."""
    pieces, position = [], 0
    for word, new in sorted(changes.items(), key=lambda change: change[0].start):
        pieces += [text[position : word.start], quote(new)]
        position = word.end
    return "".join([*pieces, text[position:]])


def _unquote(quoted: str) -> str:
    return _ESCAPE.sub(lambda match: _ESCAPED.get(match[1], match[1]), quoted[1:-1])
