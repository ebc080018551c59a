"""What every command shares: results on stdout, words and progress on stderr, errors as sentences, exit codes.

Exit codes: 0 done and valid, 1 a check failed, 2 bad input.
"""

from __future__ import annotations

import functools
import json
import sys
from collections.abc import Callable, Mapping
from typing import Annotated, Any, ParamSpec

import typer

from fingertip.errors import FingertipError

P = ParamSpec("P")

CHECK_FAILED = 1
BAD_INPUT = 2

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

    def say(self, message: str) -> None:
        """A message or a step of progress, on stderr."""
        if not self.quiet:
            print(message, file=sys.stderr, flush=True)

    def result(self, data: Mapping[str, Any], text: str) -> None:
        """The command's result on stdout: `data` as one JSON object, or else `text` for people."""
        if self.as_json:
            print(json.dumps(data, indent=2, allow_nan=False))
        elif text:
            print(text)


def command(function: Callable[P, None]) -> Callable[P, None]:
    """Turn faults into sentences on stderr (and a JSON object on stdout under --json) and exit code 2."""

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            function(*args, **kwargs)
        except FingertipError as error:
            for fault in error.faults:
                print(f"error: {fault}", file=sys.stderr)
            if kwargs.get("as_json"):
                faults = [{"field": fault.field, "sentence": fault.sentence} for fault in error.faults]
                print(json.dumps({"faults": faults}, indent=2))
            raise typer.Exit(BAD_INPUT) from None

    return run
