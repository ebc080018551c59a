"""S-expressions as KiCad writes them: text from nested tuples of words, and files read as lists."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice

Expression = tuple["str | Expression", ...]


def quote(word: str) -> str:
    """Return a word in double quotes, escaped."""
    if word.isprintable() and '"' not in word and "\\" not in word:
        return f'"{word}"'

    return json.dumps(word, ensure_ascii=False)


def number(value: float) -> str:
    """Format a length [mm] or an angle as KiCad does: six decimals at most, no minus zero."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


MAX_LINE = 110
"""Length above which an expression is divided into lines."""


def format_expression(expression: Expression, indent: str = "") -> str:
    """Format an expression on one line if it is short, else each inner list on its own line."""
    return "\n".join(_lines(expression, indent)[1])


def _lines(expression: Expression, indent: str) -> tuple[str, list[str]]:
    """Return an expression on one line, and divided into lines.

    Both come from one pass: layouts have thousands of lists.
    """
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


# Reader and editor of s-expressions: it reads a file of KiCad as lists that know their place in the
# text.
#
# A replaced word changes its own characters, and every other character of the file stays: spaces,
# line ends, the order of lists, and lists that this program does not know.

_TOKEN = re.compile(r'[()]|"(?:[^"\\]|\\.)*"|[^\s()"]+|"', re.DOTALL)
"""Bracket, quoted word, word, or a quote that is never closed."""
_ESCAPE = re.compile(r"\\(.)", re.DOTALL)
_ESCAPED = {"n": "\n", "r": "\r", "t": "\t"}
Span = tuple[int, int]
"""Index of a first character in a text, and of the one after the last."""


@dataclass(slots=True, eq=False)
class Node:
    """List of words and lists."""

    items: list[str | Node] = field(default_factory=list)
    """Words without their quotes, and lists."""
    start: int = 0
    end: int = 0
    """Index of its opening bracket in the text, and that after its closing bracket."""

    @property
    def words(self) -> list[str]:
        """Words in order; the first names the list."""
        return [item for item in self.items if isinstance(item, str)]

    @property
    def head(self) -> str:
        """Name of the list; empty if it has none."""
        first = self.items[0] if self.items else ""
        return first if isinstance(first, str) else ""

    def children(self, *heads: str) -> Iterator[Node]:
        """Yield the lists in it that have one of these names."""
        return (item for item in self.items if isinstance(item, Node) and item.head in heads)

    def word(self, head: str, index: int = 1) -> str:
        """Return a word of the first list of this name; empty if there is none."""
        words = next((child.words for child in self.children(head)), [])
        return words[index] if index < len(words) else ""


def read_expression(text: str) -> Node:
    """Read the first list of a text. Raises ValueError."""
    node = Node()
    outer = list[Node]()

    for match in _TOKEN.finditer(text):
        token = match.group()
        if token == "(":
            outer.append(node)
            node = Node([], match.start())
            outer[-1].items.append(node)
        elif token == ")":
            if not outer:
                raise ValueError("a closing bracket has no opening one")

            node.end = match.end()
            if len(outer) == 1:
                return node

            node = outer.pop()
        elif token == '"':
            break
        else:
            node.items.append(_unquote(token) if token[0] == '"' else token)

    raise ValueError("it has no complete list")


def _unquote(quoted: str) -> str:
    """Return the word within double quotes, without its escapes."""
    word = quoted[1:-1]
    return (
        _ESCAPE.sub(lambda match: _ESCAPED.get(match[1], match[1]), word) if "\\" in word else word
    )


def find_word(text: str, node: Node, index: int) -> Span:
    """Return the span of a word of a list in the text, its quotes included.

    No list stands before it.
    """
    return next(islice(_TOKEN.finditer(text, node.start + 1), index, None)).span()


def replace_spans(text: str, changes: Mapping[Span, str]) -> str:
    pieces = []
    position = 0
    for (start, end), new in sorted(changes.items()):
        pieces += [text[position:start], new]
        position = end

    return "".join([*pieces, text[position:]])


def change_property(text: str, entry: Node, word: str) -> dict[Span, str]:
    """Change the text of a field; a one-line list that becomes too long is divided."""
    start, end = find_word(text, entry, 2)
    line = text.rfind("\n", 0, entry.start) + 1
    changes = {(start, end): quote(word)}
    length = len(text[line:].partition("\n")[0]) + len(quote(word)) - (end - start)

    if length > MAX_LINE and "\n" not in text[entry.start : entry.end]:
        indent = "\n" + " " * (entry.start - line + 2)
        changes |= {
            (item.start - 1, item.start): indent for item in entry.items if isinstance(item, Node)
        }

    return changes


# Numbers and positions in the lists of KiCad's files [mm]; the y axis points down.

Point = tuple[float, float]


def first(node: Node, head: str) -> Node:
    """Return the first list of this name; an empty one if there is none."""
    return next(node.children(head), Node())


def numbers(node: Node) -> list[float]:
    """Return the words of a list after its name, as numbers."""
    return [float(word) for word in node.words[1:]]


def points(node: Node) -> list[Point]:
    return [(x, y) for x, y in (numbers(item)[:2] for item in first(node, "pts").children("xy"))]


def find_place(node: Node) -> tuple[float, float, float]:
    """Return the place of an item [mm], and the angle by which it is turned [degrees]."""
    x, y, angle = (*numbers(first(node, "at")), 0.0)[:3]
    return x, y, angle


def turn(x: float, y: float, angle_deg: float) -> Point:
    """Turn a point counter-clockwise as seen, with y pointing down."""
    cos = math.cos(math.radians(angle_deg))
    sin = math.sin(math.radians(angle_deg))
    return x * cos + y * sin, y * cos - x * sin
