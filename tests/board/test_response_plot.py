"""Band of the response: nominal board and random ones against the network, cutoffs, and the plot."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis import tolerance
from fingertip.board.analysis.report import analyse
from fingertip.board.analysis.response import find_passband, model_filter, search_band_hz
from fingertip.board.analysis.tolerance import (
    BAND_QUANTILES,
    ResponseBand,
    TolerancedFilter,
    compute_response_band,
    draw_deviations,
)
from fingertip.board.circuits.network import build_network
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from tests.conftest import run_fingertip
from tests.designs import load_article
from tests.tools import require_module

NAMES = ("article_split", "precision_single_3v3")


@pytest.fixture(scope="module", params=NAMES)
def design(request: pytest.FixtureRequest) -> Design:
    return load_article(BOARD_CONFIGURATIONS[request.param].changes)


@pytest.fixture(scope="module")
def band(design: Design) -> ResponseBand:
    return compute_response_band(design)


def test_target_is_a_butterworth_of_third_order(design: Design, band: ResponseBand) -> None:
    gain, cutoff_hz = design.board.passband_gain, design.board.cutoff_hz
    assert band.target_cutoff_hz == cutoff_hz
    s = 1j * band.f_hz / cutoff_hz
    expected = gain * np.abs(s**3 / ((s + 1) * (s**2 + s + 1)))  # its poles, not its magnitude
    assert band.target == pytest.approx(expected, rel=1e-12)
    assert np.interp(cutoff_hz, band.f_hz, band.target) == pytest.approx(gain / np.sqrt(2), rel=1e-3)


def test_cutoffs_are_those_of_the_analysis(design: Design, band: ResponseBand) -> None:
    spread = analyse(design).spread["cutoff_hz"]
    assert band.lower_ends_hz == (spread.low_95, spread.high_95)
    achieved = board_values(design).achieved_response
    assert band.lower_hz == pytest.approx(achieved.cutoff_hz, rel=1e-9)
    assert band.upper_hz == pytest.approx(achieved.upper_cutoff_hz, rel=1e-9)


def test_upper_cutoffs_are_those_of_single_boards(design: Design) -> None:
    boards = 40
    band = compute_response_band(design, boards, seed=3)
    circuit = board_circuit(board_values(design))
    network = build_network(circuit, find_gain_bandwidth_hz(design.board))
    toleranced = TolerancedFilter(model_filter(circuit, design.board.variant == "article"), network.values)
    deviations = draw_deviations(toleranced, band.percent, boards, 3)
    found = []
    for board in deviations:
        values = toleranced.deviate(board)
        found.append(find_passband(toleranced.model.transfer(values), search_band_hz(toleranced.model, values)).high_hz)
    assert band.upper_ends_hz == pytest.approx(tuple(np.quantile(found, BAND_QUANTILES)), rel=1e-6)


@pytest.mark.full
@pytest.mark.parametrize(("suffix", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml")])
def test_command_writes_the_same_plot_twice(tmp_path: Path, suffix: str, start: bytes) -> None:
    require_module("matplotlib")
    plots = [tmp_path / f"{name}{suffix}" for name in "ab"]
    for plot in plots:
        run = run_fingertip("board", "--out", tmp_path / "pcb", "--plot", plot, "--json")
        assert run.returncode == 0, run.stderr
        assert plot.as_posix() in json.loads(run.stdout)["files"]
    data = plots[0].read_bytes()
    assert data.startswith(start)
    assert data == plots[1].read_bytes()
    assert b"<dc:date>" not in data


def test_figures_stand_in_the_plot(band: ResponseBand, monkeypatch: pytest.MonkeyPatch) -> None:
    require_module("matplotlib")
    texts: list[str] = []

    def read(figure: Any) -> bytes:
        (axes,) = figure.axes
        texts.extend(text.get_text() for text in (*axes.texts, *axes.get_legend().get_texts()))
        return b""

    monkeypatch.setitem(tolerance.FORMATS, ".svg", read)
    tolerance.draw_response(band, "title", ".svg")
    low_hz, high_hz = band.lower_ends_hz
    assert f"−3 dB at {band.lower_hz:.2f} Hz\n95 %: {low_hz:.3g} to {high_hz:.3g} Hz" in texts
    assert all(words in " ".join(texts) for words in ("C1, C2, C3", "95 % of boards"))
