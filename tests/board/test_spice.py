"""The SPICE deck in ngspice: transfer function of the filter, voltages of the bridge, rectifiers and comparator."""

from __future__ import annotations

from pathlib import Path

import pytest

from fingertip.board import board_values
from fingertip.board.analysis.response import decibel
from fingertip.board.components.bridge import sensor_conductance_s
from fingertip.board.components.values import SUPPLIES
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import choose_amplifier
from fingertip.tasks.board import write_board
from tests.board.ngspice import run_ngspice
from tests.designs import load_article
from tests.oracles.filter_formulas import filter_transfer

CONTROLLER = ["board.supply=single_3v3", "board.supply_v=3.3"]
DESIGNS = {
    "article": [],
    "another": ["board.cutoff_hz=120", "board.capacitor_uf=0.22", "board.passband_gain=21", "board.series=E96"],
    "slow": ["board.cutoff_hz=5", "board.capacitor_uf=10"],
    "single supply": ["board.supply=single"],
    "precision": ["board.variant=precision"],
    "precision, single supply": ["board.variant=precision", "board.supply=single", "board.band_limit_hz=500"],
    "comparator": ["board.variant=comparator"],
    "comparator, single supply": ["board.variant=comparator", "board.supply=single", "board.capacitor_series=E12"],
    "article, 3.3 V": CONTROLLER,
    "precision, 3.3 V": ["board.variant=precision", *CONTROLLER],
    "comparator, 3.3 V": ["board.variant=comparator", *CONTROLLER, "board.cutoff_hz=90", "board.series=E96"],
}


def write_deck(folder: Path, changes: list[str]) -> tuple[Design, str]:
    design = load_article(changes)
    write_board(design, folder)
    return design, (folder / "slip_filter.cir").read_text(encoding="utf-8")


def max_deviation_db(folder: Path, design: Design, deck: str) -> float:
    """Maximum deviation of the deck from our transfer function [dB], from 1 Hz to 100 kHz."""
    rows = run_ngspice(folder, deck, "ac dec 40 1 100k\nwrdata out vr(tactile) vi(tactile) vr(filtered) vi(filtered)")
    assert len(rows) > 200
    assert (rows[0][0], round(rows[-1][0])) == (1.0, 100_000)
    values, amplifier = board_values(design), choose_amplifier(design.board)
    arguments = values.preferred, amplifier.bandwidth_hz, values.first_stage_capacitors, amplifier.input_f
    return max(
        abs(decibel(complex(fr, fi) / complex(tr, ti)) - decibel(filter_transfer(f, *arguments)))
        for f, tr, ti, fr, fi in rows
    )


@pytest.mark.full
@pytest.mark.parametrize("changes", DESIGNS.values(), ids=DESIGNS)
def test_deck_has_the_transfer_function_of_the_filter(tmp_path: Path, changes: list[str]) -> None:
    design, deck = write_deck(tmp_path, changes)
    assert max_deviation_db(tmp_path, design, deck) < 1e-2


@pytest.mark.parametrize("supply", SUPPLIES)
@pytest.mark.parametrize("force_n", [0.1, 0.8, 8.0])
def test_deck_has_the_tactile_voltage_of_the_bridge(tmp_path: Path, force_n: float, supply: str) -> None:
    design, deck = write_deck(tmp_path, [f"board.supply={supply}", f"board.supply_v={SUPPLIES[supply].nominal_v}"])
    line = next(line for line in deck.splitlines() if line.startswith("RJ1 "))
    conductance = sensor_conductance_s(force_n)
    deck = deck.replace(line, f"{' '.join(line.split()[:3])} {1 / conductance if conductance else 1e12:.10g}")
    rows = run_ngspice(tmp_path, deck, "op\nwrdata out v(tactile)")
    assert rows[0][-1] == pytest.approx(board_values(design).tactile_response.tactile_v(conductance), abs=1e-4)


@pytest.mark.full
@pytest.mark.parametrize("supply", SUPPLIES)
def test_comparator_switches_at_its_on_and_off_thresholds(tmp_path: Path, supply: str) -> None:
    """The mean sweeps slowly up and down through both thresholds. SLIP is low in between."""
    design, deck = write_deck(tmp_path, [*BOARD_CONFIGURATIONS[f"comparator_{supply}"].changes])
    levels = board_values(design).comparator_levels
    assert levels is not None
    assert levels.averaging_tau_s == pytest.approx(0.015, rel=0.05)  # half of the article's window of 30 ms
    isolated = "\n".join(line for line in deck.splitlines() if not line.startswith(("R18 ", "C17 ")))
    ground = "0" if supply == "split" else "vmid"
    isolated = isolated.replace("\n.ac", f"\nVmean mean {ground} pwl(0 0 1 0.04 2 0)\n.ac") + "\n"
    rows = run_ngspice(tmp_path, isolated, "tran 0.2m 2 0 0.2m\nwrdata out v(slip)")
    low = [t for t, v in rows if t > 0.01 and v < 1]
    on, off = 0.04 * low[0], 0.04 * (2 - low[-1])
    assert (on, off) == pytest.approx((levels.on_v, levels.off_v), abs=2e-4)
    # The output turns ON at the design's threshold, which E24 resistors approximate to within two percent.
    assert on == pytest.approx(0.017, rel=0.02)
    assert off == pytest.approx(0.75 * 0.017, rel=0.05)
    assert all(v > design.board.supply_v - 0.1 for t, v in rows if 0.04 * t < off - 1e-3)
