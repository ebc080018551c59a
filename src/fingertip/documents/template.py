"""Documents as Markdown templates (Jinja2): the text stands in a template, and a function beside it collects the data.

A name without a value is an error, and a float is written without the zeros at its end. Inside `{% filter wrap %}`,
paragraphs and list items are wrapped as a document's lines are, however the template breaks them.
"""

from __future__ import annotations

import functools
import re
import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from fingertip.foundation.files import format_figure

if TYPE_CHECKING:
    from jinja2 import Environment

WIDTH = 120
"""Longest line of a document [characters]."""
_ITEM = re.compile(r"- |\d+\. ")


def render(name: str, /, **data: Any) -> str:
    """Render a template of this package's folder, such as "board/readme.md"."""
    return _environment().get_template(name).render(data)


@functools.cache
def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("fingertip", "documents"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        finalize=lambda value: f"{value:g}" if isinstance(value, float) else value,
    )
    environment.filters |= {
        "wrap": wrap,
        "figure": format_figure,
        "fixed": _fixed,
        "digits": _digits,
        "milli": _milli,
        "ohm": format_ohm,
    }
    return environment


def _fixed(value: float, decimals: int) -> str:
    # 0 has no sign.
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def _digits(value: float, digits: int) -> str:
    return f"{value:.{digits}g}"


def _milli(value: float, decimals: int | None = None) -> str:
    """Write a value in thousandths of its unit."""
    return f"{1e3 * value:g}" if decimals is None else _fixed(1e3 * value, decimals)


def wrap(text: str) -> str:
    """Wrap the paragraphs and list items of a text, which blank lines and the marks of items begin."""
    blocks = (re.split(r"\n(?=- |\d+\. )", block.strip("\n")) for block in re.split(r"\n\s*\n", text.strip("\n")))
    return "\n\n".join("\n".join(map(_wrap_item, items)) for items in blocks) + "\n"


def _wrap_item(text: str) -> str:
    mark = _ITEM.match(text)
    return paragraph(" ".join(text.split()), "", " " * mark.end() if mark else "")


def format_ohm(value: float) -> str:
    """Format a resistance with three digits: 6800 -> "6.8 kohm"."""
    size, prefix = next(unit for unit in ((1e6, "M"), (1e3, "k"), (1.0, "")) if value >= unit[0] or not unit[1])
    return f"{value / size:.3g} {prefix}ohm"


def paragraph(text: str, first_indent: str = "", indent: str = "") -> str:
    """Wrap a text that is one paragraph."""
    return textwrap.fill(text, WIDTH, initial_indent=first_indent, subsequent_indent=indent, break_on_hyphens=False)


def bullet_list(notes: Iterable[str]) -> str:
    """Bullet list in Markdown, an item for each note."""
    return "\n".join(paragraph(note, "- ", "  ") for note in notes)
