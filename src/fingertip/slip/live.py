"""Detection on lines as they come: one sample taken, one decision made, nothing kept."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from fingertip.errors import Fault, TraceError
from fingertip.slip.detectors.stream import Detector
from fingertip.slip.traces.parsed import Wanted
from fingertip.slip.traces.trace import STEP_TOLERANCE
from fingertip.slip.traces.trace_file import split_header

NAME = "standard input"


@dataclass(frozen=True)
class Change:
    """From OFF to ON, or back."""

    on: bool
    time_s: float


def follow(lines: Iterable[str], detector: Detector, rate_hz: float, wanted: Wanted) -> Iterator[Change]:
    """Take a header and then one sample for each line, and tell every change when it is there.

    Parameters
    ----------
    lines
        CSV, as in a file.
    detector
        Takes the samples.
    rate_hz
        The rate it is made for.
    wanted
        Names of the columns; the one for the voltage is what the detector takes.

    Raises
    ------
    TraceError
        At the first line that is wrong: detection cannot go on across a gap.
    """
    numbered = iter(enumerate(lines, start=1))
    number, header = next(numbered, (1, ""))
    header = header.lstrip("\ufeff")
    if not header.strip():
        raise TraceError(Fault(NAME, "is empty; its first line must name time_s,voltage_v."))
    names, delimiter = split_header(NAME, header, wanted)
    voltage_at = names.index(wanted.of("voltage_v"))
    time_at = names.index(wanted.of("time_s")) if wanted.of("time_s") in names else -1
    usual, on, before = 1 / rate_hz, False, -math.inf
    for number, line in numbered:
        cells = line.rstrip("\r\n").split(delimiter)
        if len(cells) != len(names):
            raise _fault(number, f"has {len(cells)} cells, the header {len(names)}; one cell per column.")
        volts = _number(cells[voltage_at], delimiter, number) * wanted.scale
        time = _number(cells[time_at], delimiter, number) if time_at >= 0 else (number - 2) * usual
        step = time - before
        if before > -math.inf and abs(step - usual) > STEP_TOLERANCE * usual:
            raise _fault(
                number,
                f"{time:.9g} s comes {step:.4g} s after the sample before it; the detector is made for steps of "
                f"{usual:.4g} s ({rate_hz:g} Hz): use --rate-hz, or close the gap.",
            )
        before = time
        if detector.step(volts) != on:
            on = not on
            yield Change(on, time)


def _number(cell: str, delimiter: str, line: int) -> float:
    try:
        value = float(cell if delimiter == "," else cell.replace(",", "."))
    except ValueError:
        raise _fault(line, f"{cell.strip()!r} is not a number; write it with a decimal point.") from None
    if not math.isfinite(value):
        raise _fault(line, f"{value} is not a finite number; detection cannot go on across it.")
    return value


def _fault(line: int, sentence: str) -> TraceError:
    return TraceError(Fault(f"{NAME}, line {line}", sentence))
