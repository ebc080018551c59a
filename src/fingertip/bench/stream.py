"""Samples of a controller as they arrive, from a serial port, a pseudo terminal, a pipe or standard input.

A thread reads the port without pause, so that work on earlier samples loses none. The lines are those of the library's
sketches, which `fingertip detect -` reads too; a line that is damaged counts as a lost sample.
"""

from __future__ import annotations

import os
import queue
import stat
import termios
import threading
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from fingertip.detection.live import open_stream
from fingertip.foundation.errors import Issue, TraceError
from fingertip.slip.traces.columns import parse_number, split_cells
from fingertip.slip.traces.trace import ColumnMap

MOVING = "moving"
"""Column of the contact that opens with the motion (`MOTION_PIN` of the sketch): 1 while the slide moves."""
SILENT_S, STALE_S = 5.0, 1.0
"""Time without a byte after which a port counts as silent, and in which what waited ahead of a port has arrived [s]."""
_VERSION = "# fingertip "
"""Beginning of the line in which a sketch states its version."""
_BLOCK = 65_536


@dataclass(frozen=True, slots=True)
class Sample:
    time_s: float
    voltage_v: float
    filtered_v: float | None
    moving: bool | None
    """Whether the slide moves; None without a contact."""


def open_port(port: str) -> int:
    """Open a port for reading, a terminal without echo or translation. Raises TraceError."""
    try:
        number = os.open(port, os.O_RDONLY | os.O_NOCTTY)
    except OSError as error:
        ports = sorted(str(path) for kind in ("ttyACM*", "ttyUSB*") for path in Path("/dev").glob(kind))
        remedy = f"give one of {', '.join(ports)}" if ports else "plug the controller in, and name its port"
        reason = f"{error.strerror}; for a right that is missing: sudo usermod -aG dialout $USER, and log in again"
        message = f"cannot be opened ({reason if isinstance(error, PermissionError) else error.strerror}); {remedy}."
        raise TraceError(Issue(port, message)) from None
    if stat.S_ISDIR(os.fstat(number).st_mode):
        os.close(number)
        raise TraceError(Issue(port, "is a folder; give the port of a controller, such as /dev/ttyACM0."))
    if os.isatty(number):
        settings = termios.tcgetattr(number)
        settings[0], settings[1], settings[3] = 0, 0, 0  # no translation, no echo, no lines
        settings[2] = termios.CS8 | termios.CREAD | termios.CLOCAL
        settings[4] = settings[5] = getattr(termios, "B2000000", termios.B115200)  # a native USB port ignores it
        settings[6][termios.VMIN], settings[6][termios.VTIME] = 1, 0
        termios.tcsetattr(number, termios.TCSANOW, settings)
    return number


def read_lines(number: int, name: str, silent_s: float = SILENT_S, stale_s: float = 0.0) -> Iterator[bytes]:
    """Read lines of an open port until it ends, without those of the first `stale_s` [s].

    Raises TraceError if it stays silent.
    """
    blocks: queue.SimpleQueue[bytes] = queue.SimpleQueue()

    def read() -> None:
        block = b"."
        while block:
            try:
                block = os.read(number, _BLOCK)
            except OSError:  # the other end of a pseudo terminal was closed, or the controller unplugged
                block = b""
            blocks.put(block)

    threading.Thread(target=read, daemon=True).start()
    rest, begin_s = b"", time.monotonic() + stale_s
    while True:
        try:
            block = blocks.get(timeout=silent_s)
        except queue.Empty:
            remedy = "upload a sketch that streams, such as slip_lamp.ino with STREAM = true"
            raise TraceError(Issue(name, f"sends nothing for {silent_s:g} s; {remedy}.")) from None
        if not block:
            return
        if time.monotonic() < begin_s:
            continue
        *lines, rest = (rest + block).split(b"\n")
        yield from filter(None, lines)
        rest = rest[-_BLOCK:]


class SampleReader:
    """Samples of lines, and what the controller says of itself. Iterate once. Raises TraceError."""

    def __init__(self, lines: Iterable[str | bytes]) -> None:
        self.firmware = ""
        """Version that the sketch states; empty until it does."""
        self._lines = lines

    def __iter__(self) -> Iterator[Sample]:
        header, rows = open_stream(self._note_version(), ColumnMap())
        names = list(header.names)
        places = [names.index("time_s"), names.index("voltage_v")]
        optional = [names.index(name) if name in names else None for name in ("filtered_v", MOVING)]
        for _, line in rows:
            cells = split_cells(line, header.delimiter)
            values = [parse_number(cells[place]) if len(cells) == len(names) else None for place in places]
            more = [None if at is None or len(cells) != len(names) else parse_number(cells[at]) for at in optional]
            if values[0] is None or values[1] is None:  # the header again, a comment, or a damaged line
                continue
            yield Sample(values[0], values[1], more[0], None if more[1] is None else more[1] > 0.0)

    def _note_version(self) -> Iterator[str]:
        for line in self._lines:
            text = line.decode("utf-8", "replace") if isinstance(line, bytes) else line
            if text.startswith(_VERSION):
                self.firmware = text.removeprefix(_VERSION).strip()[:40]
            elif not text.startswith("#"):
                yield text
