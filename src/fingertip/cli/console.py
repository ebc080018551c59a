"""Output of all commands: results on stdout; messages and errors on stderr; exit codes.

Exit codes: 0 for success, 1 for a failed check, 2 for bad input, 70 for a fault of the program, 130
after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP, 141 where the reader of the output has closed its
pipe.
"""

from __future__ import annotations

import contextlib
import errno
import json
import math
import os
import re
import shutil
import sys
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import typer

from fingertip import __version__
from fingertip.foundation.errors import (
    FingertipError,
    Issue,
    OutputError,
    escape_control,
    escape_message,
    shorten,
)
from fingertip.foundation.progress import ShareText, format_duration

if TYPE_CHECKING:
    from fingertip.design.fit import Move
    from fingertip.sweep.run import RunState


MIN_ROWS_FOR_ESTIMATE = 10
BAR_WIDTH = 20
CLEAR_LINE = "\r\x1b[2K"


def format_bar(message: ShareText, columns: int) -> str:
    full = round(BAR_WIDTH * message.share)
    return f"[{'#' * full}{'.' * (BAR_WIDTH - full)}] {escape_control(message)}"[: columns - 1]


def format_state(state: RunState) -> str:
    """Format points done, speed, remaining time and numbers of refused and failed points."""
    parts = [f"{state.done} of {state.size} points", f"{state.points_per_s:.3g} points/s"]
    if state.written >= MIN_ROWS_FOR_ESTIMATE and state.remaining_s < math.inf:
        parts.append(f"{format_duration(state.remaining_s)} left")

    parts += [f"{state.refused} refused", f"{state.failures} failed"]
    if state.silent_s >= state.hang_s:
        parts.append(
            f"no worker has answered for {format_duration(state.silent_s)}: one may hang; Ctrl-C "
            "keeps the rows, and "
            "--resume continues"
        )

    return ", ".join(parts)


# Last resort of the command line: an exception that no command expected becomes one sentence and a
# file of details.
#
# A traceback would end the process with the exit code of a failed check. The code here is that of
# an internal fault.

FAULT = 70
"""Exit code of a fault of the program (`EX_SOFTWARE` of sysexits.h)."""
_MAX_REASON = 200
_MACHINE_ERRORS = frozenset({errno.EMFILE, errno.ENFILE, errno.ENOMEM})
"""Errors that blame the machine, whatever path they meet."""
_FULL_DISK = frozenset(
    getattr(errno, name) for name in ("ENOSPC", "EDQUOT", "EFBIG") if hasattr(errno, name)
)
"""Errors of a disk, which name no file when they meet one that is open."""
_REPORT = "report it, with that file, by the form for bugs of the project's issue tracker"


def describe_fault(error: BaseException) -> FingertipError:
    """Describe an unexpected exception, and write its details to a temporary file."""
    reason = type(error).__name__
    text = " ".join(str(error).split())
    if text:
        reason = f"{reason}: {shorten(text, _MAX_REASON)}"

    details = _write_details(error)
    where = f"details are in {details}" if details else "no file of details could be written"
    if isinstance(error, MemoryError):
        message = (
            f"the memory did not suffice ({reason}); close other programs, or give smaller "
            f"input; {where}."
        )
    elif isinstance(error, OSError) and error.errno in (errno.EMFILE, errno.ENFILE):
        message = (
            f"no more files may be opened ({reason}); raise the limit, as with `ulimit -n "
            f"256`; {where}."
        )
    else:
        message = (
            f"stopped at a fault of its own, not at one of your input ({reason}); {where}; "
            f"{_REPORT}."
        )

    return FingertipError(Issue("fingertip", message))


def describe_path_error(error: BaseException) -> FingertipError | None:
    """Describe an operating system's error about a path; None for others."""
    if not isinstance(error, OSError):
        return None
    has_no_path = isinstance(error, FileNotFoundError) and error.filename is None
    if has_no_path and _is_working_folder_gone():
        return FingertipError(
            Issue("working folder", "has been removed; change to a folder that exists.")
        )

    reason = error.strerror or type(error).__name__
    if error.errno in _FULL_DISK:
        message = f"cannot be written ({reason}); free some space there, and in TMPDIR."
        return FingertipError(Issue(str(error.filename or "disk"), message))

    if error.filename is None or error.errno in _MACHINE_ERRORS:
        return None

    path = str(error.filename)
    if isinstance(error.filename, str | bytes):
        path = os.fsdecode(error.filename)

    return FingertipError(
        Issue(path, f"cannot be used ({reason}); give another path, or change its mode.")
    )


def _is_working_folder_gone() -> bool:
    try:
        os.getcwd()
    except OSError:
        return True

    return False


def _write_details(error: BaseException) -> str | None:
    """Write command, versions and traceback to a new file; return its path, or None."""
    try:
        import platform
        import tempfile
        import traceback

        lines = [
            f"fingertip {__version__}, Python {platform.python_version()}, {platform.system()} "
            f"{platform.machine()}",
            f"command: {shorten(repr(sys.argv[1:]), 4000)}",
            shorten("".join(traceback.format_exception(error)), 100_000),
        ]
        handle, path = tempfile.mkstemp(prefix="fingertip-fault-", suffix=".txt")
        with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
            file.write("\n".join(lines))
    except Exception:  # no memory, no file handle, no such folder: the sentence alone must do
        return None

    return path


CHECK_FAILED = 1
BAD_INPUT = 2
_MAX_PRINTED = 200


