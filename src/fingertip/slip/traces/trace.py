"""Traces, their validation and their size: tactile voltage, and force and slip if known."""

from __future__ import annotations

import errno
import functools
import itertools
import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np
from numpy.typing import NDArray

from fingertip.design.parameters.board_and_detector import Detector as DetectorParameters
from fingertip.foundation.display import html_table, to_dataframe
from fingertip.foundation.errors import (
    ArgumentError,
    InputFileError,
    Issue,
    TraceError,
    quote_value,
    raise_issues,
)
from fingertip.foundation.input_files import RECORDING_LIMIT, SAMPLES_LIMIT, check_regular
from fingertip.foundation.numerics import Array
from fingertip.slip.traces import sampling
from fingertip.slip.traces.sampling import (
    TIME_UNITS_S,
    find_rounding,
    rises_as_time,
    sample_location,
    time_issues,
)
from fingertip.slip.traces.truth import UNKNOWN, Origin

if TYPE_CHECKING:
    import pandas

COLUMNS = ("time_s", "voltage_v", "force_n", "slip", "envelope_v", "filtered_v")
NANOSEC = "nanosec"
"""Column of nanoseconds that is added to the times, where these are given as A+B."""
BOARD_COLUMNS = ("envelope_v", "filtered_v")
"""Columns from the board; a simulation names them sampled_envelope_v and sampled_filtered_v."""
_FORCE = re.compile(r".*(_n|[\[(]N[\])]|force)$|force", re.IGNORECASE)


def as_numbers(name: str, values: Any) -> Array:
    """Return values as an array, with NaN in the place of those that numpy masks.

    Raises TraceError.
    """
    try:
        array: Any = np.ma.asarray(values)
        # Numpy would convert complex numbers, texts, flags and dates.
        if array.dtype.kind not in "iufO":
            raise TypeError(f"its type is {array.dtype}")

        return np.asarray(array.astype(float, copy=False).filled(np.nan))
    except (TypeError, ValueError, OverflowError) as error:
        raise TraceError(
            Issue(name, f"is no array of numbers ({error}); give one per sample.")
        ) from None


@dataclass(frozen=True, eq=False)
class Trace:
    """Columns of equal length, arrays or lists. Raises TraceError."""

    time_s: Array
    voltage_v: Array
    """Raw tactile voltage [V]: bridge and instrumentation amplifier, before the filter board."""
    force_n: Array | None = None
    slip: NDArray[np.bool_] | None = None
    envelope_v: Array | None = None
    """Output of the filter board [V], which the detector `analog` takes."""
    filtered_v: Array | None = None
    """Filtered signal of a controller's board, ahead of its rectifier [V], for `fast`."""
    origin: Origin = UNKNOWN

    def __post_init__(self) -> None:
        for name in COLUMNS:
            values = getattr(self, name)
            if values is None and name not in COLUMNS[:2]:
                continue

            array = np.asarray(values, dtype=bool) if name == "slip" else as_numbers(name, values)
            object.__setattr__(self, name, array)
            if array.ndim == 1 and len(self.time_s) == 0 < array.size:
                raise TraceError(Issue("time_s", "has 0 samples; give the time of each."))

            if array.ndim != 1 or len(array) != len(self.time_s):
                times = "" if name == "time_s" else f", but time_s has shape {self.time_s.shape}"
                raise TraceError(
                    Issue(name, f"has shape {array.shape}{times}; give one value per sample.")
                )

    def __repr__(self) -> str:
        count = len(self.time_s)
        if count < 2:
            return f"Trace({count} samples)"

        duration_s = float(self.time_s[-1] - self.time_s[0])
        optional = [name for name in COLUMNS[2:] if getattr(self, name) is not None]
        rate_hz = (count - 1) / duration_s if duration_s > 0.0 else float("nan")
        facts = [f"{count} samples", f"{duration_s:.4g} s at {rate_hz:.6g} Hz", *optional]
        return f"Trace({', '.join(facts)})"

    def _repr_html_(self) -> str:
        """Table of the columns with their ranges, for Jupyter."""
        rows = [
            (name, f"{np.min(values):.6g}", f"{np.max(values):.6g}")
            for name, values in self._columns()
            if len(values)
        ]
        return html_table(repr(self), ("column", "smallest", "largest"), rows)

    def to_dataframe(self) -> pandas.DataFrame:
        """Return the columns as a data frame. Raises MissingLibraryError."""
        return to_dataframe(dict(self._columns()), "Trace.to_dataframe")

    def _columns(self) -> Iterator[tuple[str, NDArray[Any]]]:
        for name in COLUMNS:
            values = getattr(self, name)
            if values is not None:
                yield name, values


