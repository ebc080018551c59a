"""What the board does beyond its ideal figures: Bode of each stage, noise, offsets, tolerances. Needs numpy."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fingertip.board.bridge import Bridge, sensor_conductance_s
from fingertip.board.circuit import Circuit
from fingertip.board.figures import Spread, monte_carlo, sensitivities
from fingertip.board.nodal import System, equations
from fingertip.board.output import board_circuit
from fingertip.board.values import board_values
from fingertip.design import Design

NETS = ("TACTILE", "STAGE1_OUT", "FILTERED")
"""Where noise and offset are looked at: ahead of the filter, between its stages, ahead of the diode."""
NOISE_BAND_HZ = (0.1, 1e6)
NOISE_FORCE_N = 0.8
"""Force on the sensor: the middle of the article's voltages."""
BRIDGE_TOLERANCE = 1e-3
"""Of R10 to R14, as the bill of materials asks for."""
_POINTS_PER_DECADE = 200


@dataclass(frozen=True)
class Contribution:
    """What one cause adds at each of `NETS` [V]."""

    cause: str
    volts: tuple[float, ...]


@dataclass(frozen=True)
class Analysis:
    """Figures of one board."""

    noise: tuple[Contribution, ...]
    """Root mean square over `NOISE_BAND_HZ`, largest first; white noise only, typical figures of data sheets."""
    noise_total_v: tuple[float, ...]
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
    noise, total = _noise(system)
    return Analysis(
        noise=noise,
        noise_total_v=total,
        offset=(*_offsets(system), _bridge_offset(values.bridge, board.supply_v)),
        spread=monte_carlo(
            values.preferred, board.resistor_tolerance_percent, board.capacitor_tolerance_percent, boards, seed
        ),
        sensitivity=sensitivities(values.preferred),
    )


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


def _noise(system: System) -> tuple[tuple[Contribution, ...], tuple[float, ...]]:
    low, high = NOISE_BAND_HZ
    f = np.logspace(math.log10(low), math.log10(high), round(_POINTS_PER_DECADE * math.log10(high / low)) + 1)
    density = np.array([source.noise for source in system.sources])
    squares = [np.trapezoid(np.abs(system.transfers(f, net) * density) ** 2, f, axis=0) for net in NETS]
    rows = [
        Contribution(source.name, tuple(math.sqrt(float(square[i])) for square in squares))
        for i, source in enumerate(system.sources)
    ]
    rows.sort(key=lambda row: -row.volts[-1])
    return tuple(rows), tuple(math.sqrt(float(square.sum())) for square in squares)


def _offsets(system: System) -> list[Contribution]:
    constant = np.zeros(1)
    transfers = [system.transfers(constant, net)[0] for net in NETS]
    return [
        Contribution(source.name, tuple(abs(float(t[i].real)) * source.offset for t in transfers))
        for i, source in enumerate(system.sources)
        if source.offset
    ]


def _bridge_offset(bridge: Bridge, supply_v: float) -> Contribution:
    """At TACTILE, with the sensor open; C1 keeps it from what follows."""
    names = ("top_ohm", "shunt_ohm", "high_ohm", "low_ohm", "gain_ohm")
    nominal = {name: getattr(bridge, name) for name in names}
    at_rest = bridge.tactile_v(0.0, supply_v)
    worst = sum(
        abs(Bridge(**{**nominal, name: nominal[name] * (1 + BRIDGE_TOLERANCE)}).tactile_v(0.0, supply_v) - at_rest)
        for name in names
    )
    return Contribution("R10 to R14", (worst, 0.0, 0.0))
