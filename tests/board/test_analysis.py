"""Analysis without a simulator, against formulas, ngspice, and itself said otherwise."""

from __future__ import annotations

import csv
import io
import json
import math
import random
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.analyse import analyse, bode_table
from fingertip.board.analysis.equations import equations
from fingertip.board.values.built import first_stage, network, open_loop
from fingertip.board.values.figures import FIGURES, NAMES, figures, monte_carlo, names, nominal, sensitivities
from fingertip.board.values.filters import decibel, overall_cutoff_hz, response
from fingertip.board.variants import VARIANTS
from fingertip.design import Design
from tests.board.ngspice import simulate
from tests.board.test_spice import deck_of
from tests.conftest import run_fingertip

VALUES = board_values(Design())
CIRCUIT = board_circuit(VALUES)


@pytest.mark.parametrize("name", VARIANTS)
def test_bode_of_the_circuit_is_the_formulas(name: str) -> None:
    """Of every variant, against where signals rest; and the resistors' middle stays where it is."""
    f = np.logspace(0, 5, 101)
    values = board_values(Design.load(changes=VARIANTS[name].changes))
    system = equations(board_circuit(values), 3e6, 1e-4, "TACTILE")
    wanted = np.array([network(float(x), values.preferred, 3e6, values.first_stage) for x in f])
    assert np.max(np.abs(system.response(f, "FILTERED") / wanted - 1)) < 1e-9
    first = np.array([first_stage(float(x), values.preferred, 3e6, values.first_stage) for x in f])
    assert np.max(np.abs(system.response(f, "STAGE1_OUT") / first - 1)) < 1e-9
    if name.endswith("single"):
        assert np.max(np.abs(system.response(f, "VMID"))) < 1e-12


def test_bode_table() -> None:
    rows = list(csv.DictReader(io.StringIO(bode_table(Design()))))
    assert len(rows) == 201
    assert (float(rows[0]["frequency_hz"]), float(rows[-1]["frequency_hz"])) == (1.0, 1e5)
    for row in rows[::20]:
        f = float(row["frequency_hz"])
        assert float(row["whole_db"]) == pytest.approx(decibel(network(f, VALUES.preferred, 3e6)), abs=2e-3)
        assert float(row["stage1_db"]) + float(row["stage2_db"]) == pytest.approx(float(row["whole_db"]), abs=2e-4)
        # Between the amplifier's corner and its gain-bandwidth, as the article draws it.
        if f > 100:
            assert float(row["open_loop_db"]) == pytest.approx(decibel(open_loop(f, 3e6)), abs=0.1)
            assert float(row["whole_db"]) < float(row["open_loop_db"])


@pytest.mark.parametrize(
    "changes", [(), ("board.cutoff_hz=90", "board.band_limit_hz=270"), ("board.passband_gain=300",)]
)
@pytest.mark.parametrize("name", VARIANTS)
def test_figures_of_the_fitted_values_are_the_achieved_ones(name: str, changes: tuple[str, ...]) -> None:
    """So what is achieved lies within what tolerances make of it."""
    design = Design.load(changes=(*VARIANTS[name].changes, *changes))
    values = board_values(design)
    found = analyse(design, boards=500).spread
    for figure in FIGURES:
        achieved, spread = getattr(values.achieved, figure), found[figure]
        assert spread.nominal == pytest.approx(achieved, rel=1e-9)
        assert spread.worst_low < spread.low_95 < achieved < spread.high_95 < spread.worst_high


def test_without_the_amplifiers_end_the_figures_are_the_formulas() -> None:
    found, wanted = figures(nominal(VALUES.preferred), 1e12), response(VALUES.preferred, 1e12)
    for name in FIGURES:
        assert float(found[name]) == pytest.approx(getattr(wanted, name), rel=4e-4)  # 1 / A0 times the gain is left


@pytest.mark.parametrize("name", VARIANTS)
def test_any_boards_figures_are_the_circuits(name: str) -> None:
    """Parts drawn within 5 %, put into the circuit itself, whose equations give the gain."""
    values = board_values(Design.load(changes=(*VARIANTS[name].changes, "board.band_limit_hz=270")))
    base, called = nominal(values.preferred, values.first_stage), names(values.first_stage)
    rng = np.random.default_rng(4)
    f = np.geomspace(20, 20e3, 6001)
    for drawn in base * (1 + 0.05 * rng.uniform(-1, 1, (5, len(base)))):
        circuit = board_circuit(values)
        fitted = dict(zip(called, drawn, strict=True))
        parts = (replace(p, value=f"{fitted[p.reference]:.12g}") if p.reference in fitted else p for p in circuit.parts)
        system = equations(replace(circuit, parts=tuple(parts)), 3e6, 1e-4, "TACTILE")
        gain = np.abs(system.response(f, "FILTERED"))
        passed = f[gain >= gain.max() / math.sqrt(2)]
        found = figures(drawn, 3e6)
        assert float(found["passband_gain"]) == pytest.approx(float(gain.max()), rel=1e-5)
        assert float(found["cutoff_hz"]) == pytest.approx(float(passed[0]), rel=1.5e-3)


def test_unequal_capacitors_by_the_network(tmp_path: Path) -> None:
    """The cutoff with three different capacitors, looked up in ngspice's own sweep."""
    _, deck = deck_of(tmp_path, [])
    for name, value in {"C1 tactile stage1_in": "1.05u", "C2 stage1_out stage2_mid": "0.93u",
                        "C3 stage2_mid stage2_in": "1.08u"}.items():  # fmt: skip
        assert f"{name} 1u" in deck
        deck = deck.replace(f"{name} 1u", f"{name} {value}")
    rows = simulate(tmp_path, deck, "ac dec 5000 50 3000\nwrdata out vr(tactile) vi(tactile) vr(filtered) vi(filtered)")
    gain = [(f, abs(complex(fr, fi) / complex(tr, ti))) for f, tr, ti, fr, fi in rows]
    level = max(g for _, g in gain) / math.sqrt(2)
    crossing = next(f for f, g in gain if g >= level)
    values = nominal(VALUES.preferred) * np.array([1, 1, 1, 1, 1, 1.05, 0.93, 1.08])
    assert float(figures(values, 3e6)["cutoff_hz"]) == pytest.approx(crossing, rel=1e-3)


