"""Noise of the board, and the contribution of each component.

The analysis includes white noise, and the 1/f noise of the operational amplifiers, with typical
values; the corner of the AD623 lies below 10 Hz. The sensor's own 1/f noise stands in no data
sheet. On the article's board nearly all comes from the bridge's amplifier: its source impedance is
a few hundred ohm, its gain amplifies its 35 nV/sqrt(Hz) 68 times, and the first stage amplifies
them 68 times again, up to the bandwidth of either amplifier. A low-pass above the vibrations
removes most of it. The article has none. A transimpedance stage amplifies its own noise by 1 + R30
/ Rs for a sensor of Rs, which is 15 at 3 N.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fingertip.board.circuits.network import Network, build_network, list_amplifiers
from fingertip.board.components import front_end
from fingertip.board.components.front_end import (
    BOLTZMANN_J_PER_K,
    TEMPERATURE_K,
    sensor_conductance_s,
)
from fingertip.board.parts.circuit import Circuit, parse_component_value
from fingertip.board.parts.nets import ADC_FILTERED, ADC_TACTILE, FILTERED, STAGE1_OUT, TACTILE
from fingertip.foundation.numerics import Array

NETS = (TACTILE, STAGE1_OUT, FILTERED, ADC_TACTILE)
"""Nets at which noise is reported: filter input, between its stages, filter output, ADC pin."""
NOISE_BAND_HZ = (0.1, 1e6)
NOISE_FORCE_N = 0.8
"""Force on the sensor: the middle one of the article's voltages."""
HALF_WAVE_MEAN = 1.0 / math.sqrt(2.0 * math.pi)
"""Mean of half-wave rectified Gaussian noise, in units of its standard deviation."""
LIMITING_CAPACITOR = "C20"
"""Capacitor across R5, which limits the band of the first stage."""
_POINTS_PER_DECADE = 50
"""Integration points per decade: the error of the integral is then at most 0.03 %."""


@dataclass(frozen=True)
class Source:
    """Cause of noise, and where it enters the equations."""

    name: str
    entries: dict[str, float]
    """Net -> what 1 A or 1 V of the source adds to the right-hand side of its equation."""
    noise: float
    """White noise density [A/sqrt(Hz) or V/sqrt(Hz)]."""
    corner_hz: float = 0.0
    """Frequency at which 1/f noise equals it [Hz]."""


@dataclass(frozen=True)
class Contribution:
    """Contribution of one cause at each of `NETS` [V]."""

    cause: str
    volts: tuple[float, ...]


@dataclass(frozen=True)
class NoiseLevels:
    """RMS noise over `NOISE_BAND_HZ` against supply ground [V], for typical data-sheet values."""

    tactile_v: float
    filtered_v: float
    tactile_pin_v: float
    filtered_pin_v: float
    """RMS noise of the filtered signal at the controller's pin, or else at the filter's output."""
    unlimited_pin_v: float
    """The same without C20, the low-pass of the first stage."""
    mean_envelope_v: float | None
    """Mean envelope due to noise; None in variant article, where the diode blocks it."""


@dataclass(frozen=True, eq=False)
class NoisyNetwork:
    network: Network
    sources: tuple[Source, ...]

    def squares(self, net: str) -> Array:
        """Return the mean square of each source's noise at a net over `NOISE_BAND_HZ` [V^2]."""
        low, high = NOISE_BAND_HZ
        f = np.geomspace(low, high, round(_POINTS_PER_DECADE * math.log10(high / low)) + 1)
        corners_hz = np.array([source.corner_hz for source in self.sources])
        density = np.array([source.noise for source in self.sources]) * np.sqrt(
            1.0 + corners_hz / f[:, None]
        )
        part = self.network.restrict(net)
        entries = np.array(
            [[source.entries.get(name, 0.0) for source in self.sources] for name in part.nets]
        )
        transfers = part.transfers(f, net) @ entries  # (frequencies, sources)

        return np.asarray(np.trapezoid(np.abs(transfers * density) ** 2, f, axis=0))

    def total_v(self, net: str) -> float:
        """Return the RMS noise of all sources at a net [V]."""
        return math.sqrt(float(self.squares(net).sum()))


