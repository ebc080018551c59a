"""Plots of sweeps, drawn from small data that stand here: the figures are compared whole with approved ones.

An approved figure lists its lines, areas, marks and texts with their data, scales and styles. Where a number in it
follows from the data, it was compared with them when it was approved.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.sweep.report import plots as sweep_plots
from tests.approved import check_figures
from tests.figures import describe_figure, keep_figures
from tests.tools import require_module

APPROVED = Path(__file__).parent / "approved"
PLOTS: dict[str, Callable[[], Any]] = {}


def plot(function: Callable[[], Any]) -> Callable[[], Any]:
    PLOTS[function.__name__] = function
    return function


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
