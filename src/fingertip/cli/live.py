"""`fingertip detect -`: lines from standard input, each change printed when it is found."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.cli.console import BAD_INPUT, INTERRUPTED, Console

if TYPE_CHECKING:
    from fingertip.design import Design
    from fingertip.slip.detectors.detector import Detector
    from fingertip.slip.live import Opened
    from fingertip.slip.traces.parsed import Wanted


def live(
    console: Console, design: Design, detector: str, wanted: Wanted, plot: Path | None, quiet_s: float | None
) -> None:
    """Follow standard input until it ends, is wrong, or is interrupted; what was found till then is told."""
    from fingertip.errors import FingertipError, Issue, TraceError
    from fingertip.slip.live import NAME, follow, opened
    from fingertip.slip.traces.parsed import Wanted

    if not wanted.in_volts and detector == "analog":
        raise TraceError(
            Issue("--column", "names a force; line by line analog takes volts only: save the lines first.")
        )
    if not sys.stdin or sys.stdin.closed:
        raise TraceError(Issue("-", "standard input is closed; pipe lines into it."))
    if refused := [name for name, value in (("--plot", plot), ("--quiet-s", quiet_s)) if value is not None]:
        raise TraceError([Issue(name, "needs the whole trace; save the lines in a file first.") for name in refused])
    changes: list[dict[str, Any]] = []
    data: dict[str, Any] = {"detector": detector, "changes": changes}
    try:
        envelope = Wanted({**wanted.names, "voltage_v": wanted.of("envelope_v")}, wanted.rate_hz)
        source = opened(sys.stdin, wanted, *([envelope] if detector == "analog" else []))
        made, column = _detector(console, design, detector, source, wanted, envelope)
        for change in follow(source, made, design.detector, column):
            if console.as_json:
                changes.append({"on": change.on, "time_s": round(change.time_s, 7)})
            else:
                console.write(f"{'ON ' if change.on else 'OFF'}  {change.time_s:9.4f} s")
    except FingertipError as error:
        console.issues(error, data)
        raise typer.Exit(BAD_INPUT) from None
    except UnicodeDecodeError:
        console.issues(TraceError(Issue(NAME, "is no UTF-8 text; save it in a file, which may be UTF-16.")), data)
        raise typer.Exit(BAD_INPUT) from None
    except KeyboardInterrupt:
        console.result(data, "")
        raise typer.Exit(INTERRUPTED) from None
    console.result(data, "")


def _detector(
    console: Console, design: Design, detector: str, source: Opened, wanted: Wanted, envelope: Wanted
) -> tuple[Detector, Wanted]:
    """The detector, and the column it takes: analog takes the board's output where the lines hold it."""
    from fingertip.slip import make_detector
    from fingertip.slip.detectors import registry
    from fingertip.slip.live import NAME

    if registry.find_detector_type(detector).reads != "envelope_v":
        return make_detector(detector, design), wanted
    if envelope.of("voltage_v") in source.header.names:
        return make_detector(detector, design), envelope
    from fingertip.sim.electronics.board_detector import BoardDetector

    console.progress(f"{NAME} holds no column {wanted.of('envelope_v')}: simulating the design's board")
    return BoardDetector(design), wanted
