"""Sampled envelope of the design's simulated board: the place where the envelope meets the ADC.

The board is driven by simulated traces, by recorded voltages, by a stream, or by noise alone (quiescent output).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable

import numpy as np

from fingertip.board import board_circuit
from fingertip.board.analysis.noise import add_noise
from fingertip.board.components.values import select_components
from fingertip.board.parts.circuit import FILTERED
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.foundation.numerics import Array
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.bridge import Bridge
from fingertip.sim.signal.converter import AdcRange, AntiAliasFilter, Converter, sample_v
from fingertip.sim.signal.filter_board import AnalogStream, simulate_board
from fingertip.sim.signal.grid import BASE_HZ, Grid, SampleClock, count_samples, draw_noise, open_stream
from fingertip.slip.detectors.analog import AnalogDetector, measure_noise_level
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.noise import NoiseLevel, input_noise_v

# Noise of the board's amplifiers, so that a simulated board is as noisy as its noise budget.
#
# Nearly all of this noise arises ahead of the filter, in the bridge's amplifier, and much of that lies beyond what the
# grid holds (`fingertip.board.analysis.noise`). The simulation adds white noise at the points of the base grid to the
# board's input, of the strength that makes the filter's output as noisy as the noise budget, from 0.1 Hz to 1 MHz. So
# the noise ahead of the rectifier has the right strength, and with it the envelope's quiescent level, at every
# sampling rate.
#
# The noise of the ADC is separate: it is added after the board's gain (`fingertip.sim.signal.converter`).


_MEMORY_S = 0.1
"""Time in which the filter forgets an impulse at a cutoff of 67 Hz [s]: seven periods."""
_SMALL_V = 1e-6
"""Impulse too small for the diode to conduct [V]."""


@functools.lru_cache(maxsize=256)
def compute_input_noise_v(design: Design) -> float:
    """Compute the white RMS noise at the board's input, on the base grid, that stands for its amplifiers' noise [V]."""
    circuit = board_circuit(select_components(design))
    return add_noise(circuit, find_gain_bandwidth_hz(design.board)).total_v(FILTERED) / compute_noise_gain(design)


def compute_noise_gain(design: Design) -> float:
    """Compute the standard deviation at the filter's output for white noise of deviation 1 on the base grid."""
    impulse = np.zeros(2 + round(_MEMORY_S * BASE_HZ * 67.0 / design.board.cutoff_hz))
    impulse[1] = _SMALL_V
    h = simulate_board(AnalogBoard.from_design(design), 1 / BASE_HZ, impulse).filtered_v / _SMALL_V
    return math.sqrt(float(h @ h))


_WINDOWS = 133
"""Number of detector windows of simulated noise: the standard deviation is known to 6 %."""
_SETTLING_S = 0.1
"""Time in which the board settles before its noise counts [s]."""


def simulate_envelope_v(design: Design, voltage_v: Array) -> Array:
    """Simulate the board's sampled envelope [V] for a sampled input [V] that is linear between samples.

    A recording has passed the anti-aliasing poles of the tactile voltage (`fingertip.sim.signal.converter`), which the
    real board's filter has not: the envelope comes out some 3 % low at 2 kHz, 12 % at 1 kHz.

    Raises TraceError.
    """
    board = AnalogBoard.from_design(design)
    envelope_v = simulate_board(board, 1 / design.detector.sample_rate_hz, voltage_v).envelope_v
    return sample_v(design, AntiAliasFilter.for_envelope(design).process(envelope_v), None)


