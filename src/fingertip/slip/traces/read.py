"""Reading of traces from CSV files and files of arrays, by first bytes and suffix."""

from __future__ import annotations

import contextlib
import re
import struct
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.catalogues.file_kinds import DESIGN, MANIPULATION, SCENE, identify_kind
from fingertip.design import Design
from fingertip.foundation.errors import Issue, TomlFileError, TraceError, gather, raise_issues
from fingertip.foundation.numerics import Array
from fingertip.slip.traces.array_files import KINDS, RATE, load_arrays
from fingertip.slip.traces.column_survey import Content, Survey, examine, join_seconds
from fingertip.slip.traces.csv_file import read_csv
from fingertip.slip.traces.sampling import check_rate, restore_even_times
from fingertip.slip.traces.trace import BOARD_COLUMNS, ColumnMap, RawTrace, Trace, check_trace_file

# Kinds of files, known by their first bytes: how each is read, or the sentence that says how to
# convert it.

_HDF5 = (
    "is an HDF5 file, as MATLAB saves with -v7.3; in MATLAB save it with -v7, or in Python with "
    "numpy.savez(file, "
    "time_s=..., voltage_v=...)."
)
_WORKBOOK = "is a workbook of a spreadsheet; save its sheet as CSV."
_COMPRESSED = "is compressed; unpack it first, and give the trace inside."
_PICKLE = "is a pickle, which may run programs when it is read; save numbers with numpy.savez."

_SIGNATURES = {
    "npy": (b"\x93NUMPY",),
    "tdms": (b"TDSm",),
    "mat": (b"MATLAB 5.0 MAT-file",),
    "parquet": (b"PAR1",),
    _HDF5: (b"MATLAB 7.3 MAT-file", b"\x89HDF\r\n\x1a\n"),
    _WORKBOOK: (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",),
    "bag": (b"#ROSBAG V", b"SQLite format 3\0", b"\x89MCAP"),
    _COMPRESSED: (
        b"\x1f\x8b",
        b"BZh",
        b"\xfd7zXZ\0",
        b"7z\xbc\xaf\x27\x1c",
        b"Rar!",
        b"\x28\xb5\x2f\xfd",
    ),
    _PICKLE: (b"\x80\x03", b"\x80\x04", b"\x80\x05"),
    "is an Arrow or Feather file; save it as Parquet or CSV.": (b"ARROW1",),
    "is a PDF; export the recording as CSV.": (b"%PDF",),
    "is a picture; export the recording as CSV.": (b"\x89PNG",),
}
"""Kind of file, or how to convert it -> its first bytes, one of these."""
_ENDINGS = {
    ".xlsx": _WORKBOOK,
    ".xls": _WORKBOOK,
    ".ods": _WORKBOOK,
    ".mcap": "bag",
    ".db3": "bag",
    ".h5": _HDF5,
    ".hdf5": _HDF5,
    ".pkl": _PICKLE,
    ".pickle": _PICKLE,
    ".json": "is a JSON file; convert it to CSV with the columns time_s,voltage_v.",
}
"""Endings of names -> how to convert such a file, if its first bytes are unknown."""
_HEAD_BYTES = 64
_MOST_SURVEYED = 60
_SURVEYED_SAMPLES = 20_000
_MAX_TABLE = 64
"""Most arrays and samples that are surveyed, and most selectable columns of an array."""
_MIN_STATED_HZ = 1e-300
"""Rate below which the times of a recording overflow [Hz]."""


def identify(path: Path) -> str:
    """Return the kind of a file from `KINDS`, a sentence that says how to convert it, or "csv".

    Raises OSError.
    """
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)

    for kind, signatures in _SIGNATURES.items():
        if head.startswith(signatures):
            return kind

    if head.startswith(b"RIFF") and head[8:12] == b"WAVE":
        return "wav"
    if head.startswith(b"PK\x03\x04"):
        return _identify_zip(path)

    suffix = path.suffix.lower()
    if suffix.lstrip(".") in KINDS:
        return suffix.lstrip(".")

    return _ENDINGS.get(suffix, "csv")


