"""Driver of a built finger: lines of its controller come in, readings of force and slip go out.
>>> from fingertip.drivers import Finger
>>> with Finger(["time_s,voltage_v", "0.0000,0.5", "0.0005,0.5"]) as finger:
...     finger.read().slip.name
'NONE'
"""

from __future__ import annotations

import os
import queue
import select
import termios
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, replace
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.detection.recordings import find_force_scale
from fingertip.detection.stream_lines import open_stream
from fingertip.foundation.errors import Issue, TraceError, checked
from fingertip.slip.detectors.fast import FastDetector
from fingertip.slip.detectors.fast_settings import GAP_S
from fingertip.slip.force import MEAN_S, Force
from fingertip.slip.traces.cells import parse_number, split_cells
from fingertip.slip.traces.trace import ColumnMap

SILENT_S = 5.0
STALE_S = 1.0
"""Time without a byte after which a port is silent, and for which older data may arrive [s]."""
_COLUMNS = ("time_s", "voltage_v", "filtered_v", "moving")
"""Columns of a stream, the last two optional; `moving`: the contact of `MOTION_PIN` is open."""
_VERSION = "# fingertip "
_BLOCK = 65_536
_MOST_BLOCKS = 2**17
"""Start of a sketch's version line, bytes read at once, and most blocks that wait."""
_POLL_S = 0.1
_FIRST = 20
_RATE_TOLERANCE = 0.02
"""Time in which a closed port is noticed [s]; first steps that show a rate; its tolerance."""


class Port:
    """Lines of a port that a thread reads without pause, after a terminal's first `stale_s` [s].

    Raises TraceError.
    """

    def __init__(self, port: Any, silent_s: float = SILENT_S, stale_s: float = STALE_S) -> None:
        """Open a port by name, or a `serial.Serial`, whose `readline` is too slow for 2 kHz."""
        is_open = hasattr(port, "fileno")
        self._silent_s = silent_s
        self.name = str(port.name if is_open else port)
        self._number = os.dup(port.fileno()) if is_open else _open(self.name)
        self._begin_s = time.monotonic() + stale_s * os.isatty(self._number)
        self._blocks = queue.SimpleQueue[bytes]()
        self._lines = list[bytes]()
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    @property
    def waiting(self) -> int:
        """Lines and blocks of lines that wait."""
        return len(self._lines) + self._blocks.qsize()

    def __iter__(self) -> Iterator[bytes]:
        rest = b""
        while True:
            try:
                block = self._blocks.get(timeout=self._silent_s)
            except queue.Empty:
                remedy = "upload a sketch that streams, such as slip_lamp.ino with STREAM = true"
                raise TraceError(
                    Issue(self.name, f"sends nothing for {self._silent_s:g} s; {remedy}.")
                ) from None

            if not block:
                return

            if time.monotonic() >= self._begin_s:
                *lines, rest = (rest + block).split(b"\n")
                self._lines = [line for line in reversed(lines) if line]
                rest = rest[-_BLOCK:]
                while self._lines:
                    yield self._lines.pop()

    def close(self) -> None:
        self._closed.set()
        self._thread.join()

    def _read(self) -> None:
        block = b"."
        # The other end of a pseudo terminal may be closed, or the controller unplugged.
        with suppress(OSError):
            while block and not self._closed.is_set():
                if select.select([self._number], [], [], _POLL_S)[0]:
                    block = os.read(self._number, _BLOCK)
                    self._blocks.put(block)

                # The oldest blocks that nobody takes are lost, and counted.
                if self._blocks.qsize() > _MOST_BLOCKS:
                    self._blocks.get()

        os.close(self._number)
        self._blocks.put(b"")


def _open(port: str) -> int:
    """Open a port for reading, a terminal without echo or translation. Raises TraceError."""
    if Path(port).is_dir():
        raise TraceError(
            Issue(port, "is a folder; give the port of a controller, such as /dev/ttyACM0.")
        )

    try:
        number = os.open(port, os.O_RDONLY | os.O_NOCTTY)
    except OSError as error:
        remedy = "plug the controller in, and name its port"
        if isinstance(error, PermissionError):
            remedy = "type sudo usermod -aG dialout $USER, and log in again"

        raise TraceError(Issue(port, f"cannot be opened ({error.strerror}); {remedy}.")) from None

    if os.isatty(number):
        speed = getattr(termios, "B2000000", termios.B115200)  # a native USB port ignores it
        characters = termios.tcgetattr(number)[6]
        characters[termios.VMIN] = 1
        characters[termios.VTIME] = 0
        mode = termios.CS8 | termios.CREAD | termios.CLOCAL
        termios.tcsetattr(number, termios.TCSANOW, [0, 0, mode, 0, speed, speed, characters])

    return number


