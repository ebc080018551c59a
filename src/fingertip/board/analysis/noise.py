"""Noise of the board: the contribution of each component, and what would reduce it. Needs numpy.

The analysis includes white noise only, with typical data-sheet values. Nearly all of it comes from the bridge's
amplifier: its source impedance is a few hundred ohm, its gain amplifies its 35 nV/sqrt(Hz) 68 times, and the first
stage amplifies them 68 times again, up to the bandwidth of either amplifier. A low-pass above the vibrations removes
most of it. The article has none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.board.analysis.nodal_analysis import System, build_equations
from fingertip.board.circuit import Circuit, Component, Net, format_component_value, parse_component_value
from fingertip.board.kicad import symbols
from fingertip.board.nets import FEEDBACK, STAGE1_OUT
from fingertip.board.values.amplifiers import AD623_NOISE_V, LOW_NOISE_NAME, LOW_NOISE_V
from fingertip.board.values.bridge import sensor_conductance_s
from fingertip.board.values.noise_and_ripple import HALF_WAVE_MEAN, NOISE_BAND_HZ, NOISE_FORCE_N
from fingertip.board.values.preferred_values import nearest_value
from fingertip.design.filter_components import compute_limiting_capacitor_f

NETS = ("TACTILE", "STAGE1_OUT", "FILTERED", "ADC_TACTILE")
"""Nets at which noise and offset are reported: before the filter, between its stages, before the rectifier, ADC pin."""
LIMITING_CAPACITOR = "C20"
"""Capacitor across R5, which limits the band of the first stage."""
_POINTS_PER_DECADE = 50
"""Integration points per decade: the error of the integral is then at most 0.03 %."""


@dataclass(frozen=True)
class Contribution:
    """Contribution of one cause at each of `NETS` [V]."""

    cause: str
    volts: tuple[float, ...]


@dataclass(frozen=True)
class NoiseAlternative:
    """Noise of this variant, or of this variant with a change."""

    change: str
    filtered_v: float
    """RMS noise ahead of the rectifier [V]."""
    mean_envelope_v: float | None
    """Mean envelope due to the noise [V]. None in variant article: the noise is below its diode's threshold."""


def noise_budget(system: System) -> tuple[tuple[Contribution, ...], tuple[float, ...]]:
    """Compute the RMS noise over `NOISE_BAND_HZ` of each source at each of `NETS`, and the total.

    The source with the largest noise at FILTERED comes first.
    """
    squares = [_squares(system, net) for net in NETS]
    rows = [
        Contribution(source.name, tuple(math.sqrt(float(square[i])) for square in squares))
        for i, source in enumerate(system.sources)
    ]
    rows.sort(key=lambda row: -row.volts[NETS.index("FILTERED")])
    return tuple(rows), tuple(math.sqrt(float(square.sum())) for square in squares)


def total_noise_v(circuit: Circuit, gain_bandwidth_hz: float, net: str) -> float:
    """Compute the RMS noise of all sources together over `NOISE_BAND_HZ` at one net [V]."""
    system = build_equations(circuit, gain_bandwidth_hz, sensor_conductance_s(NOISE_FORCE_N))
    return math.sqrt(float(_squares(system, net).sum()))


def _squares(system: System, net: str) -> NDArray[np.float64]:
    """Mean square of each source's noise at a net [V^2]."""
    low, high = NOISE_BAND_HZ
    f = np.logspace(math.log10(low), math.log10(high), round(_POINTS_PER_DECADE * math.log10(high / low)) + 1)
    density = np.array([source.noise for source in system.sources])
    return np.asarray(np.trapezoid(np.abs(system.source_transfers(f, net) * density) ** 2, f, axis=0))


def compare_noise_alternatives(
    circuit: Circuit, gain_bandwidth_hz: float, band_limit_hz: float, has_diode: bool
) -> tuple[NoiseAlternative, ...]:
    """Compute the noise of this variant, with and without the first stage's band limit, and with a low-noise amplifier.

    Parameters
    ----------
    circuit
        Circuit of this variant.
    gain_bandwidth_hz
        Gain-bandwidth product of the filter's amplifier [Hz].
    band_limit_hz
        Band limit of the first stage [Hz].
    has_diode
        Whether a bare diode precedes the envelope (variant article, which has no band limit).
    """
    if has_diode:
        other, preposition = _with_limiter(circuit, band_limit_hz), "with"
    else:
        other, preposition = _without(circuit, LIMITING_CAPACITOR), "without"
    alternatives = []
    for change, board in (("this variant", circuit), (f"{preposition} {LIMITING_CAPACITOR} across R5", other)):
        rows, _ = noise_budget(build_equations(board, gain_bandwidth_hz, sensor_conductance_s(NOISE_FORCE_N)))
        volts = {row.cause: row.volts[NETS.index("FILTERED")] for row in rows}
        alternatives.append(_alternative(change, volts, has_diode))
        low_noise = {**volts, "U2": volts["U2"] * LOW_NOISE_V / AD623_NOISE_V}
        alternatives.append(_alternative(f"{change}, {LOW_NOISE_NAME} for U2", low_noise, has_diode))
    return tuple(alternatives)


def _alternative(change: str, volts: dict[str, float], has_diode: bool) -> NoiseAlternative:
    total = math.sqrt(math.fsum(v * v for v in volts.values()))
    return NoiseAlternative(change, total, None if has_diode else HALF_WAVE_MEAN * total)


def _without(circuit: Circuit, reference: str) -> Circuit:
    nets = (Net(n.name, tuple(node for node in n.nodes if node[0] != reference)) for n in circuit.nets)
    return Circuit(circuit.name, tuple(p for p in circuit.components if p.reference != reference), tuple(nets))


def _with_limiter(circuit: Circuit, band_limit_hz: float) -> Circuit:
    """Add `LIMITER` to a circuit that lacks it."""
    farad = nearest_value(
        compute_limiting_capacitor_f(parse_component_value(circuit.component("R5").value), band_limit_hz),
        "E6",
        1e-12,
        1e-3,
    )
    pins = {STAGE1_OUT: (LIMITING_CAPACITOR, "1"), FEEDBACK: (LIMITING_CAPACITOR, "2")}
    nets = (Net(n.name, (*n.nodes, pins[n.name])) if n.name in pins else n for n in circuit.nets)
    return Circuit(
        circuit.name,
        (
            *circuit.components,
            Component(LIMITING_CAPACITOR, format_component_value(farad), symbols.CAPACITOR, symbols.C_0603, ""),
        ),
        tuple(nets),
    )
