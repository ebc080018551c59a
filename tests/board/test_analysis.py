"""Analysis without a simulator, compared with formulas, ngspice and independent computations."""

from __future__ import annotations

import csv
import io
import json
import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis import tolerance
from fingertip.board.analysis.report import analyse, bode_table
from fingertip.board.analysis.response import decibel, find_passband, model_filter, search_band_hz
from fingertip.board.analysis.tolerance import (
    BAND_QUANTILES,
    COMPONENTS,
    QUANTITIES,
    ResponseBand,
    TolerancedFilter,
    compute_response_band,
    compute_sensitivities,
    draw_deviations,
    monte_carlo,
)
from fingertip.board.circuits.network import build_network
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import parse_component_value
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.documents.board.analysis import analysis_text
from fingertip.foundation.files import format_figure
from tests.conftest import run_fingertip
from tests.designs import ARTICLE, ARTICLE_OPTIONS, load_article
from tests.oracles.filter_formulas import filter_transfer, open_loop_transfer, overall_cutoff_hz
from tests.tools import require_module

VALUES = board_values(ARTICLE)


def test_bode_table_agrees_with_the_formulas() -> None:
    rows = list(csv.DictReader(io.StringIO(bode_table(ARTICLE))))
    assert len(rows) == 201
    assert (float(rows[0]["frequency_hz"]), float(rows[-1]["frequency_hz"])) == (1.0, 1e5)
    for row in rows[::20]:
        f = float(row["frequency_hz"])
        assert float(row["whole_db"]) == pytest.approx(decibel(filter_transfer(f, VALUES.preferred, 4e6)), abs=2e-3)
        assert float(row["stage1_db"]) + float(row["stage2_db"]) == pytest.approx(float(row["whole_db"]), abs=2e-4)
        # Between the amplifier's corner frequency and its gain-bandwidth product, as in the article's figure.
        if f > 100:
            assert float(row["gbw_over_f_db"]) == pytest.approx(decibel(open_loop_transfer(f, 4e6)), abs=0.1)
            assert float(row["whole_db"]) < float(row["gbw_over_f_db"])


def toleranced_filter(design: Design, bandwidth_hz: float | None = None) -> TolerancedFilter:
    circuit, board = board_circuit(board_values(design)), design.board
    network = build_network(circuit, bandwidth_hz or find_gain_bandwidth_hz(board))
    return TolerancedFilter(model_filter(circuit, board.variant == "article"), network.values)


FILTER = toleranced_filter(ARTICLE)
TOLERANCE = {name: 1.0 if name.startswith("R") else 5.0 for name in COMPONENTS[:8]}


@pytest.mark.full
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_quantities_of_random_boards_agree_with_the_circuits_equations(name: str) -> None:
    """Random values within 5 % are put into the circuit, whose equations give the gain."""
    design = load_article((*BOARD_CONFIGURATIONS[name].changes, "board.band_limit_hz=270"))
    board, circuit = toleranced_filter(design), board_circuit(board_values(design))
    rng = np.random.default_rng(4)
    f = np.geomspace(20, 20e3, 6001)
    for deviations in 0.05 * rng.uniform(-1, 1, (5, len(board.names))):
        drawn = circuit
        for reference, deviation in zip(board.names, deviations.tolist(), strict=True):
            value = parse_component_value(circuit.component(reference).value) * (1 + deviation)
            drawn = drawn.replace(reference, f"{value:.12g}")
        path = build_network(drawn, find_gain_bandwidth_hz(design.board)).drive("TACTILE").restrict("FILTERED")
        gain = np.abs(path.response(f, {"TACTILE": 1.0}, "FILTERED")[:, 0])
        passband = f[gain >= gain.max() / math.sqrt(2)]
        quantities = board.quantities(deviations)
        assert float(quantities["passband_gain"]) == pytest.approx(float(gain.max()), rel=1e-5)
        assert float(quantities["cutoff_hz"]) == pytest.approx(float(passband[0]), rel=1.5e-3)