def _identify_zip(path: Path) -> str:
    """Return the kind of a ZIP archive, by the names in it; of a damaged one, by its own name."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except (zipfile.BadZipFile, ValueError, NotImplementedError, struct.error):
        return _ENDINGS.get(path.suffix.lower(), "npz")

    if any(name.startswith("xl/") or name == "content.xml" for name in names):
        return _WORKBOOK

    if path.suffix.lower() == ".npz" or any(name.endswith(".npy") for name in names):
        return "npz"

    return _COMPRESSED


def read_trace(
    path: str | Path,
    design: Design | None = None,
    columns: Mapping[str, str] | None = None,
    rate_hz: float | None = None,
    scale: float = 1.0,
    time_scale: float = 1.0,
) -> Trace:
    """Read a recorded trace from any kind of file, and validate it for a detector.

    The parameters are those of `detect_file`; `rate_hz` replaces the rate of the design.

    Raises
    ------
    TraceError
        With all issues of the file and of its samples.
    MissingLibraryError
        If the file needs a package that is not installed.
    """
    raw = read_raw_trace(Path(path), ColumnMap(columns or {}, rate_hz, scale, time_scale))
    detector = (design or Design()).detector

    if rate_hz is not None:
        check_rate(rate_hz)
        detector = detector.model_copy(update={"sample_rate_hz": rate_hz})

    return raw.validate(detector)


def read_raw_trace(path: Path, columns: ColumnMap) -> RawTrace:
    """Read a trace of any kind of file without validation.

    Raises TraceError or MissingLibraryError.
    """
    check_trace_file(path)
    if path.suffix.lower() == ".toml":
        _refuse_known_toml(path)

    try:
        kind = identify(path)
        if kind == "csv":
            return _with_even_times(read_csv(path, columns), columns)
        if kind not in KINDS:
            raise TraceError(Issue(str(path), kind))

        arrays = _split_tables(load_arrays(kind, path, _list_names(columns)))
    except OSError as error:
        reason = error.strerror or str(error)
        raise TraceError(
            Issue(str(path), f"cannot be read ({reason}); give the path of a trace.")
        ) from None

    columns = columns.with_simulated_names(arrays)
    missing = [column for column in columns.required if columns.name_in_file(column) not in arrays]
    if RATE in arrays and "time_s" in missing:
        missing.remove("time_s")
    if arrays and missing:
        _raise_missing(
            path,
            kind=kind,
            arrays=arrays,
            columns=columns,
            missing=missing,
        )

    return _with_even_times(_from_arrays(str(path), arrays, columns), columns)


def _list_names(columns: ColumnMap) -> set[str]:
    """List the names of the arrays that a trace takes; `NAME/2` is a column of the array NAME."""
    names = {*map(columns.name_in_file, columns.looked_for)}
    tables = {name.rpartition("/")[0] for name in names if name.rpartition("/")[2].isdecimal()}
    return {*names, *tables, *(f"sampled_{column}" for column in BOARD_COLUMNS), RATE}


def _split_tables(arrays: Mapping[str, Any]) -> dict[str, Any]:
    """Add the columns of arrays of two dimensions as NAME/1, NAME/2."""
    split = dict(arrays)
    for name, array in arrays.items():
        if getattr(array, "ndim", 0) == 2 and 1 < min(array.shape) <= _MAX_TABLE:
            rows = array.T if array.shape[0] > array.shape[1] else array
            split |= {f"{name}/{number}": row for number, row in enumerate(rows, 1)}

    return split


def _raise_missing(
    path: Path,
    kind: str,
    arrays: Mapping[str, Any],
    columns: ColumnMap,
    missing: list[str],
) -> None:
    """Raise TraceError with proposals for the missing columns, by the content of all arrays."""
    loaded = dict(arrays)
    values = dict[str, Array]()
    contents = list[Content]()
    unread = [name for name, array in arrays.items() if array is None][:_MOST_SURVEYED]

    if unread:
        with contextlib.suppress(TraceError):  # of one that is too large
            loaded |= _split_tables(load_arrays(kind, path, unread))

    for name, array in loaded.items():
        flat = np.ravel(() if array is None else array)
        if (
            name != RATE
            and flat.dtype.kind in "bifuM"
            and flat.size == max(np.shape(array), default=1)
        ):
            seconds = _read_dates(flat)[0] if flat.dtype.kind == "M" else flat
            values[name] = seconds[:_SURVEYED_SAMPLES].astype(np.float64)
            contents.append(examine(name, values[name], re.split(r"[/.]", name)[-1]))

    if RATE in loaded and "voltage_v" in missing:
        missing = [column for column in missing if column != "time_s"]

    survey = Survey(tuple(join_seconds(contents, values)))
    raise TraceError([*survey.find_issues(str(path), "array", list(arrays), columns, missing)])


def _with_even_times(raw: RawTrace, columns: ColumnMap) -> RawTrace:
    """Replace times in single precision by evenly spaced ones, with a note."""
    if not raw.has_all_times:
        return raw

    scale = columns.time_scale
    even = restore_even_times(raw.trace.time_s if scale == 1.0 else raw.trace.time_s / scale)
    if even is None:
        return raw

    trace = replace(raw.trace, time_s=even * scale)
    note = f"{raw.name}, time_s: is in single precision; evenly spaced times are taken instead"
    return replace(raw, trace=trace, notes=(*raw.notes, note))


def _refuse_known_toml(path: Path) -> None:
    """Raise TraceError for a design, scene, manipulation or sweep file."""
    try:
        kind = identify_kind(path)
    except TomlFileError:
        return

    if kind is not None:
        remedy = "give a trace"
        if kind is DESIGN:
            remedy += " first, and the design after --design"
        elif kind in (SCENE, MANIPULATION):
            remedy = "make a trace of it with `fingertip simulate`"

        raise TraceError(Issue(str(path), f"is {kind.describe()}, not a trace; {remedy}."))


def _from_arrays(name: str, arrays: Mapping[str, Any], columns: ColumnMap) -> RawTrace:
    issues = list[Issue]()
    values = dict[str, Any]()
    notes = list[str]()
    if not arrays:
        raise TraceError(Issue(name, f"contains no arrays; save {' and '.join(columns.required)}."))

    if columns.rate_hz is None and columns.name_in_file("time_s") not in arrays and RATE in arrays:
        rate_hz = _read_rate(f"{name}, {RATE}", arrays[RATE], issues)
        columns = replace(columns, rate_hz=rate_hz)

    for column in columns.looked_for:
        name_in_file = columns.name_in_file(column)
        if name_in_file not in arrays:
            continue

        field = f"{name}, {name_in_file}"
        array = np.asarray(arrays[name_in_file])
        if column == "time_s" and array.dtype.kind in "Mm":
            # Years, and dates without a unit, are no numbers of seconds.
            with contextlib.suppress(TypeError, ValueError, OverflowError):
                array, note = _read_dates(array)
                notes.append(f"{field}: {note}")

            if columns.time_scale != 1.0:
                message = f"does not apply to the dates in {name}; leave it out."
                issues.append(Issue("--time-scale", message))

        values[column] = np.zeros(0)
        if array.dtype.kind not in "bifu" or array.ndim > 2:
            message = f"has the type {array.dtype}; give an array of numbers."
            issues.append(Issue(field, message))
        elif array.ndim == 0:
            issues.append(Issue(field, "is a single number; give one value per sample."))
        else:
            # MATLAB has no arrays of one dimension: a signal is a row or a column.
            is_line = array.ndim == 2 and 1 in array.shape
            values[column] = np.ascontiguousarray(array.ravel() if is_line else array, np.float64)

    raise_issues(TraceError, issues)
    with gather(issues, f"{name}, "):
        trace = columns.make_trace(values)

    raise_issues(TraceError, issues)
    return RawTrace(name, trace, in_volts=columns.in_volts, notes=tuple(notes))


def _read_rate(field: str, value: Any, issues: list[Issue]) -> float:
    """Read the sampling rate that a file states [Hz]; another value adds an issue."""
    array = np.asarray(value)
    rate_hz = 0.0
    with contextlib.suppress(TypeError, ValueError):  # another type, or several values
        rate_hz = float(array.item())

    if _MIN_STATED_HZ < rate_hz < float("inf"):
        return rate_hz

    if array.size == 1:
        content = repr(array.item())
    else:
        content = f"{array.size or 'no'} value{'s' * (array.size > 1)}"

    message = (
        f"contains {content}; save the rate in Hz as one number, such as 2000, or give --rate-hz."
    )
    issues.append(Issue(field, message))
    return 1.0  # so that the other arrays are still validated


def _read_dates(array: NDArray[Any]) -> tuple[NDArray[Any], str]:
    """Convert durations, or dates since the first one, to seconds, and describe what was done.

    Return a note on it too.
    """
    second = np.timedelta64(1, "s")
    if array.dtype.kind == "m":
        return array / second, "durations are read as seconds"

    flat = array.ravel()
    if not flat.size:
        return np.zeros(0), "holds no dates"

    return (flat - flat[0]) / second, f"dates are read as seconds since {flat[0]}"
