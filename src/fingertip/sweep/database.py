"""Database of a sweep: one SQLite file that receives each row once, when its point is finished.

There is one writer, the sweep itself; anyone may read at the same time. The journal is SQLite's
rollback journal, not its write-ahead log, so that the folder may be on a network drive, and holds a
single file while no sweep runs. Whatever was committed survives a kill -9; the rest is computed
again.
"""

from __future__ import annotations

import contextlib
import difflib
import itertools
import math
import os
import re
import sqlite3
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import OutputError, SweepError, raise_issues
from fingertip.foundation.output_set import find_place_issues
from fingertip.sweep.axes import Value
from fingertip.sweep.database_file import (
    FILE,
    connect,
    lock_sweep,
    make_damage_error,
    make_error,
    translated_errors,
)
from fingertip.sweep.sweep_plan import SweepPlan

FORMAT = "2"
"""Version of the tables, and of the parameter and output names in them."""
_META_TABLE = "CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL)"
_ROWS_TABLE = (
    "CREATE TABLE rows (point INTEGER PRIMARY KEY, status TEXT NOT NULL, field TEXT NOT "
    "NULL, reason TEXT NOT NULL"
)
_COLUMNS = re.compile(r'(, "([^"]|"")*")+\)')
_PAGE_ROWS = 20_000
MAX_REASON_LENGTH = 4000
"""Maximum length of a reason that is written [characters]."""
_MAX_FIELD_LENGTH = 200
"""Maximum length of the name of a parameter or check [characters].
A table keeps that room for each row.
"""
_TEXTS = (str, bytes)
_MIN_OUTPUT = 1e-100
_MAX_OUTPUT = 1e100
"""Bounds of the size of an output that is neither 0 nor infinite. Statistics square it."""

StoredRow: TypeAlias = tuple[Any, ...]
"""Row as it is written: point, status, field, reason, then axes and outputs in the plan's order.
SQLite stores no NaN; it becomes NULL and is read back as NaN.
"""
Status: TypeAlias = Literal["ok", "refused", "failed", "timeout"]
STATUSES: tuple[Status, ...] = ("ok", "refused", "failed", "timeout")
"""ok: computed. refused: the design breaks a rule, which is a valid result. failed: an error, or
the worker died. timeout: the point took longer than the sweep's time limit.
"""


@dataclass(frozen=True)
class SweepRow:
    point: int
    axes: dict[str, Value]
    outputs: dict[str, float]
    """Output -> value; NaN where it was not computed."""
    status: Status
    field: str
    """Parameter or check that `reason` is about; "" if there is none."""
    reason: str
    """Reason why the point is not ok, or names of the failed checks; "" otherwise."""


@dataclass(frozen=True, eq=False)
class SweepTable:
    """All rows as columns of one length n, ordered by point number."""

    point: NDArray[np.int64]
    """(n,) number of the point in the plan. Points without a row are left out."""
    axes: dict[str, NDArray[Any]]
    """Swept parameter, dotted (`skin.width_mm`, `scene.slide.speed_m_s`) -> (n,) values: float,
    int, bool or str.
    """
    outputs: dict[str, NDArray[np.float64]]
    """Output, with the unit in its name -> (n,) values. NaN where it was not computed, infinite
    where it is unbounded (the median delay where fewer than half of the slips were detected).
    """
    status: NDArray[np.str_]
    """(n,) one of `STATUSES`."""
    field: NDArray[np.str_]
    """(n,) first parameter of a refused point's broken rule, or first failed check.
    "" otherwise.
    """
    reason: NDArray[np.object_]
    """(n,) of str: why a row is not ok, or which checks failed; "" otherwise."""

    def __len__(self) -> int:
        return len(self.point)


def _quote_columns(plan: SweepPlan) -> list[str]:
    """Quote the names of the columns of axes and numbers, as SQL writes them."""
    return [
        '"' + name.replace('"', '""') + '"'
        for name in (*(axis.name for axis in plan.axes), *plan.recorded)
    ]


