"""Detectors `digital` and `analog`: the mean of an envelope over a window against a threshold
(article, eq. 12).

The article's chain is high-pass filter, half-wave rectifier, envelope filter (so far analog),
window mean, threshold.

`digital` does all in software, from the raw tactile voltage. The filters are the board's ideal
filters by the bilinear transform, the rectifier is an ideal diode without a dead zone, and the
envelope filter is a one-pole follower without the faster attack of the board's.

`analog` takes the envelope voltage as the ADC samples it (article, section III.A). Its threshold is
the design's. It does not depend on the board's noise: a rectifier without bias passes next to no
noise, while a precision rectifier passes as much as the detector `digital` sees.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fingertip.design import Design
from fingertip.design.formulas.filter import SECTION_QUALITY as Q
from fingertip.foundation.errors import Issue, TraceError, checked
from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats, as_samples
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.noise_and_threshold import DEVIATIONS, NoiseLevel, input_noise_v


@dataclass(frozen=True)
class ChainSettings:
    sample_rate_hz: float
    cutoff_hz: float
    gain: float
    envelope_cutoff_hz: float
    window_samples: int
    threshold_v: float

    @classmethod
    def from_design(cls, design: Design) -> ChainSettings:
        """Take the settings from a design: the board's ideal
        filters, the detector's window and threshold.
        """
        b = design.board
        d = design.detector
        window = d.window_samples
        threshold_v = d.threshold_v

        return cls(
            sample_rate_hz=d.sample_rate_hz,
            cutoff_hz=b.cutoff_hz,
            gain=b.passband_gain,
            envelope_cutoff_hz=b.envelope_cutoff_hz,
            window_samples=window,
            threshold_v=threshold_v,
        )


@dataclass(frozen=True, eq=False)
class ChainOutput(DetectorOutput):
    """Output of the chain: one value per input sample; the
    statistic is the window's mean (article, eq. 12).
    """

    begin: tuple[tuple[float, ...], Floats | Array, tuple[float, ...]]
    """Coefficients, samples, and state of the filters before them."""

    @property
    def envelope_v(self) -> Array:
        """Envelope, computed anew [V]: an hour of it takes as much memory as the samples."""
        coefficients, samples, state = self.begin
        work = np.zeros(len(samples))
        _FILTER(coefficients, samples, list(state), work, work)
        return work


class FirstOrder(NamedTuple):
    """Coefficients of a first-order digital filter section."""

    b0: float
    b1: float
    a1: float


class SecondOrder(NamedTuple):
    """Coefficients of a second-order digital filter section (biquad)."""

    b0: float
    b1: float
    b2: float
    a1: float
    a2: float


@checked
class SlipChain(Detector):
    """The article's chain with its state.

    It starts as if the input had always had the value of the first sample.
    """

    def __init__(self, settings: ChainSettings) -> None:
        self.settings = settings
        first, second = high_pass(settings)
        # Pole of the analog envelope filter. The discrete step response equals the analog one at
        # the samples.
        smoothing = 1 - math.exp(
            -2 * math.pi * settings.envelope_cutoff_hz / settings.sample_rate_hz
        )
        self._coefficients = (*first, *second, smoothing)
        self._state = [0.0] * STATES
        self._started = False
        self._average = AnalogDetector(
            settings.sample_rate_hz, settings.window_samples, settings.threshold_v
        )
        self._threshold_v = settings.threshold_v
        self.memory_s = self._average.memory_s

    @classmethod
    @checked
    def for_design(
        cls, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0
    ) -> SlipChain:
        """Create the chain for a design.

        The threshold is the design's. A noise [V] gives the noise-derived threshold instead,
        rounded up as the default. So does a design for the detector `analog`, whose threshold is
        that of the board's output.
        """
        settings = ChainSettings.from_design(design)
        if noise_v is None and design.detector.kind != "analog":
            threshold_v = settings.threshold_v
        else:
            threshold_v = noise_level(design, noise_v).rounded_threshold_v

        return cls(replace(settings, threshold_v=threshold_v * threshold_scale))

    @classmethod
    def equivalent_noise_v(cls, design: Design, quiet_v: Array) -> float:
        """Noise from the mean and deviation of the window mean, as in the rule for its
        threshold.
        """
        settling = min(
            len(quiet_v) // 2,
            round(0.1 * design.detector.sample_rate_hz) + design.detector.window_samples,
        )
        means = cls(ChainSettings.from_design(design)).process(quiet_v).statistic_v[settling:]
        return float(means.mean() + DEVIATIONS * means.std()) / noise_level(design, 1.0).threshold_v

    def process(self, voltage_v: Iterable[float]) -> ChainOutput:
        samples = self._begin(voltage_v)
        begin = (self._coefficients, samples, tuple(self._state))

        # One array in turn: each loop reads a value before it writes in its place.
        work = np.zeros(len(samples))
        _FILTER(self._coefficients, samples, self._state, work, work)
        self._average.average(work, work)
        return ChainOutput(**vars(self._average.judge(work)), begin=begin)

    def filter(self, voltage_v: Iterable[float]) -> Array:
        """Process the next samples, and return the filtered signal, ahead of the rectifier [V]."""
        samples = self._begin(voltage_v)
        filtered = np.zeros(len(samples))
        _FILTER(self._coefficients, samples, self._state, filtered, np.zeros(len(samples)))
        return filtered

    def step(self, voltage_v: float) -> bool:
        self._start(voltage_v)
        envelope = [0.0]
        _FILTER.plain(self._coefficients, (voltage_v,), self._state, [0.0], envelope)
        return self._average.step(envelope[0])

    def _begin(self, voltage_v: Iterable[float]) -> list[float] | Array:
        samples = as_samples(voltage_v)
        if len(samples):
            self._start(float(samples[0]))

        return samples

    def _start(self, voltage_v: float) -> None:
        """Set the steady state of a constant input before the first
        sample: both sections' outputs are exactly 0.
        """
        if not self._started:
            self._started = True
            self._state[FIRST_ORDER] = -self._coefficients[0] * voltage_v


FIRST_ORDER, SECOND_ORDER_1, SECOND_ORDER_2, ENVELOPE = range(4)
"""Indices into the loop's state."""
STATES = 4