def test_monte_carlo_against_drawing_one_by_one() -> None:
    """Plain Python, one board after the other, with the scalar formulas; both are estimates of the same spread."""
    draw = random.Random(5)
    base = [float(v) for v in nominal(VALUES.preferred)]
    found = []
    for _ in range(4000):
        r1, r2, r3, _, _, c1, c2, c3 = (
            v * (1 + (0.01 if i < 5 else 0.05) * draw.uniform(-1, 1)) for i, v in enumerate(base)
        )
        f0 = 1 / (2 * math.pi * math.sqrt(r2 * r3 * c2 * c3))
        q = math.sqrt(r3 / r2) * math.sqrt(c2 * c3) / (c2 + c3)
        found.append(overall_cutoff_hz(1 / (2 * math.pi * r1 * c1), f0, q))
    mean = math.fsum(found) / len(found)
    deviation = math.sqrt(math.fsum((f - mean) ** 2 for f in found) / (len(found) - 1))
    spread = monte_carlo(VALUES.preferred, 3e6, None, 1.0, 5.0)["cutoff_hz"]
    assert spread.mean == pytest.approx(mean, abs=5 * deviation / math.sqrt(4000))
    assert spread.deviation == pytest.approx(deviation, rel=0.06)
    assert spread.worst_low < min(found) < spread.low_95 < spread.high_95 < max(found) < spread.worst_high


def test_monte_carlo_repeats_and_shrinks() -> None:
    one = monte_carlo(VALUES.preferred, 3e6, None, 1.0, 5.0)
    assert one == monte_carlo(VALUES.preferred, 3e6, None, 1.0, 5.0)
    assert one != monte_carlo(VALUES.preferred, 3e6, None, 1.0, 5.0, seed=2)
    exact = monte_carlo(VALUES.preferred, 3e6, None, 0.0, 0.0, boards=10)["cutoff_hz"]
    assert exact.deviation < 1e-9
    assert exact.low_95 == exact.worst_high == exact.nominal


def test_sensitivities_follow_from_dimensions() -> None:
    """Every resistor up by 1 % lowers all frequencies by 1 %, and so does every capacitor, but for the amplifier's."""
    found = sensitivities(VALUES.preferred, 3e9)
    for name in ("cutoff_hz", "section_hz", "first_pole_hz"):
        assert sum(found[name][part] for part in ("R1", "R2", "R3")) == pytest.approx(-1, abs=1e-5)
        assert sum(found[name][part] for part in ("C1", "C2", "C3")) == pytest.approx(-1, abs=1e-5)
    assert found["section_quality"]["R3"] == -found["section_quality"]["R2"] == pytest.approx(0.5, abs=1e-5)
    assert list(found["passband_gain"]) == list(NAMES)


def test_command(tmp_path: Path) -> None:
    table = tmp_path / "bode.csv"
    run = run_fingertip("board", "--analysis", "--bode", table, "--json", "--quiet", "--out", tmp_path / "pcb")
    assert (run.returncode, run.stderr) == (0, "")
    data = json.loads(run.stdout)
    assert set(data["analysis"]["spread"]) == set(FIGURES)
    assert table.read_text().startswith("frequency_hz,")
    assert str(table) in data["files"]
    text = run_fingertip("board", "--analysis", "--quiet", "--out", tmp_path / "pcb").stdout
    for words in ("noise, 0.1 Hz to 1 MHz", "202.93 mV", "-3 dB overall [Hz]", "% for 1 % of"):
        assert words in text


def test_monte_carlo_is_ngspices_board_by_board(tmp_path: Path) -> None:
    """Forty boards drawn here, each swept by ngspice: every one's cutoff is ours, and so the spread is."""
    rng = np.random.default_rng(3)
    tolerance = np.array([0.01] * 5 + [0.05] * 3)
    boards = nominal(VALUES.preferred) * (1 + tolerance * rng.uniform(-1, 1, (40, len(NAMES))))
    _, deck = deck_of(tmp_path, [])
    commands = []
    for i, board in enumerate(boards):
        commands += [f"alter {name} = {value:.12g}" for name, value in zip(NAMES, board, strict=True)]
        commands += ["ac dec 4000 60 3000", f"wrdata out{i} vr(tactile) vi(tactile) vr(filtered) vi(filtered)"]
    simulate(tmp_path, deck, "\n".join([*commands, "wrdata out v(filtered)"]))
    theirs = []
    for i in range(len(boards)):
        rows = [[float(word) for word in line.split()] for line in (tmp_path / f"out{i}").read_text().splitlines()]
        gain = [abs(complex(fr, fi) / complex(tr, ti)) for _, tr, ti, fr, fi in rows]
        theirs.append(next(row[0] for row, g in zip(rows, gain, strict=True) if g >= max(gain) / math.sqrt(2)))
    ours = figures(boards, 3e6)["cutoff_hz"]
    assert len(theirs) == len(ours)
    assert np.max(np.abs(ours / np.array(theirs) - 1)) < 1e-3
    assert float(ours.std()) == pytest.approx(float(np.std(theirs)), rel=0.01)
    assert float(ours.std()) > 0.8
