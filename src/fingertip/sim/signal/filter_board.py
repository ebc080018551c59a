"""Filter board in the time domain: tactile voltage in, filtered voltage and envelope out, for one
board or thousands.

Between samples the input is linear, which the linear stages follow exactly
(`fingertip.sim.signal.analog_circuit`). The rectifier and the envelope are solved with error
control (`fingertip.sim.signal.envelope_loop`). A jump of the input is given as two values at one
sample.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError, raise_issues
from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.foundation.numerics import Array
from fingertip.sim.signal import envelope_loop
from fingertip.sim.signal.analog_circuit import (
    AnalogBoard,
    compute_state_space,
    compute_step_matrices,
)
from fingertip.sim.signal.envelope_loop import LEVELS
from fingertip.sim.signal.parameters import describe_missing_comparator

MAX_V = 1e4
"""Largest input voltage [V], of either sign.
A diode that is driven harder has no current that a number can hold.
"""
_FIXED = 6
"""Number of a board's values that the loop takes as they are; the others determine the matrices."""


@dataclass(frozen=True)
class BoardSignals:
    """Voltages at the samples [V], with a first axis of boards if there are many, and the number of
    steps taken.
    """

    filtered_v: Array
    """Output of the second stage, ahead of the rectifier."""
    envelope_v: Array
    """Output of the rectifier."""
    clips: Array
    """1 where the filter's output was at its limits since the sample before, else 0."""
    steps: int
    rejected: int
    implicit: int
    """Steps in which the diode conducted; the others are closed forms."""


def simulate_board(
    board: AnalogBoard,
    step_s: float,
    voltage_v: Array,
    tolerance_v: float = 1e-4,
    after_v: Array | None = None,
) -> BoardSignals:
    """Simulate a board's response to a voltage, starting in the steady state of its first sample.

    The tolerance is that of the estimated error of one step, not of their sum: docs/accuracy.md
    says what is left. The matrices of 256 boards take 4 MB.
    """
    after = voltage_v if after_v is None else after_v
    values = _values(board)
    is_one = all(np.ndim(value) == 0 for value in values)
    by_name = values if is_one else np.broadcast_arrays(*map(np.atleast_1d, values))
    rows = np.array(by_name, dtype=np.float64).reshape(len(values), -1).T
    integrator = Integrator(board, step_s, tolerance_v, rows[:, :_FIXED])
    signals = np.zeros((3, len(rows), len(voltage_v)))
    counts = np.zeros(3)
    straight = np.zeros(len(voltage_v))

    for i in range(len(rows)):
        state = integrator.steady_state(i, voltage_v[0])
        counts += integrator.integrate(i, *state, voltage_v, after, straight, *signals[:, i])

    return BoardSignals(*(signals[:, 0] if is_one else signals), *(int(count) for count in counts))


class AnalogStream:
    """One board; voltages in any chunks give the bits of `simulate_board`."""

    def __init__(self, board: AnalogBoard, step_s: float, tolerance_v: float = 1e-4) -> None:
        fixed = np.array([[float(value) for value in _values(board)[:_FIXED]]])
        self.integrator = Integrator(board, step_s, tolerance_v, fixed)
        self._state: tuple[Array, Array] | None = None
        self._last = np.zeros((3, 0))
        self.steps = 0
        """Steps taken so far, accepted and rejected."""
        self.clips = np.zeros(0)
        """1 where the filter's output was at its limits since the sample before, at the samples
        processed last.
        """

    def process(
        self, voltage_v: Array, after_v: Array | None = None, bend_v: Array | None = None
    ) -> tuple[Array, Array]:
        """Return filtered voltages and envelopes [V] at the next samples. Raises TraceError.

        In the middle of the step before a sample, the input is `bend_v` [V] above the straight
        line; None: it is on it.
        """
        after = voltage_v if after_v is None else after_v
        issues = list(find_voltage_issues("voltage_v", voltage_v))
        if after_v is not None:
            issues += find_voltage_issues("after_v", after_v)

        raise_issues(TraceError, issues)
        # The interval before a chunk's first sample begins at the last sample of the chunk before.
        bends = np.zeros(len(voltage_v)) if bend_v is None else bend_v
        known = np.concatenate((self._last, [voltage_v, after, bends]), axis=1)
        if self._state is None:
            self._state = self.integrator.steady_state(0, voltage_v[0])

        filtered_v, envelope_v, clips = np.zeros_like(known)
        before, after, bends = known
        counts = self.integrator.integrate(
            0, *self._state, before, after, bends, filtered_v, envelope_v, clips
        )
        self.steps += int(counts[envelope_loop.STEPS] + counts[envelope_loop.REJECTED])
        repeated = self._last.shape[1]
        self._last = known[:, -1:].copy()
        self.clips = clips[repeated:]

        return filtered_v[repeated:], envelope_v[repeated:]


