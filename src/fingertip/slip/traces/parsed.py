"""What reading a file gave, before a detector's rate is known: a trace, and what was wrong with the file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fingertip.design.sections import Detector
from fingertip.errors import Issue, TraceError
from fingertip.slip.traces.rounded import rounded
from fingertip.slip.traces.trace import Trace, column_issues, length_issues, range_issues, time_issues

COLUMNS = ("time_s", "voltage_v", "force_n", "slip", "envelope_v")
_FORCE = re.compile(r".*(_n|[\[(]N[\])]|force)$|force", re.IGNORECASE)


def is_force(name: str) -> bool:
    """Whether a column's name says that it holds a force: `force_n`, `Load [N]`, `Force`."""
    return _FORCE.match(name) is not None


@dataclass(frozen=True)
class Wanted:
    """What to look for in a file.

    Raises
    ------
    TraceError
        If a column is renamed that no trace has.
    """

    names: Mapping[str, str] = field(default_factory=dict)
    """A trace's column -> the file's name for it; without an entry they are the same."""
    rate_hz: float | None = None
    """For a file without times; times that are there are kept, and judged."""
    scale: float = 1.0
    """Volts for each unit of the file's voltage."""

    def __post_init__(self) -> None:
        issues = [
            Issue("--column", f"{name!r} is no column of a trace; known here: {', '.join(COLUMNS)}.")
            for name in self.names
            if name not in COLUMNS
        ]
        if self.rate_hz is not None and not 0.0 < self.rate_hz < float("inf"):
            issues.append(Issue("--rate-hz", f"{self.rate_hz:g} Hz is no sampling rate; 1000 to 20000 Hz."))
        if not (np.isfinite(self.scale) and self.scale != 0.0):
            issues.append(Issue("--scale", f"{self.scale:g} scales nothing; give volts for each unit of the file."))
        if issues:
            raise TraceError(issues)

    def of(self, column: str) -> str:
        """The file's name for a trace's column."""
        return self.names.get(column, column)

    @property
    def needed(self) -> tuple[str, ...]:
        """Columns without which there is no trace."""
        return ("voltage_v",) if self.rate_hz is not None else ("time_s", "voltage_v")

    @property
    def in_volts(self) -> bool:
        """Whether the signal is a voltage: a force column may stand in for it."""
        return not is_force(self.of("voltage_v"))

    def trace(self, columns: Mapping[str, NDArray[np.float64]]) -> Trace:
        """A trace of columns that were read under a trace's names."""
        voltage = columns["voltage_v"]
        time = columns.get("time_s")
        if time is None:
            assert self.rate_hz is not None
            time = np.arange(len(voltage)) / self.rate_hz
        slip = columns.get("slip")
        volts = voltage if self.scale == 1.0 else voltage * self.scale
        flags = None if slip is None else slip == 1.0
        return Trace(time, volts, columns.get("force_n"), flags, columns.get("envelope_v"))


@dataclass(frozen=True, eq=False)
class Parsed:
    """A file that was read."""

    name: str
    trace: Trace
    issues: tuple[Issue, ...] = ()
    """Of the file's form."""
    first_line: int | None = None
    """Line that holds the first sample, where the file has lines."""
    timed: bool = True
    """Whether the times were all read, and can be judged."""
    in_volts: bool = True

    @property
    def rate_hz(self) -> float | None:
        """The usual rate [Hz], to six digits as it was meant; None if there is none to be told, as from times that were
        rounded until they repeat."""
        time = self.trace.time_s
        if not self.timed or time.ndim != 1 or len(time) < 2 or not np.isfinite(time).all() or rounded(time):
            return None
        usual = float(np.median(np.diff(time)))
        return float(f"{1 / usual:.6g}") if usual > 0.0 else None

    def checked(self, detector: Detector) -> Trace:
        """The trace, once nothing is wrong with it for a detector's rate, window and converter.

        Raises
        ------
        TraceError
            With one sentence for each issue of the file and of its samples.
        """
        found = list(self.issues)
        found.extend(length_issues(self.trace, detector, self.name))
        found.extend(column_issues(self.trace, self.name, self.first_line))
        if self.in_volts:
            found.extend(range_issues(self.trace, detector, self.name, self.first_line))
        time = self.trace.time_s
        if self.timed and time.ndim == 1 and len(time) > 1 and np.isfinite(time).all():
            found.extend(time_issues(time, detector, self.name, self.first_line))
        if found:
            raise TraceError(found)
        return self.trace
