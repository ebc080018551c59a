"""Sampled envelope of the design's simulated board: the place where the envelope meets the ADC.

The board is driven by simulated traces, by recorded voltages, by a stream, or by noise alone (quiescent output).
"""

from __future__ import annotations

import random
from collections.abc import Iterable

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.sim.signal.converter import AntiAliasFilter, draw_noise_v, sample_v
from fingertip.sim.signal.filter_board import AnalogStream, simulate_board
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.board_noise import compute_input_noise_v
from fingertip.sim.signal.fsr import select_voltage_function
from fingertip.slip.detectors.analog import AnalogDetector
from fingertip.slip.detectors.detector import DetectorOutput
from fingertip.slip.detectors.noise import NoiseLevel, input_noise_v, measure_noise_level

_WINDOWS = 133
"""Number of detector windows of simulated noise: the standard deviation is known to 6 %."""


def sample_envelope_v(
    design: Design, envelope_v: Array, rng: random.Random | None, anti_alias: AntiAliasFilter | None = None
) -> Array:
    """Sample the board's envelope output with the ADC: the anti-aliasing pole, then noise and quantisation [V].

    Parameters
    ----------
    design
        Its board and ADC.
    envelope_v
        Envelope at the samples, ahead of the ADC [V].
    rng
        Source of the ADC's noise. None: the ADC has no noise.
    anti_alias
        Filter that keeps its state between chunks. None: a new one, in the steady state of the first sample.
    """
    poles = anti_alias or AntiAliasFilter.for_envelope(design)
    return sample_v(design, poles.process(envelope_v), rng)


def simulate_envelope_v(design: Design, voltage_v: Array) -> Array:
    """Simulate the board's sampled envelope [V] for a sampled input [V] that is linear between samples.

    A recording has passed the anti-aliasing poles of the tactile voltage (`fingertip.sim.signal.converter`), which the
    real board's filter has not: the envelope comes out some 3 % low at 2 kHz, 12 % at 1 kHz.

    Raises
    ------
    TraceError
        If a sample is not finite.
    """
    board = AnalogBoard.from_design(design)
    envelope_v = simulate_board(board, 1 / design.detector.sample_rate_hz, voltage_v).envelope_v
    return sample_envelope_v(design, envelope_v, None)


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
        return np.stack([sample_envelope_v(self._design, row, None, poles) for row, poles in pairs])


class SimulatedBoardDetector:
    """Detector `analog` behind the design's simulated board: raw voltage in, ON or OFF out.

    It is a detector like those of `fingertip.slip`: any chunks give the same bits, and it is causal.

    Parameters
    ----------
    design
        Its board, ADC, window and threshold.
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
    voltage = select_voltage_function(design, "board")
    return np.array([voltage(force) for force in force_n.tolist()])


def simulate_quiescent_level(design: Design) -> NoiseLevel:
    """Simulate the noise level of the detector `analog` behind the design's board while nothing happens.

    The board's amplifiers add noise ahead of the filter, the ADC adds noise behind it.
    """
    return _simulate_level(design, compute_input_noise_v(design), random.Random("converter"))


def simulate_replay_level(design: Design) -> NoiseLevel:
    """Simulate the noise level of the detector `analog` behind a board that is simulated on a recorded voltage.

    The recording already contains the ADC's noise, which therefore comes ahead of the filter.
    """
    return _simulate_level(design, input_noise_v(design), None)


def _simulate_level(design: Design, sigma_v: float, adc: random.Random | None) -> NoiseLevel:
    """Measure the noise level on the simulated board.

    The threshold that follows is at least one step of the ADC: a diode without bias passes so little noise that the
    ADC shows none.
    """
    d = design.detector
    settling = round(0.1 * d.sample_rate_hz)
    noise = draw_noise_v(random.Random(0), sigma_v, _WINDOWS * d.window_samples + settling)
    envelope_v = simulate_board(AnalogBoard.from_design(design), 1 / d.sample_rate_hz, noise).envelope_v
    return measure_noise_level(sample_envelope_v(design, envelope_v, adc)[settling:], design, "simulated noise")
