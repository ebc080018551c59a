"""Analog-to-digital converter (ADC): the anti-aliasing poles ahead of its pins, its jitter, noise and quantisation.

The poles lie between the board's outputs and the ADC (R8, C9, R9, C19 for the tactile voltage; R7, C8 for the
envelope; R27, C25 for the filtered signal of a board for 3.3 V). Between the points of a grid the voltage is linear,
which two RC sections follow exactly (`analog_circuit`). They delay by some 1.3 samples, whatever the
sampling rate, because the board's values are selected for it.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fingertip.board import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.components.values import SUPPLIES, select_components
from fingertip.board.parts.circuit import ADC_ENVELOPE, ADC_FILTERED, ADC_TACTILE, ENVELOPE, FILTERED, TACTILE, Circuit
from fingertip.design import Design
from fingertip.foundation.jit import CompiledLoop
from fingertip.foundation.numerics import Array
from fingertip.sim.signal.analog_circuit import augment, exponentials
from fingertip.sim.signal.grid import Instants, Sampler, Stream, draw_noise
from fingertip.sim.signal.parameters import ConverterInput

_FIRST, _SECOND, _INPUT = range(3)
"""Indices of the filter's state: voltages of the first and the second capacitor, and the previous input [V]."""


class AntiAliasFilter:
    """One or two poles that start in the steady state of their first sample and keep their state between chunks."""

    def __init__(self, circuit: Circuit, source: str, pin: str, step_s: float) -> None:
        network = build_network(circuit).drive(source)
        system = network.ground(*(name for name in network.inputs if name != source)).restrict(pin).state_space()
        step = exponentials(augment(system.A, system.B[:, 0], np.zeros(len(system.A))), step_s, 1)[0]
        # The loop has two states, the second of which is the voltage at the pin. One pole stands in both.
        last = int(np.argmax(system.rows[pin][: len(system.A)]))
        order = [0 if last else len(system.A) - 1, last]
        n = len(system.A)
        rows = np.zeros((2, 4))
        rows[:, :2] = step[np.ix_(order, order)] if n == 2 else np.diag(step[:1, :1].repeat(2))
        # Scale the slope's column for the difference of two samples.
        rows[:, 2:] = step[order][:, n : n + 2] * [1.0, 1 / step_s]
        self._matrix = tuple(rows.ravel().tolist())
        self._state: Array | None = None

    @classmethod
    def for_tactile(cls, design: Design, step_s: float | None = None) -> AntiAliasFilter:
        """Filter ahead of the tactile voltage's pin; without a step [s], for voltages at the samples."""
        return cls(board_circuit(select_components(design)), TACTILE, ADC_TACTILE, _step_s(design, step_s))

    @classmethod
    def for_envelope(cls, design: Design, step_s: float | None = None) -> AntiAliasFilter:
        """Filter ahead of the envelope's pin; without a step [s], for voltages at the samples."""
        return cls(board_circuit(select_components(design)), ENVELOPE, ADC_ENVELOPE, _step_s(design, step_s))

    @classmethod
    def for_filtered(cls, design: Design, step_s: float | None = None) -> AntiAliasFilter:
        """Filter ahead of the filtered signal's pin, on a board for a controller; step [s] as above."""
        return cls(board_circuit(select_components(design)), FILTERED, ADC_FILTERED, _step_s(design, step_s))

    def process(self, voltage_v: Array, after_v: Array | None = None) -> Array:
        """Return the voltage at the pin [V] at the same instants as the voltage at the board's output [V].

        Where the input jumps, `after_v` is the voltage right after each instant.
        """
        out = np.zeros(len(voltage_v))
        if len(voltage_v):
            if self._state is None:
                self._state = np.full(3, voltage_v[0])
            _filter(self._matrix, voltage_v, voltage_v if after_v is None else after_v, self._state, out)
        return out


def _filter_loop(
    matrix: tuple[float, ...],
    samples: Sequence[float],
    after: Sequence[float],
    state: MutableSequence[float],
    out: MutableSequence[float],
) -> None:
    """Follow the filter over samples between which the input is linear."""
    a11, a12, b1, d1, a21, a22, b2, d2 = matrix
    x, y, u = state[_FIRST], state[_SECOND], state[_INPUT]
    for i in range(len(samples)):
        v = samples[i]
        x, y = a11 * x + a12 * y + b1 * u + d1 * (v - u), a21 * x + a22 * y + b2 * u + d2 * (v - u)
        u = after[i]
        out[i] = y
    state[_FIRST], state[_SECOND], state[_INPUT] = x, y, u


_filter = CompiledLoop(_filter_loop, outputs=2, samples="samples", plain_us=0.5)


def _step_s(design: Design, step_s: float | None) -> float:
    return 1 / design.detector.sample_rate_hz if step_s is None else step_s


@dataclass(frozen=True)
class AdcRange:
    """Resolution and range of a converter."""

    bits: int
    low_v: float
    """Lower end of the range [V]."""
    high_v: float
    """Upper end of the range [V]."""

    @classmethod
    def from_design(cls, design: Design) -> AdcRange:
        """Range of the design's ADC against ground."""
        d = design.detector
        return cls(d.adc_bits, d.adc_low_v, d.adc_range_v)

    @classmethod
    def select(cls, design: Design, converter: ConverterInput) -> AdcRange:
        """Range of a scene's converter, or of the design's where the scene names none."""
        if converter.bits:
            return cls(converter.bits, converter.low_v, converter.high_v)
        return cls.from_design(design)

    def above_signal_ground(self, design: Design) -> AdcRange:
        """The same range for voltages above the signal ground, which on a single supply lies near half of it.

        Filtered signal and envelope are computed so. The controller subtracts the signal ground from its readings.
        """
        ground_v = SUPPLIES[design.board.supply].signal_ground_v(design.board.supply_v)
        return replace(self, low_v=self.low_v - ground_v, high_v=self.high_v - ground_v)

    def quantise_v(self, voltage_v: Array) -> Array:
        """Round to the converter's steps [V]; voltages outside the range saturate."""
        step = (self.high_v - self.low_v) / 2**self.bits
        codes = np.floor((voltage_v - self.low_v) / step + 0.5)
        return np.asarray(np.clip(codes, 0, 2**self.bits - 1) * step + self.low_v)


class Converter:
    """One channel of the ADC: anti-aliasing poles on the grid, then samples with jitter, noise and quantisation.

    Units: `jitter` [s].
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
        self._deviation_v, self._anti_alias, self._adc, self._step_s = design.detector.noise_v, anti_alias, adc, step_s
        self._noise, self._jitter = noise, jitter
        self._sampler, self._slope_sampler = Sampler(), Sampler()
        self._last = np.zeros(0)

    def process(self, voltage_v: Array, at: Instants, after_v: Array | None = None) -> Array:
        """Return the samples [V] of a chunk of voltages on the grid [V], with those right after each jump."""
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


def sample_v(design: Design, voltage_v: Array, noise: Stream | None) -> Array:
    """Convert envelopes at the ADC's instants [V] to samples [V]; without `noise` the ADC has none."""
    noisy = voltage_v if noise is None else voltage_v + draw_noise(noise, design.detector.noise_v, len(voltage_v))
    return AdcRange.from_design(design).above_signal_ground(design).quantise_v(noisy)