def add_noise(circuit: Circuit, gain_bandwidth_hz: float) -> NoisyNetwork:
    """Build a circuit's network under `NOISE_FORCE_N`, with its sources of noise."""
    network = build_network(
        circuit, gain_bandwidth_hz, sensor_s=sensor_conductance_s(NOISE_FORCE_N)
    )
    return NoisyNetwork(network, tuple(_sources(circuit, network)))


def _sources(circuit: Circuit, network: Network) -> Iterator[Source]:
    amplifiers = tuple(list_amplifiers(circuit))
    for component in circuit.components:
        symbol = component.symbol.name
        reference = component.reference
        if component.value == "FSR" or (symbol == "R" and reference != front_end.GAIN_RESISTOR):
            own = [
                t.equation for t in network.terms if t.quantity == reference and t.equation == t.net
            ]
            # A current from one net to the other.
            entries = dict(zip(own, (1.0, -1.0), strict=False))
            yield Source(reference, entries, _thermal_noise(float(network.values[reference])))

        for name, _, out, _, data in (
            output for output in amplifiers if output.reference == reference
        ):
            if data:
                yield Source(name, {out: -1.0}, data.noise_v, data.noise_corner_hz)
                continue

            resistor_ohm = parse_component_value(circuit.component(front_end.GAIN_RESISTOR).value)
            gain = 1.0 + front_end.GAIN_CONSTANT_OHM / resistor_ohm
            noise_v = math.hypot(front_end.AD623_NOISE_V, front_end.AD623_OUTPUT_NOISE_V / gain)
            yield Source(reference, {out: -gain}, noise_v)
            # The gain resistor carries the input voltage, so its noise is amplified as noise at the
            # input is.
            yield Source(front_end.GAIN_RESISTOR, {out: 1.0 - gain}, _thermal_noise(resistor_ohm))


def _thermal_noise(value: float) -> float:
    """Return sqrt(4 k T x): Johnson-Nyquist noise current of x [S], or voltage of x [ohm]."""
    return math.sqrt(4.0 * BOLTZMANN_J_PER_K * TEMPERATURE_K * value)


def compute_noise_levels(
    circuit: Circuit, gain_bandwidth_hz: float, envelope_gain: float | None
) -> NoiseLevels:
    board = add_noise(circuit, gain_bandwidth_hz)
    unlimited = add_noise(circuit.without(LIMITING_CAPACITOR), gain_bandwidth_hz)
    pin = ADC_FILTERED if ADC_FILTERED in circuit.net_by_pin.values() else FILTERED
    tactile_v, filtered_v, tactile_pin_v, pin_v = map(
        board.total_v, (TACTILE, FILTERED, ADC_TACTILE, pin)
    )
    mean_envelope_v = None if envelope_gain is None else HALF_WAVE_MEAN * envelope_gain * filtered_v

    return NoiseLevels(
        tactile_v=tactile_v,
        filtered_v=filtered_v,
        tactile_pin_v=tactile_pin_v,
        filtered_pin_v=pin_v,
        unlimited_pin_v=unlimited.total_v(pin),
        mean_envelope_v=mean_envelope_v,
    )


def noise_warning(noise: NoiseLevels, threshold_v: float) -> str:
    """Return a warning if noise alone brings the envelope to the threshold, or ""."""
    if noise.mean_envelope_v is None or noise.mean_envelope_v < threshold_v:
        return ""

    return (
        f"noise alone raises the mean envelope to {1e3 * noise.mean_envelope_v:.1f} mV, and "
        f"detector.threshold_v is {1e3 * threshold_v:g} mV: this board reports slip without "
        "contact. Raise the "
        "threshold, or lower board.passband_gain or board.band_limit_hz."
    )


def noise_budget(board: NoisyNetwork) -> tuple[tuple[Contribution, ...], tuple[float, ...]]:
    """Compute the RMS noise of each source and in total at `NETS`; by that at FILTERED."""
    squares = [board.squares(net) for net in NETS]
    rows = [
        Contribution(source.name, tuple(math.sqrt(float(square[i])) for square in squares))
        for i, source in enumerate(board.sources)
    ]
    rows.sort(key=lambda row: -row.volts[NETS.index(FILTERED)])

    return tuple(rows), tuple(math.sqrt(float(square.sum())) for square in squares)
