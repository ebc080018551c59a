"""A sweep's progress on stderr: a bar where a person looks on, a line now and then where a log does."""

from __future__ import annotations

import contextlib
import math
import sys
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from fingertip.cli.console import Console

if TYPE_CHECKING:
    from fingertip.sweep.run import State

LINE_EVERY_S = 10.0
FEW = 10
"""Before so many rows nobody knows how long the rest takes."""


@contextlib.contextmanager
def progress(console: Console, size: int) -> Iterator[Callable[[State], None]]:
    """A function to be told of a sweep's state."""
    if console.quiet:
        yield lambda state: None
    elif sys.stderr.isatty():
        with _bar(size) as told:
            yield told
    else:
        yield _lines(console)


def as_text(state: State) -> str:
    """How far, how fast, how long still, and what went wrong."""
    parts = [f"{state.done} of {state.size} points", f"{state.points_per_s:.3g} points/s"]
    if state.written >= FEW and state.left_s < math.inf:
        parts.append(f"{_duration(state.left_s)} left")
    return ", ".join([*parts, f"{state.refused} refused", f"{state.failures} failed"])


def _lines(console: Console) -> Callable[[State], None]:
    last = time.perf_counter()

    def told(state: State) -> None:
        nonlocal last
        if time.perf_counter() - last >= LINE_EVERY_S:
            last = time.perf_counter()
            console.progress(as_text(state))

    return told


@contextlib.contextmanager
def _bar(size: int) -> Iterator[Callable[[State], None]]:
    from rich.console import Console as Terminal
    from rich.progress import BarColumn, Progress, TextColumn

    columns = (BarColumn(), TextColumn("{task.percentage:3.0f} %"), TextColumn("{task.description}"))
    with Progress(*columns, console=Terminal(stderr=True), transient=True) as shown:
        task = shown.add_task("starting", total=size)
        yield lambda state: shown.update(task, completed=state.done, description=as_text(state))


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    if seconds < 100 * 60:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
