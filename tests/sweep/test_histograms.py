"""Histograms and heading of the scatter matrix: no comb that is not in the data, no line wider than the figure."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.sweep.report.feasibility_plot import histogram_edges, make_scale
from fingertip.sweep.report.plots import _CHARACTER_IN, _write_heading, draw_scatter_matrix
from tests.tools import require_module


@pytest.mark.parametrize("count", [5, 24, 25, 37, 40, 100, 239])
def test_equally_frequent_numbers_give_a_flat_histogram(count: int) -> None:
    values = np.repeat(np.arange(1.0, count + 1), 50)
    scale = make_scale("x", values, 24)
    edges = histogram_edges(values, scale, 24)
    heights = np.histogram(values, edges)[0]
    assert heights.sum() == len(values)
    assert len(heights) <= 24
    density = heights / np.diff(edges)
    assert density.max() / density.min() == pytest.approx(1.0)
    comb = np.histogram(values, np.linspace(scale.edges[0], scale.edges[-1], 25))[0]
    if count in (37, 40):
        assert comb.max() >= 1.9 * comb.min()  # what bins of equal width would show


def test_preferred_values_on_a_logarithmic_scale() -> None:
    values = np.repeat(10 ** (np.arange(60) / 24), 7)
    scale = make_scale("x", values, 24)
    assert scale.log
    edges = histogram_edges(values, scale, 24)
    density = np.histogram(values, edges)[0] / np.diff(np.log(edges))
    assert density.max() / density.min() == pytest.approx(1.0)


def test_continuous_values_have_bins_of_equal_width() -> None:
    values = np.random.default_rng(0).uniform(0, 1, 5000)
    edges = histogram_edges(values, make_scale("x", values, 24), 24)
    assert len(edges) == 25
    assert np.diff(edges) == pytest.approx(np.diff(edges)[0])
    assert np.histogram(values, edges)[0].sum() == len(values)


@pytest.mark.parametrize("width_in", [3.4, 5.8, 8.2, 15.0])
def test_no_line_of_the_heading_is_cut_off(width_in: float) -> None:
    require_module("matplotlib")
    from fingertip.foundation.plot_style import new_figure

    lines = _write_heading(2000, 4096, ["amplifier_bandwidth_hz", "board.r2_ohm", "board.r3_ohm"], width_in)
    assert " ".join(lines).count("board.r3_ohm") == 1
    figure = new_figure(width_in, 2.0, automatic_layout=False)
    text = figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=9)
    assert text.get_window_extent().x1 <= figure.bbox.width
    assert max(map(len, lines)) <= width_in / _CHARACTER_IN


def test_a_small_matrix_is_drawn() -> None:
    require_module("matplotlib")
    rows = np.arange(40.0)
    data = draw_scatter_matrix({"x": rows, "y": np.sqrt(rows)}, rows > 7, ["left"])
    assert data.startswith(b"\x89PNG")
