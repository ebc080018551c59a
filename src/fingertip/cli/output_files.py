"""Names of files that a command is asked to write: what is wrong with them is found before any work starts."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from fingertip.errors import Issue


def find_idle_issues(mode: str, options: Mapping[str, object]) -> Iterator[Issue]:
    """Find options that are given though an option that only prints something would pass over them."""
    for name, value in options.items():
        if value:
            yield Issue(name, f"has no effect with {mode}, which writes nothing; leave one of them out.")


def find_file_issues(
    option: str, path: Path | None, *suffixes: str, inputs: Iterable[Path | None] = (), kept: str = ""
) -> Iterator[Issue]:
    """Find why a file is not written: it is a folder, ends in another suffix, is needed, or its place takes no file.

    Parameters
    ----------
    option
        Option that names the file.
    path
        The file; None if the option was left out.
    suffixes
        Suffixes of the formats that are written.
    inputs
        Files that the command reads.
    kept
        Remedy for an existing file, such as "overwrite it with --force"; empty if it may be overwritten.
    """
    from fingertip.output_set.trial import find_place_issues

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