def test_monte_carlo_agrees_with_scalar_formulas_board_by_board() -> None:
    """Both are estimates of the same spread, within their statistical errors."""
    rng = random.Random(5)
    base = [VALUES.by_reference[name] for name in FILTER.names]
    cutoffs = []
    for _ in range(4000):
        r1, r2, r3, _, _, c1, c2, c3 = (
            v * (1 + (0.01 if i < 5 else 0.05) * rng.uniform(-1, 1)) for i, v in enumerate(base)
        )
        f0 = 1 / (2 * math.pi * math.sqrt(r2 * r3 * c2 * c3))
        q = math.sqrt(r3 / r2) * math.sqrt(c2 * c3) / (c2 + c3)
        cutoffs.append(overall_cutoff_hz(1 / (2 * math.pi * r1 * c1), f0, q))
    mean = math.fsum(cutoffs) / len(cutoffs)
    deviation = math.sqrt(math.fsum((f - mean) ** 2 for f in cutoffs) / (len(cutoffs) - 1))
    spread = monte_carlo(FILTER, TOLERANCE)["cutoff_hz"]
    assert spread.mean == pytest.approx(mean, abs=5 * deviation / math.sqrt(4000))
    assert spread.deviation == pytest.approx(deviation, rel=0.06)
    assert spread.worst_low < min(cutoffs) < spread.low_95 < spread.high_95 < max(cutoffs) < spread.worst_high


def test_monte_carlo_is_reproducible_and_exact_without_tolerances() -> None:
    first = monte_carlo(FILTER, TOLERANCE)
    assert first == monte_carlo(FILTER, TOLERANCE)
    assert first != monte_carlo(FILTER, TOLERANCE, seed=2)
    exact = monte_carlo(FILTER, dict.fromkeys(COMPONENTS, 0.0), boards=10)["cutoff_hz"]
    assert exact.deviation < 1e-9
    assert exact.low_95 == exact.worst_high == exact.nominal


def test_sensitivities_satisfy_dimensional_analysis() -> None:
    """Raising all resistors, or all capacitors, by 1 % lowers all frequencies by 1 % for a fast amplifier."""
    sensitivities = compute_sensitivities(toleranced_filter(ARTICLE, 1e9))
    for name in ("cutoff_hz", "section_hz", "first_pole_hz"):
        assert sum(sensitivities[name][component] for component in ("R1", "R2", "R3")) == pytest.approx(-1, abs=2e-5)
        assert sum(sensitivities[name][component] for component in ("C1", "C2", "C3")) == pytest.approx(-1, abs=2e-5)
    assert (
        sensitivities["section_quality"]["R3"]
        == -sensitivities["section_quality"]["R2"]
        == pytest.approx(0.5, abs=1e-5)
    )
    assert list(sensitivities["passband_gain"]) == list(COMPONENTS[:8])


def test_analysis_command_prints_tables_and_writes_the_bode_table(tmp_path: Path) -> None:
    table = tmp_path / "bode.csv"
    run = run_fingertip(
        "board", *ARTICLE_OPTIONS, "--analysis", "--bode", table, "--json", "--quiet", "--out", tmp_path / "pcb"
    )
    assert (run.returncode, run.stderr) == (0, "")
    data = json.loads(run.stdout)
    assert set(data["analysis"]["spread"]) == set(QUANTITIES)
    assert table.read_text().startswith("frequency_hz,")
    assert str(table) in data["files"]
    text = run_fingertip("board", *ARTICLE_OPTIONS, "--analysis", "--quiet", "--out", tmp_path / "pcb").stdout
    assert analysis_text(analyse(ARTICLE)).strip() in text


def test_tolerances_are_those_of_the_parts() -> None:
    """With C1 to C3 of twice the article's tolerance the cutoff spreads almost twice as much."""
    analysis = analyse(ARTICLE, boards=2000)
    assert analysis.component_percent == {name: 1.0 if name[0] == "R" else 10.0 for name in COMPONENTS[:8]}
    own, article = (spread["cutoff_hz"] for spread in (analysis.spread, analysis.article_spread))
    assert 1.7 < own.deviation / article.deviation < 2.0
    assert own.worst_low < article.worst_low < article.worst_high < own.worst_high
    stated = analyse(load_article(["board.capacitor_tolerance_percent=5"]), boards=2000)
    assert stated.spread == stated.article_spread == analysis.article_spread


