"""A sweep's rows as CSV and as Parquet: in order of their points, a few at a time in memory."""

from __future__ import annotations

import csv
import io
import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from fingertip.errors import Issue, MissingLibraryError
from fingertip.files import open_atomic

if TYPE_CHECKING:
    from fingertip.sweep.plan import Plan
    from fingertip.sweep.database import Row

_GROUP = 65_536
"""Rows of one row group."""


class Rows(Protocol):
    """What is exported: a `sweep.store.Store`."""

    @property
    def plan(self) -> Plan:
        """The sweep as it was asked for."""

    def rows(self) -> Iterator[Row]:
        """Every row in order of its point."""


def write_csv(store: Rows, path: Path) -> None:
    """One line for each row: point, parameters, outputs (their names carry the units), status, field, reason.

    Numbers read back as they were; an output that was not computed is empty, one without a bound is inf. The same rows
    give the same bytes.

    Raises
    ------
    OutputError
        If the file cannot be written; what was there has not changed then.
    """
    with open_atomic(path, "--csv") as raw:
        text = io.TextIOWrapper(raw, encoding="utf-8", newline="", write_through=False)
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(names(store.plan))
        for row in store.rows():
            numbers = ("" if math.isnan(value) else value for value in row.outputs.values())
            lines.writerow([row.point, *row.axes.values(), *numbers, row.status, row.field, row.reason])
        text.flush()
        text.detach()


def write_parquet(store: Rows, path: Path) -> None:
    """The columns of `write_csv` with their types, in row groups; what was not computed is null.

    Raises
    ------
    MissingLibraryError
        Without pyarrow.
    OutputError
        If the file cannot be written; what was there has not changed then.
    """
    pyarrow, parquet = arrow()
    types = {"point": pyarrow.int64()}
    types |= {axis.name: _axis_type(pyarrow, axis.values, axis.whole) for axis in store.plan.axes}
    types |= dict.fromkeys(store.plan.outputs, pyarrow.float64())
    word = pyarrow.dictionary(pyarrow.int32(), pyarrow.string())
    schema = pyarrow.schema([*types.items(), ("status", word), ("field", word), ("reason", pyarrow.string())])
    rows = store.rows()
    with open_atomic(path, "--parquet") as raw, parquet.ParquetWriter(raw, schema) as writer:
        while group := list(itertools.islice(rows, _GROUP)):
            columns = [_column(pyarrow, field, group) for field in schema]
            writer.write_table(pyarrow.Table.from_arrays(columns, schema=schema), row_group_size=_GROUP)


def arrow() -> tuple[Any, Any]:
    """The modules pyarrow and pyarrow.parquet; ask before a long sweep, not after it.

    Raises
    ------
    MissingLibraryError
        Where they are not installed.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        remedy = "pip install 'fingertip[parquet]', or write CSV with --csv"
        raise MissingLibraryError(Issue("--parquet", f"needs the package pyarrow; {remedy}.")) from error
    return pyarrow, pyarrow.parquet


def names(plan: Plan) -> list[str]:
    """The columns of an export."""
    return ["point", *(axis.name for axis in plan.axes), *plan.outputs, "status", "field", "reason"]


def _axis_type(pyarrow: Any, values: tuple[Any, ...], whole: bool) -> Any:
    kinds = {type(value) for value in values}
    if str in kinds:
        return pyarrow.dictionary(pyarrow.int32(), pyarrow.string())
    if kinds == {bool}:
        return pyarrow.bool_()
    return pyarrow.int64() if whole or kinds == {int} else pyarrow.float64()


def _column(pyarrow: Any, field: Any, group: list[Row]) -> Any:
    name, words = field.name, pyarrow.types.is_dictionary(field.type)
    values: list[Any]
    if name in ("point", "status", "field", "reason"):
        values = [getattr(row, name) for row in group]
    elif name in group[0].axes:
        values = [str(row.axes[name]) if words else row.axes[name] for row in group]
    else:
        values = [None if math.isnan(row.outputs[name]) else row.outputs[name] for row in group]
    return pyarrow.array(values, pyarrow.string()).dictionary_encode() if words else pyarrow.array(values, field.type)
