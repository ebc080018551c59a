"""The SPICE deck, run by ngspice: the filter as the formulas have it, the bridge's voltages, the rectifier."""

from __future__ import annotations

import math
import subprocess
from pathlib import Path

import pytest

from fingertip.board import board_values, write_board
from fingertip.board.bridge import sensor_conductance_s
from fingertip.board.built import network
from fingertip.board.filters import decibel, filter_network
from fingertip.design import Design
from tests.tools import require_tool

HOW = "run `sh .ci/install-ngspice` as root on Debian, or install ngspice"
DESIGNS = {
    "article": [],
    "another": ["board.cutoff_hz=120", "board.capacitor_uf=0.22", "board.passband_gain=21", "board.series=E96"],
    "slow": ["board.cutoff_hz=5", "board.capacitor_uf=10", "board.gain_bandwidth_hz=1e5"],
}


def simulate(folder: Path, deck: str, commands: str) -> list[list[float]]:
    """Rows of numbers ngspice writes with `wrdata out ...` in these commands."""
    ngspice = require_tool("ngspice", HOW)
    body, analysis, _ = deck.partition("\n.ac ")
    assert analysis
    body += f"\n.control\nset wr_singlescale\n{commands}\n.endc\n.end\n"
    (folder / "run.cir").write_text(body, encoding="utf-8")
    done = subprocess.run([ngspice, "-b", "run.cir"], cwd=folder, capture_output=True, text=True, check=False)
    assert (folder / "out").exists(), done.stdout + done.stderr
    return [[float(word) for word in line.split()] for line in (folder / "out").read_text().splitlines()]


def deck_of(folder: Path, changes: list[str]) -> tuple[Design, str]:
    design = Design.load(changes=changes)
    write_board(design, folder)
    return design, (folder / "slip_filter.cir").read_text(encoding="utf-8")


def worst_db(folder: Path, design: Design, deck: str) -> float:
    """Largest deviation of the deck from our transfer function, 1 Hz to 100 kHz [dB]."""
    rows = simulate(folder, deck, "ac dec 40 1 100k\nwrdata out vr(tactile) vi(tactile) vr(filtered) vi(filtered)")
    assert len(rows) > 200
    assert (rows[0][0], round(rows[-1][0])) == (1.0, 100_000)
    values, gbw = board_values(design).preferred, design.board.gain_bandwidth_hz
    return max(
        abs(decibel(complex(fr, fi) / complex(tr, ti)) - decibel(network(f, values, gbw))) for f, tr, ti, fr, fi in rows
    )


@pytest.mark.parametrize("changes", DESIGNS.values(), ids=DESIGNS)
def test_the_deck_is_the_filter(tmp_path: Path, changes: list[str]) -> None:
    design, deck = deck_of(tmp_path, changes)
    assert worst_db(tmp_path, design, deck) < 1e-2


@pytest.mark.parametrize(("right", "wrong"), [("R2 stage2_mid filtered 1.2k", "R2 stage2_mid filtered 1.21k"),
                                              ("C1 tactile stage1_in 1u", "C1 tactile stage1_in 0.99u")])  # fmt: skip
def test_a_part_one_percent_off_is_seen(tmp_path: Path, right: str, wrong: str) -> None:
    design, deck = deck_of(tmp_path, [])
    assert right in deck
    assert worst_db(tmp_path, design, deck.replace(right, wrong)) > 1e-2


def test_built_tends_to_the_formulas() -> None:
    values = board_values(Design()).preferred
    for f in (1.0, 67.0, 1e4):
        # What is left is 1/A0 at G = 67.7: 3e-4.
        assert network(f, values, 1e15) == pytest.approx(filter_network(f, values), rel=1e-3)


@pytest.mark.parametrize("force_n", [0.1, 0.2, 0.8, 1.3, 8.0])
def test_the_bridges_voltage(tmp_path: Path, force_n: float) -> None:
    design, deck = deck_of(tmp_path, [])
    line = next(line for line in deck.splitlines() if line.startswith("RJ1 "))
    conductance = sensor_conductance_s(force_n)
    deck = deck.replace(line, f"RJ1 sensor 0 {1 / conductance if conductance else 1e12:.10g}")
    rows = simulate(tmp_path, deck, "op\nwrdata out v(tactile)")
    assert rows[0][-1] == pytest.approx(board_values(design).bridge.tactile_v(conductance, 5.0), abs=1e-5)


def test_the_rectifier_is_a_peak_detector_behind_a_dead_zone(tmp_path: Path) -> None:
    """100 Hz of 1 V ahead of the diode come out with 0.23 V of mean and 0.35 V of ripple; an ideal mean is 0.32 V."""
    _, deck = deck_of(tmp_path, [])
    alone = "\n".join(line for line in deck.splitlines() if not line.startswith(("XU1", "R2 ")))
    alone = alone.replace("\n.ac", "\nVtest filtered 0 sin(0 1 100)\n.ac") + "\n"
    rows = simulate(tmp_path, alone, "tran 20u 0.3 0.2 20u uic\nwrdata out v(envelope)")
    volts = [v for _, v in rows]
    mean = math.fsum(volts) / len(volts)
    assert mean == pytest.approx(0.23, abs=0.02)
    assert max(volts) - min(volts) == pytest.approx(0.35, abs=0.04)