def find_voltage_issues(field: str, voltage_v: Array) -> Iterator[Issue]:
    """Report voltages that are not finite or beyond `MAX_V`, with the first such sample."""
    invalid = np.flatnonzero(~np.isfinite(voltage_v))
    if invalid.size:
        more = f" (and {invalid.size - 1} more after it)" if invalid.size > 1 else ""
        yield Issue(
            field,
            f"{voltage_v[invalid[0]]} at sample {invalid[0]}{more} is not a finite number; give "
            "the true value.",
        )
        return

    too_high = np.flatnonzero(np.abs(voltage_v) > MAX_V)
    if too_high.size:
        message = (
            f"{voltage_v[too_high[0]]:g} V at sample {too_high[0]} is no voltage of a board; at "
            f"most {MAX_V:g} V."
        )
        yield Issue(field, message)


class Integrator:
    """Boards with their step matrices, and one run of the loop for each."""

    def __init__(
        self,
        board: AnalogBoard,
        step_s: float,
        tolerance_v: float,
        fixed: Array,
    ) -> None:
        self._board = board
        self._step_s = step_s
        self._tolerance_v = tolerance_v
        self._fixed = fixed.tolist()
        self.state_count, self._rows, *matrices = compute_step_matrices(board, step_s)
        self._steady_state = board.network.steady_state().reshape(-1, self.state_count)
        self._step_columns, self._output_rows, self._watched_rows = matrices
        self._limits: envelope_loop.Limits = (0, 0, 0.0, 0.0, 0.0, 0.0)
        a = board.amplifiers

        if a:
            outputs = compute_state_space(board).outputs
            reversal = -math.inf if a.reversal_v is None else -a.reversal_v
            self._limits = (outputs[0], outputs[1], -a.trough_v, a.peak_v, a.slew_v_per_s, reversal)

        self._width = self.state_count + (4 if board.amplifiers else 2) + board.is_curved

    def steady_state(self, i: int, voltage_v: float) -> tuple[Array, Array]:
        """State for a constant input, which no filter passes: that of the envelope, and the
        circuit's.
        """
        z = np.zeros(self._width)
        z[: self.state_count] = self._steady_state[i] * voltage_v
        z[self.state_count] = voltage_v

        return np.zeros(envelope_loop.CARRIED), z

    def integrate(
        self,
        i: int,
        carried: Array,
        z: Array,
        before: Array,
        after: Array,
        bend: Array,
        filtered_v: Array,
        envelope_v: Array,
        clips: Array,
    ) -> Array:
        """Integrate board i from the first sample to the last; returns the loop's statistics."""
        statistics = np.zeros(3)
        envelope_loop.run(
            self.constants(i),
            before,
            after,
            bend,
            *self.matrices(i),
            carried,
            z,
            *self.make_scratch(),
            filtered_v,
            envelope_v,
            clips,
            statistics,
        )
        envelope_v *= self.gain(i)

        return statistics

    def constants(self, i: int) -> envelope_loop.Constants:
        saturation, nvt, series, r, c, _ = self._fixed[i]
        sizes = (self.state_count, self._rows, LEVELS)
        is_precise = self._board.rectifier == "precision"
        return (
            self._tolerance_v,
            self._step_s,
            *sizes,
            self._limits,
            is_precise,
            (saturation, nvt, series),
            (r, c),
        )

    def matrices(self, i: int) -> tuple[Array, Array, Array]:
        return self._step_columns[i], self._output_rows[i], self._watched_rows[i]

    def make_scratch(self) -> tuple[Array, Array]:
        return np.zeros(self._rows), np.zeros(4 * LEVELS)

    def gain(self, i: int) -> float:
        """Return the gain of the envelope of board i: that of the loop is 1."""
        return float(self._fixed[i][-1])


def _values(board: AnalogBoard) -> list[Any]:
    """Values of the diode and the envelope, which the loop takes, then those that determine the
    matrices.
    """
    d = board.diode
    fixed = [
        d.saturation_a,
        d.emission * d.thermal_v,
        d.series_ohm,
        *board.load,
        board.envelope_gain,
    ]
    return [*fixed, *board.components.values()]


# Digital slip output of variant `comparator`: the envelope's mean against a threshold with
# hysteresis, in hardware.
#
# The mean is one pole behind the envelope, ``tau m' = v - m``. Between samples the envelope is the
# cubic through its values and slopes at both ends, for which m has a closed form. The pin is an
# open collector: low while the board indicates slip.

PIN_LOW_V = 0.0
"""Voltage of the pin while it indicates slip [V]: an open collector's 0.05 V at 1 mA are neglected.
"""
_PARTS = 4
"""Number of parts of a sampling interval at whose ends the mean is compared with a threshold."""


