"""Analog-to-digital converter (ADC): the anti-aliasing poles ahead of its pins, its jitter, noise
and quantisation.

The poles lie between the board's outputs and the ADC (R8, C9, R9, C19 for the tactile voltage; R7,
C8 for the envelope; R27, C25 for the filtered signal of a board for 3.3 V). Of a board without an
envelope, software computes it from the samples of the filtered signal. Between the points of a grid
the voltage is linear, which two RC sections follow exactly (`analog_circuit`). They delay by some
1.3 samples, whatever the sampling rate, because the board's values are selected for it.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from fingertip.board.analysis.noise import add_noise
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.components.values import SUPPLIES, select_components
from fingertip.board.parts.nets import (
    ADC_ENVELOPE,
    ADC_FILTERED,
    ADC_TACTILE,
    ENVELOPE,
    FILTERED,
    TACTILE,
)
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats, as_samples
from fingertip.foundation.numerics import Array
from fingertip.sim.signal.analog_circuit import AnalogBoard, augment, exponentials
from fingertip.sim.signal.filter_board import AnalogStream, simulate_board
from fingertip.sim.signal.grid import (
    BASE_HZ,
    Grid,
    Instants,
    SampleClock,
    Sampler,
    Stream,
    count_samples,
    draw_noise,
    open_stream,
)
from fingertip.slip.detectors.analog_and_digital import AnalogDetector, measure_noise_level
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.noise_and_threshold import NoiseLevel, input_noise_v

_FIRST, _SECOND, _INPUT = range(3)
"""Indices of the filter's state: voltages of the first and the second capacitor, and the previous
input [V].
"""

PINS = {ADC_TACTILE: TACTILE, ADC_ENVELOPE: ENVELOPE, ADC_FILTERED: FILTERED}
"""Pin of the ADC -> output of the board ahead of its filter.
The last one is on boards for a controller.
"""

_NO_POLES = (0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0)
"""Matrix of a pin without poles, whose voltage is the input."""


class AntiAliasFilter:
    """One or two poles that start in the steady state of their first sample and keep their state
    between chunks.
    """

    def __init__(self, matrix: tuple[float, ...]) -> None:
        self.matrix = matrix
        self._state: Array | None = None

    @classmethod
    def ahead_of(cls, pin: str, design: Design, step_s: float | None = None) -> AntiAliasFilter:
        """Filter of a board's pin, one of `PINS`.

        Without a step [s], it takes voltages at the samples.
        """
        return cls(
            _compute_poles(
                pin, design, 1 / design.detector.sample_rate_hz if step_s is None else step_s
            )
        )

    def process(self, voltage_v: Array, after_v: Array | None = None) -> Array:
        """Return the voltage at the pin [V].

        Where the input jumps, `after_v` is the voltage right after.
        """
        out = np.zeros(len(voltage_v))
        if len(voltage_v):
            if self._state is None:
                self._state = np.full(3, voltage_v[0])

            run_poles(
                self.matrix, voltage_v, voltage_v if after_v is None else after_v, self._state, out
            )

        return out


@functools.lru_cache(maxsize=256)
def _compute_poles(pin: str, design: Design, step_s: float) -> tuple[float, ...]:
    if not design.board.has_filter:  # the pin is the divider's own node
        return _NO_POLES

    source = PINS[pin]
    network = build_network(board_circuit(select_components(design))).drive(source)
    system = (
        network.ground(*(name for name in network.inputs if name != source))
        .restrict(pin)
        .state_space
    )
    step = exponentials(augment(system.A, system.B[:, 0]), step_s, 1)[0]
    # The loop has two states, the second of which is the voltage at the pin. One pole stands in
    # both.
    last = int(np.argmax(system.rows[pin][: len(system.A)]))
    order = [0 if last else len(system.A) - 1, last]
    n = len(system.A)
    rows = np.zeros((2, 4))
    rows[:, :2] = step[np.ix_(order, order)] if n == 2 else np.diag(step[:1, :1].repeat(2))
    # Scale the slope's column for the difference of two samples.
    rows[:, 2:] = step[order][:, n : n + 2] * [1.0, 1 / step_s]

    return tuple(rows.ravel().tolist())


def _filter_loop(
    matrix: tuple[float, ...],
    samples: Floats,
    after: Floats,
    state: MutableFloats,
    out: MutableFloats,
) -> None:
    a11, a12, b1, d1, a21, a22, b2, d2 = matrix
    x = state[_FIRST]
    y = state[_SECOND]
    u = state[_INPUT]

    for i in range(len(samples)):
        v = samples[i]
        x, y = a11 * x + a12 * y + b1 * u + d1 * (v - u), a21 * x + a22 * y + b2 * u + d2 * (v - u)
        u = after[i]
        out[i] = y

    state[_FIRST] = x
    state[_SECOND] = y
    state[_INPUT] = u


run_poles = CompiledLoop(_filter_loop, samples="samples", plain_us=0.5)


@dataclass(frozen=True)
class AdcRange:
    """Resolution and range of a converter."""

    bits: int
    low_v: float
    high_v: float

    @classmethod
    def from_design(cls, design: Design) -> AdcRange:
        """Range of the design's ADC against ground."""
        d = design.detector
        return cls(d.adc_bits, d.adc_low_v, d.adc_range_v)

    def above_signal_ground(self, design: Design) -> AdcRange:
        """The same range above the signal ground, which the controller subtracts from filtered
        signal and envelope.
        """
        ground_v = SUPPLIES[design.board.variant].signal_ground_v(design.board.supply_v)
        return replace(self, low_v=self.low_v - ground_v, high_v=self.high_v - ground_v)

    def quantise_v(self, voltage_v: Array) -> Array:
        """Round to the converter's steps [V]; voltages outside the range saturate."""
        codes = np.floor((voltage_v - self.low_v) / self.step_v + 0.5)
        return np.asarray(
            np.minimum(np.maximum(codes, 0.0), 2.0**self.bits - 1) * self.step_v + self.low_v
        )

    @property
    def step_v(self) -> float:
        """Voltage between two codes [V]."""
        return float((self.high_v - self.low_v) / 2**self.bits)