class Console:
    """Output of one run of a command."""

    has_bar: ClassVar[bool] = False
    """True while the terminal shows a bar, which the next message removes."""

    def __init__(self, as_json: bool = False, quiet: bool = False, fits: bool = False) -> None:
        self.as_json = as_json
        self.quiet = quiet
        self.fits = fits
        self.warnings: list[str] = []
        self._moves: list[dict[str, Any]] = []
        self._tables: list[str] = []
        self._is_terminal = sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self._printed: set[str] = set()

    def progress(self, message: str) -> None:
        """Print a note to stderr once; on a terminal, draw a bar for the share of long work."""
        if message.startswith("warning: "):
            self.warnings.append(message.removeprefix("warning: "))
        if self.quiet:
            return

        if not isinstance(message, ShareText):
            message = escape_message(message)
            if message not in self._printed:
                self.clear()
                print(message, file=sys.stderr, flush=True)

            self._printed.add(message)
        elif self._is_terminal:
            line = format_bar(message, shutil.get_terminal_size().columns)
            print(f"{CLEAR_LINE}{line}", end="", file=sys.stderr, flush=True)
            Console.has_bar = True

    def clear(self) -> None:
        if Console.has_bar:
            print(CLEAR_LINE, end="", file=sys.stderr, flush=True)
            Console.has_bar = False

    def show_moves(self, design: str, moves: Sequence[Move]) -> None:
        """Print what a fit has moved, or with --quiet add it to the result."""
        from fingertip.design.parameters import find_kind

        keys = ("parameter", "kind", "was", "is", "why")
        # Of what is measured, guesses alone move.
        kinds = (find_kind(move.name).replace("measurement", "guess") for move in moves)
        rows = [
            (move.name, kind, move.before, move.after, move.reason)
            for move, kind in zip(moves, kinds, strict=True)
        ]
        self._moves += ({"design": design, **dict(zip(keys, row, strict=True))} for row in rows)
        verdict = "passes as it is, nothing was moved"
        lines = []
        if rows:
            verdict = f"{len(rows)} value{'s' * (len(rows) > 1)} moved"
            lines = align_columns([[*map(str, row)] for row in (keys, *rows)])

        table = "\n".join([f"{design}, fit: {verdict}", *lines])
        self._tables.append(table)

        if not self.quiet:
            self.clear()
            width = shutil.get_terminal_size().columns if self._is_terminal else 0
            text = escape_control(fit_width(table, width), spared="\n")
            print(text, file=sys.stderr, flush=True)

    def warn(self, warnings: Iterable[str]) -> None:
        for warning in warnings:
            self.progress(f"warning: {warning}")

    def result(self, data: Mapping[str, Any], text: str, passed: bool = True) -> None:
        """Print the result to stdout: `data` as one JSON object, or `text` for people.

        After a fit, the object holds what moved. So does the text with --quiet, unless it is a file
        of the design. On a terminal, lines of the text that are too long for it are broken between
        words. A file or another program gets them whole. A result that has not `passed` ends the
        command with `CHECK_FAILED`.
        """
        self.clear()
        if self.fits:
            data = {**data, "fitted": self._moves}
        if self.quiet and "toml" not in data:
            text = "\n".join([*self._tables, text])

        if self.as_json:
            self.write(json.dumps(data, indent=2, allow_nan=False))
        elif text:
            if sys.stdout.isatty():
                text = fit_width(text, shutil.get_terminal_size().columns)

            self.write(text)

        if not passed:
            raise typer.Exit(CHECK_FAILED)

    def show(self, text: str) -> None:
        """Print what is known before the whole result is; nothing with --json."""
        if not self.as_json:
            self.clear()
            self.write(text)

    def write(self, text: str) -> None:
        """Write text of the result to stdout. Raises OutputError or BrokenPipeError."""
        try:
            print(escape_control(text, spared="\n\t"), flush=True)
        except BrokenPipeError:
            raise
        except OSError as error:
            discard_stdout()
            message = f"cannot be written ({error.strerror or error}); redirect it elsewhere."
            raise OutputError(Issue("standard output", message)) from error

    def print_issues(
        self, error: FingertipError, partial_result: Mapping[str, Any] | None = None
    ) -> None:
        """Print the issues of an error to stderr; with --json to stdout too."""
        self.clear()
        for issue in error.issues[:_MAX_PRINTED]:
            print(f"error: {issue.typed}", file=sys.stderr)

        if len(error.issues) > _MAX_PRINTED:
            print(
                f"error: and {len(error.issues) - _MAX_PRINTED} more; correct these first",
                file=sys.stderr,
            )

        if self.as_json:
            issues = [{"field": issue.field, "message": issue.message} for issue in error.issues]
            with contextlib.suppress(OutputError):  # they are on stderr in any case
                self.write(json.dumps({"issues": issues, **(partial_result or {})}, indent=2))


def align_columns(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]


MIN_WIDTH = 40
"""Smallest width to which lines are broken."""
_LAST_COLUMN = re.compile(r"^(.*\S {2,})\S")


def fit_width(text: str, width: int) -> str:
    """Break long lines between words; the rest of a table's row stands below its last column."""
    lines = []
    for line in text.split("\n"):
        if len(line) <= width or width < MIN_WIDTH:
            lines.append(line)
            continue

        begin = _LAST_COLUMN.match(line[: width // 2])
        start = " " * (len(begin[1]) if begin else len(line) - len(line.lstrip()) + 2)
        lines += textwrap.wrap(
            line, width, subsequent_indent=start, break_long_words=False, break_on_hyphens=False
        )

    return "\n".join(lines)


def discard_stdout() -> None:
    """Redirect stdout to the null device, so that flushing it at exit does not fail."""
    with contextlib.suppress(OSError, ValueError):
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, sys.stdout.fileno())
        os.close(null)