class SampleReader:
    """Samples (`_COLUMNS`; NaN for one that is not there) of lines, and the version that the sketch
    states, to be iterated once. Raises TraceError.
    """

    def __init__(self, lines: Iterable[str | bytes]) -> None:
        self.firmware = ""
        self._lines = lines

    def __iter__(self) -> Iterator[tuple[float, ...]]:
        header, numbered_lines = open_stream(
            self._note_version(), ColumnMap(), name=str(getattr(self._lines, "name", "stream"))
        )
        names = list(header.names)
        for line in numbered_lines:
            cells = split_cells(line.text, header.delimiter)
            if len(cells) != len(names):
                continue

            values = [
                parse_number(cells[names.index(name)]) if name in names else None
                for name in _COLUMNS
            ]
            # A repeated header and a damaged line hold no numbers there.
            if all(value is not None and abs(value) < np.inf for value in values[:2]):
                yield tuple(np.nan if value is None else value for value in values)

    def _note_version(self) -> Iterator[str]:
        for line in self._lines:
            text = line.decode("utf-8", "replace") if isinstance(line, bytes) else line
            if text.startswith(_VERSION):
                self.firmware = text.removeprefix(_VERSION).strip()[:40]
            elif "force_n:" in text:
                remedy = "set STREAM = true in slip_lamp.ino, and upload it again"
                raise TraceError(Issue("stream", f"is made for the Serial Plotter; {remedy}."))
            elif not text.startswith("#"):
                yield text


class Slip(IntEnum):
    """State of a contact, in order of certainty.

    A divider takes knocks for incipient slip, and is never INCIPIENT.
    """

    NONE = 0
    INCIPIENT = 1
    ON = 2


@dataclass(frozen=True)
class Reading:
    """State of a finger at a time of its controller.

    The force, off the mean of 20 ms, is NaN where no curve is known; `lost` samples have not
    arrived, from the first on.
    """

    time_s: float
    voltage_v: float
    force_n: float
    force_interval_n: tuple[float, float]
    slip: Slip
    lost: int


@checked
class Finger(AbstractContextManager["Finger"]):
    """A built finger whose controller streams its samples.

    `port` is a name, such as /dev/ttyACM0, or a `serial.Serial`, or gives lines, as a file or a
    list does. `design` is the one whose firmware streams, or its name. A thread reads the port:
    samples wait until they are read, the first for a second. Read a finger from one thread. Raises
    TraceError.
    """

    def __init__(
        self, port: str | Path | Iterable[str | bytes], design: Design | str = "first_finger"
    ) -> None:
        self.design = design if isinstance(design, Design) else Design.load(design)
        is_port = isinstance(port, str | Path) or hasattr(port, "in_waiting")
        self._lines: Any = Port(port) if is_port else port
        self._name = str(getattr(self._lines, "name", "stream"))
        self._readings = self._judge()

    def close(self, *of_an_error: object) -> None:
        if isinstance(self._lines, Port):
            self._lines.close()

    __exit__ = close

    def __iter__(self) -> Iterator[Reading]:
        return self._readings

    def read(self) -> Reading:
        """Wait for a sample, and return the newest, with the surest slip since the last call.

        Raises TraceError.
        """
        # A computer that is too slow would read samples for ever.
        slip = Slip.NONE
        end_s = time.monotonic() + SILENT_S

        for reading in self._readings:
            slip = max(slip, reading.slip)
            if not getattr(self._lines, "waiting", 0) or time.monotonic() > end_s:
                return replace(reading, slip=slip)

        raise TraceError(
            Issue(self._name, "has ended; plug the controller in, and make another Finger.")
        )

    def _judge(self) -> Iterator[Reading]:
        rate_hz = self.design.detector.sample_rate_hz
        has_filter = self.design.board.has_filter
        detector = FastDetector.for_design(self.design)
        scale = find_force_scale(self.design)
        most = round(GAP_S * rate_hz) + 1
        share = 1 / max(1.0, MEAN_S * rate_hz)
        lost = 0
        odd = 0
        mean_v = 0.0
        last_s = 0.0

        for number, (time_s, volts, filtered_v, _) in enumerate(SampleReader(self._lines)):
            steps = (time_s - last_s) * rate_hz if number else 1.0
            odd += abs(steps - 1) > _RATE_TOLERANCE
            if number == _FIRST and odd > number / 2 and steps > 0:
                remedy = (
                    f'give the design as design.replace({{"detector.sample_rate_hz": '
                    f"{rate_hz / steps:.4g}}})"
                )
                message = (
                    f"sends {rate_hz / steps:.4g} samples a second, not {rate_hz:g}; {remedy}."
                )
                raise TraceError(Issue(self._name, message))

            if not np.isnan(filtered_v) and not has_filter:
                message = (
                    f"sends filtered_v, and {self.design.name} has no filter board; name "
                    "the finger's design."
                )
                raise TraceError(Issue(self._name, message))

            # A lost sample is no number to the detector, as in the firmware; a reset of the
            # controller is a long gap.
            missing = round(steps) - 1
            for _ in range(most if missing < 0 else min(missing, most)):
                detector.step(np.nan)

            is_on = detector.step(volts, None if np.isnan(filtered_v) else filtered_v)
            is_incipient = has_filter and detector.is_incipient
            mean_v = mean_v + share * (volts - mean_v) if number else volts
            force = scale.read(mean_v) if scale else Force(np.nan, 0.0, np.inf)
            slip = Slip(2 * is_on or is_incipient)
            lost = lost + max(missing, 0)
            last_s = time_s
            yield Reading(
                time_s=time_s,
                voltage_v=volts,
                force_n=force.force_n,
                force_interval_n=(force.low_n, force.high_n),
                slip=slip,
                lost=lost,
            )