class Converter:
    """One channel of the ADC: anti-aliasing poles on the grid, then samples with jitter [s], noise
    and quantisation.
    """

    def __init__(
        self,
        design: Design,
        anti_alias: AntiAliasFilter,
        adc: AdcRange,
        step_s: float,
        noise: Stream | None = None,
        jitter: tuple[Stream, float] | None = None,
    ) -> None:
        self._deviation_v = design.detector.noise_v
        self._anti_alias = anti_alias
        self._adc = adc
        self._step_s = step_s
        self._noise = noise
        self._jitter = jitter
        self._sampler = Sampler()
        self._slope_sampler = Sampler()
        self._last = np.zeros(0)

    def process(self, voltage_v: Array, at: Instants, after_v: Array | None = None) -> Array:
        """Return the samples [V] of a chunk of voltages on the grid [V], with those right after
        each jump.
        """
        pin_v = self._anti_alias.process(voltage_v, after_v)
        sampled = self._sampler.process(pin_v, at)

        if self._jitter:
            # The ADC samples a little early or late, on the line through the two latest points.
            stream, deviation_s = self._jitter
            before = np.concatenate((self._last if len(self._last) else pin_v[:1], pin_v[:-1]))
            self._last = pin_v[-1:].copy()
            slope = self._slope_sampler.process((pin_v - before) / self._step_s, at)
            sampled = sampled + slope * draw_noise(stream, deviation_s, len(sampled))

        if self._noise:
            sampled = sampled + draw_noise(self._noise, self._deviation_v, len(sampled))

        return self._adc.quantise_v(sampled)


def _follow_loop(
    smoothing: float, samples: Floats, state: MutableFloats, out: MutableFloats
) -> None:
    envelope = state[0]
    for i in range(len(samples)):
        x = samples[i]
        envelope += smoothing * ((x if x > 0.0 else 0.0) - envelope)
        out[i] = envelope

    state[0] = envelope


_follow = CompiledLoop(_follow_loop, samples="samples", plain_us=0.2)


class EnvelopeSource:
    """Output of a design's board from which its sampled envelope follows, and what lies between
    them.

    Of a board without an envelope, software rectifies the filtered signal, and follows its half
    waves with one pole.
    """

    def __init__(self, design: Design) -> None:
        self._is_sampled = design.board.has_envelope
        self.pin = ADC_ENVELOPE if self._is_sampled else ADC_FILTERED
        # The discrete step response equals that of the analog pole at the samples.
        cutoff_hz = design.board.envelope_cutoff_hz
        rate_hz = design.detector.sample_rate_hz
        self._smoothing = 1 - math.exp(-math.tau * cutoff_hz / rate_hz)
        self._state = [0.0]

    def select(self, filtered_v: Array, envelope_v: Array) -> Array:
        """Select the output that is sampled [V]."""
        return envelope_v if self._is_sampled else filtered_v

    def finish(self, sampled_v: Array) -> Array:
        """Return the envelope [V] of the next samples of that output [V]."""
        if self._is_sampled:
            return sampled_v

        envelope_v = np.zeros(len(sampled_v))
        _follow(self._smoothing, sampled_v, self._state, envelope_v)
        return envelope_v


# Noise of the board's amplifiers, so that a simulated board is as noisy as its noise budget.
#
# Nearly all of this noise arises ahead of the filter, in the sensor's amplifier, and much of that
# lies beyond what the grid holds (`fingertip.board.analysis.noise`). The simulation adds white
# noise at the points of the base grid to the board's input, of the strength that makes the filter's
# output as noisy as the noise budget, from 0.1 Hz to 1 MHz. So the noise ahead of the rectifier has
# the right strength, and with it the envelope's quiescent level, at every sampling rate.
#
# The noise of the ADC is separate: it is added after the board's gain
# (`fingertip.sim.signal.converter`).

