"""Trace files of a simulation: CSV and NPZ, written piece by piece, with the same bytes for the
same numbers.
"""

from __future__ import annotations

import io
import shutil
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from fingertip.catalogues.output_files import DETECTION, PLOT, SIGNAL, TRACE
from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.folder_swap import hash_content
from fingertip.foundation.output_set import has_hash

SUFFIXES = (".csv", ".npz")
_ROWS = 2**16
"""Samples that are written at a time: a number takes ten times the memory as text."""
DECIMALS = {
    "_v": 6,
    "_n": 6,
    "_m": 9,
    "_m_s": 7,
}
"""Decimals of a column by the end of its name, so that equal numbers give equal bytes."""


def write_trace(design: Design, path: Path, trace: Path, force: bool = False) -> tuple[str, ...]:
    """Move a trace into a design's signals, and remove plot and detection of another one.

    Return their names.
    """
    is_new = path.name == TRACE and not has_hash(path, hash_content(trace))
    return SIGNAL.writer(design, path.parent, force).write(
        {path.name: trace}, (PLOT, DETECTION) if is_new else ()
    )


class CsvTraceWriter:
    """Writer of a CSV file: one line that names the columns, then one sample per line, with fixed
    decimals.
    """

    def __init__(self, file: BinaryIO, names: Sequence[str]) -> None:
        self._file = file
        file.write((",".join(["time_s", *names]) + "\n").encode("ascii"))

    def write(self, time_s: NDArray[Any], columns: Mapping[str, NDArray[Any]]) -> None:
        for start in range(0, len(time_s), _ROWS):
            rows = slice(start, start + _ROWS)
            cells = [[f"{t:.7f}" for t in time_s[rows].tolist()]]
            for name, values in columns.items():
                form = "d" if values.dtype == np.bool_ else f".{_decimals(name)}f"
                cells.append(
                    [f"{value:{form}}" for value in round_column(name, values[rows]).tolist()]
                )

            lines = [*map(",".join, zip(*cells, strict=True)), ""]
            self._file.write("\n".join(lines).encode("ascii"))

    def close(self) -> None:
        """Complete the file."""


class NpzTraceWriter:
    """Writer of a numpy archive with one member per column. The columns wait in temporary files."""

    def __init__(self, file: BinaryIO, names: Sequence[str]) -> None:
        self._file = file
        self._spools = {name: tempfile.TemporaryFile() for name in ("time_s", *names)}  # noqa: SIM115 (closed below)
        self._types: dict[str, np.dtype[Any]] = {}
        self._count = 0

    def write(self, time_s: NDArray[Any], columns: Mapping[str, NDArray[Any]]) -> None:
        self._count += len(time_s)
        rounded = {"time_s": np.round(time_s, 7)} | {
            name: round_column(name, v) for name, v in columns.items()
        }
        for name, values in rounded.items():
            self._types[name] = values.dtype
            self._spools[name].write(values.tobytes())

    def close(self) -> None:
        with zipfile.ZipFile(self._file, "w") as archive:
            for name, spool in self._spools.items():
                # A date of its own would give other bytes every day.
                member = zipfile.ZipInfo(f"{name}.npy", (1980, 1, 1, 0, 0, 0))
                member.compress_type = zipfile.ZIP_DEFLATED
                kind = np.lib.format.dtype_to_descr(self._types[name])

                with archive.open(member, "w", force_zip64=True) as out, spool:
                    header = {"descr": kind, "fortran_order": False, "shape": (self._count,)}
                    np.lib.format.write_array_header_1_0(out, header)
                    spool.seek(0)
                    shutil.copyfileobj(spool, out)


def open_trace(file: BinaryIO, path: Path, names: Sequence[str]) -> CsvTraceWriter | NpzTraceWriter:
    """Open a writer for the kind of file that a path names, CSV or NPZ. Raises TraceError."""
    if path.suffix.lower() not in SUFFIXES:
        raise TraceError(
            Issue(
                str(path), f"is not a known kind of trace file; end it in {' or '.join(SUFFIXES)}."
            )
        )

    return (
        NpzTraceWriter(file, names)
        if path.suffix.lower() == ".npz"
        else CsvTraceWriter(file, names)
    )


def encode_trace(time_s: NDArray[Any], columns: Mapping[str, NDArray[Any]], path: Path) -> bytes:
    """Encode columns as CSV or NPZ, by the path's ending; equal numbers give equal bytes.

    Raises TraceError.
    """
    out = io.BytesIO()
    write_columns(out, path, time_s, columns)
    return out.getvalue()


def write_columns(
    file: BinaryIO, path: Path, time_s: NDArray[Any], columns: Mapping[str, NDArray[Any]]
) -> None:
    writer = open_trace(file, path, [*columns])
    writer.write(time_s, columns)
    writer.close()


def _decimals(name: str) -> int:
    return next(decimals for end, decimals in reversed(DECIMALS.items()) if name.endswith(end))


def round_column(name: str, values: NDArray[Any]) -> NDArray[Any]:
    """Round a column to the decimals that are written; negative zero becomes zero."""
    return values if values.dtype == np.bool_ else np.round(values, _decimals(name)) + 0.0