def _filter_loop(
    coefficients: Floats,
    samples: Floats,
    state: MutableFloats,
    filtered: MutableFloats,
    envelopes: MutableFloats,
) -> None:
    # First-order section (g), second-order section (b, a), smoothing factor of the envelope.
    g0, g1, g_a1, b0, b1, b2, a1, a2, smoothing = coefficients
    s = state[FIRST_ORDER]
    s1 = state[SECOND_ORDER_1]
    s2 = state[SECOND_ORDER_2]
    envelope = state[ENVELOPE]

    for i in range(len(samples)):
        # High-pass filter: both sections in transposed direct form II.
        x = samples[i]
        w = g0 * x + s
        s = g1 * x - g_a1 * w
        y = b0 * w + s1
        s1 = b1 * w - a1 * y + s2
        s2 = b2 * w - a2 * y

        # Half-wave rectifier and one-pole envelope filter.
        envelope += smoothing * ((y if y > 0.0 else 0.0) - envelope)
        filtered[i] = y
        envelopes[i] = envelope

    state[FIRST_ORDER] = s
    state[SECOND_ORDER_1] = s1
    state[SECOND_ORDER_2] = s2
    state[ENVELOPE] = envelope


_FILTER = CompiledLoop(_filter_loop, samples="samples", plain_us=0.4)


def high_pass(settings: ChainSettings) -> tuple[FirstOrder, SecondOrder]:
    """Compute the third-order Butterworth high-pass: a first-order section with the gain, then a
    second-order section.

    The analog prototypes are eqs. 1, 4 and 9 of the article. The bilinear transform is prewarped at
    the cutoff frequency, where the response is exact.
    """
    K = math.tan(math.pi * settings.cutoff_hz / settings.sample_rate_hz)
    g = settings.gain / (1 + K)
    norm = 1 / (1 + K / Q + K * K)
    first = FirstOrder(g, -g, (K - 1) / (K + 1))
    second = SecondOrder(
        b0=norm,
        b1=-2 * norm,
        b2=norm,
        a1=2 * (K * K - 1) * norm,
        a2=(1 - K / Q + K * K) * norm,
    )

    return first, second


