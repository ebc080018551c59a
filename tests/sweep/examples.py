"""Small plans, tables and a database of sweeps, and an engine without processes, for the tests."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import numpy as np
from click.testing import Result
from numpy.typing import ArrayLike
from typer.testing import CliRunner

from fingertip.cli import app
from fingertip.sweep.database import SweepDatabase, SweepRow, SweepTable
from fingertip.sweep.sweep_plan import SweepPlan

BOARD: dict[str, Any] = {
    "name": "boards",
    "outputs": ["q", "cutoff_3db_hz", "board.r2_ohm"],
    "axes": {
        "board.cutoff_hz": {"low": 20.0, "high": 2000.0, "steps": 12, "spacing": "logarithmic"},
        "board.capacitor_uf": [0.01, 1.0, 1000.0],
        "board.series": ["E12", "E96"],
    },
}
"""Tables of a sweep of 72 boards; points with the large capacitors break a rule."""


def make_plan(**changes: Any) -> SweepPlan:
    return SweepPlan.from_tables({**BOARD, **changes})


def make_table(
    axes: dict[str, Any],
    outputs: dict[str, Any],
    status: ArrayLike,
    field: Sequence[str],
    reason: Sequence[str],
) -> SweepTable:
    axis_columns = {name: np.asarray(column) for name, column in axes.items()}
    output_columns = {name: np.asarray(column, dtype=float) for name, column in outputs.items()}
    points = np.arange(len(np.asarray(status)))
    reasons = np.asarray(reason, dtype=np.object_)
    return SweepTable(
        points, axis_columns, output_columns, np.asarray(status), np.asarray(field), reasons
    )


class InlineEngine:
    """Engine without processes: each task runs at once, in this process.

    Tests of failures override `submit`.
    """

    description = "workers in this process"
    attempts = 1
    workers = 1

    def __init__(self, jobs: int = 1) -> None:
        pass

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(function(*arguments))
        except Exception as error:
            future.set_exception(error)
        return future

    def close(self) -> None:
        pass


def run_sweep_command(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["sweep", *map(str, arguments)])


def read_rows(folder: Path) -> list[SweepRow]:
    with SweepDatabase.open(folder) as database:
        return list(database.rows())
