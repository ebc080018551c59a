"""Traces from files of any kind known here, chosen by the end of the file's name."""

from __future__ import annotations

import importlib
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.design.issues import nearest
from fingertip.errors import Issue, MissingLibraryError, TraceError
from fingertip.slip.traces.own_names import own_names
from fingertip.slip.traces.parsed import COLUMNS, Parsed, Wanted
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.trace_file import parse_csv

RATE = "sample_rate_hz"
"""A number of this name in an archive stands for its times."""


def read_trace(
    path: str | Path,
    design: Design | None = None,
    columns: Mapping[str, str] | None = None,
    rate_hz: float | None = None,
    scale: float = 1.0,
) -> Trace:
    """Read a trace that somebody recorded: .csv, .npz, .npy or .tdms.

    Parameters
    ----------
    path
        The file.
    design
        What the trace is checked for: the detector's rate and window, the converter's range. By default the defaults.
    columns
        A trace's column -> the file's name for it, such as ``{"voltage_v": "AI0"}``.
    rate_hz
        Sampling rate of a file without times [Hz].
    scale
        Volts for each unit of the file's voltage.

    Returns
    -------
    Trace
        Columns of equal length, evenly sampled, without NaN.

    Raises
    ------
    TraceError
        With one sentence for each issue of the file and of its samples.
    MissingLibraryError
        If npTDMS is needed and not installed.
    """
    parsed = parse(Path(path), Wanted(columns or {}, rate_hz, scale))
    return parsed.checked((design or Design()).detector)


def parse(path: Path, wanted: Wanted) -> Parsed:
    """Read a trace: .npz and .npy by numpy, .tdms by npTDMS, anything else as CSV.

    Raises
    ------
    TraceError
        If there is no trace in the file.
    MissingLibraryError
        If npTDMS is needed and not installed.
    """
    kind = path.suffix.lower()
    if kind not in (".npz", ".npy", ".tdms"):
        return parse_csv(path, wanted)
    try:
        arrays = _tdms(path, wanted) if kind == ".tdms" else _numpy(path, wanted)
    except OSError as error:
        reason = error.strerror or str(error)
        raise TraceError(Issue(str(path), f"cannot be read ({reason}); give the path of a trace.")) from None
    return _from_arrays(str(path), arrays, wanted)


def _from_arrays(name: str, arrays: Mapping[str, Any], wanted: Wanted) -> Parsed:
    """A trace of named arrays."""
    issues, columns = list[Issue](), dict[str, Any]()
    if wanted.rate_hz is None and wanted.of("time_s") not in arrays and RATE in arrays:
        rate_hz = _rate_hz(np.asarray(arrays[RATE]))
        if not rate_hz:
            told = f"holds {_words(np.asarray(arrays[RATE]))}; save the rate in Hz as one number, such as 2000"
            issues.append(Issue(f"{name}, {RATE}", f"{told}, or give --rate-hz."))
        # A place holder where it is wrong: the other arrays are judged all the same.
        wanted = Wanted(wanted.names, rate_hz or 1.0, wanted.scale)
    missing = [column for column in wanted.needed if wanted.of(column) not in arrays]
    for column in COLUMNS:
        known = wanted.of(column)
        if known not in arrays:
            if column in missing:
                remedy = nearest(known, list(arrays))
                more = f" Or give --rate-hz, or {RATE} in the file." if column == "time_s" else ""
                if column == missing[-1] and (own := own_names(list(arrays), wanted)):
                    more += f" O{own.removeprefix('; o')}."
                issues.append(Issue(name, f"holds no array {known}; {remedy}{more}"))
            continue
        array = np.asarray(arrays[known])
        if array.dtype.kind not in "bifu":
            issues.append(Issue(f"{name}, {known}", f"holds {array.dtype}; give an array of numbers."))
        columns[column] = array.astype(np.float64) if array.dtype.kind in "bifu" else np.zeros(0)
    if issues:
        raise TraceError(issues)
    return Parsed(name, wanted.trace(columns), in_volts=wanted.in_volts)


def _rate_hz(stated: NDArray[Any]) -> float | None:
    """A rate [Hz] that an archive states; None if that is no single number above 0."""
    if stated.size != 1 or stated.dtype.kind not in "iufUS":
        return None
    try:
        rate_hz = float(stated.ravel()[0])
    except ValueError:
        return None
    return rate_hz if 0.0 < rate_hz < float("inf") else None


def _words(stated: NDArray[Any]) -> str:
    """What an array holds instead of a number."""
    if stated.size != 1:
        return f"{stated.size} values" if stated.size else "no value"
    return repr(stated.ravel()[0].item())


def _numpy(path: Path, wanted: Wanted) -> Mapping[str, Any]:
    try:
        loaded = np.load(path, allow_pickle=False)
        if not isinstance(loaded, np.ndarray):
            with loaded:
                return {key: loaded[key] for key in loaded.files}
    except (ValueError, EOFError, zipfile.BadZipFile):
        raise TraceError(
            Issue(str(path), "is no array that numpy reads without pickle; save numbers by numpy.savez.")
        ) from None
    if loaded.ndim == 1:
        return {wanted.of("voltage_v"): loaded}
    if loaded.ndim == 2 and loaded.shape[1] == 2:
        if wanted.rate_hz is not None and "time_s" in wanted.names:  # no column has a name here: it is set aside
            return {wanted.of("voltage_v"): loaded[:, 1]}
        return {wanted.of("time_s"): loaded[:, 0], wanted.of("voltage_v"): loaded[:, 1]}
    raise TraceError(
        Issue(str(path), f"has shape {loaded.shape}; give (samples,) with --rate-hz, or (samples, 2): time, voltage.")
    )


def _tdms(path: Path, wanted: Wanted) -> Mapping[str, Any]:
    """Channels by name; a lone channel is the voltage, and the recording's increment gives the times."""
    try:
        nptdms = importlib.import_module("nptdms")
    except ImportError:
        raise MissingLibraryError(
            Issue(str(path), "needs npTDMS, which is not installed; pip install 'fingertip[tdms]'.")
        ) from None
    try:
        channels = [channel for group in nptdms.TdmsFile.read(path).groups() for channel in group.channels()]
    except (ValueError, KeyError, IndexError) as error:
        raise TraceError(Issue(str(path), f"is no TDMS file that npTDMS reads ({error}).")) from None
    found = {channel.name: channel for channel in channels}
    if len(channels) == 1 and "voltage_v" not in wanted.names:
        found = {"voltage_v": channels[0]}
    arrays: dict[str, Any] = {name: channel[:] for name, channel in found.items()}
    voltage = found.get(wanted.of("voltage_v"))
    increment = voltage.properties.get("wf_increment") if voltage is not None else None
    if increment:
        arrays[RATE] = float(f"{1 / float(increment):.9g}")
    return arrays
