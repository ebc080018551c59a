"""Reading of traces from CSV, NumPy and TDMS files, selected by the file name's suffix."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip import extras
from fingertip.design import Design
from fingertip.design.issues import suggest_name
from fingertip.errors import Issue, TomlFileError, TraceError
from fingertip.slip.traces.csv_file import read_csv
from fingertip.slip.traces.guess_columns import suggest_options
from fingertip.slip.traces.trace import COLUMNS, ColumnMap, RawTrace, Trace
from fingertip.toml_files import DESIGN, MANIPULATION, SCENE, identify_kind

RATE = "sample_rate_hz"
"""Name of a number in an archive that replaces its times."""


def read_trace(
    path: str | Path,
    design: Design | None = None,
    columns: Mapping[str, str] | None = None,
    rate_hz: float | None = None,
    scale: float = 1.0,
) -> Trace:
    """Read a recorded trace from a .csv, .npz, .npy or .tdms file, and validate it for a design's detector.

    Parameters
    ----------
    path
        The file.
    design
        Source of the detector's sampling rate and window, and of the ADC range; by default the default design.
    columns
        Name in the file for each column of a trace, such as ``{"voltage_v": "AI0"}``.
    rate_hz
        Sampling rate of a file without times [Hz].
    scale
        Volts per unit of the file's voltage.

    Returns
    -------
    Trace
        Columns of equal length, evenly sampled, without NaN.

    Raises
    ------
    TraceError
        With all issues of the file and of its samples.
    MissingLibraryError
        If npTDMS is required and not installed.
    """
    raw = read_raw_trace(Path(path), ColumnMap(columns or {}, rate_hz, scale))
    return raw.validate((design or Design()).detector)


def read_raw_trace(path: Path, columns: ColumnMap) -> RawTrace:
    """Read a trace without validation: .npz and .npy by numpy, .tdms by npTDMS, any other file as CSV.

    Raises
    ------
    TraceError
        If the file does not contain a trace.
    MissingLibraryError
        If npTDMS is required and not installed.
    """
    suffix = path.suffix.lower()
    if suffix == ".toml":
        _refuse_known_toml(path)
    if suffix not in (".npz", ".npy", ".tdms"):
        return read_csv(path, columns)
    try:
        arrays = _load_tdms(path, columns) if suffix == ".tdms" else _load_numpy(path, columns)
    except OSError as error:
        reason = error.strerror or str(error)
        raise TraceError(Issue(str(path), f"cannot be read ({reason}); give the path of a trace.")) from None
    return _from_arrays(str(path), arrays, columns)


def _refuse_known_toml(path: Path) -> None:
    """Raise TraceError for a design, scene, manipulation or sweep file given in place of a trace."""
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
    """Make a trace of named arrays."""
    issues, values = list[Issue](), dict[str, Any]()
    if not arrays:
        raise TraceError(Issue(name, f"contains no arrays; save {' and '.join(columns.required)}."))
    if columns.rate_hz is None and columns.name_in_file("time_s") not in arrays and RATE in arrays:
        stated = np.asarray(arrays[RATE])
        rate_hz = _parse_rate(stated)
        if not rate_hz:
            message = f"contains {_describe(stated)}; save the rate in Hz as one number, such as 2000"
            issues.append(Issue(f"{name}, {RATE}", f"{message}, or give --rate-hz."))
        # A placeholder replaces a wrong rate, so that the other arrays are still validated.
        columns = ColumnMap(columns.names, rate_hz or 1.0, columns.scale)
    missing = [column for column in columns.required if columns.name_in_file(column) not in arrays]
    for column in COLUMNS:
        name_in_file = columns.name_in_file(column)
        if name_in_file not in arrays:
            if column in missing:
                remedy = suggest_name(name_in_file, list(arrays))
                remedy += f" Or give --rate-hz, or {RATE} in the file." if column == "time_s" else ""
                if column == missing[-1] and (options := suggest_options(list(arrays), columns)):
                    remedy += f" Or {options}."
                issues.append(Issue(name, f"there is no array {name_in_file}; {remedy}"))
            continue
        array = np.asarray(arrays[name_in_file])
        is_numeric = array.dtype.kind in "bifu"
        if not is_numeric:
            issues.append(Issue(f"{name}, {name_in_file}", f"has the type {array.dtype}; give an array of numbers."))
        values[column] = array.astype(np.float64) if is_numeric else np.zeros(0)
    if issues:
        raise TraceError(issues)
    return RawTrace(name, columns.make_trace(values), in_volts=columns.in_volts)


def _parse_rate(stated: NDArray[Any]) -> float | None:
    """Parse the sampling rate that an archive states [Hz]; None if it is not one number above 0."""
    if stated.size != 1 or stated.dtype.kind not in "iufUS":
        return None
    try:
        rate_hz = float(stated.ravel()[0])
    except ValueError:
        return None
    return rate_hz if 0.0 < rate_hz < float("inf") else None


def _describe(stated: NDArray[Any]) -> str:
    """Describe an array that is not one number."""
    if stated.size != 1:
        return f"{stated.size} values" if stated.size else "no value"
    return repr(stated.ravel()[0].item())


def _load_numpy(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    try:
        loaded = np.load(path, allow_pickle=False)
        if not isinstance(loaded, np.ndarray):
            with loaded:
                return {key: loaded[key] for key in loaded.files}
    except (ValueError, EOFError, zipfile.BadZipFile):
        message = "is not a file that numpy can read without pickle; save numbers with numpy.savez."
        raise TraceError(Issue(str(path), message)) from None
    if loaded.ndim == 1:
        return {columns.name_in_file("voltage_v"): loaded}
    if loaded.ndim == 2 and loaded.shape[1] == 2:
        # The columns of an array have no names: a name for the time (`--column time_s=none`) means to ignore it.
        if columns.rate_hz is not None and "time_s" in columns.names:
            return {columns.name_in_file("voltage_v"): loaded[:, 1]}
        return {columns.name_in_file("time_s"): loaded[:, 0], columns.name_in_file("voltage_v"): loaded[:, 1]}
    message = f"has shape {loaded.shape}; give (samples,) with --rate-hz, or (samples, 2) for time and voltage."
    raise TraceError(Issue(str(path), message))


def _load_tdms(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    """Load channels by name. A single channel is the voltage, and the recording's increment gives the times."""
    nptdms = extras.load("nptdms", str(path), alternative="save the recording as CSV")
    with path.open("rb") as file:
        if file.read(4) != b"TDSm":  # the tag of every segment
            raise TraceError(Issue(str(path), "is not a TDMS file; export it again, or save it as CSV."))
    try:
        channels = [channel for group in nptdms.TdmsFile.read(path).groups() for channel in group.channels()]
    except (ValueError, KeyError, IndexError) as error:
        message = f"is not a TDMS file that npTDMS can read ({error}); export it again, or save it as CSV."
        raise TraceError(Issue(str(path), message)) from None
    by_name = {channel.name: channel for channel in channels}
    if len(channels) == 1 and "voltage_v" not in columns.names:
        by_name = {"voltage_v": channels[0]}
    arrays: dict[str, Any] = {name: channel[:] for name, channel in by_name.items()}
    voltage = by_name.get(columns.name_in_file("voltage_v"))
    increment = voltage.properties.get("wf_increment") if voltage is not None else None
    if increment:
        arrays[RATE] = float(f"{1 / float(increment):.9g}")
    return arrays
