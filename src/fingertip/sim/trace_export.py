"""Recorded columns as a trace file, CSV or NPZ, all at once or chunk by chunk."""

from __future__ import annotations

import io
import shutil
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO, Protocol

import numpy as np
from numpy.typing import NDArray

from fingertip.catalogues.output_files import DETECTION, PLOT, SIGNAL, TRACE
from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.output_set import SetWriter
from fingertip.foundation.output_set.replacement import hash_content
from fingertip.foundation.output_set.writer import has_hash

SUFFIXES = (".csv", ".npz")
"""Suffixes of the files that are written."""
DECIMALS = {"_v": 6, "_n": 6, "_m": 9, "_m_s": 7}
"""Decimals of a column by the end of its name: 1 uV, 1 uN, 1 nm, 0.1 um/s. The same numbers then give the same
bytes."""


def signal_writer(design: Design, folder: Path, force: bool = False, top: Path | None = None) -> SetWriter:
    """Writer of simulated traces of a design, and of what is made from them; `top` as for `SetWriter`."""
    return SIGNAL.writer(design, folder, force, top)


def write_trace(design: Design, path: Path, trace: Path, force: bool = False) -> tuple[str, ...]:
    """Move a trace into the folder of a design's signals, and return the names of the files that were removed.

    Plot and detection of the trial are removed if the trace is another one than they were made from.
    """
    is_new = path.name == TRACE and not has_hash(path, hash_content(trace))
    return signal_writer(design, path.parent, force).write({path.name: trace}, (PLOT, DETECTION) if is_new else ())


class TraceWriter(Protocol):
    """Writer of a trace, chunk by chunk."""

    def write(self, time_s: NDArray[Any], columns: Mapping[str, NDArray[Any]]) -> None:
        """Add the next samples of all columns."""
        ...

    def close(self) -> None:
        """Complete the file."""
        ...


class CsvTraceWriter:
    """Writer of a CSV file: one line that names the columns, then one sample per line, with fixed decimals."""

    def __init__(self, file: BinaryIO, names: Sequence[str]) -> None:
        self._file = file
        file.write((",".join(["time_s", *names]) + "\n").encode("ascii"))

    def write(self, time_s: NDArray[Any], columns: Mapping[str, NDArray[Any]]) -> None:
        """Add the next samples of all columns."""
        cells = [[f"{t:.7f}" for t in time_s.tolist()]]
        cells += [
            [_format_cell(name, value) for value in round_column(name, v).tolist()] for name, v in columns.items()
        ]
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
        """Add the next samples of all columns."""
        self._count += len(time_s)
        rounded = {"time_s": np.round(time_s, 7)} | {name: round_column(name, v) for name, v in columns.items()}
        for name, values in rounded.items():
            self._types[name] = values.dtype
            self._spools[name].write(values.tobytes())

    def close(self) -> None:
        """Complete the file."""
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


def open_trace(file: BinaryIO, path: Path, names: Sequence[str]) -> TraceWriter:
    """Open a writer for the kind of file that a path names: CSV, or a numpy archive if it ends in .npz.

    Raises TraceError.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise TraceError(Issue(str(path), f"is not a known kind of trace file; end it in {' or '.join(SUFFIXES)}."))
    return NpzTraceWriter(file, names) if path.suffix.lower() == ".npz" else CsvTraceWriter(file, names)


def encode_trace(time_s: NDArray[Any], columns: Mapping[str, NDArray[Any]], path: Path) -> bytes:
    """Encode columns as CSV or, for a path that ends in .npz, as numpy archive. The same numbers give the same bytes.

    Raises TraceError.
    """
    out = io.BytesIO()
    writer = open_trace(out, path, [*columns])
    writer.write(time_s, columns)
    writer.close()
    return out.getvalue()


def _decimals(name: str) -> int:
    return next(decimals for end, decimals in reversed(DECIMALS.items()) if name.endswith(end))


def round_column(name: str, values: NDArray[Any]) -> NDArray[Any]:
    """Round a column to the decimals that are written; negative zero becomes zero."""
    return values if values.dtype == np.bool_ else np.round(values, _decimals(name)) + 0.0


def _format_cell(name: str, value: float | bool) -> str:
    return ("1" if value else "0") if isinstance(value, bool) else f"{value:.{_decimals(name)}f}"
