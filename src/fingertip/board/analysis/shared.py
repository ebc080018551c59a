"""Shared figures of a board's channels: its supply current, and how much slip at one finger appears at the others.

Four ways couple channels: the references, the supply, whose voltage falls when an amplifier draws more current, the
ground of the cables, over which that current returns, and the capacitance between wires. All amplifiers draw their
output current from the supply alone, which doubles what a push-pull stage would draw.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from fingertip.board.analysis.loads import signal_band_hz
from fingertip.board.analysis.response import decibel
from fingertip.board.circuits.channels import leave_out_empty, name_net
from fingertip.board.circuits.network import build_network
from fingertip.board.circuits.spice import HOST_GROUND, HOST_SUPPLY
from fingertip.board.components.bridge import AD623_SUPPLY_A, AMPLIFIERS, COMPARATOR_SUPPLY_A, sensor_conductance_s
from fingertip.board.parts.circuit import Circuit, Component, Net, parse_component_value
from fingertip.board.parts.nets import ADC_FILTERED, ADC_TACTILE, GND, POWER_IN, SENSOR, VCC, VEE
from fingertip.board.parts.symbols import C_0603, CAPACITOR, R_0603, RESISTOR
from fingertip.design.parameters.electronics import Board

MAX_CROSSTALK_DB = -60.0
"""Crosstalk above which a board warns: a firm slip at one finger then shows as the noise of the others."""
WIRE_OHM_PER_M, CONTACT_OHM = 0.22, 0.02
"""Resistance of a wire of AWG 28 [ohm/m], and of one contact of a plug [ohm]."""
WIRE_F_PER_M = 60e-12
"""Capacitance between wires of neighbouring channels, as if they touched; ground between them lowers it [F/m]."""
REGULATOR_OHM = 0.5
"""Output resistance of the controller's 3.3 V in the band of the vibrations [ohm], an assumption."""
_FORCES_N = (0.3, 8.0)
_FREQUENCIES = 12


@dataclass(frozen=True)
class SharedFigures:
    supply_current_a: float
    """Typical current at rest, with open sensors [A]."""
    crosstalk_db: float
    """Largest ratio of the filtered signal of a finger at rest to that of a finger that slips, at the controller."""
    crosstalk_hz: float
    """Frequency of that ratio, in the band of the vibrations."""


def compute_shared_figures(circuit: Circuit, gain_bandwidth_hz: float, board: Board) -> SharedFigures:
    """Compute what the channels of a board share; empty places count for nothing."""
    fitted = leave_out_empty(circuit)
    crosstalk_db, hz = find_crosstalk(fitted, board, gain_bandwidth_hz)
    return SharedFigures(compute_supply_current_a(fitted, board.supply_v), crosstalk_db, hz)


def compute_supply_current_a(circuit: Circuit, supply_v: float) -> float:
    """Typical current at rest [A]: of the amplifiers, and through the resistors at the supply."""
    chips_a = {"AD623ARMZ": AD623_SUPPLY_A, "LMV331": COMPARATOR_SUPPLY_A}
    chips_a |= {name: amplifier.supply_current_a * len(amplifier.units) for name, amplifier in AMPLIFIERS.items()}
    parts_a = [chips_a.get(part.symbol.name, 0.0) for part in circuit.components]
    branches = []
    for part in circuit.components:
        ends = [circuit.net_by_pin.get((part.reference, pin), "") for pin in "12"]
        if part.symbol.name == "R" and VCC in ends:
            branches.append((ends[1] if ends[0] == VCC else ends[0], parse_component_value(part.value)))
    network = build_network(circuit).restrict(*(net for net, _ in branches))
    volts = network.operating_point({VCC: supply_v, VEE: -supply_v})
    parts_a += [(supply_v - volts[net]) / ohm for net, ohm in branches]
    return sum(parts_a)


def crosstalk_warning(shared: SharedFigures, board: Board) -> str:
    """Return a warning if the channels couple too much, or "". The wires' capacitance makes most of it."""
    if shared.crosstalk_db <= MAX_CROSSTALK_DB:
        return ""
    length_m = board.cable_m * 10.0 ** ((MAX_CROSSTALK_DB - shared.crosstalk_db) / 20.0)
    return (
        f"slip at one finger shows at others with {shared.crosstalk_db:.0f} dB, above {MAX_CROSSTALK_DB:g} dB; give "
        f"board.cable_m of {math.floor(100.0 * length_m) / 100.0:g} or less, or keep the cables of the fingers apart"
    )


def connect_cables(circuit: Circuit, board: Board) -> Circuit:
    """Connect what lies between the board and its controller and sensors: resistance, and capacitance of wires."""
    moved = {("J2", "1"): HOST_SUPPLY, ("J2", "2"): HOST_GROUND}
    nets = [Net(net.name, tuple(node for node in net.nodes if node not in moved)) for net in circuit.nets]
    nets += [Net(name, (node,)) for node, name in moved.items()]
    cabled = replace(circuit, nets=tuple(nets))
    wire_ohm = board.cable_m * WIRE_OHM_PER_M + 2.0 * CONTACT_OHM
    ends = [(HOST_SUPPLY, POWER_IN, wire_ohm + REGULATOR_OHM), (HOST_GROUND, GND, wire_ohm)]
    for number, (one, other, ohm) in enumerate(ends, start=91):
        part = Component(f"R{number}", f"{ohm:.10g}", RESISTOR, R_0603, "wire of the supply")
        cabled = cabled.connect(part, {"1": one, "2": other})
    pairs = [(SENSOR, SENSOR), *itertools.product((ADC_TACTILE, ADC_FILTERED), repeat=2)]
    neighbours = [(k, one, other) for k in range(1, board.channels) for one, other in pairs]
    for number, (k, one, other) in enumerate(neighbours, start=41):
        part = Component(f"C{number}", f"{WIRE_F_PER_M * board.cable_m:.10g}", CAPACITOR, C_0603, "wires side by side")
        cabled = cabled.connect(part, {"1": name_net(one, k), "2": name_net(other, k + 1)})
    return cabled


def find_crosstalk(circuit: Circuit, board: Board, gain_bandwidth_hz: float) -> tuple[float, float]:
    """Find the largest crosstalk [dB] and its frequency [Hz], for light and firm touch."""
    # For a signal the source of the supply is a short: both of its ends are one net.
    nets: dict[str, tuple[tuple[str, str], ...]] = {}
    cabled = connect_cables(circuit, board)
    for net in cabled.nets:
        name = HOST_GROUND if net.name == HOST_SUPPLY else net.name
        nets[name] = (*nets.get(name, ()), *net.nodes)
    joined = replace(cabled, nets=tuple(Net(*each) for each in nets.items()))
    f = np.geomspace(*signal_band_hz(board.cutoff_hz), _FREQUENCIES)
    worst = (0.0, 0.0)
    for force_n in _FORCES_N:
        network = build_network(
            joined, gain_bandwidth_hz, sensor_s=sensor_conductance_s(force_n), is_supply_resistive=True
        )
        sources = [network.nets.index(name_net(SENSOR, k + 1)) for k in range(board.channels)]
        ground = network.transfers(f, HOST_GROUND)[:, sources]
        pins = [network.transfers(f, name_net(ADC_FILTERED, k + 1))[:, sources] - ground for k in range(board.channels)]
        for slips, rests in itertools.permutations(range(board.channels), 2):
            ratios = np.abs(pins[rests][:, slips] / pins[slips][:, slips])
            worst = max(worst, (float(ratios.max()), float(f[ratios.argmax()])))
    return decibel(worst[0]), worst[1]
