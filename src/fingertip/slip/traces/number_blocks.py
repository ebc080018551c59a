"""Blocks of lines of plain numbers, parsed at once by pyarrow or numpy.

Both round as Python does. A block that holds anything else is left to whoever reads it line by
line, and names what is wrong.
"""

from __future__ import annotations

import importlib
import io
import warnings
from collections.abc import Sequence

import numpy as np

from fingertip.foundation import extras
from fingertip.foundation.numerics import Array
from fingertip.slip.traces.cells import SPACES

_ARROW_FROM = 2**19
"""Length of a block from which pyarrow is imported, where it is installed [characters]."""
_MARKS = ('"', "#")
"""Begin of a quoted cell, which may hold the delimiter, and of a comment."""


def parse_numbers(
    block: str, delimiter: str, width: int, places: Sequence[int]
) -> list[Array] | None:
    """Parse the columns at some places of a block of one sample a line.

    Parameters
    ----------
    width
        Number of cells that each line has.

    Returns None if any line may not be such a sample: if it is empty or a comment, has another
    number of cells, or a cell that is not a finite number.
    """
    if any(mark in block for mark in _MARKS):
        return None

    columns = None
    if len(block) >= _ARROW_FROM and delimiter != SPACES and extras.is_installed("pyarrow"):
        columns = _parse_by_arrow(block, delimiter, width, places)
    if columns is None:
        columns = _parse_by_numpy(block, delimiter, width, places)

    lines = block.count("\n") + (not block.endswith("\n"))
    is_plain = columns is not None and all(
        len(column) == lines and np.isfinite(column).all() for column in columns
    )
    return columns if is_plain else None


def _parse_by_arrow(
    block: str, delimiter: str, width: int, places: Sequence[int]
) -> list[Array] | None:
    """Parse a block; None also for the signs and spaces that pyarrow does not take."""
    csv = importlib.import_module("pyarrow.csv")
    pyarrow = importlib.import_module("pyarrow")
    names = [str(place) for place in range(width)]
    data = pyarrow.py_buffer(block.encode())

    try:
        table = csv.read_csv(
            data,
            read_options=csv.ReadOptions(
                use_threads=False, column_names=names, block_size=len(data)
            ),
            parse_options=csv.ParseOptions(delimiter=delimiter, quote_char=False),
            convert_options=csv.ConvertOptions(
                column_types=dict.fromkeys(names, pyarrow.float64()),
                include_columns=[names[place] for place in places],
                null_values=[],
            ),
        )
    except pyarrow.ArrowInvalid:
        return None

    pyarrow.default_memory_pool().release_unused()
    # Its method to_numpy would import pandas.
    return [np.asarray(np.from_dlpack(column.combine_chunks())) for column in table.columns]


def _parse_by_numpy(
    block: str, delimiter: str, width: int, places: Sequence[int]
) -> list[Array] | None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of a block without samples
            table = np.loadtxt(
                io.StringIO(block),
                delimiter=None if delimiter == SPACES else delimiter,
                comments=None,
                ndmin=2,
            )
    except ValueError:
        return None

    return [table[:, place] for place in places] if table.shape[1] == width else None
