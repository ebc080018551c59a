"""Plot of a sweep, drawn from small data that stand here: the
figure is compared whole with an approved one.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fingertip.sweep.report import plots
from tests.approved import check_figures
from tests.figures import describe_figure, keep_figures
from tests.tools import require_module


def test_scatter_matrix_is_the_approved_one() -> None:
    """Points with two numbers, one of them logarithmic, a category and an output."""
    require_module("matplotlib")
    rng = np.random.default_rng(0)
    width = rng.uniform(15.0, 23.0, 100)
    cutoff = 10.0 ** rng.uniform(1.0, 3.0, 100)
    series = np.array(["E12", "E96"], dtype=object)[np.arange(100) % 2]
    columns = {
        "skin.width_mm": width,
        "board.cutoff_hz": cutoff,
        "board.series": series,
        "delay": width + 900.0 / cutoff,
    }
    with keep_figures() as figures:
        plots.draw_scatter_matrix(columns, width > 17.0, ["force_n"])
    assert figures
    path = Path(__file__).parent / "approved" / "plot_scatter_matrix.txt"
    check_figures(path, (line for figure in figures for line in describe_figure(figure)))
