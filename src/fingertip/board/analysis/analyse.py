"""Analysis of a design's board: Bode table of each stage, noise, offsets and tolerances. Needs numpy."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from fingertip.board.analysis.nodal_analysis import System, build_equations
from fingertip.board.analysis.noise import (
    NETS,
    Contribution,
    NoiseAlternative,
    compare_noise_alternatives,
    noise_budget,
)
from fingertip.board.circuit import Circuit
from fingertip.board.output import board_circuit
from fingertip.board.values.adc_interface import AliasAttenuation
from fingertip.board.values.board_values import Tolerance, board_values
from fingertip.board.values.bridge import Bridge, sensor_conductance_s
from fingertip.board.values.comparator_stage import ComparatorStage
from fingertip.board.values.noise_and_ripple import NOISE_FORCE_N, SupplyRipple
from fingertip.board.values.output_offset import OutputOffset
from fingertip.board.values.tolerance import Spread, compute_sensitivities, monte_carlo
from fingertip.board.values.voltage_limits import VoltageLimits
from fingertip.design import Design

BRIDGE_TOLERANCE = 1e-3
"""Tolerance of R10 to R14, as the bill of materials specifies it."""


@dataclass(frozen=True)
class Analysis:
    """Results of the analysis of one board."""

    noise: tuple[Contribution, ...]
    """RMS noise over `NOISE_BAND_HZ`, largest first; white noise only, typical data-sheet values."""
    noise_total_v: tuple[float, ...]
    noise_alternatives: tuple[NoiseAlternative, ...]
    """Total noise of this variant and with changes that affect it, and the mean envelope due to it."""
    threshold_v: float
    """Threshold of the detector, for comparison with the mean envelope due to noise."""
    amplifier: str
    """Dual amplifier of filter and rectifier."""
    aliasing: AliasAttenuation
    voltage_limits: VoltageLimits
    output_offset: OutputOffset | None
    """Envelope offset; None in variant article."""
    supply_ripple: SupplyRipple
    comparator_stage: ComparatorStage | None
    tolerance: Tolerance
    """Tolerances for which `spread` is computed."""
    offset: tuple[Contribution, ...]
    """Contribution of each amplifier's typical offset (TL082BC: its maximum), and of the bridge with the worst-case
    resistors of 0.1 %."""
    spread: dict[str, Spread]
    sensitivity: dict[str, dict[str, float]]

    def as_data(self) -> dict[str, Any]:
        """Return plain mappings and lists for JSON."""
        return {"nets": NETS, **asdict(self)}


def analyse(design: Design, boards: int = 10_000, seed: int = 1) -> Analysis:
    """Analyse a design's board.

    Parameters
    ----------
    design
        Design of the board.
    boards, seed
        Number of boards and seed of the Monte Carlo analysis of tolerances.
    """
    values, board = board_values(design), design.board
    circuit = board_circuit(values)
    system = build_equations(circuit, board.gain_bandwidth_hz, sensor_conductance_s(NOISE_FORCE_N))
    noise, total = noise_budget(system)
    return Analysis(
        noise=noise,
        noise_total_v=total,
        noise_alternatives=compare_noise_alternatives(
            circuit, board.gain_bandwidth_hz, board.band_limit_hz, has_diode=values.variant == "article"
        ),
        threshold_v=design.detector.threshold_v,
        amplifier=values.amplifier,
        aliasing=values.aliasing,
        voltage_limits=values.voltage_limits,
        output_offset=values.output_offset,
        supply_ripple=values.supply_ripple,
        comparator_stage=values.comparator_stage,
        tolerance=values.tolerance,
        offset=(*_offsets(system), _bridge_offset(values.bridge, board.supply_v)),
        spread=monte_carlo(
            values.preferred, board.gain_bandwidth_hz, values.first_stage_capacitors,
            values.tolerance.resistor_percent, values.tolerance.capacitor_percent, boards, seed,
        ),
        sensitivity=compute_sensitivities(values.preferred, board.gain_bandwidth_hz, values.first_stage_capacitors),
    )  # fmt: skip


def bode_table(design: Design, low_hz: float = 1.0, high_hz: float = 1e5, per_decade: int = 40) -> str:
    """Tabulate the article's figure 4 as CSV: magnitude [dB] and phase [degree] of each stage and of the whole filter.

    The response starts at the tactile voltage. Amplifiers have one pole, so their gain falls with their gain-bandwidth
    product. The last column is that product over the frequency [dB], the asymptote of the amplifier's open-loop gain.
    """
    circuit = board_circuit(board_values(design))
    f = np.logspace(math.log10(low_hz), math.log10(high_hz), round(per_decade * math.log10(high_hz / low_hz)) + 1)
    first, whole = _stage_responses(circuit, design, f)
    lines = ["frequency_hz,stage1_db,stage1_deg,stage2_db,stage2_deg,whole_db,whole_deg,gbw_over_f_db"]
    for i, hz in enumerate(f):
        cells = [f"{hz:.6g}"]
        for value in (first[i], whole[i] / first[i], whole[i]):
            cells += [f"{20 * math.log10(abs(value)):.4f}", f"{math.degrees(np.angle(value)):.3f}"]
        cells.append(f"{20 * math.log10(design.board.gain_bandwidth_hz / hz):.4f}")
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def _stage_responses(circuit: Circuit, design: Design, f: Any) -> tuple[Any, Any]:
    system = build_equations(circuit, design.board.gain_bandwidth_hz, 0.0, "TACTILE")
    return system.driven_response(f, "STAGE1_OUT"), system.driven_response(f, "FILTERED")


def _offsets(system: System) -> list[Contribution]:
    constant = np.zeros(1)
    transfers = [system.source_transfers(constant, net)[0] for net in NETS]
    return [
        Contribution(source.name, tuple(abs(float(t[i].real)) * source.offset for t in transfers))
        for i, source in enumerate(system.sources)
        if source.offset
    ]


def _bridge_offset(bridge: Bridge, supply_v: float) -> Contribution:
    """Offset of the bridge at TACTILE and its ADC pin, with the sensor open. C1 blocks it from the filter."""
    nominal_v = bridge.tactile_v(0.0, supply_v)
    worst_v = 0.0
    for name in ("sensor_top_ohm", "sensor_shunt_ohm", "reference_top_ohm", "reference_bottom_ohm", "gain_ohm"):
        changed = replace(bridge, **{name: getattr(bridge, name) * (1 + BRIDGE_TOLERANCE)})
        worst_v += abs(changed.tactile_v(0.0, supply_v) - nominal_v)
    return Contribution("R10 to R14", tuple(worst_v if net in ("TACTILE", "ADC_TACTILE") else 0.0 for net in NETS))
