"""Noise of each component and in total, compared with ngspice and with estimates by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.noise import NETS, add_noise, noise_budget
from fingertip.board.analysis.report import analyse
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from tests.board.ngspice import read_noise_total
from tests.board.test_spice import write_deck
from tests.designs import ARTICLE

VALUES = board_values(ARTICLE)
CIRCUIT = board_circuit(VALUES)


@pytest.mark.full
@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_total_noise_agrees_with_ngspice(tmp_path: Path, name: str) -> None:
    """All amplifiers and resistors, 0.1 Hz to 1 MHz: 20 mV after the article's filters, 0.1 mV on the other boards."""
    design, deck = write_deck(tmp_path, list(VARIANT_CHANGES[name]))
    rows, total = noise_budget(add_noise(board_circuit(board_values(design)), find_gain_bandwidth_hz(design.board)))
    assert rows[0].cause == ("U2" if name == "article" else "U2a")
    for net in ("TACTILE", "FILTERED", "ADC_TACTILE"):
        # The noise is measured against ground, as the ADC measures it. On boards for a controller it contains VMID's.
        assert total[NETS.index(net)] == pytest.approx(read_noise_total(tmp_path, deck, net), rel=0.005), net
    found = board_values(design).noise
    assert found.tactile_v == pytest.approx(total[NETS.index("TACTILE")], rel=1e-3)
    assert found.filtered_v == pytest.approx(total[NETS.index("FILTERED")], rel=1e-3)
    figures = {"article": 20.1e-3, "precision": 0.106e-3, "comparator": 0.098e-3}
    assert found.filtered_v == pytest.approx(figures.get(name, found.filtered_v), rel=0.01)


@pytest.mark.parametrize(("gain_resistor", "density_nv"), [("1M", 57.37), ("100k", 43.01), ("10k", 35.29)])
def test_output_noise_of_the_bridge_amplifier_shows_at_low_gain(gain_resistor: str, density_nv: float) -> None:
    """AD623's data sheet: 35 nV at the input and 50 nV at the output; with gains of 1.1, 2 and 11 [nV/sqrt(Hz)]."""
    sources = {source.name: source for source in add_noise(CIRCUIT.replace("R14", gain_resistor), 4e6).sources}
    assert sources["U2"].noise == pytest.approx(density_nv * 1e-9, rel=1e-3)


def test_noise_budget_begins_with_the_bridge_amplifier() -> None:
    assert analyse(ARTICLE, boards=100).noise[0].cause == "U2"