def is_force(name: str) -> bool:
    """Return whether a column's name indicates a force: `force_n`, `Load [N]`, `Force`."""
    return _FORCE.match(name) is not None


@dataclass(frozen=True)
class ColumnMap:
    """Names of a trace's columns in a file, and how to convert the file's values.

    Raises TraceError.
    """

    names: Mapping[str, str] = field(default_factory=dict)
    """Name in the file for each column of a trace; without an entry the names are the same."""
    rate_hz: float | None = None
    """Sampling rate of a file without times [Hz]; times in the file are kept and validated."""
    scale: float = 1.0
    """Volts per unit of the file's voltages."""
    time_scale: float = 1.0
    """Seconds per unit of the file's times."""

    def __post_init__(self) -> None:
        issues = [
            Issue(
                "--column",
                f"{name!r} is not a column of a trace; choose one of {', '.join(COLUMNS)}.",
            )
            for name in self.names
            if name not in (*COLUMNS, NANOSEC)
        ]
        if self.rate_hz is not None and not 0.0 < self.rate_hz < float("inf"):
            issues.append(
                Issue(
                    "--rate-hz",
                    f"{self.rate_hz:g} Hz is not a sampling rate; choose 1000 to 20000 Hz.",
                )
            )

        if not (np.isfinite(self.scale) and self.scale != 0.0):
            message = f"{self.scale:g} is not a scale; give volts per unit of the file's voltage."
            issues.append(Issue("--scale", message))

        if not 0.0 < self.time_scale < float("inf"):
            message = (
                f"{self.time_scale:g} is not a unit of time; give its length in seconds, or one of "
            )
            issues.append(Issue("--time-scale", f"{message}{', '.join(TIME_UNITS_S)}."))

        raise_issues(TraceError, issues)
        seconds, plus, nanosec = self.names.get("time_s", "").partition("+")
        if seconds and plus and nanosec:
            object.__setattr__(self, "names", {**self.names, "time_s": seconds, NANOSEC: nanosec})

    def name_in_file(self, column: str) -> str:
        return self.names.get(column, column)

    @property
    def looked_for(self) -> tuple[str, ...]:
        return (*COLUMNS, NANOSEC) if NANOSEC in self.names else COLUMNS

    def with_simulated_names(self, names: Collection[str]) -> ColumnMap:
        """Map the board's columns to a simulation's names, if a file has only those."""
        simulated = {
            column: f"sampled_{column}"
            for column in BOARD_COLUMNS
            if self.name_in_file(column) not in names and f"sampled_{column}" in names
        }
        return replace(self, names={**self.names, **simulated}) if simulated else self

    @property
    def required(self) -> tuple[str, ...]:
        """Columns that every trace must have, and those of the board that are named."""
        times = ("time_s",) if self.rate_hz is None else ()
        extra = (column for column in (NANOSEC, *BOARD_COLUMNS) if column in self.names)
        return (*times, "voltage_v", *extra)

    @property
    def in_volts(self) -> bool:
        """True if the signal is a voltage: the column of a force may replace it."""
        return not is_force(self.name_in_file("voltage_v"))

    @np.errstate(over="ignore")  # a value that overflows is infinite, and refused by its name
    def make_trace(self, columns: Mapping[str, Array]) -> Trace:
        """Make a trace of the file's columns, given by a trace's names."""
        time = columns.get("time_s")
        slip = columns.get("slip")

        if time is None:
            assert self.rate_hz is not None
            time = np.arange(len(columns["voltage_v"])) / self.rate_hz
        else:
            if NANOSEC in columns:
                time = time + 1e-9 * columns[NANOSEC]

            time = time if self.time_scale == 1.0 else time * self.time_scale

        volts: dict[str, Any] = {
            name: columns[name] for name in ("voltage_v", *BOARD_COLUMNS) if name in columns
        }
        if self.scale != 1.0:
            volts = {name: values * self.scale for name, values in volts.items()}

        flags = None if slip is None else slip == 1.0
        return Trace(time, force_n=columns.get("force_n"), slip=flags, **volts)


