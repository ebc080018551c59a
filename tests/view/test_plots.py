"""Plots of boards and sweeps, drawn from small data that stand here: the figures are compared whole with approved ones.

An approved figure lists its lines, areas, marks and texts with their data, scales and styles. Where a number in it
follows from the data, it was compared with them when it was approved.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.board.analysis.tolerance import ResponseBand, compute_response_band, draw_response
from fingertip.design import Design
from fingertip.sweep.report import plots as sweep_plots
from fingertip.sweep.report.feasibility_plot import draw_feasibility
from fingertip.sweep.report.statistics import AxisSensitivity, OutputSensitivity, PointClasses
from fingertip.sweep.report.summary import Objective
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


@plot
def heat_map() -> None:
    columns = make_columns()
    axes = {name: columns[name] for name in ("skin.width_mm", "board.cutoff_hz", "board.series")}
    for minimise in (True, False):
        sweep_plots.draw_heat_map(
            axes, "skin.width_mm", "board.cutoff_hz", "delay", columns["delay"], find_feasible(columns), minimise
        )
    grid, rows = (values.ravel() for values in np.meshgrid([1.0, 2.0, 4.0], [5.0, 6.0]))
    few = {"x": grid, "y": rows}
    sweep_plots.draw_heat_map(few, "x", "y", "delay", grid * rows, grid + rows < 10.0, None)


@plot
def sensitivities() -> None:
    rows = [("delay", 0.7, 0.95, 0.2, -0.4), ("a_long_name_of_an_output_in_mm", 0.0, math.nan, 0.1, 0.05)]
    found = [
        OutputSensitivity(
            name, 60, 0.01, (AxisSensitivity("skin.width_mm", a, b), AxisSensitivity("board.cutoff_hz", c, d))
        )
        for name, a, b, c, d in rows
    ]
    sweep_plots.draw_sensitivities(found, ["skin.width_mm", "board.cutoff_hz", "board.series"])


@plot
def pareto_front() -> None:
    x = np.linspace(1.0, 3.0, 9)
    y = np.where(np.arange(9) % 2, 9.0 / x, 12.0 / x)
    for extra in ((), (Objective("force", 1),)):
        sweep_plots.draw_pareto_front(
            [Objective("delay", 1), Objective("area", -1), *extra], (x, y), np.array([5, 1, 3]), 3
        )


@plot
def feasibility() -> None:
    columns = make_columns()
    names = ("feasible", "skin.width_mm", "failed", "mold.wall_mm", *(f"field_{i}" for i in range(9)))
    classes = PointClasses(names, np.where(find_feasible(columns), 0, 1 + np.arange(100) % 12))
    axes = {name: columns[name] for name in ("skin.width_mm", "board.cutoff_hz", "board.series")}
    draw_feasibility(axes, classes, [*axes])
    draw_feasibility(axes, classes, ["board.cutoff_hz", "skin.width_mm"])
    grid, rows = (values.ravel() for values in np.meshgrid(np.arange(10.0), np.arange(10.0)))
    draw_feasibility({"x": grid, "y": rows}, classes, ["y", "x"])


@pytest.mark.every_case
@pytest.mark.parametrize("name", PLOTS)
def test_plot_is_the_approved_one(name: str) -> None:
    require_module("matplotlib")
    with keep_figures() as figures:
        PLOTS[name]()
    assert figures
    check_figures(APPROVED / f"plot_{name}.txt", (line for figure in figures for line in describe_figure(figure)))
