"""Markdown as the sheets of a design use it, as HTML: headings, paragraphs, lists, tables, bold, code and pictures."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from fingertip.page.html import Markup, element, join, table

_SPAN = re.compile(r"\*\*(?P<bold>.+?)\*\*|`(?P<code>[^`]+)`|!\[(?P<alt>[^\]]*)\]\((?P<picture>[^)]*)\)")
_NUMBERED = re.compile(r"\d+\. ")


def split_sections(text: str, level: int = 2) -> dict[str, str]:
    """Split a page at the headings of a level: heading -> text below it. The part before the first has the key ""."""
    mark, found, heading = "#" * level + " ", {"": ""}, ""
    for line in text.splitlines():
        if line.startswith(mark):
            heading = line.removeprefix(mark).strip()
            found[heading] = ""
        else:
            found[heading] += line + "\n"
    return found


def render(text: str, pictures: Mapping[str, str] | None = None) -> Markup:
    """Render Markdown. Headings become the third level and below, because a page has its own two."""
    return join(_render_block(block, pictures or {}) for block in _split_blocks(text))


def list_steps(text: str, pictures: Mapping[str, str]) -> Markup:
    """Render a numbered list as steps, each with its picture."""
    return element("ol", *_render_items(text.strip().splitlines(), pictures), class_="steps")


def _split_blocks(text: str) -> Iterator[list[str]]:
    """Yield the lines of each block: blocks are separated by empty lines, but a list goes on over them."""
    block: list[str] = []
    for line in [*text.splitlines(), ""]:
        in_list = bool(block) and _is_item(block[0])
        if line.strip() and not (block and _starts_anew(block[0], line)):
            block.append(line)
        elif line.strip():
            yield block
            block = [line]
        elif block and not in_list:
            yield block
            block = []
    if block:
        yield block


def _is_item(line: str) -> bool:
    return line.startswith("- ") or bool(_NUMBERED.match(line))


def _starts_anew(first: str, line: str) -> bool:
    """Return whether a line cannot belong to the block that begins with another line."""
    if _is_item(first):
        return not (line.startswith(" ") or _is_item(line))
    return first.startswith("#") or line.startswith("#") or first.startswith("|") != line.startswith("|")


def _render_block(lines: list[str], pictures: Mapping[str, str]) -> Markup:
    first = lines[0]
    if first.startswith("#"):
        hashes, _, title = first.partition(" ")
        return element(f"h{min(len(hashes) + 1, 6)}", _render_spans(title, pictures))
    if first.startswith("|"):
        cells = [
            [_render_spans(cell.strip(), pictures) for cell in line.strip().strip("|").split(" | ")] for line in lines
        ]
        return table(cells[0], cells[2:])
    if _is_item(first):
        return element("ol" if _NUMBERED.match(first) else "ul", *_render_items(lines, pictures))
    return element("p", _render_spans(" ".join(line.strip() for line in lines), pictures))


def _render_items(lines: Iterable[str], pictures: Mapping[str, str]) -> list[Markup]:
    items: list[list[str]] = []
    for line in lines:
        if _is_item(line):
            items.append([line.partition(" ")[2]])
        elif line.strip() and items:
            items[-1].append(line.strip())
    return [element("li", _render_spans(" ".join(item), pictures)) for item in items]


def _render_spans(text: str, pictures: Mapping[str, str]) -> Markup:
    """Render bold text, code and pictures within a line. A picture stands below its text."""
    pieces: list[str] = []
    end = 0
    for match in _SPAN.finditer(text):
        pieces.append(text[end : match.start()])
        end = match.end()
        if bold := match["bold"]:
            pieces.append(element("strong", bold))
        elif code := match["code"]:
            pieces.append(element("code", code))
        elif source := pictures.get(match["picture"]):
            pieces.append(element("img", src=source, alt=match["alt"], decoding="async"))
    pieces.append(text[end:])
    return join(piece if isinstance(piece, Markup) else piece.replace("&nbsp;", "") for piece in pieces)