@dataclass(frozen=True, eq=False)
class RawTrace:
    """Content of a trace file before validation for a detector."""

    name: str
    trace: Trace
    issues: tuple[Issue, ...] = ()
    lines: Sequence[int] | None = None
    """Line that contains each sample, in a file of lines."""
    has_all_times: bool = True
    """True if every sample's time was read, so that the times can be validated."""
    in_volts: bool = True
    notes: tuple[str, ...] = ()
    """Sentences on what was passed over, or read in another way than it stands in the file."""
    is_array: bool = False
    """True if it is an array of a program, which no options convert."""

    @property
    def rate_hz(self) -> float | None:
        """Sampling rate by the median time step, to six digits [Hz]; None if undetermined."""
        if not self._times_are_valid or find_rounding(self.trace.time_s):
            return None

        usual = self._usual_step
        return float(f"{1 / usual:.6g}") if usual > 0.0 else None

    @functools.cached_property
    def _usual_step(self) -> float:
        """Median step of the times."""
        return float(np.median(np.diff(self.trace.time_s), overwrite_input=True))

    def validate(self, detector: DetectorParameters) -> Trace:
        """Return the trace if it is valid for a detector's sampling rate, window and ADC.

        Raises TraceError.
        """
        raise_issues(TraceError, self.find_issues(detector))
        return self.trace

    def find_issues(self, detector: DetectorParameters) -> list[Issue]:
        issues = [*self.issues, *self._value_issues(detector)]
        if self._times_are_valid:
            issues.extend(
                time_issues(
                    self.trace.time_s,
                    self._usual_step,
                    detector=detector,
                    name=self.name,
                    lines=self.lines,
                    is_array=self.is_array,
                )
            )

        return issues

    def _value_issues(self, detector: DetectorParameters) -> Iterator[Issue]:
        count = len(self.trace.time_s)
        minimum = max(2, detector.window_samples)
        if count < minimum:
            yield Issue(self.name, sampling.length_message(count, minimum))

        for column, values in self.trace._columns():
            wrong = np.flatnonzero(~np.isfinite(values))
            if wrong.size:
                first = int(wrong[0])
                where = (
                    f"{sample_location(first, self.lines)} is not a finite "
                    f"number{sampling.count_others(wrong.size)}"
                )
                message = f"{values[first]} {where}; record again or remove it."
                yield Issue(f"{self.name}, {column}", message)

        volts = self.trace.voltage_v
        if count >= minimum and np.isfinite(volts).all() and rises_as_time(volts):
            step = (volts[-1] - volts[0]) / (count - 1)
            message = (
                f"rises by {step:.4g} per sample: it is a time or a counter; name the "
                "column of the voltage."
            )
            yield Issue(f"{self.name}, voltage_v", message)
            return

        if not self.in_volts:
            return

        outside = np.flatnonzero(
            np.isfinite(volts) & ((volts > detector.adc_range_v) | (volts < detector.adc_low_v))
        )
        if outside.size:
            first = int(outside[0])
            all_whole = bool(np.all(volts[np.isfinite(volts)] % 1 == 0))
            where = sample_location(first, self.lines)
            message = sampling.range_message(
                float(volts[first]),
                where=f" {where}",
                whole=all_whole,
                detector=detector,
                is_array=self.is_array,
            )
            yield Issue(f"{self.name}, voltage_v", message)

    @property
    def _times_are_valid(self) -> bool:
        time_s = self.trace.time_s
        return self.has_all_times and len(time_s) > 1 and bool(np.isfinite(time_s).all())


# Limits on the size of a recording.

MAX_LINE = 2**20
"""Maximum length of a line of text [characters]. Ten thousand columns need a third of it."""
_CELLS_PER_SAMPLE = 4
"""Largest ratio of numbers in a table, with unused columns, to samples."""
_REMEDY = "cut the recording into parts"


def max_table_bytes() -> int:
    """Return the maximum size of all numbers of a table [bytes]."""
    return 8 * _CELLS_PER_SAMPLE * SAMPLES_LIMIT.value


def check_trace_file(path: Path) -> None:
    """Check that a trace is a regular file of at most the largest size. Raises TraceError."""
    try:
        check_regular(path, RECORDING_LIMIT, "a trace")
    except InputFileError as error:
        pipe = re.compile(r"(is a pipe.*)\.$")
        messages = (
            pipe.sub(r"\1, or - for lines from standard input.", issue.message)
            for issue in error.issues
        )
        raise TraceError(
            Issue(str(path), message.replace("make it smaller", _REMEDY)) for message in messages
        ) from None


def max_lines() -> int:
    """Return the maximum number of lines of a file, those without a sample included."""
    return 2 * SAMPLES_LIMIT.value + 10_000


def bounded_blocks(file: TextIO, name: str, most: int) -> Iterator[str]:
    """Yield a text file in blocks of whole lines, none of which is longer than `MAX_LINE`.

    Raises TraceError if a line is, and where there are more than `most` lines.
    """
    count = 0
    while block := file.read(MAX_LINE):
        block += file.readline(MAX_LINE)
        last = block.rfind("\n", 0, -1) + 1  # no other line is longer than what was read at first
        if len(block) - last > MAX_LINE:
            raise _too_long(name, count + block.count("\n", 0, last) + 1)

        yield block if count else block.lstrip("\ufeff")
        count += block.count("\n")
        if count > most:
            raise _too_many_lines(name, most)


