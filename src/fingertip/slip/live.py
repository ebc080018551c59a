"""Detection on lines as they come: one sample taken, one decision made, nothing kept."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from fingertip.design.sections import Detector as Settings
from fingertip.errors import Issue, TraceError
from fingertip.slip.detectors.stream import Detector
from fingertip.slip.traces.header import Header, find_header, unquoted
from fingertip.slip.traces.parsed import Wanted
from fingertip.slip.traces.trace import RATE_TOLERANCE, STEP_TOLERANCE, beyond_sentence, rate_sentence

NAME = "standard input"
_STRETCH = 100
"""Windows over which the mean rate is taken, before it begins anew."""


@dataclass(frozen=True)
class Change:
    """From OFF to ON, or back."""

    on: bool
    time_s: float


@dataclass(frozen=True)
class Opened:
    """Lines of which the header has been taken."""

    header: Header
    rows: Iterator[tuple[int, str]]
    """Numbers and lines below it, empty ones left out."""


def opened(lines: Iterable[str], wanted: Wanted, *others: Wanted) -> Opened:
    """Take the lines up to the header, and the units below it.

    Parameters
    ----------
    lines
        CSV, as in a file.
    wanted, others
        Names of the columns; any of them will do.

    Raises
    ------
    TraceError
        If there is no header.
    """
    left = iter(lines)
    header = find_header(NAME, left, wanted, *others)
    rows = ((n, line) for n, line in enumerate(left, start=header.line + 1) if line.strip())
    if (first := next(rows, None)) is None or header.has_units(first[1]):
        return Opened(header, rows)
    return Opened(header, itertools.chain([first], rows))


def follow(source: Opened, detector: Detector, settings: Settings, wanted: Wanted) -> Iterator[Change]:
    """Take one sample for each line, and tell every change when it is there.

    Parameters
    ----------
    source
        The lines.
    detector
        Takes the samples.
    settings
        The rate [Hz] it is made for, its window, and the converter's range [V].
    wanted
        Names of the columns; the one for the voltage is what the detector takes.

    Raises
    ------
    TraceError
        At the first line that is wrong: detection cannot go on across a gap, nor at another rate, nor on what is no
        voltage of this converter. And at the end, if there was no line at all.
    """
    names, delimiter = source.header.names, source.header.delimiter
    voltage_at = names.index(wanted.of("voltage_v"))
    time_at = names.index(wanted.of("time_s")) if wanted.of("time_s") in names else -1
    clock, on, whole, width, sample = _Clock(settings), False, True, 0, -1
    for sample, (number, line) in enumerate(source.rows):
        cells = line.rstrip("\r\n").split(delimiter)
        width = width or source.header.width(len(cells), wanted)
        if len(cells) != width:
            raise _issue(number, f"has {len(cells)} cells, the header {len(names)}; one cell per column.")
        volts = _number(cells[voltage_at], delimiter, number) * wanted.scale
        whole = whole and volts % 1 == 0
        if wanted.in_volts and abs(volts) > settings.adc_range_v:
            raise _issue(number, beyond_sentence(f"{volts:g}", whole, settings))
        time = sample / settings.sample_rate_hz
        if time_at >= 0:
            time = _number(cells[time_at], delimiter, number)
            clock.take(time, number)
        if detector.step(volts) != on:
            on = not on
            yield Change(on, time)
    if sample < 0:
        raise TraceError(Issue(NAME, "ends below its header; write at least one sample a line."))


class _Clock:
    """Holds the samples' times against the rate: each step, and the mean of many once a window is full."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._usual_s = 1 / settings.sample_rate_hz
        self._before_s = -math.inf
        self._since_s = 0.0
        self._steps = 0

    def take(self, time_s: float, line: int) -> None:
        """The time of the next sample [s]."""
        before_s, self._before_s = self._before_s, time_s
        if before_s == -math.inf:
            self._since_s = time_s
            return
        step_s = time_s - before_s
        if abs(step_s - self._usual_s) > STEP_TOLERANCE * self._usual_s:
            remedy = "use --rate-hz, or close the gap"
            if step_s == 0.0:
                remedy = "set times that are rounded aside with --column time_s=none and --rate-hz"
            raise _issue(
                line,
                f"{time_s:.9g} s comes {step_s:.4g} s after the sample before it; the detector is made for steps of "
                f"{self._usual_s:.4g} s ({self._settings.sample_rate_hz:g} Hz): {remedy}.",
            )
        self._steps += 1
        if self._steps % self._settings.window_samples == 0:
            self._judge(time_s, line)

    def _judge(self, time_s: float, line: int) -> None:
        rate_hz = self._steps / (time_s - self._since_s)
        # Stamps may stray as single steps may: of few steps that makes more of the mean.
        tolerance = RATE_TOLERANCE + STEP_TOLERANCE / self._steps
        if abs(rate_hz / self._settings.sample_rate_hz - 1) > tolerance:
            raise _issue(line, rate_sentence(rate_hz, self._settings))
        if self._steps >= _STRETCH * self._settings.window_samples:
            self._since_s, self._steps = time_s, 0


def _number(cell: str, delimiter: str, line: int) -> float:
    plain = unquoted(cell) if '"' in cell else cell
    try:
        value = float(plain if delimiter == "," else plain.replace(",", "."))
    except ValueError:
        raise _issue(line, f"{cell.strip()!r} is not a number; write it with a decimal point.") from None
    if not math.isfinite(value):
        raise _issue(line, f"{value} is not a finite number; detection cannot go on across it.")
    return value


def _issue(line: int, sentence: str) -> TraceError:
    return TraceError(Issue(f"{NAME}, line {line}", sentence))
