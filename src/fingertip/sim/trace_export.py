"""Columns as the bytes of a trace file."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.errors import Issue, TraceError
from fingertip.slip.traces.csv_file import to_csv
from fingertip.slip.traces.trace import Trace

Array = NDArray[Any]

DECIMALS = {"_v": 6, "_n": 6, "_m": 9, "_m_s": 7}
"""Of a column by the end of its name, so that the same numbers give the same bytes: 1 uV, 1 uN, 1 nm, 0.1 um/s."""


def file_bytes(time_s: Array, columns: Mapping[str, Array], path: Path) -> bytes:
    """The columns as CSV or, for a path that ends in .npz, as numpy's archive; the same numbers give the same bytes.

    Raises
    ------
    TraceError
        If the path ends otherwise.
    """
    rounded = {name: _rounded(name, values) for name, values in columns.items()}
    match path.suffix.lower():
        case ".npz":
            out = io.BytesIO()
            np.savez_compressed(out, time_s=np.round(time_s, 7), **rounded)  # type: ignore[arg-type]
            return out.getvalue()
        case ".csv":
            if list(rounded) == ["voltage_v", "force_n", "slip"]:
                return to_csv(Trace(time_s, columns["voltage_v"], columns["force_n"], columns["slip"]))
            cells = [[f"{t:.7f}" for t in time_s.tolist()]]
            cells += [[_cell(name, value) for value in values.tolist()] for name, values in rounded.items()]
            lines = [",".join(["time_s", *rounded]), *map(",".join, zip(*cells, strict=True))]
            return ("\n".join(lines) + "\n").encode("ascii")
    raise TraceError(Issue("--out", f"{path.name!r} is no kind of trace file known here; end it in .csv or .npz."))


def _decimals(name: str) -> int:
    return next(decimals for end, decimals in reversed(DECIMALS.items()) if name.endswith(end))


def _rounded(name: str, values: Array) -> Array:
    return values if values.dtype == np.bool_ else np.round(values, _decimals(name)) + 0.0


def _cell(name: str, value: float | bool) -> str:
    return ("1" if value else "0") if isinstance(value, bool) else f"{value:.{_decimals(name)}f}"
