"""Progress on stderr: a bar on a terminal, else a line now and then for a log."""

from __future__ import annotations

import contextlib
import math
import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, ClassVar

from fingertip.progress import ShareText, format_duration

if TYPE_CHECKING:
    from fingertip.cli.console import Console
    from fingertip.sweep.run import RunState

LINE_INTERVAL_S = 10.0
"""Smallest time between two lines of a log that report shares [s]."""
MIN_ROWS_FOR_ESTIMATE = 10
"""Number of rows from which the remaining time is estimated."""
BAR_WIDTH = 20
CLEAR_LINE = "\r\x1b[2K"


class ProgressDisplay:
    """Messages on stderr. The share of long work is a bar in the last line of a terminal, and a few lines of a log."""

    has_bar: ClassVar[bool] = False
    """True while the terminal, of which there is one, shows a bar: whoever prints next removes it."""

    def __init__(self) -> None:
        self._is_terminal = sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self._last_s = -math.inf

    def show(self, message: str) -> None:
        """Show a message; one that carries a share replaces the one before it, or is left out of a log for a while."""
        if not isinstance(message, ShareText):
            self.clear()
            print(message, file=sys.stderr, flush=True)
        elif self._is_terminal:
            line = format_bar(message, shutil.get_terminal_size().columns)
            print(f"{CLEAR_LINE}{line}", end="", file=sys.stderr, flush=True)
            ProgressDisplay.has_bar = True
        elif time.monotonic() - self._last_s >= LINE_INTERVAL_S:
            self._last_s = time.monotonic()
            print(message, file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Remove the bar."""
        if ProgressDisplay.has_bar:
            print(CLEAR_LINE, end="", file=sys.stderr, flush=True)
            ProgressDisplay.has_bar = False


def format_bar(message: ShareText, columns: int) -> str:
    """Format a bar with its message, in one line of a terminal."""
    full = round(BAR_WIDTH * message.share)
    return f"[{'#' * full}{'.' * (BAR_WIDTH - full)}] {message}"[: columns - 1]


@contextlib.contextmanager
def sweep_progress(console: Console, size: int) -> Iterator[Callable[[RunState], None]]:
    """Provide a callback that shows the state of a sweep."""
    begun = time.monotonic()

    def show(state: RunState) -> None:
        # A short sweep leaves no line in a log.
        if sys.stderr.isatty() or time.monotonic() - begun >= LINE_INTERVAL_S:
            console.progress(ShareText(format_state(state), state.done / size))

    yield show
    console.end_progress()


def format_state(state: RunState) -> str:
    """Format points done, speed, remaining time and numbers of refused and failed points."""
    parts = [f"{state.done} of {state.size} points", f"{state.points_per_s:.3g} points/s"]
    if state.written >= MIN_ROWS_FOR_ESTIMATE and state.remaining_s < math.inf:
        parts.append(f"{format_duration(state.remaining_s)} left")
    parts += [f"{state.refused} refused", f"{state.failures} failed"]
    if state.silent_s >= state.hang_s:
        parts.append(
            f"no worker has answered for {format_duration(state.silent_s)}: one may hang; Ctrl-C keeps the rows, and "
            "--resume continues"
        )
    return ", ".join(parts)
