"""Load of the amplifiers of signal path and bridge: what each drives in the band of the vibrations.

Data sheets state the output swing for a load of 2 kohm or more. The rectifying diode counts as conducting, without its
drop, so the current that charges the envelope's capacitor is an upper bound: at the current's peak both ends of the
diode rise equally fast, and the capacitor's end is at the lower voltage. The buffers of VMID and VREF are not covered.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from fingertip.board.analysis.response import RECTIFYING_DIODE
from fingertip.board.circuit import Circuit
from fingertip.board.nets import TACTILE
from fingertip.board.network import Spectrum, build_network, list_amplifiers
from fingertip.design.amplifier_stages import BAND_CUTOFFS
from fingertip.design.parameters import Board
from fingertip.design.preferred_series import find_preferred_neighbours

MIN_LOAD_OHM = 2e3
"""Smallest load for which the data sheets of both amplifiers state their output swing."""
_MARGIN = 0.88
_FREQUENCIES = 30
"""Number of frequencies at which the loads are evaluated."""
_FILTER_AMPLIFIERS = ("U1a", "U1b")
_OTHER_BUFFERS = ("U5", "U6")
"""Amplifiers that drive the signal ground or feed the bridge, whose load is not an impedance to signal ground."""


@dataclass(frozen=True)
class AmplifierLoad:
    """Load of one amplifier over the band of the vibrations."""

    amplifier: str
    """Reference, with the letter of its unit."""
    min_ohm: float
    """Smallest ratio of its output's voltage to its current [ohm], with the current through the rectifying diode."""
    min_filter_ohm: float | None
    """Smallest such ratio without the current through the diode [ohm]; None if the amplifier drives only the diode."""
    max_current_a: float
    """Peak of the current for the largest vibrations that are not clipped [A]; through the diode an upper bound."""


def signal_band_hz(cutoff_hz: float) -> tuple[float, float]:
    """Band of the vibrations [Hz]: from the cutoff to `BAND_CUTOFFS` cutoffs."""
    return cutoff_hz, BAND_CUTOFFS * cutoff_hz


def compute_amplifier_loads(
    circuit: Circuit, gain_bandwidth_hz: float, cutoff_hz: float, vibration_v: float
) -> tuple[AmplifierLoad, ...]:
    """Compute the load of each amplifier between the bridge and the envelope, in the order of their references.

    Parameters
    ----------
    circuit
        Circuit of the board.
    gain_bandwidth_hz
        Gain-bandwidth product of the filter's amplifiers [Hz].
    cutoff_hz
        Cutoff of the design.
    vibration_v
        Peak of the tactile voltage's vibrations for which currents are computed [V].
    """
    loads = []
    for current in compute_output_currents(circuit, gain_bandwidth_hz, cutoff_hz):
        if current.reference in _OTHER_BUFFERS:
            continue
        total_a, filter_a = np.abs(current.filter_s + current.diode_s), current.filter_s
        loads.append(
            AmplifierLoad(
                current.amplifier,
                min_ohm=float((np.abs(current.gain) / total_a).min()),
                min_filter_ohm=float(np.abs(current.gain / filter_a).min()) if filter_a.any() else None,
                max_current_a=vibration_v * float(total_a.max()),
            )
        )
    return tuple(loads)


@dataclass(frozen=True, eq=False)
class OutputCurrent:
    """Current of one amplifier's output over the band of the vibrations, for 1 V of the tactile voltage."""

    amplifier: str
    """Reference, with the letter of its unit."""
    reference: str
    """Reference of its component."""
    gain: Spectrum
    """Voltage of the output [V/V]."""
    filter_s: Spectrum
    """Current without the rectifying diode [A/V]."""
    diode_s: Spectrum
    """Current through the rectifying diode, as if it always conducted [A/V]."""


def compute_output_currents(circuit: Circuit, gain_bandwidth_hz: float, cutoff_hz: float) -> tuple[OutputCurrent, ...]:
    """Compute the current of each amplifier's output, in the order of their references."""
    network = build_network(circuit, gain_bandwidth_hz, conducting=[RECTIFYING_DIODE]).drive(TACTILE)
    f = np.geomspace(*signal_band_hz(cutoff_hz), _FREQUENCIES)
    volts = dict(zip(network.nets, network.response(f, {TACTILE: 1.0}, *network.nets).T, strict=True))
    volts[TACTILE] = np.ones(len(f), dtype=np.complex128)
    nets = circuit.net_by_pin
    branches = [
        (c.reference, nets[c.reference, "1"], nets[c.reference, "2"])
        for c in circuit.components
        if c.symbol.name in "RC" or c.reference == RECTIFYING_DIODE
    ]
    currents = []
    for amplifier, component, output in sorted(list_amplifiers(circuit)):
        filter_s, diode_s = np.zeros((2, len(f)), dtype=np.complex128)
        for reference, first, second in branches:
            if output not in (first, second):
                continue
            admittance = network.values[reference] * (2j * np.pi * f if reference.startswith("C") else 1.0)
            # What is not among the equations, such as a rail, carries no signal.
            difference = volts[output] - volts.get(second if output == first else first, 0.0)
            (diode_s if reference == RECTIFYING_DIODE else filter_s)[:] += admittance * difference
        currents.append(OutputCurrent(amplifier, component, volts[output], filter_s, diode_s))
    return tuple(currents)


def find_filter_load_ohm(loads: Iterable[AmplifierLoad]) -> float:
    """Find the smallest impedance that an amplifier of the two filter stages drives [ohm], without the diode."""
    return min(load.min_filter_ohm for load in loads if load.min_filter_ohm and load.amplifier in _FILTER_AMPLIFIERS)


def load_warnings(board: Board, filter_load_ohm: float, capacitor_f: float) -> Iterator[str]:
    """Find a filter whose amplifiers may swing less than computed, because they drive too small a load.

    Parameters
    ----------
    board
        Parameters of the board.
    filter_load_ohm
        Smallest impedance that an amplifier of the filter drives, without the rectifier.
    capacitor_f
        Fitted capacitance of C1, C2 and C3.
    """
    if filter_load_ohm >= MIN_LOAD_OHM:
        return
    # Resistors are inverse to the capacitors. The margin covers their rounding to preferred values, so a larger
    # capacitor may pass too.
    passing_uf, _ = find_preferred_neighbours(_MARGIN * 1e6 * capacitor_f * filter_load_ohm / MIN_LOAD_OHM)
    capacitor_uf = f"{passing_uf:.3g}"
    settings = f"board.capacitor_uf={capacitor_uf}"
    if board.capacitor_series != "given":
        settings = f"board.capacitor_series=given and {settings}"
    yield (
        f"the amplifiers of the filter (U1) drive {filter_load_ohm:.0f} ohm between {board.cutoff_hz:g} Hz and "
        f"{BAND_CUTOFFS * board.cutoff_hz:g} Hz. Their data sheets state the output swing for {MIN_LOAD_OHM:.0f} ohm "
        f"and above, so they may clip earlier than stated; set, for example, {settings}."
    )
