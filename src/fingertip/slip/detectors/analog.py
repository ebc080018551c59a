"""Detector `analog`: the article's detector, which works on the output of the analog filter board.

High-pass filter, rectifier and envelope are analog circuits on the board. Only the window mean and the threshold are
software (article, section III.A, eq. 12). The input is the envelope voltage as the ADC samples it.

The threshold is the design's. It does not depend on the board's noise: a rectifier without bias passes next to no
noise, while a precision rectifier passes as much as the detector `digital` sees.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, MutableSequence, Sequence

import numpy as np

from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.jit import CompiledLoop, as_samples
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.noise import DEVIATIONS, NoiseLevel
from fingertip.slip.detectors.registry import Detector, DetectorOutput


class AnalogDetector(Detector):
    """Moving average of the board's envelope, compared with a threshold.

    Before the first sample the board's output is taken as 0 V.

    Units: `window_samples` [samples].
    """

    def __init__(self, sample_rate_hz: float, window_samples: int, threshold_v: float) -> None:
        self.sample_rate_hz = sample_rate_hz
        self._threshold_v = threshold_v
        self._ring_buffer = [0.0] * window_samples
        self._state = [0.0, 0.0]

    @classmethod
    def from_design(cls, design: Design, threshold_scale: float = 1.0) -> AnalogDetector:
        """Create the detector with a design's window and threshold, the threshold times a factor."""
        detector = design.detector
        return cls(detector.sample_rate_hz, detector.window_samples, detector.threshold_v * threshold_scale)

    @classmethod
    def for_design(cls, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0) -> AnalogDetector:
        """Create the detector for a design. Raises TraceError."""
        if noise_v is not None:
            message = (
                f"{noise_v:g} V of input noise does not determine the threshold of the detector analog, which applies "
                "to the board's output; set detector.threshold_v instead."
            )
            raise TraceError(Issue("noise_v", message))
        return cls.from_design(design, threshold_scale)

    @property
    def threshold_v(self) -> float:
        """Window mean above which slip is ON [V]."""
        return self._threshold_v

    @property
    def memory_s(self) -> float:
        """Window length [s]."""
        return len(self._ring_buffer) / self.sample_rate_hz

    def process(self, voltage_v: Iterable[float]) -> DetectorOutput:
        """Process the next samples of the envelope [V], any number of them, and return one output per sample."""
        samples = as_samples(voltage_v)
        mean = np.zeros(len(samples))
        _LOOP(samples, self._state, self._ring_buffer, mean)
        return DetectorOutput(mean, np.full(len(mean), self.threshold_v), mean > self.threshold_v)

    def step(self, voltage_v: float) -> bool:
        """Process one sample of the envelope [V] and return whether slip is ON."""
        mean = [0.0]
        _LOOP.plain((voltage_v,), self._state, self._ring_buffer, mean)
        return mean[0] > self.threshold_v


# Indices into the loop's state.
SUM = 0
POSITION = 1


def _moving_average_loop(
    samples: Sequence[float],
    state: MutableSequence[float],
    ring_buffer: MutableSequence[float],
    means: MutableSequence[float],
) -> None:
    total, position, length = state[SUM], int(state[POSITION]), len(ring_buffer)
    for i in range(len(samples)):
        # Replace the oldest sample in the window by the newest, in the buffer and in the running sum.
        x = samples[i]
        total += x - ring_buffer[position]
        ring_buffer[position] = x
        position += 1
        # Sum the whole buffer once per revolution, so that rounding errors of the running sum do not accumulate.
        if position == length:
            position, total = 0, 0.0
            for j in range(length):
                total += ring_buffer[j]
        means[i] = total / length
    state[SUM], state[POSITION] = total, float(position)


_LOOP = CompiledLoop(_moving_average_loop, outputs=3, samples="samples", plain_us=0.2)


def measure_noise_level(envelope_v: Array, design: Design, name: str) -> NoiseLevel:
    """Measure the noise level of a board's quiescent output, after the design's window. Raises TraceError."""
    d = design.detector
    minimum = 11 * d.window_samples
    if len(envelope_v) < minimum:
        samples = f"{len(envelope_v)} sample{'s' * (len(envelope_v) != 1)}"
        min_s = math.ceil(round(1000 * minimum / d.sample_rate_hz, 6)) / 1000
        raise TraceError(Issue("--calibrate", f"covers {samples} of {name}; choose at least {min_s:g} s."))
    means = AnalogDetector.from_design(design).process(envelope_v).statistic_v[d.window_samples :]
    step = d.adc_step_v
    return NoiseLevel(float(means.mean()), max(float(means.std()), step / DEVIATIONS))