@dataclass(frozen=True)
class Comparator:
    """Time constant and thresholds, relative to the signal ground."""

    averaging_tau_s: float
    on_v: float
    """Mean above which the pin goes ON [V]."""
    off_v: float
    """Mean below which the pin goes OFF [V]."""
    high_v: float = 5.0
    """Voltage of the pin while it is OFF [V]."""

    @classmethod
    def from_design(cls, design: Design) -> Comparator:
        """Comparator with the components that are fitted and the trimmer in its middle.

        Raises TraceError.
        """
        from fingertip.board.analysis.board_values import board_values  # noqa: PLC0415

        values = board_values(design)
        if values.comparator_levels is None:
            raise TraceError(Issue("outputs", describe_missing_comparator(design.board.variant)))

        levels = values.comparator_levels
        return cls(levels.averaging_tau_s, levels.on_v, levels.off_v, design.board.supply_v)


class ComparatorStream:
    """Comparator behind one board's outputs, chunk by chunk.

    The mean begins in its steady state.
    """

    def __init__(self, comparator: Comparator, board: AnalogBoard, step_s: float) -> None:
        self._comparator = comparator
        self._board = board
        self._step_s = step_s
        self._state = np.zeros(0)
        self._last = np.zeros((2, 0))

    def process(self, filtered_v: Array, envelope_v: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Return the mean [V], and whether it is ON, for the next outputs of the board [V]."""
        levels = self._comparator
        board = self._board
        slope = (board.envelope_gain * np.maximum(filtered_v, 0.0) - envelope_v) / np.asarray(
            board.envelope_decay_s
        )
        if not len(self._state):
            self._state = np.array([envelope_v[0], 1.0 if envelope_v[0] > levels.on_v else 0.0])

        known = np.concatenate((self._last, [envelope_v, slope]), axis=1)
        repeated = self._last.shape[1]
        count = known.shape[1]
        self._last = known[:, -1:].copy()
        mean, on = np.zeros((2, count))
        thresholds_v = levels.on_v, levels.off_v
        _compare(
            levels.averaging_tau_s,
            *thresholds_v,
            self._step_s,
            known[0],
            known[1],
            self._state,
            mean,
            on,
        )

        return mean[repeated:], on[repeated:] > 0.0


class SlipPin:
    def __init__(self, design: Design, step_s: float) -> None:
        self._comparator = Comparator.from_design(design)
        self._stream = ComparatorStream(self._comparator, AnalogBoard.from_design(design), step_s)

    def process(self, filtered_v: Array, envelope_v: Array) -> Array:
        """Return the voltage of the pin [V] behind the board's outputs [V]."""
        return np.where(
            self._stream.process(filtered_v, envelope_v)[1], PIN_LOW_V, self._comparator.high_v
        )


def mean_after(
    tau: float,
    s: float,
    m: float,
    v: float,
    d: float,
    a: float,
    b: float,
) -> float:
    """Mean m(s) for ``tau m' = v + d s + a s^2 + b s^3 - m``, m(0) = m."""
    start = v - tau * (d - tau * (2 * a - tau * 6 * b))
    now = (
        v
        + s * (d + s * (a + s * b))
        - tau * (d + s * (2 * a + s * 3 * b) - tau * (2 * a + s * 6 * b - tau * 6 * b))
    )
    return now + (m - start) * math.exp(-s / tau)


def _comparator_loop(
    tau: float,
    on_v: float,
    off_v: float,
    H: float,
    envelope: Floats,
    slope: Floats,
    state: MutableFloats,
    mean: MutableFloats,
    on_out: MutableFloats,
) -> None:
    # ON is a float, because the output array takes only floats
    m = state[0]
    on = state[1]
    mean[0] = m
    on_out[0] = on

    for i in range(len(envelope) - 1):
        # Hermite's cubic of the envelope: v + d s + a s^2 + b s^3.
        v = envelope[i]
        d = slope[i]
        rise = (envelope[i + 1] - v) / H
        a = (3 * rise - 2 * d - slope[i + 1]) / H
        b = (d + slope[i + 1] - 2 * rise) / (H * H)

        # Two crossings in one interval count both.
        for part in range(1, _PARTS + 1):
            value = mean_after(tau, part / _PARTS * H, m, v, d, a, b)
            if (value < off_v) if on > 0.0 else (value > on_v):
                on = 1.0 - on

        m = mean_after(tau, H, m, v, d, a, b)
        mean[i + 1] = m
        on_out[i + 1] = on

    state[0] = m
    state[1] = on


_compare = CompiledLoop(_comparator_loop, mean_after, samples="envelope", plain_us=4.0)
"""Carries mean and output, and fills the mean, and ON or OFF."""
