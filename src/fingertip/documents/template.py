"""Documents as Markdown templates (Jinja2): the text stands in a template, and a function beside it
collects the data.

A name without a value is an error, and a float is written without the zeros at its end. The lines
of a template may break anywhere within a sentence: `lay_out_page` makes the lines of the page.
"""

from __future__ import annotations

import contextlib
import functools
import re
import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingertip.foundation.errors import join_words
from fingertip.foundation.files import format_figure

if TYPE_CHECKING:
    from jinja2 import Environment
    from jinja2.bccache import Bucket

WIDTH = 120
"""Longest line of a document whose text is wrapped [characters]."""
_FENCE = "```"
_ITEM = re.compile(r"- |\d+\. ")
_BEGINS_BLOCK = re.compile(rf"#+ |\||{_ITEM.pattern}|\s*!\[")


def render(name: str, /, **data: Any) -> str:
    """Render a template of this package's folder, such as "board/readme.md"."""
    return _environment().get_template(name).render(data)


def render_text(template: str, /, **data: Any) -> str:
    return _environment().from_string(template).render(data)


def fill(name: str, sheet: object) -> str:
    """Render a template with the fields of a dataclass, and lay it out."""
    return render_page(name, **vars(sheet))


def render_page(name: str, width: int | None = None, /, **data: Any) -> str:
    """Render a template and lay it out, with a width of its lines or each block in one."""
    return lay_out_page(render(name, **data), width)


@functools.cache
def _environment() -> Environment:
    from jinja2 import Environment, FileSystemBytecodeCache, PackageLoader, StrictUndefined  # noqa: PLC0415

    class Cache(FileSystemBytecodeCache):
        """Compiled templates beside this module's own bytecode:
        compiling takes a twentieth of `make`.
        """

        def get_source_checksum(self, source: str) -> str:
            return super().get_source_checksum(source + own)

        def dump_bytecode(self, bucket: Bucket) -> None:
            with contextlib.suppress(OSError):  # no room, or no right to write
                super().dump_bytecode(bucket)

    own = Path(__file__).read_text(encoding="utf-8")
    folder = Path(__file__).parent / "__pycache__"
    environment = Environment(
        bytecode_cache=None if sys.dont_write_bytecode else Cache(str(folder)),
        optimized=False,  # no filter is called while a template is compiled: its code may change
        loader=PackageLoader("fingertip", "documents"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        finalize=lambda value: f"{value:g}" if isinstance(value, float) else value,
    )
    environment.filters |= {
        "wrap": lambda text: lay_out_page(text, WIDTH),
        "paragraphs": lay_out_page,
        "listed": join_words,
        # The lower and the upper limit of a size; one figure if they agree.
        "span": lambda limits: " to ".join(dict.fromkeys(f"{limit:g}" for limit in limits)),
        "figure": format_figure,
        "fixed": _fixed,
        "digits": lambda value, digits: f"{value:.{digits}g}",
        # In thousandths of the unit.
        "milli": lambda value, decimals=None: (
            f"{1e3 * value:g}" if decimals is None else _fixed(1e3 * value, decimals)
        ),
        "ohm": format_ohm,
    }

    return environment


def _fixed(value: float, decimals: int) -> str:
    # 0 has no sign.
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def format_ohm(value: float) -> str:
    """Format a resistance with three digits: 6800 -> "6.8 kohm"."""
    size, prefix = next(
        unit for unit in ((1e6, "M"), (1e3, "k"), (1.0, "")) if value >= unit[0] or not unit[1]
    )
    return f"{value / size:.3g} {prefix}ohm"


def lay_out_page(text: str, width: int | None = None) -> str:
    """Make one line of each paragraph, item of a list and row of a table, and one empty line
    between blocks.

    With a width, paragraphs and items are wrapped. The further lines of a row are indented in the
    template.
    """
    lines = [""]
    is_fenced = False
    is_open = False

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
    """Wrap paragraphs and items of lists; tables, headings and code stay as they are."""
    wrapped = list[str]()
    is_fenced = False

    for line in lines:
        is_fenced ^= line.startswith(_FENCE)
        if is_fenced or not line or line.startswith(("|", "#", _FENCE)):
            wrapped.append(line)
        else:
            mark = _ITEM.match(line)
            indent = " " * mark.end() if mark else ""
            wrapped += textwrap.wrap(line, width, subsequent_indent=indent, break_on_hyphens=False)

    return wrapped
