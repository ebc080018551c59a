"""The rows of a sweep on disk: one SQLite file, written as points finish, each row once and never again.

There is one writer, the sweep itself; anyone may read meanwhile. The journal is SQLite's plain one, not its
write-ahead log, so that the folder may lie on a network drive and there is one file when the sweep rests. Whatever was
committed survives a kill -9; whatever was not is computed again.
"""

from __future__ import annotations

import contextlib
import itertools
import math
import os
import sqlite3
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fingertip.errors import Issue, OutputError, SweepError
from fingertip.sweep import sweep_file
from fingertip.sweep.axes import Value
from fingertip.sweep.plan import Plan
from fingertip.sweep.rows import STATUSES, Status, Table

FILE = "sweep.sqlite"
FORMAT = "1"
_PATIENCE_S = 30.0
"""How long a reader and the writer wait for each other."""
_PAGE = 20_000

Stored: TypeAlias = tuple[Any, ...]
"""A row as it is written: point, status, field, reason, then axes and outputs in the plan's order. SQLite keeps no
NaN: it becomes NULL, and is read back as NaN."""


@dataclass(frozen=True)
class Row:
    """One point: what it was, what came out, and if nothing did, why."""

    point: int
    axes: dict[str, Value]
    outputs: dict[str, float]
    """Those computed; NaN otherwise."""
    status: Status
    field: str
    reason: str


class Store:
    """A sweep's folder. Made by `Store.create`, `Store.resume` or `Store.open`; close it, or use it in a `with`."""

    def __init__(self, folder: Path, connection: sqlite3.Connection, lock: int | None = None) -> None:
        self.folder = folder
        self._connection = connection
        self._lock = lock

    @staticmethod
    def exists(folder: Path) -> bool:
        """Whether a sweep was begun in a folder."""
        path = folder / FILE
        if not path.is_file():
            return False
        with contextlib.closing(_connect(path, "ro")) as connection:
            return bool(_said(folder, lambda: connection.execute("SELECT 1 FROM sqlite_master").fetchone()))

    @classmethod
    def create(cls, folder: Path, plan: Plan) -> Store:
        """Begin a sweep in a folder, which is made.

        Raises
        ------
        OutputError
            If the folder cannot be written.
        SweepError
            If a sweep was begun there before.
        """
        if folder.exists() and cls.exists(folder):
            raise SweepError(
                Issue(
                    str(folder),
                    "holds a sweep already; continue it with --resume, look at it with --show, or choose another "
                    "folder with --out. Nothing was changed.",
                )
            )
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise _unwritable(folder, error.strerror or str(error)) from error
        lock = _locked(folder)
        store = cls(folder, _connect(folder / FILE, "rwc"), lock)
        try:
            _said(folder, lambda: store._make(plan))
        except BaseException:
            store.close()
            raise
        return store

    @classmethod
    def resume(cls, folder: Path, plan: Plan) -> Store:
        """Open a sweep to go on with it. What it minimises and maximises may have changed, and is kept as it is now.

        Raises
        ------
        SweepError
            If the sweep begun there is another one; says line by line how.
        """
        lock = _locked(folder)
        store = cls(folder, _connect(folder / FILE, "rw"), lock)
        try:
            store.refuse_other(plan)
            _said(folder, lambda: store._keep(plan))
        except BaseException:
            store.close()
            raise
        return store

    @classmethod
    def open(cls, folder: Path) -> Store:
        """Open a sweep to read it; it may be running.

        Raises
        ------
        SweepError
            If there is none.
        """
        if not folder.is_dir() or not cls.exists(folder):
            raise SweepError(Issue(str(folder), "holds no sweep; give the folder of one (--out), or run it first."))
        return cls(folder, _connect(folder / FILE, "ro"))

    def close(self) -> None:
        """Write nothing more."""
        self._connection.close()
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def text(self) -> str:
        """The sweep's canonical text."""
        rows = _said(self.folder, lambda: self._connection.execute("SELECT key, value FROM meta").fetchall())
        meta = dict(rows)
        if meta.get("format") != FORMAT:
            raise SweepError(
                Issue(
                    str(self.folder), f"was written as format {meta.get('format')!r}, this is {FORMAT!r}; run it anew."
                )
            )
        return str(meta["plan"])

    @cached_property
    def plan(self) -> Plan:
        """The sweep as it was asked for."""
        return Plan.from_toml(self.text)

    def add(self, rows: Sequence[Stored]) -> None:
        """Write rows in one transaction: all of them or none.

        Raises
        ------
        OutputError
            If the disk is full or fails; nothing that was written before is lost.
        """
        marks = ", ".join("?" * (4 + len(self.plan.axes) + len(self.plan.outputs)))

        def write() -> None:
            with self._connection:
                self._connection.execute("BEGIN IMMEDIATE")
                self._connection.executemany(f"INSERT INTO rows VALUES ({marks})", rows)

        _said(self.folder, write)

    def counts(self) -> dict[str, int]:
        """How many rows there are of each status."""
        statement = "SELECT status, count(*) FROM rows GROUP BY status"
        found = dict(_said(self.folder, partial(self._fetched, statement)))
        return {status: int(found.get(status, 0)) for status in STATUSES}

    def missing(self) -> NDArray[np.bool_]:
        """(size,) whether a point of the plan has no row."""
        missing = np.ones(self.plan.size, dtype=np.bool_)
        for part in self._pages("point"):
            missing[[point for (point,) in part]] = False
        return missing

    def rows(self) -> Iterator[Row]:
        """Every row in order of its point, a few at a time in memory."""
        outputs, split = self.plan.outputs, len(self.plan.axes)
        for point, status, field, reason, *values in itertools.chain.from_iterable(self._pages("*")):
            given, found = values[:split], values[split:]
            numbers = (math.nan if value is None else float(value) for value in found)
            named = {axis.name: axis.typed(value) for axis, value in zip(self.plan.axes, given, strict=True)}
            yield Row(point, named, dict(zip(outputs, numbers, strict=True)), status, field, reason)

    def table(self) -> Table:
        """All rows as columns."""
        plan = self.plan
        count = sum(self.counts().values())
        point = np.empty(count, dtype=np.int64)
        outputs = np.full((len(plan.outputs), count), np.nan)
        words: list[tuple[str, str, str]] = []
        # A running sweep may grow meanwhile: what came after the count is left for the next look.
        first = itertools.islice(itertools.chain.from_iterable(self._pages("*")), count)
        seen: dict[str, str] = {}
        for at, (number, status, field, reason, *values) in enumerate(first):
            point[at] = number
            outputs[:, at] = [math.nan if v is None else v for v in values[len(plan.axes) :]]
            words.append((seen.setdefault(status, status), seen.setdefault(field, field), reason))
        # Reasons are long and often differ: an array of the longest one's width would take gigabytes.
        kinds = (np.str_, np.str_, np.object_)
        text: list[NDArray[Any]] = [np.array([row[i] for row in words], dtype=kind) for i, kind in enumerate(kinds)]
        named = dict(zip(plan.outputs, outputs, strict=True))
        return Table(point, plan.columns(point), named, text[0], text[1], text[2])

    def _pages(self, columns: str) -> Iterator[list[Any]]:
        """Rows in order of their point, some at a time; between them the file is free for the writer."""
        statement = f"SELECT {columns} FROM rows WHERE point > ? ORDER BY point LIMIT {_PAGE}"
        page: list[Any] = [(-1,)]
        while page := _said(self.folder, partial(self._fetched, statement, page[-1][0])):
            yield page

    def _fetched(self, statement: str, *given: Any) -> list[Any]:
        return self._connection.execute(statement, given).fetchall()

    def _make(self, plan: Plan) -> None:
        names = [axis.name for axis in plan.axes] + list(plan.outputs)
        columns = ", ".join('"' + name.replace('"', '""') + '"' for name in names)
        with self._connection:  # one transaction: a sweep is begun or it is not
            self._connection.execute("BEGIN IMMEDIATE")
            self._connection.execute("CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL)")
            self._connection.execute(
                "CREATE TABLE rows (point INTEGER PRIMARY KEY, status TEXT NOT NULL, field TEXT NOT NULL, "
                f"reason TEXT NOT NULL, {columns})"
            )
            meta = [("format", FORMAT), ("plan", plan.to_toml())]
            self._connection.executemany("INSERT INTO meta VALUES (?, ?)", meta)

    def _keep(self, plan: Plan) -> None:
        text = plan.to_toml()
        if text != self.text:
            with self._connection:
                self._connection.execute("BEGIN IMMEDIATE")
                self._connection.execute("UPDATE meta SET value = ? WHERE key = 'plan'", (text,))

    def refuse_other(self, plan: Plan) -> None:
        """Refuse a plan whose rows would be others than those of this sweep; its objectives may differ.

        Raises
        ------
        SweepError
            Line by line.
        """
        before, now = (sweep_file.without_objectives(text) for text in (self.text, plan.to_toml()))
        if before == now:
            return
        import difflib

        lines = [line for line in difflib.ndiff(before, now) if line[0] in "+-"]
        changed = "\n".join(f"  {line}" for line in lines)
        raise SweepError(
            Issue(
                str(self.folder),
                "holds another sweep than the file now asks for (- then, + now); change the file back, or choose "
                f"another folder with --out. Nothing was changed.\n{changed}",
            )
        )


