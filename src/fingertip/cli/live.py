"""`fingertip detect -`: detection on lines from standard input; each transition is printed when it occurs."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.cli.console import BAD_INPUT, Console
from fingertip.interruption import INTERRUPTIONS, exit_code

if TYPE_CHECKING:
    from fingertip.design import Design


def detect_standard_input(
    console: Console,
    design: Design,
    detector: str,
    rate_hz: float | None,
    scale: float,
    time_scale: float,
    columns: Mapping[str, str],
    keep_window: bool,
    plot: Path | None,
    calibrate: str | None,
) -> None:
    """Detect slip in standard input until it ends, is wrong or is interrupted; report the transitions up to then."""
    from fingertip.detect_trace import detect_stream
    from fingertip.errors import FingertipError, Issue, TraceError
    from fingertip.slip.live import NAME

    if not sys.stdin or sys.stdin.closed:
        raise TraceError(Issue("-", "standard input is closed; pipe lines into it."))
    if unavailable := [name for name, value in (("--plot", plot), ("--calibrate", calibrate)) if value is not None]:
        message = "requires the whole recording; save the lines in a file first."
        raise TraceError([Issue(name, message) for name in unavailable])
    transitions: list[dict[str, Any]] = []
    data: dict[str, Any] = {"detector": detector, "transitions": transitions}
    any_on = False
    try:
        found = detect_stream(
            sys.stdin,
            design,
            detector,
            rate_hz=rate_hz,
            scale=scale,
            time_scale=time_scale,
            columns=columns,
            keep_window=keep_window,
            progress=console.progress,
        )
        data["signals"] = list(found.signals.columns)
        console.progress(f"detector {detector}, {found.signals.describe()}")
        for warning in found.warnings:
            console.progress(f"warning: {warning}")
        for transition in found.transitions:
            any_on = True
            if console.as_json:
                transitions.append({"on": transition.on, "time_s": round(transition.time_s, 7)})
            else:
                console.write(f"{'ON ' if transition.on else 'OFF'}  {transition.time_s:9.4f} s")
    except FingertipError as error:
        console.print_issues(error, data)
        raise typer.Exit(BAD_INPUT) from None
    except UnicodeDecodeError:
        message = "is not UTF-8 text; save it in a file, which may be UTF-16."
        console.print_issues(TraceError(Issue(NAME, message)), data)
        raise typer.Exit(BAD_INPUT) from None
    except INTERRUPTIONS as error:
        console.result(data, "" if any_on else "never ON")
        raise typer.Exit(exit_code(error)) from None
    console.result(data, "" if any_on else "never ON")
