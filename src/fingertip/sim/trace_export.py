"""Recorded columns as the bytes of a trace file, CSV or NPZ."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.output_set import SetWriter, hash_parameters
from fingertip.slip.traces.csv_file import to_csv
from fingertip.slip.traces.trace import Trace

TRACE, PLOT, DETECTION = "trace.csv", "slip.png", "detection.json"
"""Names of the files of a simulated trial."""
SIGNAL_FOLDER = "signal"
"""Folder of simulated traces within the output folder of a design."""
DECIMALS = {"_v": 6, "_n": 6, "_m": 9, "_m_s": 7}
"""Decimals of a column by the end of its name: 1 uV, 1 uN, 1 nm, 0.1 um/s. The same numbers then give the same
bytes."""


def signal_writer(design: Design, folder: Path, force: bool = False) -> SetWriter:
    """Writer of simulated traces of a design, and of what is made from them."""
    return SetWriter(folder, "signal", design.name, hash_parameters(design.model_dump(mode="json")), force=force)


def write_trace(design: Design, path: Path, data: bytes, force: bool = False) -> tuple[str, ...]:
    """Write a trace to the folder of a design's signals, and return the names of the files that were removed.

    Plot and detection of the trial are removed if the trace is another one than they were made from.
    """
    is_new = path.name == TRACE and not (path.is_file() and path.read_bytes() == data)
    return signal_writer(design, path.parent, force).write({path.name: data}, (PLOT, DETECTION) if is_new else ())


def find_path_issues(path: Path, option: str = "--out") -> list[Issue]:
    """Report a path whose suffix is not that of a trace file."""
    if path.suffix.lower() in (".csv", ".npz"):
        return []
    return [Issue(option, f"{path.name!r} is not a known kind of trace file; end it in .csv or .npz.")]


def encode_trace(time_s: NDArray[Any], columns: Mapping[str, NDArray[Any]], path: Path) -> bytes:
    """Encode columns as CSV or, for a path that ends in .npz, as numpy archive. The same numbers give the same bytes.

    Raises
    ------
    TraceError
        If the path has another suffix.
    """
    if issues := find_path_issues(path):
        raise TraceError(issues)
    rounded = {name: _round(name, values) for name, values in columns.items()}
    if path.suffix.lower() == ".npz":
        out = io.BytesIO()
        np.savez_compressed(out, time_s=np.round(time_s, 7), **rounded)  # type: ignore[arg-type]
        return out.getvalue()
    if list(rounded) == ["voltage_v", "force_n", "slip"]:
        return to_csv(Trace(time_s, columns["voltage_v"], columns["force_n"], columns["slip"]))
    cells = [[f"{t:.7f}" for t in time_s.tolist()]]
    cells += [[_format_cell(name, value) for value in values.tolist()] for name, values in rounded.items()]
    lines = [",".join(["time_s", *rounded]), *map(",".join, zip(*cells, strict=True))]
    return ("\n".join(lines) + "\n").encode("ascii")


def _decimals(name: str) -> int:
    return next(decimals for end, decimals in reversed(DECIMALS.items()) if name.endswith(end))


def _round(name: str, values: NDArray[Any]) -> NDArray[Any]:
    return values if values.dtype == np.bool_ else np.round(values, _decimals(name)) + 0.0


def _format_cell(name: str, value: float | bool) -> str:
    return ("1" if value else "0") if isinstance(value, bool) else f"{value:.{_decimals(name)}f}"
