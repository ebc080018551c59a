"""Analog-to-digital converter (ADC): the anti-aliasing poles ahead of its pins, its noise and its quantisation.

The poles lie between the board's outputs and the ADC (R8, C9, R9, C19 for the tactile voltage; R7, C8 for the
envelope). Between samples the voltage is linear, which two RC sections follow exactly
(`fingertip.sim.signal.exact_steps`). They delay by some 1.3 samples, whatever the sampling rate, because the
board's values are selected for it.
"""

from __future__ import annotations

import random
from collections.abc import MutableSequence, Sequence

import numpy as np

from fingertip.arrays import Array
from fingertip.board import board_circuit
from fingertip.board.circuit import Circuit
from fingertip.board.components.component_values import select_components
from fingertip.board.nets import ADC_ENVELOPE, ADC_TACTILE, ENVELOPE, TACTILE
from fingertip.board.network import build_network
from fingertip.design import Design
from fingertip.jit import CompiledLoop
from fingertip.sim.signal.exact_steps import augment, exponentials

_FIRST, _SECOND, _INPUT = range(3)
"""Indices of the filter's state: voltages of the first and the second capacitor, and the previous input [V]."""


class AntiAliasFilter:
    """One or two poles that start in the steady state of their first sample and keep their state between chunks.

    Parameters
    ----------
    circuit
        Circuit of a board.
    source, pin
        Nets between which the poles lie.
    step_s
        Sampling interval [s].
    """

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
    def for_tactile(cls, design: Design) -> AntiAliasFilter:
        """Filter ahead of the tactile voltage's pin."""
        return cls(board_circuit(select_components(design)), TACTILE, ADC_TACTILE, 1 / design.detector.sample_rate_hz)

    @classmethod
    def for_envelope(cls, design: Design) -> AntiAliasFilter:
        """Filter ahead of the envelope's pin."""
        return cls(board_circuit(select_components(design)), ENVELOPE, ADC_ENVELOPE, 1 / design.detector.sample_rate_hz)

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
