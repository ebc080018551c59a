"""Output conventions of all commands: results on stdout; messages, progress and errors on stderr; exit codes.

Exit codes: 0 for success, 1 for a failed check, 2 for bad input, 70 for a fault of the program, 130 after Ctrl-C, 143
after SIGTERM, 129 after SIGHUP, 141 where the reader of the output has closed its pipe.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
import json
import os
import re
import shutil
import sys
import textwrap
from collections.abc import Callable, Mapping
from typing import Annotated, Any, NoReturn, ParamSpec

import typer

from fingertip import interruption
from fingertip.cli.last_resort import FAULT, describe_fault, describe_path_error
from fingertip.cli.progress import ProgressDisplay
from fingertip.errors import FingertipError, Issue, OutputError, escape_control
from fingertip.progress import ShareText

P = ParamSpec("P")

CHECK_FAILED = 1
BAD_INPUT = 2
PIPE_CLOSED = 141
_MAX_PRINTED = 200
"""Maximum number of issues that are printed to stderr."""

COMMON = "Options of all commands"
"""Heading of these options on the help pages."""

# An option of the same name means the same in every command, so it is declared once.
JsonOption = Annotated[
    bool, typer.Option("--json", rich_help_panel=COMMON, help="Print one JSON object to stdout and nothing else.")
]
QuietOption = Annotated[
    bool,
    typer.Option(
        "--quiet",
        "-q",
        rich_help_panel=COMMON,
        help="Print no progress and no messages on stderr, only errors; the result still goes to stdout.",
    ),
]
VerboseOption = Annotated[bool, typer.Option("--verbose", "-v", help="Print the details too, not only the verdict.")]
ForceOption = Annotated[
    bool, typer.Option("--force", help="Overwrite files that fingertip did not write, or that were changed since.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="TABLE.KEY=VALUE", help="Change a parameter of the design; repeatable."),
]


class Console:
    """Output of a command.

    Parameters
    ----------
    as_json
        Whether the result is printed as one JSON object.
    quiet
        Whether progress and messages are suppressed. Errors are always printed.
    """

    def __init__(self, as_json: bool, quiet: bool) -> None:
        self.as_json = as_json
        self.quiet = quiet
        self._display = ProgressDisplay()

    def progress(self, message: str) -> None:
        """Print a message or a step of progress to stderr; on a terminal a share of long work is a bar."""
        if not self.quiet:
            text = escape_control(message, kept="\n\t")
            self._display.show(ShareText(text, message.share) if isinstance(message, ShareText) else text)

    def end_progress(self) -> None:
        """Remove the bar of a terminal."""
        self._display.clear()

    def result(self, data: Mapping[str, Any], text: str) -> None:
        """Print the result of the command to stdout: `data` as one JSON object, else `text` for people.

        On a terminal, lines of the text that are too long for it are broken between words. A file or another program
        gets them whole.
        """
        self._display.clear()
        if self.as_json:
            self.write(json.dumps(data, indent=2, allow_nan=False))
        elif text:
            self.write(fit_width(text, shutil.get_terminal_size().columns) if sys.stdout.isatty() else text)

    def write(self, text: str) -> None:
        """Write a line of the result, or all of it, to stdout and flush it.

        Raises
        ------
        OutputError
            If stdout cannot be written, for example on a full disk.
        BrokenPipeError
            If the reader has closed the pipe, which is not an error of the output.
        """
        try:
            print(escape_control(text, kept="\n\t"), flush=True)
        except BrokenPipeError:
            raise
        except OSError as error:
            _discard_stdout()
            reason = error.strerror or str(error)
            raise OutputError(
                Issue("standard output", f"cannot be written ({reason}); redirect it elsewhere.")
            ) from error

    def print_issues(self, error: FingertipError, partial_result: Mapping[str, Any] | None = None) -> None:
        """Print the issues of an error to stderr, one per line.

        With --json also print them to stdout as one object, together with the result found before the error.
        """
        self._display.clear()
        for issue in error.issues[:_MAX_PRINTED]:
            print(f"error: {issue}", file=sys.stderr)
        if len(error.issues) > _MAX_PRINTED:
            print(f"error: and {len(error.issues) - _MAX_PRINTED} more; correct these first", file=sys.stderr)
        if self.as_json:
            issues = [{"field": issue.field, "message": issue.message} for issue in error.issues]
            with contextlib.suppress(OutputError):  # they are on stderr in any case
                self.write(json.dumps({**(partial_result or {}), "issues": issues}, indent=2))


MIN_WIDTH = 40
"""Smallest width to which lines are broken."""
_LAST_COLUMN = re.compile(r"^(.*\S {2,})\S")


def fit_width(text: str, width: int) -> str:
    """Break the lines of a text that are longer than a width between words.

    The rest of a table's row stands below its last column if that leaves room for words, else two columns further in.
    """
    lines = []
    for line in text.split("\n"):
        if len(line) <= width or width < MIN_WIDTH:
            lines.append(line)
            continue
        begin = _LAST_COLUMN.match(line[: width // 2])
        start = len(begin[1]) if begin else len(line) - len(line.lstrip()) + 2
        lines += textwrap.wrap(
            line,
            width,
            subsequent_indent=" " * start,
            break_long_words=False,
            break_on_hyphens=False,
            drop_whitespace=True,
            replace_whitespace=False,
        )
    return "\n".join(lines)


def _discard_stdout() -> None:
    """Redirect stdout to the null device: its buffer would fail again, with a traceback, when the process ends."""
    with contextlib.suppress(OSError, ValueError):
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, sys.stdout.fileno())
        os.close(null)


def _end_interrupted(error: BaseException) -> NoReturn:
    ProgressDisplay().clear()
    raise typer.Exit(interruption.report(error)) from None


def command(function: Callable[P, None]) -> Callable[P, None]:
    """Decorate a command: print the issues of an error and exit with `BAD_INPUT`, or at an interruption with its code.

    What no command expects ends with `FAULT`: never with the exit code of a failed check, as a traceback would.
    """

    # The help page would keep the line breaks of the source within a paragraph.
    paragraphs = inspect.cleandoc(function.__doc__ or "").split("\n\n")
    function.__doc__ = "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            function(*args, **kwargs)
        except FingertipError as error:
            if interruption.find_signal(error) is not None:
                _end_interrupted(error)
            Console(bool(kwargs.get("as_json")), False).print_issues(error)
            raise typer.Exit(BAD_INPUT) from None
        except interruption.INTERRUPTIONS as error:
            _end_interrupted(error)
        except BrokenPipeError:
            _discard_stdout()
            raise typer.Exit(PIPE_CLOSED) from None
        except (typer.Exit, typer.Abort, typer.BadParameter):
            raise
        except Exception as error:
            if interruption.find_signal(error) is not None:
                _end_interrupted(error)
            refusal = describe_path_error(error) if isinstance(error, OSError) else None
            Console(bool(kwargs.get("as_json")), False).print_issues(refusal or describe_fault(error))
            raise typer.Exit(BAD_INPUT if refusal else FAULT) from None

    return run
