"""Load of the filter's amplifiers: data sheets state their output swing for a load of 2 kohm or more."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fingertip.board.circuit import Circuit
from fingertip.board.nets import FILTERED, STAGE1_OUT, TACTILE
from fingertip.board.network import Spectrum, build_network
from fingertip.design.parameters import Board

MIN_LOAD_OHM = 2e3
"""Smallest load for which the data sheets of both amplifiers state their output swing."""
_MARGIN = 0.88
_FREQUENCIES = 60
"""Number of frequencies at which the load is evaluated."""


def compute_filter_load_ohm(circuit: Circuit, gain_bandwidth_hz: float, band_hz: tuple[float, float]) -> float:
    """Compute the smallest impedance that an amplifier of the filter drives within a band [ohm].

    It is the ratio of the amplifier's voltage to its current. Inputs of amplifiers and diodes draw none.
    """
    network = build_network(circuit, gain_bandwidth_hz).drive(TACTILE).restrict(FILTERED)
    f = np.geomspace(*band_hz, _FREQUENCIES)
    volts = dict(zip(network.nets, network.response(f, {TACTILE: 1.0}, *network.nets).T, strict=True))
    ends = {
        c.reference: [n.name for n in circuit.nets if (c.reference, "1") in n.nodes or (c.reference, "2") in n.nodes]
        for c in circuit.components
        if c.symbol.name in "RC"
    }

    def current(reference: str, output: str, other: str) -> Spectrum:
        admittance = network.values[reference] * (2j * np.pi * f if reference.startswith("C") else 1.0)
        # What is not part of the filter, such as the rectifier's virtual ground, is at the signal ground.
        return np.asarray(admittance * (volts[output] - volts.get(other, 0.0)))

    loads = []
    for output in (STAGE1_OUT, FILTERED):
        branches = [(r, *nets) for r, nets in ends.items() if output in nets]
        total = sum(current(r, output, b if a == output else a) for r, a, b in branches)
        loads.append(float(np.abs(volts[output] / total).min()))
    return min(loads)


def load_warnings(board: Board, filter_load_ohm: float, capacitor_f: float) -> Iterator[str]:
    """Find a filter whose amplifiers may swing less than computed, because they drive too small a load.

    Parameters
    ----------
    board
        Parameters of the board.
    filter_load_ohm
        Smallest impedance that an amplifier drives.
    capacitor_f
        Fitted capacitance of C1, C2 and C3.
    """
    if filter_load_ohm >= MIN_LOAD_OHM:
        return
    # Resistors are inverse to the capacitors; the margin covers their rounding to preferred values.
    capacitor_uf = f"{_MARGIN * 1e6 * capacitor_f * filter_load_ohm / MIN_LOAD_OHM:.3g}"
    remedy = f"set board.capacitor_uf to at most {capacitor_uf}"
    if board.capacitor_series != "given":
        remedy = f"set board.capacitor_series=given and board.capacitor_uf={capacitor_uf}"
    yield (
        f"the filter's amplifiers drive {filter_load_ohm:.0f} ohm. Their data sheets state the output swing for "
        f"{MIN_LOAD_OHM:.0f} ohm and above, so they may clip earlier than stated; {remedy}."
    )
