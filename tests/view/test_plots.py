"""Plots of boards and sweeps, drawn from small data that stand here: the figures are compared whole with approved ones.

An approved figure lists its lines, areas, marks and texts with their data, scales and styles. Where a number in it
follows from the data, it was compared with them when it was approved.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.board.analysis.tolerance import ResponseBand, compute_response_band, draw_response
from fingertip.design import Design
from fingertip.sweep.report import plots as sweep_plots
from tests.approved import check_figures
from tests.figures import describe_figure, keep_figures
from tests.tools import require_module

APPROVED = Path(__file__).parent / "approved"
DESIGN = Design(board={"variant": "precision"})
PLOTS: dict[str, Callable[[], Any]] = {}


def plot(function: Callable[[], Any]) -> Callable[[], Any]:
    PLOTS[function.__name__] = function
    return function


# Board


@plot
def board() -> None:
    f_hz = np.logspace(1.0, 6.0, 51)
    target = 100.0 / np.sqrt(1.0 + (67.0 / f_hz) ** 6)
    nominal = 1.01 * target / np.sqrt(1.0 + (f_hz / 3e4) ** 2)
    percent = {"R1": 1.0, "C1": 5.0, "C2": 5.0}
    band = ResponseBand(
        f_hz, target, nominal, 0.9 * nominal, 1.1 * nominal, 67.0, 66.5, (63.1, 70.2), 3.01e4, (2.5e4, 3.5e4), percent
    )
    draw_response(band, "board", ".svg")
    draw_response(compute_response_band(DESIGN, 20), "20 boards", ".png")


# Sweeps


def make_columns() -> dict[str, Any]:
    """Points with two numbers, one of them logarithmic, a category and an output."""
    rng = np.random.default_rng(0)
    width, cutoff = rng.uniform(15.0, 23.0, 100), 10.0 ** rng.uniform(1.0, 3.0, 100)
    series = np.array(["E12", "E96"], dtype=object)[np.arange(100) % 2]
    return {"skin.width_mm": width, "board.cutoff_hz": cutoff, "board.series": series, "delay": width + 900.0 / cutoff}


def find_feasible(columns: dict[str, Any]) -> Any:
    return columns["skin.width_mm"] > 17.0


@plot
def scatter_matrix() -> None:
    columns = make_columns()
    sweep_plots.draw_scatter_matrix(columns, find_feasible(columns), ["force_n"])


@pytest.mark.every_case
@pytest.mark.parametrize("name", PLOTS)
def test_plot_is_the_approved_one(name: str) -> None:
    require_module("matplotlib")
    with keep_figures() as figures:
        PLOTS[name]()
    assert figures
    check_figures(APPROVED / f"plot_{name}.txt", (line for figure in figures for line in describe_figure(figure)))
