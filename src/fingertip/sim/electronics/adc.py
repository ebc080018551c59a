"""Analog-to-digital converter (ADC): the anti-aliasing poles ahead of its pins, its noise and its quantisation.

The poles lie between the board's outputs and the ADC (R8, C9, R9, C19 for the tactile voltage; R7, C8 for the
envelope). Between samples the voltage is linear, which two RC sections follow exactly
(`fingertip.sim.electronics.state_space`). They delay by some 1.3 samples, whatever the sampling rate, because the
board's values are selected for it.
"""

from __future__ import annotations

import random
from collections.abc import MutableSequence, Sequence

import numpy as np

from fingertip.arrays import Array
from fingertip.board import board_values
from fingertip.design import Design
from fingertip.jit import CompiledLoop
from fingertip.sim.electronics.state_space import augment, exponentials

_FIRST, _SECOND, _INPUT = range(3)
"""Indices of the filter's state: voltages of the first and the second capacitor, and the previous input [V]."""


class AntiAliasFilter:
    """One or two RC sections that start in the steady state of their first sample and keep their state between chunks.

    Parameters
    ----------
    sections
        Resistance [ohm] and capacitance [F] of each, from the board to the pin.
    step_s
        Sampling interval [s].
    """

    def __init__(self, sections: Sequence[tuple[float, float]], step_s: float) -> None:
        (r1, c1), (r2, c2) = (sections[0], sections[-1])
        if len(sections) == 1:  # both states are that of the one section
            A = np.diag([-1 / (r1 * c1)] * 2)
            b = np.full(2, 1 / (r1 * c1))
        else:
            A = np.array([[-(1 / r1 + 1 / r2) / c1, 1 / (r2 * c1)], [1 / (r2 * c2), -1 / (r2 * c2)]])
            b = np.array([1 / (r1 * c1), 0.0])
        step = exponentials(augment(A, b, np.zeros(2)), step_s, 1)[0]
        # Scale the slope's column for the difference of two samples.
        self._matrix = tuple(float(v) for row in step[:2, :4] * [1.0, 1.0, 1.0, 1 / step_s] for v in row)
        self._state: Array | None = None

    @classmethod
    def for_tactile(cls, design: Design) -> AntiAliasFilter:
        """Filter ahead of the tactile voltage's pin."""
        c = board_values(design).adc_interface
        return cls([(c.first_ohm, c.first_f), (c.second_ohm, c.second_f)], 1 / design.detector.sample_rate_hz)

    @classmethod
    def for_envelope(cls, design: Design) -> AntiAliasFilter:
        """Filter ahead of the envelope's pin."""
        c = board_values(design).adc_interface
        return cls([(c.envelope_ohm, c.envelope_f)], 1 / design.detector.sample_rate_hz)

    def process(self, voltage_v: Array) -> Array:
        """Return the voltage at the pin [V] at the same instants as the voltage at the board's output [V]."""
        out = np.zeros(len(voltage_v))
        if len(voltage_v):
            if self._state is None:
                self._state = np.full(3, voltage_v[0])
            _filter(self._matrix, voltage_v, self._state, out)
        return out


def _filter_loop(
    matrix: tuple[float, ...], samples: Sequence[float], state: MutableSequence[float], out: MutableSequence[float]
) -> None:
    """Follow the filter over samples between which the input is linear."""
    a11, a12, b1, d1, a21, a22, b2, d2 = matrix
    x, y, u = state[_FIRST], state[_SECOND], state[_INPUT]
    for i in range(len(samples)):
        v = samples[i]
        x, y = a11 * x + a12 * y + b1 * u + d1 * (v - u), a21 * x + a22 * y + b2 * u + d2 * (v - u)
        u = v
        out[i] = y
    state[_FIRST], state[_SECOND], state[_INPUT] = x, y, u


_filter = CompiledLoop(_filter_loop, outputs=2, samples="samples", plain_us=0.5)


def sample_v(design: Design, voltage_v: Array, rng: random.Random | None) -> Array:
    """Convert the voltages at the ADC's instants [V] to samples [V]; without `rng` the ADC has no noise."""
    d = design.detector
    noisy = voltage_v if rng is None else voltage_v + draw_noise_v(rng, d.noise_v, len(voltage_v))
    return quantise_v(noisy, d.adc_bits, d.adc_range_v)


def draw_noise_v(rng: random.Random, deviation_v: float, count: int) -> Array:
    """Draw samples of white Gaussian noise [V]."""
    return np.array([rng.gauss(0.0, deviation_v) for _ in range(count)])


def quantise_v(voltage_v: Array, bits: int, range_v: float) -> Array:
    """Round to the ADC's steps [V] for ``-range_v <= V < range_v``; voltages outside saturate."""
    half: int = 2 ** (bits - 1)
    codes = np.floor(voltage_v / range_v * half + 0.5)
    return np.clip(codes, -half, half - 1) * range_v / half
