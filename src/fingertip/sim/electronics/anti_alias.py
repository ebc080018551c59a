"""The poles between the board's outputs and the converter's pins (R8, C9, R9, C19; R7, C8), on samples of a voltage.

Between samples the voltage is straight, which two RC sections follow exactly (`fingertip.sim.electronics.linear`). They
delay by some 1.3 samples, whatever the rate, as the board's values are made for it.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence

import numpy as np

from fingertip.arrays import Array
from fingertip.board import board_values
from fingertip.design import Design
from fingertip.jit import CompiledLoop
from fingertip.sim.electronics.linear import augmented, exponentials


class Poles:
    """One or two RC sections, settled on the first sample they are given; state is carried from chunk to chunk.

    Parameters
    ----------
    sections
        Resistance [ohm] and capacitance [F] of each, from the board to the pin.
    step_s
        Time between samples [s].
    """

    def __init__(self, sections: Sequence[tuple[float, float]], step_s: float) -> None:
        (r1, c1), (r2, c2) = (sections[0], sections[-1])
        if len(sections) == 1:  # both states are that of the one
            A = np.diag([-1 / (r1 * c1)] * 2)
            b = np.full(2, 1 / (r1 * c1))
        else:
            A = np.array([[-(1 / r1 + 1 / r2) / c1, 1 / (r2 * c1)], [1 / (r2 * c2), -1 / (r2 * c2)]])
            b = np.array([1 / (r1 * c1), 0.0])
        step = exponentials(augmented(A, b, np.zeros(2)), step_s, 1)[0]
        # The slope's column for the difference of two samples.
        self._matrix = tuple(float(v) for row in step[:2, :4] * [1.0, 1.0, 1.0, 1 / step_s] for v in row)
        self._state: Array | None = None

    @classmethod
    def tactile(cls, design: Design) -> Poles:
        """Ahead of the tactile voltage's pin."""
        c = board_values(design).converter
        return cls([(c.first_ohm, c.first_f), (c.second_ohm, c.second_f)], 1 / design.detector.sample_rate_hz)

    @classmethod
    def envelope(cls, design: Design) -> Poles:
        """Ahead of the envelope's pin."""
        c = board_values(design).converter
        return cls([(c.envelope_ohm, c.envelope_f)], 1 / design.detector.sample_rate_hz)

    def process(self, voltage_v: Array) -> Array:
        """Voltage at the pin [V] at the same instants, as many as are given."""
        out = np.zeros(len(voltage_v))
        if len(voltage_v):
            if self._state is None:
                self._state = np.full(3, voltage_v[0])
            _run(self._matrix, voltage_v, self._state, out)
        return out


def _loop(
    matrix: tuple[float, ...], samples: Sequence[float], state: MutableSequence[float], out: MutableSequence[float]
) -> None:
    a11, a12, b1, d1, a21, a22, b2, d2 = matrix
    x, y, u = state[0], state[1], state[2]
    for i in range(len(samples)):
        v = samples[i]
        x, y = a11 * x + a12 * y + b1 * u + d1 * (v - u), a21 * x + a22 * y + b2 * u + d2 * (v - u)
        u = v
        out[i] = y
    state[0], state[1], state[2] = x, y, u


_run = CompiledLoop(_loop, outputs=2, samples="samples", plain_us=0.5)
