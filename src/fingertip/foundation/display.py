"""Display of results in Python and Jupyter: tables in HTML, pictures, and data frames where pandas is installed.

A design cannot import what draws it, which builds on it. `plot` therefore finds it by its name.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingertip.foundation.errors import Issue, OutputError
from fingertip.foundation.extras import load

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Picture:
    """Picture that Jupyter shows, and that can be saved."""

    png: bytes

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        width, height = self.size_px
        return f"Picture({width} x {height} pixels; save it with .save('picture.png'))"

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height [pixels], as the file states them."""
        return int.from_bytes(self.png[16:20], "big"), int.from_bytes(self.png[20:24], "big")

    def save(self, path: str | Path) -> Path:
        """Write the picture to a PNG file.

        Raises
        ------
        OutputError
            If the name does not end in ``.png``, or the file cannot be written.
        """
        from fingertip.foundation.files import write_file  # noqa: PLC0415

        if Path(path).suffix.lower() != ".png":
            raise OutputError(Issue(str(path), "would be a PNG file of another name; end it in .png."))
        write_file(Path(path), self.png, "picture")
        return Path(path)


def plot(where: str, *arguments: Any) -> Picture:
    """Draw something with a function that returns a PNG, named as ``module:function``."""
    module, function = where.split(":")
    return Picture(getattr(import_module(module), function)(*arguments))


def html_table(caption: str, header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Write a table in HTML with its caption; every text is escaped."""
    head = "".join(f"<th>{html.escape(name)}</th>" for name in header)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    return (
        f"<table><caption>{html.escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )


def to_dataframe(columns: Mapping[str, Any], method: str) -> pandas.DataFrame:
    """Make a data frame of columns. Raises MissingLibraryError."""
    return load("pandas", method).DataFrame(dict(columns))
