"""Load of the amplifiers of the signal path: what each drives in the band of the vibrations.

Data sheets state the output swing for a load of 2 kohm or more. The rectifying diode counts as
conducting, without its drop, so the current that charges the envelope's capacitor is an upper
bound: at the current's peak both ends of the diode rise equally fast, and the capacitor's end is at
the lower voltage. The buffer of VMID is not covered.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fingertip.board.analysis.response import RECTIFYING_DIODE
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import (
    AmplifierOutput,
    Network,
    Spectrum,
    add_second_poles,
    build_network,
    list_amplifiers,
)
from fingertip.board.components.values import select_components
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.nets import FILTERED, SUM, TACTILE
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import BAND_CUTOFFS, find_gain_bandwidth_hz
from fingertip.design.formulas.filter import find_preferred_neighbours
from fingertip.foundation.numerics import Array

MIN_LOAD_OHM = 2e3
"""Smallest load for which the data sheets of both amplifiers state their output swing."""
_FREQUENCIES = 30
_FILTER_AMPLIFIERS = ("U1a", "U1b")


def signal_band_hz(cutoff_hz: float) -> tuple[float, float]:
    """Return the band of the vibrations [Hz]: from the cutoff to `BAND_CUTOFFS` cutoffs."""
    return cutoff_hz, BAND_CUTOFFS * cutoff_hz


@dataclass(frozen=True, eq=False)
class OutputCurrent:
    """Output current of an amplifier among vibrations, for 1 V of the tactile voltage."""

    output: AmplifierOutput
    gain: Spectrum
    """Voltage of the output [V/V]."""
    filter_s: Spectrum
    """Current without the rectifying diode [A/V]."""
    diode_s: Spectrum
    """Current through the rectifying diode, as if it always conducted [A/V]."""


def compute_output_currents(
    circuit: Circuit, gain_bandwidth_hz: float, cutoff_hz: float
) -> tuple[OutputCurrent, ...]:
    """Compute the current of each amplifier's output, in the order of their references."""
    # SUM is driven with 0 V.
    driven = [net for net in (TACTILE, SUM) if net in circuit.net_by_pin.values()]
    network = build_network(circuit, gain_bandwidth_hz, conducting=[RECTIFYING_DIODE])
    network = network.drive(*driven)
    f = np.geomspace(*signal_band_hz(cutoff_hz), _FREQUENCIES)
    responses = network.response(f, {TACTILE: 1.0}, *network.nets).T
    volts = dict(zip(network.nets, responses, strict=True))
    volts[TACTILE] = np.ones(len(f), dtype=np.complex128)
    nets = circuit.net_by_pin
    branches = [
        (c.reference, nets[c.reference, "1"], nets[c.reference, "2"])
        for c in circuit.components
        if c.symbol.name in "RC" or c.reference == RECTIFYING_DIODE
    ]
    currents = []

    for output in sorted(list_amplifiers(circuit)):
        filter_s, diode_s = np.zeros((2, len(f)), dtype=np.complex128)
        for reference, first, second in branches:
            if output.net not in (first, second):
                continue

            order = 2j * np.pi * f if reference.startswith("C") else 1.0
            admittance = network.values[reference] * order
            # What is not among the equations, such as a rail, carries no signal.
            far_end = second if output.net == first else first
            difference = volts[output.net] - volts.get(far_end, 0.0)
            current = diode_s if reference == RECTIFYING_DIODE else filter_s
            current += admittance * difference

        currents.append(OutputCurrent(output, volts[output.net], filter_s, diode_s))

    return tuple(currents)


def find_filter_load_ohm(circuit: Circuit, gain_bandwidth_hz: float, cutoff_hz: float) -> float:
    """Find the smallest impedance that the filter's amplifiers drive [ohm], without the diode."""
    currents = compute_output_currents(circuit, gain_bandwidth_hz, cutoff_hz)
    filters = [current for current in currents if current.output.amplifier in _FILTER_AMPLIFIERS]
    return min(
        float(np.abs(current.gain / current.filter_s).min())
        for current in filters
        if current.filter_s.any()
    )