class SweepDatabase:
    """Folder of a sweep with its rows: open it with `create`, `resume` or `open`, and close it."""

    def __init__(
        self, folder: Path, connection: sqlite3.Connection, lock: int | None = None
    ) -> None:
        self.folder = folder
        self._connection = connection
        self._lock = lock

    @staticmethod
    def exists(folder: Path) -> bool:
        path = folder / FILE
        if not os.path.lexists(path):
            return False

        with contextlib.closing(connect(path, "rw")) as connection, translated_errors(folder):
            return connection.execute("SELECT 1 FROM sqlite_master").fetchone() is not None

    @classmethod
    def create(cls, folder: Path, plan: SweepPlan) -> SweepDatabase:
        """Create the database of a new sweep, and its folder. Raises OutputError or SweepError."""
        if folder.exists() and cls.exists(folder):
            problem = (
                "holds a sweep already; continue it with --resume, report on it with "
                "--show, or choose another"
            )
            raise make_error(folder, f"{problem} folder with --out. Nothing was changed.")

        raise_issues(OutputError, find_place_issues(folder, "choose another folder with --out"))
        created = [path for path in (folder / FILE, folder, *folder.parents) if not path.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        lock = lock_sweep(folder)
        database = cls(folder, connect(folder / FILE, "rwc"), lock)

        try:
            columns = "".join(f", {name}" for name in _quote_columns(plan))
            with database._transaction() as connection:
                connection.execute(_META_TABLE)
                connection.execute(f"{_ROWS_TABLE}{columns})")
                connection.execute(
                    "INSERT INTO meta VALUES ('format', ?), ('plan', ?)", (FORMAT, plan.to_toml())
                )
        except BaseException:
            database.close()
            for path in created:
                with contextlib.suppress(OSError):
                    path.unlink() if path.name == FILE else path.rmdir()

            raise

        return database

    @classmethod
    def resume(cls, folder: Path, plan: SweepPlan) -> SweepDatabase:
        """Open a sweep to continue it, with its new objectives if they have changed.

        Raises SweepError.
        """
        lock = lock_sweep(folder)
        database = cls(folder, connect(folder / FILE, "rw"), lock)

        try:
            database.check_same_sweep(plan)
            text = plan.to_toml()
            if text != database.text:
                with database._transaction() as connection:
                    connection.execute("UPDATE meta SET value = ? WHERE key = 'plan'", (text,))
        except BaseException:
            database.close()
            raise

        return database

    @classmethod
    def open(cls, folder: Path) -> SweepDatabase:
        """Open the database of a sweep to read it; the sweep may be running. Raises SweepError."""
        if not folder.is_dir() or not cls.exists(folder):
            raise make_error(
                folder,
                "holds no sweep; give the folder of a sweep with --out, or run the sweep first.",
            )

        # What a killed sweep has begun is undone before it is read.
        return cls(folder, connect(folder / FILE, "rw"))

    def close(self) -> None:
        """Close the file and release the folder."""
        self._connection.close()
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def __enter__(self) -> SweepDatabase:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def text(self) -> str:
        tables = dict(self._fetch("SELECT name, sql FROM sqlite_master LIMIT 4"))
        rows_table = str(tables.pop("rows", ""))
        is_sound = rows_table.startswith(_ROWS_TABLE) and _COLUMNS.fullmatch(
            rows_table, len(_ROWS_TABLE)
        )
        if not is_sound or tables != {"meta": _META_TABLE, "sqlite_autoindex_meta_1": None}:
            raise make_damage_error(self.folder, "it holds other tables than a sweep")

        query = "SELECT key, value FROM meta WHERE key IN ('format', 'plan')"
        meta = dict(self._fetch(query))
        if meta.get("format") != FORMAT:
            problem = (
                f"was written in format {meta.get('format')!r}, but this version reads {FORMAT!r}"
            )
            raise make_error(self.folder, f"{problem}; run the sweep again in another folder.")

        return str(meta.get("plan"))

    @cached_property
    def plan(self) -> SweepPlan:
        text = self.text
        try:
            return SweepPlan.from_toml(text)
        except (ValueError, RecursionError):  # no valid TOML
            raise make_damage_error(
                self.folder, "the description of its sweep cannot be read"
            ) from None
        except SweepError as error:
            reason = error.issues[0].typed.rstrip(".")
            raise make_damage_error(
                self.folder, f"the description of its sweep cannot be used ({reason})"
            ) from None

    def add(self, rows: Sequence[StoredRow]) -> None:
        """Write rows in one transaction: all of them or none. Raises OutputError."""
        marks = ", ".join("?" * (4 + len(self.plan.axes) + len(self.plan.recorded)))
        with self._transaction() as connection:
            connection.executemany(f"INSERT INTO rows VALUES ({marks})", rows)

    def count_by_status(self) -> dict[str, int]:
        query = f"SELECT status, count(*) FROM rows WHERE status IN {STATUSES} GROUP BY status"
        counts = dict(self._fetch(query))
        return {status: int(counts.get(status, 0)) for status in STATUSES}

    def find_outputs(self) -> tuple[str, ...]:
        """Find the outputs to show: those of the plan, and the values that a fit has moved in any
        point.
        """
        fitted = self.plan.fitted
        moved = list[int | None]()

        if fitted:
            compared = ", ".join(f'max("{name}" != ?)' for name in fitted)
            (moved,) = self._fetch(f"SELECT {compared} FROM rows", *fitted.values())

        return (
            *self.plan.outputs,
            *(name for name, has_moved in zip(fitted, moved, strict=True) if has_moved),
        )

    def find_missing_points(self) -> NDArray[np.bool_]:
        """Find the points without a row: (size,) true where a point has none."""
        size = self.plan.size
        missing = np.ones(size, dtype=np.bool_)

        for page in self._read_pages("point"):
            if not all(0 <= point < size for (point,) in page):
                raise make_damage_error(self.folder, "a row is of no point")

            missing[[point for (point,) in page]] = False

        return missing

    def _read_valid_rows(self) -> Iterator[StoredRow]:
        """Read every row; a damaged file may hold any type in any column."""
        size = self.plan.size
        outputs_at = 4 + len(self.plan.axes)
        columns = ", ".join(["point", "status", "field", "reason", *_quote_columns(self.plan)])

        for row in itertools.chain.from_iterable(self._read_pages(columns)):
            point, status, *texts = row[:4]
            is_text = (
                all(isinstance(text, str) for text in texts) and len(texts[0]) <= _MAX_FIELD_LENGTH
            )
            if not (0 <= point < size and status in STATUSES and is_text):
                raise make_damage_error(self.folder, f"row {point} is damaged")
            if (
                any(isinstance(value, _TEXTS) for value in row[outputs_at:])
                or None in row[4:outputs_at]
            ):
                raise make_damage_error(self.folder, f"row {point} holds what is no number")

            yield row

    def rows(self) -> Iterator[SweepRow]:
        """Read every row in order of the points; few rows are in memory at a time."""
        outputs = self.find_outputs()
        axis_count = len(self.plan.axes)

        for point, status, field, reason, *values in self._read_valid_rows():
            numbers = (math.nan if value is None else float(value) for value in values[axis_count:])
            pairs = zip(self.plan.axes, values[:axis_count], strict=True)
            axes = {axis.name: axis.restore_type(value) for axis, value in pairs}
            by_name = dict(zip(self.plan.recorded, numbers, strict=True))
            yield SweepRow(
                point=point,
                axes=axes,
                outputs={name: by_name[name] for name in outputs},
                status=status,
                field=field,
                reason=reason,
            )

    def table(self) -> SweepTable:
        plan = self.plan
        count = sum(self.count_by_status().values())
        point = np.empty(count, dtype=np.int64)
        outputs = np.full((len(plan.recorded), count), np.nan)
        texts: list[tuple[str, str, str]] = []
        # A running sweep may add rows after they were counted; those are left out.
        rows = itertools.islice(self._read_valid_rows(), count)
        interned: dict[str, str] = {}

        for i, (number, status, field, reason, *values) in enumerate(rows):
            point[i] = number
            outputs[:, i] = [math.nan if v is None else v for v in values[len(plan.axes) :]]
            texts.append(
                (interned.setdefault(status, status), interned.setdefault(field, field), reason)
            )

        for name, column in zip(plan.recorded, outputs, strict=True):
            sizes = np.abs(column[np.isfinite(column) & (column != 0.0)])
            if np.any((sizes < _MIN_OUTPUT) | (sizes > _MAX_OUTPUT)):
                what = f"{name} is beyond {_MAX_OUTPUT:g}, or nearer to 0 than {_MIN_OUTPUT:g}"
                raise make_damage_error(self.folder, what)

        # Reasons are long and mostly differ: an array as wide as the longest one could take
        # gigabytes.
        status, field = (np.array([text[i] for text in texts], dtype=np.str_) for i in range(2))
        reason = np.array([text[2] for text in texts], dtype=np.object_)
        columns = dict(zip(plan.recorded, outputs, strict=True))
        by_name = {name: columns[name] for name in self.find_outputs()}

        return SweepTable(
            point=point,
            axes=plan.columns(point),
            outputs=by_name,
            status=status,
            field=field,
            reason=reason,
        )

    def check_same_sweep(self, plan: SweepPlan) -> None:
        """Refuse a plan whose rows would differ; its objectives may differ. Raises SweepError."""
        objectives = ("minimise = ", "maximise = ")
        before, now = (
            [line for line in text.splitlines() if not line.startswith(objectives)]
            for text in (self.text, plan.to_toml())
        )
        if before == now:
            return

        lines = [line for line in difflib.ndiff(before, now) if line[0] in "+-"]
        difference = "\n".join(f"  {line}" for line in lines)
        problem = "holds a different sweep than the file now describes (- stored, + file)"
        remedy = "change the file back, or choose another folder with --out. Nothing was changed."
        raise make_error(self.folder, f"{problem}; {remedy}\n{difference}")

    def _read_pages(self, columns: str) -> Iterator[list[Any]]:
        """Read rows page by page in order of the points; between two pages the writer can write."""
        query = f"SELECT {columns} FROM rows WHERE point > ? ORDER BY point LIMIT {_PAGE_ROWS}"
        page = list(self._fetch(query, -1))

        while page:
            yield page
            page = list(self._fetch(query, page[-1][0]))

    def _fetch(self, query: str, *parameters: Any) -> Iterator[Any]:
        with translated_errors(self.folder):
            yield from self._connection.execute(query, parameters)

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        """Write all or nothing: a sweep exists completely or not at all."""
        with translated_errors(self.folder), self._connection:
            self._connection.execute("BEGIN IMMEDIATE")
            yield self._connection