class EnvelopeStream:
    """Sampled envelopes of several fingers' boards for voltages that come in chunks; any chunks give the same bits."""

    def __init__(self, design: Design) -> None:
        self._design = design
        self._boards: AnalogStream | None = None
        self._filters: list[AntiAliasFilter] = []

    def process(self, voltage_v: Array) -> Array:
        """Return the sampled envelopes of the next samples [V], (fingers, samples) like the voltages [V]."""
        if self._boards is None:
            step_s = 1 / self._design.detector.sample_rate_hz
            self._boards = AnalogStream(AnalogBoard.from_design(self._design), step_s, len(voltage_v))
            self._filters = [AntiAliasFilter.for_envelope(self._design) for _ in voltage_v]
        envelope_v = self._boards.process(voltage_v)[1]
        pairs = zip(envelope_v, self._filters, strict=True)
        return np.stack([sample_v(self._design, poles.process(row), None) for row, poles in pairs])


class SimulatedBoardDetector(Detector):
    """Detector `analog` behind the design's simulated board: raw voltage in, ON or OFF out.

    It is a detector like those of `fingertip.slip`: any chunks give the same bits, and it is causal.
    """

    def __init__(self, design: Design) -> None:
        self._board, self._detector = EnvelopeStream(design), AnalogDetector.from_design(design)

    @property
    def threshold_v(self) -> float:
        """Mean of the envelope above which slip is ON [V]."""
        return self._detector.threshold_v

    @property
    def memory_s(self) -> float:
        """Length of the window [s]."""
        return self._detector.memory_s

    def process(self, voltage_v: Iterable[float]) -> DetectorOutput:
        """Process the next samples of the tactile voltage [V], any number of them, and return as many outputs."""
        samples = np.asarray(voltage_v if isinstance(voltage_v, np.ndarray) else list(voltage_v), dtype=np.float64)
        return self._detector.process(self._board.process(samples[None])[0] if len(samples) else samples)

    def step(self, voltage_v: float) -> bool:
        """Process one sample [V] and return whether slip is ON."""
        return self._detector.step(float(self._board.process(np.array([[voltage_v]]))[0, 0]))


def compute_bridge_v(design: Design, force_n: Array) -> Array:
    """Compute the bridge's voltage [V] for a normal force [N], without the sensor's hysteresis."""
    return Bridge.of_board(design).voltage_v(force_n)


def simulate_quiescent_level(design: Design) -> NoiseLevel:
    """Simulate the noise level of the detector `analog` behind the design's board while nothing happens.

    The board's amplifiers add noise ahead of the filter, the ADC adds noise behind it.
    """
    grid, rate = Grid(), design.detector.sample_rate_hz
    count = grid.count_points(_noise_s(design), rate)
    noise_v = draw_noise(open_stream(0, "quiescent board"), compute_input_noise_v(design), count)
    envelope_v = simulate_board(AnalogBoard.from_design(design), grid.step_s, noise_v).envelope_v
    poles = AntiAliasFilter.for_envelope(design, grid.step_s)
    adc = AdcRange.from_design(design).above_signal_ground(design)
    converter = Converter(design, poles, adc, grid.step_s, open_stream(0, "quiescent converter"))
    return _measure_level(design, converter.process(envelope_v, SampleClock(grid, rate).advance(count)))


def simulate_replay_level(design: Design) -> NoiseLevel:
    """Simulate the noise level of the detector `analog` behind a board that is simulated on a recorded voltage.

    The recording already contains the ADC's noise, which therefore comes ahead of the filter.
    """
    count = count_samples(_noise_s(design), design.detector.sample_rate_hz)
    return _measure_level(
        design, simulate_envelope_v(design, draw_noise(open_stream(0, "replayed noise"), input_noise_v(design), count))
    )


def _noise_s(design: Design) -> float:
    """Duration of the simulated noise [s]."""
    return _SETTLING_S + _WINDOWS * design.detector.window_samples / design.detector.sample_rate_hz


def _measure_level(design: Design, sampled_v: Array) -> NoiseLevel:
    """Measure the noise level of a sampled envelope.

    The threshold that follows is at least one step of the ADC: a diode without bias passes so little noise that the
    ADC shows none.
    """
    settled = sampled_v[round(_SETTLING_S * design.detector.sample_rate_hz) :]
    return measure_noise_level(settled, design, "simulated noise")
