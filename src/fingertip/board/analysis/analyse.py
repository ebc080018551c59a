"""What the board does beyond its ideal figures: Bode of each stage, noise, offsets, tolerances. Needs numpy."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from fingertip.board.analysis.equations import equations
from fingertip.board.analysis.nodal import System
from fingertip.board.analysis.noise import NETS, Contribution, Remedy, budget, remedies
from fingertip.board.circuit import Circuit
from fingertip.board.output import board_circuit
from fingertip.board.values.board_values import Tolerance, board_values
from fingertip.board.values.bridge import Bridge, sensor_conductance_s
from fingertip.board.values.converter import AliasFigures
from fingertip.board.values.decision import Decision
from fingertip.board.values.figures import Spread, monte_carlo, sensitivities
from fingertip.board.values.limits import Limits
from fingertip.board.values.rest import Rest
from fingertip.board.values.ripple import Ripple
from fingertip.board.values.white_noise import NOISE_FORCE_N
from fingertip.design import Design

BRIDGE_TOLERANCE = 1e-3
"""Of R10 to R14, as the bill of materials asks for."""


@dataclass(frozen=True)
class Analysis:
    """Figures of one board."""

    noise: tuple[Contribution, ...]
    """Root mean square over `NOISE_BAND_HZ`, largest first; white noise only, typical figures of data sheets."""
    noise_total_v: tuple[float, ...]
    quieter: tuple[Remedy, ...]
    """The total with what would lower it, and where the envelope then rests."""
    threshold_v: float
    """The detector's, for comparison with where the envelope rests."""
    alias: AliasFigures
    limits: Limits
    rest: Rest | None
    """Where offsets let the envelope rest; None in variant article."""
    ripple: Ripple
    decision: Decision | None
    tolerance: Tolerance
    """What `spread` is of."""
    offset: tuple[Contribution, ...]
    """Of each amplifier's typical offset, and of the bridge with all resistors at the worst ends of 0.1 %."""
    spread: dict[str, Spread]
    sensitivity: dict[str, dict[str, float]]

    def as_data(self) -> dict[str, Any]:
        """Plain mappings and lists, for JSON."""
        return {"nets": NETS, **asdict(self)}


def analyse(design: Design, boards: int = 10_000, seed: int = 1) -> Analysis:
    """All figures of a design's board."""
    values, board = board_values(design), design.board
    circuit = board_circuit(values)
    system = equations(circuit, board.gain_bandwidth_hz, sensor_conductance_s(NOISE_FORCE_N))
    noise, total = budget(system)
    return Analysis(
        noise=noise,
        noise_total_v=total,
        quieter=remedies(circuit, board.gain_bandwidth_hz, board.band_limit_hz, values.variant == "article"),
        threshold_v=design.detector.threshold_v,
        alias=values.alias,
        limits=values.limits,
        rest=values.rest,
        ripple=values.ripple,
        decision=values.decision,
        tolerance=values.tolerance,
        offset=(*_offsets(system), _bridge_offset(values.bridge, board.supply_v)),
        spread=monte_carlo(
            values.preferred, board.gain_bandwidth_hz, values.first_stage,
            values.tolerance.resistor_percent, values.tolerance.capacitor_percent, boards, seed,
        ),
        sensitivity=sensitivities(values.preferred, board.gain_bandwidth_hz, values.first_stage),
    )  # fmt: skip


def bode_table(design: Design, low_hz: float = 1.0, high_hz: float = 1e5, per_decade: int = 40) -> str:
    """CSV of the article's figure 4: dB and degrees of each stage and of the whole, with the amplifier's open loop.

    From the tactile voltage; amplifiers of one pole, so the gain falls where the gain-bandwidth product ends it.
    """
    circuit = board_circuit(board_values(design))
    f = np.logspace(math.log10(low_hz), math.log10(high_hz), round(per_decade * math.log10(high_hz / low_hz)) + 1)
    first, whole = _stages(circuit, design, f)
    lines = ["frequency_hz,stage1_db,stage1_deg,stage2_db,stage2_deg,whole_db,whole_deg,open_loop_db"]
    for i, hz in enumerate(f):
        cells = [f"{hz:.6g}"]
        for value in (first[i], whole[i] / first[i], whole[i]):
            cells += [f"{20 * math.log10(abs(value)):.4f}", f"{math.degrees(np.angle(value)):.3f}"]
        cells.append(f"{20 * math.log10(design.board.gain_bandwidth_hz / hz):.4f}")
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def _stages(circuit: Circuit, design: Design, f: Any) -> tuple[Any, Any]:
    system = equations(circuit, design.board.gain_bandwidth_hz, 0.0, "TACTILE")
    return system.response(f, "STAGE1_OUT"), system.response(f, "FILTERED")


def _offsets(system: System) -> list[Contribution]:
    constant = np.zeros(1)
    transfers = [system.transfers(constant, net)[0] for net in NETS]
    return [
        Contribution(source.name, tuple(abs(float(t[i].real)) * source.offset for t in transfers))
        for i, source in enumerate(system.sources)
        if source.offset
    ]


def _bridge_offset(bridge: Bridge, supply_v: float) -> Contribution:
    """At TACTILE and its pin, with the sensor open; C1 keeps it from what follows."""
    at_rest = bridge.tactile_v(0.0, supply_v)
    worst = 0.0
    for name in ("top_ohm", "shunt_ohm", "high_ohm", "low_ohm", "gain_ohm"):
        off = replace(bridge, **{name: getattr(bridge, name) * (1 + BRIDGE_TOLERANCE)})
        worst += abs(off.tactile_v(0.0, supply_v) - at_rest)
    return Contribution("R10 to R14", tuple(worst if net in ("TACTILE", "ADC_TACTILE") else 0.0 for net in NETS))
