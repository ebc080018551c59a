"""Documents as Markdown templates, which stand beside the functions that collect their data.

A template holds whole sentences on lines of any length. What it gives is then laid out as Markdown reads it: the lines
of a paragraph, of an entry of a list or of a row of a table become one, and one empty line parts two blocks.
"""

from __future__ import annotations

import functools
import re
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment

_FENCE = "```"
_BEGINS_BLOCK = re.compile(r"#+ |\||- |\d+\. |\s*!\[")
_LIST_ENTRY = re.compile(r"- ")


def render(name: str, data: Mapping[str, Any], width: int | None = None) -> str:
    """Render a template of this folder as a page; a width wraps its paragraphs and lists."""
    return lay_out(_templates().get_template(name).render(data), width)


def render_rows(name: str, data: Mapping[str, Any]) -> list[dict[str, str]]:
    """Render a template that is a table, as its rows: column -> cell."""
    rows = (line for line in render(name, data).splitlines() if line.startswith("|"))
    head, _, *cells = ([cell.strip() for cell in row[1:-1].split("|")] for row in rows)
    return [dict(zip(head, row, strict=True)) for row in cells]


@functools.cache
def _templates() -> Environment:
    import jinja2

    # No page is HTML: nothing is escaped. A name that the data lack is an error.
    templates = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_write,
    )
    templates.filters |= {"listed": list_in_words, "span": write_span, "fixed": write_fixed}
    return templates


def _write(value: Any) -> Any:
    """Write a float without the zeros at its end."""
    return f"{value:g}" if isinstance(value, float) else value


def list_in_words(names: Sequence[str], last_word: str = "and") -> str:
    """Write names as a list in words."""
    *first, last = names
    return f"{', '.join(first)} {last_word} {last}" if first else last


def write_span(limits: Sequence[float]) -> str:
    """Write the lower and the upper limit of a size; one figure if they agree."""
    low, high = limits
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def write_fixed(value: float, decimals: int) -> str:
    """Write a number with fixed decimals."""
    return f"{value:.{decimals}f}"


def lay_out(text: str, width: int | None = None) -> str:
    """Join the lines of each block of a page, and wrap paragraphs and lists to a width if there is one.

    The further lines of a row of a table are indented.
    """
    lines, is_fenced, is_open = [""], False, False
    for line in text.splitlines():
        is_fence = line.startswith(_FENCE)
        continues_row = lines[-1].startswith("|") and line.startswith("  ")
        if is_fenced or is_fence:
            lines.append(line)
            is_fenced ^= is_fence
            is_open = False
        elif not line.strip():
            lines += [""] if lines[-1] else []
            is_open = False
        elif continues_row or (is_open and not _BEGINS_BLOCK.match(line)):
            lines[-1] += f" {line.strip()}"
        else:
            lines.append(line.rstrip())
            is_open = not line.startswith(("#", "|"))
    return "\n".join(_wrap(lines, width) if width else lines).strip("\n") + "\n"


def _wrap(lines: Sequence[str], width: int) -> list[str]:
    """Wrap paragraphs and entries of lists; tables, headings and code stay as they are."""
    wrapped, is_fenced = list[str](), False
    for line in lines:
        is_fenced ^= line.startswith(_FENCE)
        if is_fenced or not line or line.startswith(("|", "#", _FENCE)):
            wrapped.append(line)
        else:
            indent = "  " if _LIST_ENTRY.match(line) else ""
            wrapped += textwrap.wrap(line, width, subsequent_indent=indent, break_on_hyphens=False)
    return wrapped
