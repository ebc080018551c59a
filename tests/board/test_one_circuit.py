"""One place for each component: a change there reaches netlist, bill
of materials, deck, analysis and simulation.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from fingertip.board.analysis.board_analysis import analyse, bode_table
from fingertip.board.analysis.board_values import _model_variant, board_values, compute_filter
from fingertip.board.circuits import board_circuit as circuits
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.spice import spice_deck
from fingertip.board.fabrication.bom import bill_of_materials
from fingertip.board.kicad.netlist import kicad_netlist_file
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.filter_board import simulate_board
from tests.board.ngspice import run_ngspice
from tests.designs import load_article

TONE_HZ = 100.0
STEP_S = 1 / 16_000
DESIGN = load_article(["board.variant=comparator"])


@pytest.fixture(autouse=True)
def forget_boards() -> Iterator[None]:
    """Forget the boards of other tests before each test here, and the changed boards after it."""
    for remembered in (board_values, _model_variant):
        remembered.cache_clear()
    yield
    for remembered in (board_values, _model_variant):
        remembered.cache_clear()


def simulated_gain(design: Design) -> float:
    """Gain of a tone from the tactile voltage to the filtered one, in the simulation over time."""
    time = np.arange(32_000) * STEP_S
    board = AnalogBoard.from_design(design)
    filtered = simulate_board(board, STEP_S, 1e-4 * np.sin(math.tau * TONE_HZ * time)).filtered_v[
        16_000:
    ]
    # The input is linear between samples, which a tone of 160 samples per period hardly notices.
    chords = 2 * (1 - math.cos(math.tau * TONE_HZ * STEP_S)) / (math.tau * TONE_HZ * STEP_S) ** 2
    return float(np.sqrt(2 * np.mean(filtered**2)) / 1e-4 / chords)


def bode_gain(design: Design) -> float:
    """Gain of a tone in the Bode table."""
    rows = csv.DictReader(io.StringIO(bode_table(design)))
    return next(
        10 ** (float(row["whole_db"]) / 20) for row in rows if float(row["frequency_hz"]) == TONE_HZ
    )


def ngspice_gain(folder: Path, design: Design) -> float:
    """Gain of a tone in the SPICE deck."""
    deck = spice_deck(
        board_circuit(board_values(design)),
        find_gain_bandwidth_hz(design.board),
        design.board.supply_v,
    )
    rows = run_ngspice(
        folder,
        deck.decode(),
        f"ac lin 1 {TONE_HZ} {TONE_HZ}\nlet h = abs(v(filtered)/v(tactile))\nwrdata out h",
    )
    return rows[0][1]


def assert_everything_has_the_gain(folder: Path, design: Design, gain: float) -> None:
    """Bode table, deck and simulation agree on the gain of a tone."""
    assert bode_gain(design) == pytest.approx(gain, rel=1e-4)
    assert ngspice_gain(folder, design) == pytest.approx(gain, rel=1e-3)  # 0.01 dB
    assert simulated_gain(design) == pytest.approx(gain, rel=1e-4)


def bom_rows(content: bytes) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(content.decode())))


def test_component_added_in_one_place_is_everywhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """R99 of 47k parallel to R3, which it halves, where the signal path is wired."""
    parallel = {
        "boards": "",
        "reference": "R99",
        "kind": "part",
        "value": "47k",
        "symbol": "R",
        "footprint": "R_0603",
        "role": "parallel to R3",
        "pins": "1=STAGE2_IN 2=GND",
    }
    rows = (*circuits.load_rows(), parallel)
    original_gain = bode_gain(DESIGN)
    monkeypatch.setattr(circuits, "load_rows", lambda: rows)
    values = board_values(DESIGN)
    circuit = board_circuit(board_values(DESIGN))
    assert '(ref "R99")' in kicad_netlist_file(circuit).decode()
    assert any("R99" in row["References"].split() for row in bom_rows(bill_of_materials(circuit)))
    assert values.achieved_response.section_quality == pytest.approx(
        math.sqrt(2350 / 4800), rel=1e-9
    )
    assert asdict(compute_filter(DESIGN.board)[1]) == pytest.approx(
        asdict(values.achieved_response)
    )
    assert any(item.cause == "R99" for item in analyse(DESIGN, boards=10).noise)
    gain = bode_gain(DESIGN)
    assert gain < 0.9 * original_gain
    assert_everything_has_the_gain(tmp_path, DESIGN, gain)
