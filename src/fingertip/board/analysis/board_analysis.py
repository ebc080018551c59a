"""Analysis of a design's board: Bode table of each stage, noise and tolerances. Needs numpy."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fingertip.board.analysis import noise, tolerance
from fingertip.board.analysis.noise import NETS, Contribution
from fingertip.board.analysis.response import model_filter
from fingertip.board.analysis.tolerance import Spread
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.components.values import select_components
from fingertip.board.parts.nets import FILTERED, STAGE1_OUT, TACTILE
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz


@dataclass(frozen=True)
class Analysis:
    """Noise and tolerances of a board, which its component values do not include."""

    noise: tuple[Contribution, ...]
    """RMS noise over `NOISE_BAND_HZ`, largest first; white and 1/f noise, typical values."""
    noise_total_v: tuple[float, ...]
    component_percent: dict[str, float]
    boards: int
    spread: dict[str, Spread]

    def as_data(self) -> dict[str, Any]:
        return {"nets": NETS, **asdict(self)}


def analyse(design: Design, boards: int = 10_000) -> Analysis:
    circuit = board_circuit(select_components(design))
    bandwidth_hz = find_gain_bandwidth_hz(design.board)
    toleranced = tolerance.TolerancedFilter(
        model_filter(circuit), build_network(circuit, bandwidth_hz).values
    )
    percent = tolerance.component_tolerances(circuit)

    return Analysis(
        *noise.noise_budget(noise.add_noise(circuit, bandwidth_hz)),
        component_percent=percent,
        boards=boards,
        spread=tolerance.monte_carlo(toleranced, percent, boards),
    )


def bode_table(design: Design) -> str:
    """Return the article's figure 4 as CSV: magnitude [dB] and phase [degree] of each stage.

    The response starts at the tactile voltage. Amplifiers have one pole, so their gain falls with
    their gain-bandwidth product. The last column is that product over the frequency [dB], the
    asymptote of the amplifier's open-loop gain.
    """
    network = build_network(
        board_circuit(select_components(design)), find_gain_bandwidth_hz(design.board)
    )
    frequencies_hz = np.logspace(0, 5, 201)
    filter_network = network.drive(TACTILE).restrict(FILTERED)
    first, whole = filter_network.response(frequencies_hz, {TACTILE: 1.0}, STAGE1_OUT, FILTERED).T
    lines = [
        "frequency_hz,stage1_db,stage1_deg,stage2_db,stage2_deg,whole_db,whole_deg,gbw_over_f_db"
    ]

    for i, hz in enumerate(frequencies_hz):
        cells = [f"{hz:.6g}"]
        for value in (first[i], whole[i] / first[i], whole[i]):
            cells += [f"{20 * math.log10(abs(value)):.4f}", f"{math.degrees(np.angle(value)):.3f}"]

        cells.append(f"{20 * math.log10(find_gain_bandwidth_hz(design.board) / hz):.4f}")
        lines.append(",".join(cells))

    return "\n".join(lines) + "\n"
