"""Progress of a sweep on stderr: a progress bar on a terminal, else a line now and then for a log."""

from __future__ import annotations

import contextlib
import math
import sys
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from fingertip.cli.console import Console

if TYPE_CHECKING:
    from fingertip.sweep.run import RunState

LINE_INTERVAL_S = 10.0
MIN_ROWS_FOR_ESTIMATE = 10
"""Number of rows from which the remaining time is estimated."""


@contextlib.contextmanager
def sweep_progress(console: Console, size: int) -> Iterator[Callable[[RunState], None]]:
    """Provide a callback that shows the state of a sweep."""
    if console.quiet:
        yield lambda state: None
    elif sys.stderr.isatty():
        with _progress_bar(size) as show:
            yield show
    else:
        yield _log_lines(console)


def format_state(state: RunState) -> str:
    """Format points done, speed, remaining time and numbers of refused and failed points."""
    parts = [f"{state.done} of {state.size} points", f"{state.points_per_s:.3g} points/s"]
    if state.written >= MIN_ROWS_FOR_ESTIMATE and state.remaining_s < math.inf:
        parts.append(f"{_format_duration(state.remaining_s)} left")
    return ", ".join([*parts, f"{state.refused} refused", f"{state.failures} failed"])


def _log_lines(console: Console) -> Callable[[RunState], None]:
    last = time.perf_counter()

    def show(state: RunState) -> None:
        nonlocal last
        if time.perf_counter() - last >= LINE_INTERVAL_S:
            last = time.perf_counter()
            console.progress(format_state(state))

    return show


@contextlib.contextmanager
def _progress_bar(size: int) -> Iterator[Callable[[RunState], None]]:
    from rich.console import Console as Terminal
    from rich.progress import BarColumn, Progress, TextColumn

    columns = (BarColumn(), TextColumn("{task.percentage:3.0f} %"), TextColumn("{task.description}"))
    with Progress(*columns, console=Terminal(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=size)
        yield lambda state: bar.update(task, completed=state.done, description=format_state(state))


def _format_duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    if seconds < 100 * 60:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
