"""Analysis of a design's board: Bode table of each stage, noise and tolerances. Needs numpy."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fingertip.board.analysis import noise, tolerance
from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.interference import AliasAttenuation, SupplyRipple
from fingertip.board.analysis.limits import VoltageLimits
from fingertip.board.analysis.noise import NETS, Contribution, NoiseLevels
from fingertip.board.analysis.response import model_filter
from fingertip.board.analysis.thresholds import ComparatorLevels, OutputOffset
from fingertip.board.analysis.tolerance import Spread
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.components.front_end import MAX_FORCE_N, sensor_conductance_s
from fingertip.board.components.values import Tolerance, select_components
from fingertip.board.parts.nets import FILTERED, STAGE1_OUT, TACTILE
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz

_OF_BOARD = (
    "amplifier", "aliasing", "voltage_limits", "output_offset", "supply_ripple", "comparator_levels", "tolerance",
)  # fmt: skip
"""Figures of a board that its analysis repeats."""


@dataclass(frozen=True)
class Analysis:
    noise: tuple[Contribution, ...]
    """RMS noise over `NOISE_BAND_HZ`, largest first; white noise only, typical data-sheet values."""
    noise_total_v: tuple[float, ...]
    noise_levels: NoiseLevels
    threshold_v: float
    amplifier: str
    """Dual amplifier of filter and rectifier."""
    aliasing: AliasAttenuation
    voltage_limits: VoltageLimits
    idle_v: float
    """Tactile voltage with an open sensor [V]."""
    pressed_v: float
    """Tactile voltage at the sensor's maximum force [V]."""
    output_offset: OutputOffset | None
    supply_ripple: SupplyRipple
    comparator_levels: ComparatorLevels | None
    tolerance: Tolerance
    component_percent: dict[str, float]
    boards: int
    spread: dict[str, Spread]
    article_spread: dict[str, Spread]
    """Spread with C1 to C3 of the article's tolerance, for comparison."""
    sensitivity: dict[str, dict[str, float]]

    def as_data(self) -> dict[str, Any]:
        return {"nets": NETS, **asdict(self)}


def analyse(design: Design, boards: int = 10_000) -> Analysis:
    values, board = board_values(design), design.board
    circuit = board_circuit(values)
    bandwidth_hz = find_gain_bandwidth_hz(board)
    network = build_network(circuit, bandwidth_hz)
    model, noisy = model_filter(circuit), noise.add_noise(circuit, bandwidth_hz)
    toleranced = tolerance.TolerancedFilter(model, network.values)
    budget, total = noise.noise_budget(noisy)
    percent = tolerance.component_tolerances(circuit)
    article_percent = percent | dict.fromkeys(tolerance.CUTOFF_CAPACITORS, tolerance.ARTICLE_CAPACITOR_PERCENT)
    return Analysis(
        **{name: getattr(values, name) for name in _OF_BOARD},
        noise=budget,
        noise_total_v=total,
        noise_levels=values.noise,
        threshold_v=design.detector.threshold_v,
        idle_v=values.tactile_response.open_v,
        pressed_v=values.tactile_response.tactile_v(sensor_conductance_s(MAX_FORCE_N)),
        component_percent=percent,
        boards=boards,
        spread=tolerance.monte_carlo(toleranced, percent, boards),
        article_spread=tolerance.monte_carlo(toleranced, article_percent, boards),
        sensitivity=tolerance.compute_sensitivities(toleranced),
    )  # fmt: skip


def bode_table(design: Design) -> str:
    """Tabulate the article's figure 4 as CSV: magnitude [dB] and phase [degree] of each stage and of the whole filter.

    The response starts at the tactile voltage. Amplifiers have one pole, so their gain falls with their gain-bandwidth
    product. The last column is that product over the frequency [dB], the asymptote of the amplifier's open-loop gain.
    """
    network = build_network(board_circuit(select_components(design)), find_gain_bandwidth_hz(design.board))
    f = np.logspace(0, 5, 201)
    filter_network = network.drive(TACTILE).restrict(FILTERED)
    first, whole = filter_network.response(f, {TACTILE: 1.0}, STAGE1_OUT, FILTERED).T
    lines = ["frequency_hz,stage1_db,stage1_deg,stage2_db,stage2_deg,whole_db,whole_deg,gbw_over_f_db"]
    for i, hz in enumerate(f):
        cells = [f"{hz:.6g}"]
        for value in (first[i], whole[i] / first[i], whole[i]):
            cells += [f"{20 * math.log10(abs(value)):.4f}", f"{math.degrees(np.angle(value)):.3f}"]
        cells.append(f"{20 * math.log10(find_gain_bandwidth_hz(design.board) / hz):.4f}")
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"
