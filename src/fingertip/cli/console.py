"""What every command shares: results on stdout, words and progress on stderr, errors as sentences, exit codes.

Exit codes: 0 done and valid, 1 a check failed, 2 bad input, 130 interrupted with part of the result told.
"""

from __future__ import annotations

import contextlib
import functools
import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, ParamSpec

import typer

from fingertip.errors import FingertipError, Issue, OutputError

P = ParamSpec("P")

CHECK_FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130

# Options of the same name mean the same in every command, so they are declared once.
JsonOption = Annotated[bool, typer.Option("--json", help="One JSON object on stdout, nothing else there.")]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="No progress and no messages on stderr.")]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="TABLE.KEY=VALUE", help="Change a parameter of the design; repeatable."),
]


class Console:
    """Where a command's words go."""

    def __init__(self, as_json: bool, quiet: bool) -> None:
        self.as_json = as_json
        self.quiet = quiet

    def progress(self, message: str) -> None:
        """A message or a step of progress, on stderr."""
        if not self.quiet:
            print(message, file=sys.stderr, flush=True)

    def result(self, data: Mapping[str, Any], text: str) -> None:
        """The command's result on stdout: `data` as one JSON object, or else `text` for people."""
        if self.as_json:
            self.write(json.dumps(data, indent=2, allow_nan=False))
        elif text:
            self.write(text)

    def write(self, text: str) -> None:
        """A line of the result, or all of it, on stdout at once.

        Raises
        ------
        OutputError
            If it cannot be written, as on a full disk; a reader who has seen enough is no error of that kind.
        """
        try:
            print(text, flush=True)
        except BrokenPipeError:
            raise
        except OSError as error:
            _abandon_stdout()
            reason = error.strerror or str(error)
            raise OutputError(Issue("standard output", f"cannot be written ({reason}); send it elsewhere.")) from error

    def issues(self, error: FingertipError, beside: Mapping[str, Any] | None = None) -> None:
        """Issues as sentences on stderr, and under --json as one object on stdout, with what was found before them."""
        for issue in error.issues:
            print(f"error: {issue}", file=sys.stderr)
        if self.as_json:
            issues = [{"field": issue.field, "message": issue.message} for issue in error.issues]
            with contextlib.suppress(OutputError):  # then they stand on stderr only
                self.write(json.dumps({**(beside or {}), "issues": issues}, indent=2))


def picture_issues(option: str, path: Path | None) -> Iterator[Issue]:
    """Pictures are PNG, and a file should be what its name says."""
    if path is not None and path.suffix.lower() != ".png" and not path.is_dir():
        yield Issue(option, f"{path.name!r} is no name of a PNG, which is what is written; end it in .png.")


def _abandon_stdout() -> None:
    """What is left in its buffer would fail once more when the process ends, with a traceback."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def command(function: Callable[P, None]) -> Callable[P, None]:
    """Turn issues into sentences on stderr (and a JSON object on stdout under --json) and exit code 2."""

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            function(*args, **kwargs)
        except FingertipError as error:
            Console(bool(kwargs.get("as_json")), False).issues(error)
            raise typer.Exit(BAD_INPUT) from None

    return run