def noise_level(design: Design, noise_v: float | None = None) -> NoiseLevel:
    """Compute the level of noise at the window mean of the design's chain.

    White Gaussian noise of deviation sigma leaves the high-pass filter with ``sigma sqrt(sum
    h^2)``. Its half wave has the mean ``sigma / sqrt(2 pi)``. The half wave is ``x/2 + |x|/2``. The
    high-pass filter has removed from the first term what is slow enough for the window to pass. The
    second term has the variance ``sigma^2 (1 - 2/pi) / 4`` and is averaged as if its samples were
    independent (a test compares the result with noise: within 10 %).
    """
    settings = ChainSettings.from_design(design)
    sigma = input_noise_v(design) if noise_v is None else noise_v

    memory = math.ceil(
        settings.sample_rate_hz / min(settings.cutoff_hz, settings.envelope_cutoff_hz) * 4
    )
    impulse = [0.0, 1.0] + [0.0] * memory
    h = SlipChain(settings).filter(impulse)
    sigma *= math.sqrt(float(h @ h))

    smoothing = 1 - math.exp(-2 * math.pi * settings.envelope_cutoff_hz / settings.sample_rate_hz)
    envelope = smoothing * (1 - smoothing) ** np.arange(memory)
    weights = np.convolve(envelope, np.full(settings.window_samples, 1 / settings.window_samples))
    deviation = sigma * math.sqrt((1 - 2 / math.pi) / 4 * float(weights @ weights))

    return NoiseLevel(sigma / math.sqrt(2 * math.pi), deviation)


class AnalogDetector(Detector):
    """Moving average of the board's envelope, compared with a threshold.

    Before the first sample the board's output is taken as 0 V. Units: `window_samples` [samples].
    """

    def __init__(self, sample_rate_hz: float, window_samples: int, threshold_v: float) -> None:
        self._threshold_v = threshold_v
        self.memory_s = window_samples / sample_rate_hz
        self._ring_buffer = [0.0] * window_samples
        self._state = [0.0, 0.0]

    @classmethod
    def for_design(
        cls, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0
    ) -> AnalogDetector:
        """Create the detector with a design's window, and its threshold times a factor.

        Raises TraceError.
        """
        if noise_v is not None:
            problem = (
                f"{noise_v:g} V of input noise does not determine the threshold of the "
                "detector analog"
            )
            remedy = "set detector.threshold_v instead."
            raise TraceError(
                Issue("noise_v", f"{problem}, which applies to the board's output; {remedy}")
            )

        d = design.detector
        return cls(d.sample_rate_hz, d.window_samples, d.threshold_v * threshold_scale)

    def process(self, voltage_v: Iterable[float]) -> DetectorOutput:
        samples = as_samples(voltage_v)
        mean = np.zeros(len(samples))
        self.average(samples, mean)
        return self.judge(mean)

    def average(self, samples: Floats | Array, mean: Array) -> None:
        """Write the mean over the window at each of the next samples, which may lie there [V]."""
        _AVERAGE(samples, self._state, self._ring_buffer, mean)

    def judge(self, mean: Array) -> DetectorOutput:
        """Compare means with the threshold [V]."""
        threshold = np.broadcast_to(self.threshold_v, mean.shape)
        return DetectorOutput(mean, threshold, mean > self.threshold_v)

    def step(self, voltage_v: float) -> bool:
        mean = [0.0]
        _AVERAGE.plain((voltage_v,), self._state, self._ring_buffer, mean)
        return mean[0] > self.threshold_v


_TOTAL, _PLACE = range(2)
"""Indices into the state of the moving average."""


def _moving_average_loop(
    samples: Floats, state: MutableFloats, ring_buffer: MutableFloats, means: MutableFloats
) -> None:
    total = state[_TOTAL]
    position = int(state[_PLACE])
    length = len(ring_buffer)

    for i in range(len(samples)):
        # Replace the oldest sample in the window by the newest, in the buffer and in the running
        # sum.
        x = samples[i]
        total += x - ring_buffer[position]
        ring_buffer[position] = x
        position += 1

        # Sum the whole buffer once per revolution, so that rounding errors of the running sum do
        # not accumulate.
        if position == length:
            position = 0
            total = 0.0
            for j in range(length):
                total += ring_buffer[j]

        means[i] = total / length

    state[_TOTAL] = total
    state[_PLACE] = float(position)


_AVERAGE = CompiledLoop(_moving_average_loop, samples="samples", plain_us=0.2)


def measure_noise_level(envelope_v: Array, design: Design, name: str) -> NoiseLevel:
    """Measure the noise level of a board's quiescent output, after the design's window.

    Raises TraceError.
    """
    d = design.detector
    minimum = 11 * d.window_samples

    if len(envelope_v) < minimum:
        samples = f"{len(envelope_v)} sample{'s' * (len(envelope_v) != 1)}"
        min_s = math.ceil(round(1000 * minimum / d.sample_rate_hz, 6)) / 1000
        raise TraceError(
            Issue("--calibrate", f"covers {samples} of {name}; choose at least {min_s:g} s.")
        )

    means = AnalogDetector.for_design(design).process(envelope_v).statistic_v[d.window_samples :]
    return NoiseLevel(float(means.mean()), max(float(means.std()), d.adc_step_v / DEVIATIONS))
