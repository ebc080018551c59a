"""Arguments and options that several commands declare: one of the same name means the same in each."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from fingertip.catalogues.silicones import SILICONES
from fingertip.foundation.errors import Issue

if TYPE_CHECKING:
    from fingertip.design import Design


DesignArgument = Annotated[
    Path, typer.Argument(help="Design file, or a bundled design such as fsr400 or adult_finger.")
]
"""Design that must be named."""
OptionalDesignArgument = Annotated[
    Path | None, typer.Argument(help="Design file or bundled name; the default design if left out.")
]
"""Design that may be left out."""
MaterialOption = Annotated[
    str | None,
    typer.Option(help=f"Silicone: {', '.join(SILICONES)} or own; the design's silicone.product if omitted."),
]
"""Silicone of the skin."""
CalibratedDesignOption = Annotated[
    Path | None,
    typer.Option("--out", "-o", metavar="FILE", help="File for the calibrated design, a complete design file."),
]
"""File that a calibration writes."""
ForceCalibratedOption = Annotated[bool, typer.Option("--force", help="Overwrite FILE if it exists.")]
"""Permission to overwrite that file."""


# Loading of the design that a command is given.


Progress: TypeAlias = Callable[[str], None]
"""Callback that reports progress text."""


def load_design(
    file: Path | None, changes: Sequence[str] | None, progress: Progress | None = None
) -> tuple[Design, dict[str, Any]]:
    """Load the design of a file, or the default design, with changes. Raises DesignError."""
    from fingertip.design import Design
    from fingertip.design.files import load_tables

    loaded = load_tables([file] if file else [], changes or ())
    if file and not loaded.before and progress:
        progress(f"{file} sets no parameter: this is the default design, fsr400")
    return Design.from_tables(loaded.tables, loaded.before, loaded.changed), loaded.tables


# Names of files that a command is asked to write: what is wrong with them is found before any work starts.


def find_idle_issues(mode: str, options: Mapping[str, object]) -> Iterator[Issue]:
    """Find options that are given though an option that only prints something would pass over them."""
    for name, value in options.items():
        if value:
            yield Issue(name, f"has no effect with {mode}, which writes nothing; leave one of them out.")


def find_file_issues(
    option: str, path: Path | None, *suffixes: str, inputs: Iterable[Path | None] = (), kept: str = ""
) -> Iterator[Issue]:
    """Find why a file is not written: it is a folder, ends in another suffix, is needed, or its place takes no file."""
    from fingertip.foundation.output_set.writer import find_place_issues

    if path is None:
        return
    remedy = f"choose another file with {option}"
    if os.path.isdir(path):
        yield Issue(str(path), f"is a folder; {remedy}.")
    elif path.suffix.lower() not in suffixes:
        yield Issue(option, f"{path.name!r} is of no format that is written; end it in {' or '.join(suffixes)}.")
    elif os.path.exists(path) and any(given and os.path.exists(given) and path.samefile(given) for given in inputs):
        yield Issue(option, f"{path} is an input of this command; give another name.")
    elif kept and os.path.lexists(path):
        yield Issue(str(path), f"exists and is not overwritten; {remedy}, or {kept}.")
    else:
        yield from find_place_issues(path.parent, remedy, path.name)