def load_warnings(design: Design, filter_load_ohm: float, capacitor_f: float) -> Iterator[str]:
    """Yield a warning if the filter's amplifiers drive too small a load for their full swing."""
    board = design.board
    passing_uf = 1e6 * capacitor_f
    load_ohm = filter_load_ohm
    if load_ohm >= MIN_LOAD_OHM:
        return

    while load_ohm < MIN_LOAD_OHM:  # resistors grow as the capacitors shrink
        passing_uf = float(f"{find_preferred_neighbours(0.99 * passing_uf)[0]:.3g}")
        values = {"board.capacitor_uf": passing_uf, "board.capacitor_series": "given"}
        circuit = board_circuit(select_components(design.with_values(values)))
        load_ohm = find_filter_load_ohm(circuit, find_gain_bandwidth_hz(board), board.cutoff_hz)

    settings = f"board.capacitor_uf={passing_uf:.3g}"
    if board.capacitor_series != "given":
        settings = f"board.capacitor_series=given and {settings}"

    yield (
        f"the amplifiers of the filter (U1) drive {filter_load_ohm:.0f} ohm between "
        f"{board.cutoff_hz:g} Hz and "
        f"{BAND_CUTOFFS * board.cutoff_hz:g} Hz. Their data sheets state the output swing for "
        f"{MIN_LOAD_OHM:.0f} ohm "
        f"and above, so they may clip earlier than stated; set, for example, {settings}."
    )


# Stability of the amplifiers with two poles: phase margin of each loop, and resonances of the
# filter.
#
# The loop of an amplifier is opened at its output: a source drives the net instead, and the
# difference of its inputs is what is fed back. The circuit around it is that of
# `fingertip.board.circuits.network`, with the capacitances of all inputs. Outputs have no
# resistance, so a capacitive load is not covered.

LOOP_HZ = 1e3, 1e9
"""Band in which a loop's gain falls to 1 [Hz]."""
_LOOP_POINTS = 73
PEAK_HZ = 1e4, 1e8
"""Band beyond the passband in which a resonance is searched [Hz]."""
_PEAK_POINTS = 97


def compute_phase_margins_deg(circuit: Circuit, network: Network) -> dict[str, float]:
    """Compute the phase margin of each operational amplifier [degree], by reference and unit."""
    f = np.geomspace(*LOOP_HZ, _LOOP_POINTS)
    margins = {}

    for amplifier, _, output, (plus, minus), data in list_amplifiers(circuit):
        if data:
            fed_back = _voltage(network, f, minus, output) - _voltage(network, f, plus, output)
            open_loop = np.array([data.open_loop_gain(hz) for hz in f.tolist()])
            margins[amplifier] = _find_margin_deg(open_loop * fed_back)

    return margins


def _voltage(network: Network, f: Array, net: str, driven: str) -> Spectrum:
    if net == driven:
        return np.ones(len(f), dtype=np.complex128)

    opened = network.drive(driven).restrict(net)
    if net in opened.inputs:
        return np.zeros(len(f), dtype=np.complex128)

    return opened.response(f, {driven: 1.0}, net)[:, 0]


def _find_margin_deg(loop: Spectrum) -> float:
    """Return the phase above -180 degrees where a loop's gain last falls through 1 [degree]."""
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
    """Compute the filter's gain from the tactile voltage with two-pole amplifiers."""
    part = add_second_poles(network.drive(TACTILE).restrict(FILTERED), circuit, f_hz)
    return part.response(f_hz, {TACTILE: 1.0}, FILTERED)[:, 0]


def compute_peaking_db(circuit: Circuit, network: Network, passband_gain: float) -> float:
    """Compute the ratio of the filter's largest gain beyond the passband to the passband's [dB]."""
    gains = compute_two_pole_gain(circuit, network, np.geomspace(*PEAK_HZ, _PEAK_POINTS))
    return 20.0 * math.log10(float(np.abs(gains).max()) / passband_gain)
