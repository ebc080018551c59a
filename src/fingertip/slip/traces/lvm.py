"""LabVIEW's measurement files (LVM): the names of their columns, their times, and headers between their segments.

Reference: National Instruments, "Specification for the LabVIEW Measurement File (.lvm)". A file has a header, and each
segment another one; both end with `***End_of_Header***`. The names of the columns follow: `X_Value`, the channels, and
`Comment`. Where the file has no column of times (`X_Columns No`), `Delta_X` is the step between samples.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from fingertip.foundation.errors import Issue, TraceError
from fingertip.slip.traces.columns import DELIMITERS, is_number
from fingertip.slip.traces.trace import ColumnMap

MAX_LINES = 200
"""Number of lines in which the headers of a file end."""
TITLE = "LabVIEW Measurement"
_END = "***End_of_Header***"
_SEGMENT_KEYS = (
    "Channels", "Samples", "Date", "Time", "Y_Unit_Label", "X_Dimension", "X0", "Delta_X", "Notes", "Test_Name",
    "Test_Numbers", "Test_Series", "UUT_M/N", "UUT_Name", "UUT_S/N", "Y_Dimension", _END,
)  # fmt: skip
"""First cells of the lines in the header of a segment."""
_TIMES, _COMMENT = "X_Value", "Comment"


@dataclass
class PassedOver:
    """Lines that hold no sample: how many, and the number of the first one."""

    count: int = 0
    first: int = 0

    def append(self, number: int) -> None:
        """Add a line by its number."""
        self.count += 1
        self.first = self.first or number


def adapt_columns(name: str, lines: Iterable[str], columns: ColumnMap) -> ColumnMap:
    """Fill in the names of an LVM file's columns where `columns` has none; other files leave `columns` as it is.

    Raises TraceError.
    """
    rows = iter(lines)
    if not next(rows, "").lstrip("\ufeff").startswith(TITLE):
        return columns
    settings: dict[str, list[str]] = {}
    names: list[str] = []
    for line in rows:
        cells = _split(line)
        if cells[0] == _TIMES:
            names = [cell for cell in cells if cell]
            break
        settings[cells[0]] = cells[1:]
    if not names:
        return columns  # a program has written columns of its own below the header
    added: dict[str, str] = {}
    if "voltage_v" not in columns.names and "voltage_v" not in names:
        channels = [each for each in names if each not in (_TIMES, _COMMENT)]
        if len(channels) != 1:
            options = " or ".join(f"--column voltage_v={each!r}" for each in channels[:4])
            raise TraceError(Issue(name, f"holds {len(channels)} channels; choose one with {options}."))
        added["voltage_v"] = channels[0]
    rate_hz = columns.rate_hz
    if "time_s" not in columns.names:
        added["time_s"] = _TIMES
        if settings.get("X_Columns", [""])[0] == "No":
            added["time_s"] = "no times"
            rate_hz = rate_hz or _read_rate(name, settings.get("Delta_X", []))
    return replace(columns, names={**columns.names, **added}, rate_hz=rate_hz)


def without_headers(rows: Iterable[tuple[int, str]], passed_over: PassedOver) -> Iterator[tuple[int, str]]:
    """Yield numbered lines but those of the headers of segments, whose first line is added to `passed_over`."""
    within = False
    for number, line in rows:
        if line[:1].isalpha() or line.startswith(_END):
            first = _split(line)[0]
            if first in _SEGMENT_KEYS:
                if not within:
                    passed_over.append(number)
                within = first != _END
                continue
        yield number, line


def _read_rate(name: str, steps: Sequence[str]) -> float:
    """Return the sampling rate that the step between samples gives [Hz]."""
    step = steps[0].replace(",", ".") if steps else ""
    step_s = float(step) if is_number(step) else 0.0
    if not 0.0 < step_s < float("inf"):
        raise TraceError(Issue(name, f"has no times, and states the step {step!r} between samples; give --rate-hz."))
    return float(f"{1 / step_s:.9g}")


def _split(line: str) -> list[str]:
    """Split a line at its tabs, or at another delimiter if it has none."""
    delimiter = next((each for each in ("\t", *DELIMITERS) if each in line), "\t")
    return [cell.strip() for cell in line.split(delimiter)]
