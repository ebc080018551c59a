"""The board's noise: what each part adds, what would lower it, and where that leaves the envelope. Needs numpy.

White noise only, typical figures of data sheets. Nearly all of it is the bridge's amplifier's: its input is a few
hundred ohm, and its 35 nV/sqrt(Hz) are amplified 68 times by itself, then 68 times by the first stage up to where
either amplifier's bandwidth ends. A low-pass above the vibrations takes most of that away; the article has none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.board.analysis.equations import equations
from fingertip.board.analysis.nodal import System
from fingertip.board.circuit import Circuit, Net, Part, engineering, farads_or_ohms
from fingertip.board.kicad import symbols
from fingertip.board.nets import FEEDBACK, STAGE1_OUT
from fingertip.board.values.amplifiers import AD623_NOISE_V, QUIET_NAME, QUIET_NOISE_V
from fingertip.board.values.bridge import sensor_conductance_s
from fingertip.board.values.preferred import nearest
from fingertip.board.values.white_noise import BAND_HZ, HALF_WAVE_MEAN, NOISE_FORCE_N
from fingertip.design.filter_components import limit_capacitor_f

NETS = ("TACTILE", "STAGE1_OUT", "FILTERED", "ADC_TACTILE")
"""Where noise and offset are looked at: ahead of the filter, between its stages, ahead of the rectifier, at the pin."""
LIMITER = "C20"
"""The capacitor across R5."""
_POINTS_PER_DECADE = 50
"""The integral is then within 0.03 % of its limit."""


@dataclass(frozen=True)
class Contribution:
    """What one cause adds at each of `NETS` [V]."""

    cause: str
    volts: tuple[float, ...]


@dataclass(frozen=True)
class Remedy:
    """The board as it is, or changed."""

    change: str
    filtered_v: float
    """Noise ahead of the rectifier, rms [V]."""
    rest_v: float
    """Mean of it behind a rectifier without dead zone [V]: where the envelope rests; hidden by variant article's diode."""


def budget(system: System) -> tuple[tuple[Contribution, ...], tuple[float, ...]]:
    """Root mean square over `BAND_HZ` of each source at each of `NETS`, largest at FILTERED first, and their sum."""
    squares = [_squares(system, net) for net in NETS]
    rows = [
        Contribution(source.name, tuple(math.sqrt(float(square[i])) for square in squares))
        for i, source in enumerate(system.sources)
    ]
    rows.sort(key=lambda row: -row.volts[NETS.index("FILTERED")])
    return tuple(rows), tuple(math.sqrt(float(square.sum())) for square in squares)


def total_v(circuit: Circuit, gain_bandwidth_hz: float, net: str) -> float:
    """Root mean square of all sources together over `BAND_HZ` at one net [V]."""
    system = equations(circuit, gain_bandwidth_hz, sensor_conductance_s(NOISE_FORCE_N))
    return math.sqrt(float(_squares(system, net).sum()))


def _squares(system: System, net: str) -> NDArray[np.float64]:
    """Mean square of each source at a net [V^2]."""
    low, high = BAND_HZ
    f = np.logspace(math.log10(low), math.log10(high), round(_POINTS_PER_DECADE * math.log10(high / low)) + 1)
    density = np.array([source.noise for source in system.sources])
    return np.asarray(np.trapezoid(np.abs(system.transfers(f, net) * density) ** 2, f, axis=0))


def remedies(circuit: Circuit, gain_bandwidth_hz: float, band_limit_hz: float, plain: bool) -> tuple[Remedy, ...]:
    """The noise as built, with and without the low-pass in the first stage, and with a quieter amplifier."""
    other, words = (_limited(circuit, band_limit_hz), "with") if plain else (_without(circuit, LIMITER), "without")
    found = []
    for change, board in (("as built", circuit), (f"{words} {LIMITER} across R5", other)):
        rows, _ = budget(equations(board, gain_bandwidth_hz, sensor_conductance_s(NOISE_FORCE_N)))
        volts = {row.cause: row.volts[NETS.index("FILTERED")] for row in rows}
        found.append(_remedy(change, volts))
        quiet = {**volts, "U2": volts["U2"] * QUIET_NOISE_V / AD623_NOISE_V}
        found.append(_remedy(f"{change}, {QUIET_NAME} for U2", quiet))
    return tuple(found)


def _remedy(change: str, volts: dict[str, float]) -> Remedy:
    total = math.sqrt(math.fsum(v * v for v in volts.values()))
    return Remedy(change, total, HALF_WAVE_MEAN * total)


def _without(circuit: Circuit, reference: str) -> Circuit:
    nets = (Net(n.name, tuple(node for node in n.nodes if node[0] != reference)) for n in circuit.nets)
    return Circuit(circuit.name, tuple(p for p in circuit.parts if p.reference != reference), tuple(nets))


def _limited(circuit: Circuit, band_limit_hz: float) -> Circuit:
    """The circuit with `LIMITER`, which it lacks."""
    farad = nearest(limit_capacitor_f(farads_or_ohms(circuit.part("R5").value), band_limit_hz), "E6", 1e-12, 1e-3)
    pins = {STAGE1_OUT: (LIMITER, "1"), FEEDBACK: (LIMITER, "2")}
    nets = (Net(n.name, (*n.nodes, pins[n.name])) if n.name in pins else n for n in circuit.nets)
    return Circuit(
        circuit.name,
        (*circuit.parts, Part(LIMITER, engineering(farad), symbols.CAPACITOR, symbols.C_0603, "")),
        tuple(nets),
    )