def _connect(path: Path, mode: str) -> sqlite3.Connection:
    try:
        quoted = path.absolute().as_posix().replace("%", "%25").replace("?", "%3f").replace("#", "%23")
        connection = sqlite3.connect(f"file:{quoted}?mode={mode}", uri=True, timeout=_PATIENCE_S, isolation_level=None)
    except sqlite3.Error as error:
        raise _unwritable(path.parent, str(error)) from error
    _said(path.parent, lambda: connection.execute("PRAGMA synchronous = FULL"))
    return connection


def _locked(folder: Path) -> int | None:
    """A lock on the folder that the system lifts when this process ends, however it ends; None where there are none."""
    try:
        import fcntl
    except ImportError:
        return None
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise _unwritable(folder, error.strerror or str(error)) from error
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise SweepError(
            Issue(str(folder), "is being written by another sweep; wait for it, or choose another folder with --out.")
        ) from None
    except OSError:  # a file system without locks; rows are unique all the same
        os.close(handle)
        return None
    return handle


def _said(folder: Path, work: Any) -> Any:
    """What `work` gives; what SQLite finds wrong becomes a sentence."""
    try:
        return work()
    except sqlite3.IntegrityError as error:
        raise OutputError(Issue(str(folder), f"already has a row that was to be written ({error}).")) from error
    except sqlite3.DatabaseError as error:
        text = str(error)
        if "disk is full" in text or "disk I/O error" in text:
            remedy = "make room, then go on with --resume. What was written is safe"
            raise OutputError(Issue(str(folder), f"cannot be written any further ({text}); {remedy}.")) from error
        if "not a database" in text or "malformed" in text or "no such table" in text:
            raise SweepError(Issue(str(folder / FILE), f"is no sweep's file ({text}).")) from error
        raise _unwritable(folder, text) from error


def _unwritable(folder: Path, reason: str) -> OutputError:
    return OutputError(Issue(str(folder), f"cannot be written ({reason}); choose another folder with --out."))
