"""Stability of the amplifiers with two poles: phase margin of each loop, and resonances of the filter.

The loop of an amplifier is opened at its output: a source drives the net instead, and the difference of its inputs is
what is fed back. The circuit around it is that of `fingertip.board.network`, with the capacitances of all inputs.
Outputs have no resistance, so a capacitive load is not covered.
"""

from __future__ import annotations

import math

import numpy as np

from fingertip.arrays import Array
from fingertip.board.circuit import Circuit
from fingertip.board.components.amplifiers import AMPLIFIERS
from fingertip.board.nets import FILTERED, TACTILE
from fingertip.board.network import INVERSE_BANDWIDTH, INVERSE_GAIN, Network, Spectrum

LOOP_HZ = 1e3, 1e9
"""Band in which a loop's gain falls to 1 [Hz]."""
_LOOP_POINTS = 73
PEAK_HZ = 1e4, 1e8
"""Band beyond the passband in which a resonance is searched [Hz]."""
_PEAK_POINTS = 97


def compute_phase_margins_deg(circuit: Circuit, network: Network) -> dict[str, float]:
    """Compute the phase margin of each operational amplifier of the catalogue [degree], by reference and unit.

    Parameters
    ----------
    circuit
        Circuit of the board.
    network
        Its equations with amplifiers as built, and with the diodes that conduct.
    """
    f = np.geomspace(*LOOP_HZ, _LOOP_POINTS)
    margins = {}
    for component in circuit.components:
        data = AMPLIFIERS.get(component.symbol.name)
        if data is None:
            continue
        for unit, (plus, minus, out) in data.units.items():
            nets = [circuit.net_by_pin[component.reference, pin] for pin in (plus, minus, out)]
            fed_back = _voltage(network, f, nets[1], nets[2]) - _voltage(network, f, nets[0], nets[2])
            open_loop = np.array([data.open_loop_gain(hz) for hz in f.tolist()])
            margins[f"{component.reference}{unit}"] = _find_margin_deg(open_loop * fed_back)
    return margins


def _voltage(network: Network, f: Array, net: str, driven: str) -> Spectrum:
    """Voltage of a net for 1 V at a driven one."""
    if net == driven:
        return np.ones(len(f), dtype=np.complex128)
    opened = network.drive(driven).restrict(net)
    if net in opened.inputs:
        return np.zeros(len(f), dtype=np.complex128)
    return opened.response(f, {driven: 1.0}, net)[:, 0]


def _find_margin_deg(loop: Spectrum) -> float:
    """Phase of a loop above -180 degrees where its gain last falls through 1, by interpolation between two points."""
    with np.errstate(divide="ignore"):  # far above its bandwidth a loop may have no gain left
        level = np.log(np.abs(loop))
    phase = np.degrees(np.unwrap(np.angle(loop)))
    above = np.flatnonzero(level > 0.0)
    if not len(above):
        return math.inf
    i = int(above[-1])
    if i + 1 == len(level):
        return -math.inf
    share = level[i] / (level[i] - level[i + 1])
    # At low frequencies a loop lags by 90 degrees or less; unwrapping may have started a turn away.
    turns = 360.0 * round(float(phase[0]) / 360.0)
    return float(180.0 + phase[i] + share * (phase[i + 1] - phase[i]) - turns)


def compute_two_pole_gain(circuit: Circuit, network: Network, f_hz: Array) -> Spectrum:
    """Compute the filter's gain from the tactile voltage with two-pole amplifiers.

    The equations hold 1 / A = 1 / A0 + s / (2 pi GBW). The second pole multiplies it by 1 + s / (2 pi f2).
    """
    part = network.drive(TACTILE).restrict(FILTERED)
    n, s = len(part.nets), 2j * math.pi * f_hz
    G, C = part.matrices()
    matrices = G[:, :n] + s[:, None, None] * C[:, :n]
    for component in circuit.components:
        data = AMPLIFIERS.get(component.symbol.name)
        for unit, (_, _, out) in data.units.items() if data else ():
            name, net = f"{component.reference}{unit}", circuit.net_by_pin[component.reference, out]
            if data and net in part.nets:
                inverse = part.values[f"{name} {INVERSE_GAIN}"] + s * part.values[f"{name} {INVERSE_BANDWIDTH}"]
                row = part.nets.index(net)
                matrices[:, row, row] -= inverse * s / (2.0 * math.pi * data.second_pole_hz)
    given = np.array([1.0 if name == TACTILE else 0.0 for name in part.inputs])
    right = -(G[:, n:] @ given + s[:, None] * (C[:, n:] @ given))
    return np.asarray(np.linalg.solve(matrices, right[:, :, None])[:, part.nets.index(FILTERED), 0])


def compute_peaking_db(circuit: Circuit, network: Network, passband_gain: float) -> float:
    """Compute the ratio of the filter's largest gain beyond the passband to the passband's [dB]."""
    gains = compute_two_pole_gain(circuit, network, np.geomspace(*PEAK_HZ, _PEAK_POINTS))
    return 20.0 * math.log10(float(np.abs(gains).max()) / passband_gain)