def bounded_lines(
    lines: Iterable[str | bytes], name: str, most: int | None = None
) -> Iterator[str]:
    """Yield lines of a text file or stream, none of which is longer than `MAX_LINE`.

    Raises TraceError.

    Bytes, as of a serial port, are UTF-8. An empty read is the end, and so is that of a port that
    is unplugged.
    """
    lines = _read_port(lines) if hasattr(lines, "in_waiting") else lines
    readline = getattr(lines, "readline", None)
    rest = iter(() if hasattr(lines, "readline") else lines)

    for number in itertools.count(1):
        try:
            line: str | bytes = readline(MAX_LINE + 1) if readline else next(rest, "")
        except OSError as error:
            if error.errno not in (errno.EIO, None):  # pyserial states none
                raise

            return

        if line in ("", b""):
            return

        line = line.decode("utf-8", "replace") if isinstance(line, bytes) else line
        if not isinstance(line, str):
            message = f"is {quote_value(line)}, no text; give lines of CSV, or arrays to `detect`."
            raise ArgumentError(Issue(f"{name}, line {number}", message))

        if len(line) > MAX_LINE:
            raise _too_long(name, number)

        if most is not None and number > most:
            raise _too_many_lines(name, most)

        yield line.lstrip("\ufeff") if number == 1 else line


def _too_long(name: str, number: int) -> TraceError:
    message = (
        f"is longer than {MAX_LINE} characters; a trace has one sample per line, so break the "
        "lines."
    )
    return TraceError(Issue(f"{name}, line {number}", message))


def _too_many_lines(name: str, most: int) -> TraceError:
    message = f"has more than {most} lines; {_REMEDY}, or raise {SAMPLES_LIMIT.variable}."
    return TraceError(Issue(name, message))


_ARRIVAL_BYTES = 2**16
"""Largest part of a stream that is taken at once [bytes]."""


def arriving_blocks(lines: Iterable[str | bytes], name: str) -> Iterator[str]:
    """Yield the lines of a stream in blocks of whole lines, as soon as they arrive.

    Standard input and other buffers of bytes give blocks; lines that come one by one are a block
    each. Raises TraceError as `bounded_lines`.
    """
    read = getattr(lines, "read1", None)
    if read is None:
        yield from bounded_lines(lines, name)
        return

    count = 0
    rest = b""
    while arrived := _read_arrived(read):
        rest += arrived
        if (rest.find(b"\n") + 1 or len(rest)) > MAX_LINE:
            raise _too_long(name, count + 1)

        end = rest.rfind(b"\n") + 1
        if end:
            block = rest[:end].decode("utf-8", "replace")
            yield block if count else block.lstrip("\ufeff")
            count += block.count("\n")
            rest = rest[end:]

    if rest:
        block = rest.decode("utf-8", "replace")
        yield block if count else block.lstrip("\ufeff")


def _read_arrived(read: Callable[[int], bytes]) -> bytes:
    """Read what has arrived; the end of a port that is unplugged is the end of the stream."""
    try:
        return read(_ARRIVAL_BYTES)
    except OSError as error:
        if error.errno not in (errno.EIO, None):
            raise

        return b""


def _read_port(port: Any) -> Iterator[bytes]:
    """Yield lines of a `serial.Serial`, whose `readline` asks the system for each byte."""
    rest = b""
    for block in iter(lambda: port.read(port.in_waiting or 1), b""):
        *lines, rest = (rest + block)[-MAX_LINE:].split(b"\n")
        yield from (line + b"\n" for line in lines)


def shape_message(shape: Sequence[int], item_bytes: int = 8, other_bytes: int = 0) -> str | None:
    """Describe an array that is too large by its shape, beside others [bytes]; else None."""
    count = math.prod(shape)
    maximum = SAMPLES_LIMIT.value
    fits = (
        all(0 <= length <= maximum for length in shape)
        and 0 <= count <= _CELLS_PER_SAMPLE * maximum
    )
    # As many numbers as all columns of a trace hold, and those of the board by their other names.
    most = min(
        RECORDING_LIMIT.value, 8 * (len(COLUMNS) + len(BOARD_COLUMNS)) * maximum - other_bytes
    )
    if fits and count * item_bytes <= most:
        return None

    values = f"{count + other_bytes / 8:.3g}" if abs(count) < 10**300 else "too many"
    remedy = f"{_REMEDY}, record again, or raise {SAMPLES_LIMIT.variable}"
    return f"claims to hold {values} values; at most {maximum} samples are read; {remedy}."