def test_alias_attenuation_of_the_default_board() -> None:
    a = board_values(ARTICLE).aliasing
    assert (a.band_hz, a.nyquist_hz, a.alias_hz) == (201.0, 1000.0, 1799.0)
    assert a.lsb_v == 20 / 65536
    # A swing of 3.5 V against a step of 0.305 mV.
    assert a.required_db == pytest.approx(20 * math.log10(3.5 * 65536 / 20), rel=1e-12)
    assert a.one_lsb_tone_v * 10 ** (a.tactile_alias_db / 20) == pytest.approx(a.lsb_v, rel=1e-12)
    assert -1.7 < a.tactile_band_db < -1.5  # slip ends below 100 Hz in the embedded finger: 0.4 dB
    precision = board_values(load_article(["board.variant=precision"])).aliasing
    envelope_pole_db = -10 * math.log10(1 + (1000 / 36.17) ** 2)
    assert precision.envelope_nyquist_db - a.envelope_nyquist_db == pytest.approx(envelope_pole_db, abs=0.01)


# Band of the response and its plot


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


def test_plot_shows_the_band(band: ResponseBand, monkeypatch: pytest.MonkeyPatch) -> None:
    """Curves, area, marks and texts are read back from the figure."""
    require_module("matplotlib")
    drawn: list[Any] = []
    monkeypatch.setitem(tolerance.FORMATS, ".svg", lambda figure: drawn.append(figure) or b"")
    tolerance.draw_response(band, "title", ".svg")
    (axes,) = drawn[0].axes
    level_db = decibel(band.nominal.max()) - 10 * math.log10(2)
    target, nominal, level, *marks = ((line.get_xdata(), line.get_ydata()) for line in axes.lines)
    for curve, magnitude in ((target, band.target), (nominal, band.nominal)):
        assert np.array_equal(curve[0], band.f_hz)
        assert 10 ** (curve[1] / 20) == pytest.approx(magnitude)
    area, *ends = axes.collections
    expected = {
        (f, round(decibel(v), 9)) for each in (band.low, band.high) for f, v in zip(band.f_hz, each, strict=True)
    }
    assert {(x, round(y, 9)) for x, y in area.get_paths()[0].vertices} == expected
    assert [*level[1], *(y for _, (y,) in marks)] == pytest.approx([level_db] * 4)
    assert [x for (x,), _ in marks] == [band.lower_hz, band.upper_hz]
    for each, ends_hz in zip(ends, (band.lower_ends_hz, band.upper_ends_hz), strict=True):
        assert each.get_segments()[0] == pytest.approx(np.array([(hz, level_db) for hz in ends_hz]))
    top_db = decibel(band.nominal.max())
    assert (axes.get_xscale(), *axes.get_xlim()) == ("log", band.f_hz[0], band.f_hz[-1])
    assert axes.get_ylim() == pytest.approx((top_db - 25, top_db + 8)), "nothing is cut off that tells boards apart"
    said = [text.get_text() for text in (*axes.texts, *axes.get_legend().get_texts())]
    for text, hz, ends_hz in zip(
        said, (band.lower_hz, band.upper_hz), (band.lower_ends_hz, band.upper_ends_hz), strict=False
    ):
        low, high = (format_figure(end, 3) for end in ends_hz)
        assert text == f"−3 dB at {format_figure(hz)} Hz\n95 %: {low} to {high} Hz"
    assert all(words in " ".join(said[2:]) for words in ("C1, C2, C3", "95 % of boards", "Butterworth, third order"))


@pytest.mark.full
@pytest.mark.parametrize(("suffix", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml")])
def test_command_writes_the_same_plot_twice(tmp_path: Path, suffix: str, start: bytes) -> None:
    require_module("matplotlib")
    plot, data = tmp_path / f"a{suffix}", set()
    for _ in range(2):
        run = run_fingertip("board", "--out", tmp_path / "pcb", "--plot", plot, "--json", "--force")
        assert plot.as_posix() in json.loads(run.stdout)["files"], run.stderr
        data.add(plot.read_bytes())
    (once,) = data
    assert once.startswith(start)
    assert b"<dc:date>" not in once