_MEMORY_S = 0.1
"""Time in which the filter forgets an impulse at a cutoff of 67 Hz [s]: seven periods."""
_SMALL_V = 1e-6
"""Impulse too small for the diode to conduct [V]."""


@functools.lru_cache(maxsize=256)
def compute_input_noise_v(design: Design) -> float:
    """Compute the white RMS noise at the board's input, on the base grid, that stands for its
    amplifiers' noise [V].
    """
    if not design.board.has_filter:
        return 0.0

    circuit = board_circuit(select_components(design))
    return add_noise(circuit, find_gain_bandwidth_hz(design.board)).total_v(
        FILTERED
    ) / compute_noise_gain(design)


def compute_noise_gain(design: Design) -> float:
    """Compute the standard deviation at the filter's output for white noise of deviation 1 on the
    base grid.
    """
    impulse = np.zeros(2 + round(_MEMORY_S * BASE_HZ * 67.0 / design.board.cutoff_hz))
    impulse[1] = _SMALL_V
    h = simulate_board(AnalogBoard.from_design(design), 1 / BASE_HZ, impulse).filtered_v / _SMALL_V

    return math.sqrt(float(h @ h))


# Sampled envelope of the design's simulated board, driven by recorded voltages, by a stream, or by
# noise alone.

_WINDOWS = 133
"""Number of detector windows of simulated noise: the standard deviation is known to 6 %."""
_SETTLING_S = 0.1
"""Time in which the board settles before its noise counts [s]."""


class SimulatedBoardDetector(Detector):
    """Detector `analog` behind the design's simulated board, of raw voltages in any chunks.

    A recording has passed the anti-aliasing poles of the tactile voltage, which the real board's
    filter has not: the envelope comes out some 3 % low at 2 kHz, 12 % at 1 kHz.
    """

    def __init__(self, design: Design) -> None:
        self._board = AnalogStream(
            AnalogBoard.from_design(design), 1 / design.detector.sample_rate_hz
        )
        self._source = EnvelopeSource(design)
        self._poles = AntiAliasFilter.ahead_of(self._source.pin, design)
        self._adc = AdcRange.from_design(design).above_signal_ground(design)
        self._detector = AnalogDetector.for_design(design)
        self._threshold_v = self._detector.threshold_v
        self.memory_s = self._detector.memory_s

    def process(self, voltage_v: Iterable[float]) -> DetectorOutput:
        samples = np.asarray(as_samples(voltage_v), dtype=np.float64)
        return self._detector.process(
            self.simulate_envelope_v(samples) if len(samples) else samples
        )

    def step(self, voltage_v: float) -> bool:
        return self._detector.step(float(self.simulate_envelope_v(np.array([voltage_v]))[0]))

    def simulate_envelope_v(self, voltage_v: Array) -> Array:
        """Return the sampled envelope [V] of the next samples [V], between which the input is
        linear.
        """
        output_v = self._source.select(*self._board.process(voltage_v))
        return self._source.finish(self._adc.quantise_v(self._poles.process(output_v)))


def simulate_quiescent_level(design: Design, diode: str = "1N4148") -> NoiseLevel:
    """Simulate the noise level of `analog` behind the board while nothing happens: amplifiers,
    filter, then ADC.
    """
    grid = Grid()
    rate = design.detector.sample_rate_hz
    count = grid.count_points(_noise_s(design), rate)
    noise_v = draw_noise(open_stream(0, "quiescent board"), compute_input_noise_v(design), count)
    board = AnalogBoard.from_design(design, diode=diode)
    source = EnvelopeSource(design)
    signals = simulate_board(board, grid.step_s, noise_v)
    output_v = source.select(signals.filtered_v, signals.envelope_v)
    poles = AntiAliasFilter.ahead_of(source.pin, design, grid.step_s)
    adc = AdcRange.from_design(design).above_signal_ground(design)
    converter = Converter(
        design=design,
        anti_alias=poles,
        adc=adc,
        step_s=grid.step_s,
        noise=open_stream(0, "quiescent converter"),
    )
    sampled_v = converter.process(output_v, SampleClock(grid, rate).advance(count))

    return _measure_level(design, source.finish(sampled_v))


def simulate_replay_level(design: Design) -> NoiseLevel:
    """Simulate the noise level of `analog` behind a board that is fed a recording, which holds the
    ADC's noise.
    """
    count = count_samples(_noise_s(design), design.detector.sample_rate_hz)
    noise_v = draw_noise(open_stream(0, "replayed noise"), input_noise_v(design), count)
    return _measure_level(design, SimulatedBoardDetector(design).simulate_envelope_v(noise_v))


def _noise_s(design: Design) -> float:
    return _SETTLING_S + _WINDOWS * design.detector.window_samples / design.detector.sample_rate_hz


def _measure_level(design: Design, sampled_v: Array) -> NoiseLevel:
    """Measure the noise of a sampled envelope.

    The threshold is at least a step, where the ADC shows none.
    """
    settled = sampled_v[round(_SETTLING_S * design.detector.sample_rate_hz) :]
    return measure_noise_level(settled, design, "simulated noise")
