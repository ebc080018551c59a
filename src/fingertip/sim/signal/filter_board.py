"""Filter board in the time domain: tactile voltage in, filtered voltage and envelope out, for one board or thousands.

Between samples the input is linear, which the linear stages follow exactly (`fingertip.sim.signal.analog_circuit`).
The rectifier and the envelope are solved with error control (`fingertip.sim.signal.envelope_loop`). A jump of the
input is given as two values at one sample.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingertip.foundation.errors import Issue
from fingertip.foundation.numerics import Array
from fingertip.foundation.validation import find_column_issues, find_not_positive, raise_issues
from fingertip.sim.signal import envelope_loop
from fingertip.sim.signal.analog_circuit import AnalogBoard, compute_step_matrices
from fingertip.sim.signal.envelope_loop import LEVELS

MAX_V = 1e4
"""Largest input voltage [V], of either sign. A diode that is driven harder has no current that a number can hold."""
_CHUNK = 256  # boards whose matrices are in memory at a time: 4 MB
_FIXED = 6
"""Number of a board's values that the loop takes as they are; the others determine the matrices."""


@dataclass(frozen=True)
class BoardSignals:
    """Voltages at the samples [V], with a first axis of boards if there are many, and the number of steps taken."""

    filtered_v: Array
    """Output of the second stage, ahead of the rectifier."""
    envelope_v: Array
    """Output of the rectifier."""
    steps: int
    """Accepted steps."""
    rejected: int
    """Rejected steps."""
    implicit: int
    """Steps in which the diode conducted; the others are closed forms."""


def simulate_board(
    board: AnalogBoard, step_s: float, voltage_v: Array, tolerance_v: float = 1e-4, after_v: Array | None = None
) -> BoardSignals:
    """Simulate a board's response to a voltage, starting in the steady state of its first sample. Raises TraceError."""
    single = all(np.ndim(value) == 0 for value in _values(board))
    chunks = list(simulate_boards(board, step_s, voltage_v, tolerance_v, after_v))
    filtered_v = np.concatenate([chunk.filtered_v for chunk in chunks])
    envelope_v = np.concatenate([chunk.envelope_v for chunk in chunks])
    if single:
        filtered_v, envelope_v = filtered_v[0], envelope_v[0]
    return BoardSignals(
        filtered_v,
        envelope_v,
        sum(chunk.steps for chunk in chunks),
        sum(chunk.rejected for chunk in chunks),
        sum(chunk.implicit for chunk in chunks),
    )


def simulate_boards(
    board: AnalogBoard, step_s: float, voltage_v: Array, tolerance_v: float = 1e-4, after_v: Array | None = None
) -> Iterator[BoardSignals]:
    """Simulate more boards than memory holds: yields the signals of 256 boards at a time; else as `simulate_board`."""
    after = voltage_v if after_v is None else after_v
    raise_issues(
        [
            *find_not_positive("step_s", step_s, "s", "0.0005"),
            *find_not_positive("tolerance_v", tolerance_v, "V", "1e-4"),
            *(columns := list(find_column_issues(voltage_v=voltage_v, after_v=after))),
            *(() if columns else find_voltage_issues("voltage_v", voltage_v)),
            *(() if columns or after is voltage_v else find_voltage_issues("after_v", after)),
        ]
    )
    table = np.stack(np.broadcast_arrays(*map(np.atleast_1d, _values(board))), axis=1).astype(np.float64)
    for start in range(0, len(table), _CHUNK):
        rows = table[start : start + _CHUNK]
        chunk = board
        if len(table) > _CHUNK:
            chunk = board.with_components(**{name: rows[:, _FIXED + i] for i, name in enumerate(board.components)})
        integrator = _Integrator(chunk, step_s, tolerance_v, rows[:, :_FIXED])
        filtered_v, envelope_v = np.zeros((len(rows), len(voltage_v))), np.zeros((len(rows), len(voltage_v)))
        counts = np.zeros(3)
        for i in range(len(rows)):
            state = integrator.steady_state(i, voltage_v[0])
            counts += integrator.integrate(i, *state, voltage_v, after, filtered_v[i], envelope_v[i])
        yield BoardSignals(filtered_v, envelope_v, *(int(count) for count in counts))


class AnalogStream:
    """Several equal boards on voltages that come in chunks; any chunks give the bits of `simulate_board`.

    Raises TraceError.
    """

    def __init__(self, board: AnalogBoard, step_s: float, count: int = 1, tolerance_v: float = 1e-4) -> None:
        raise_issues(
            [
                *find_not_positive("step_s", step_s, "s", "0.0005"),
                *find_not_positive("tolerance_v", tolerance_v, "V", "1e-4"),
            ]
        )
        fixed = np.array([[float(value) for value in _values(board)[:_FIXED]]])
        self._integrator, self._count = _Integrator(board, step_s, tolerance_v, fixed), count
        self._states: list[tuple[Array, Array]] = []
        self._last = np.zeros((2, count, 0))
        self.steps = 0
        """Steps taken so far, accepted and rejected."""

    def process(self, voltage_v: Array, after_v: Array | None = None) -> tuple[Array, Array]:
        """Return filtered voltages and envelopes [V] at the next samples, (boards, samples) like the voltages [V].

        Raises TraceError.
        """
        after = voltage_v if after_v is None else after_v
        for name, rows in (("voltage_v", voltage_v), ("after_v", after)):
            raise_issues(
                issue for i, row in enumerate(rows) for issue in find_voltage_issues(f"{name} of board {i}", row)
            )
        # The interval before a chunk's first sample begins at the last sample of the chunk before.
        known = np.concatenate((self._last, [voltage_v, after]), axis=2)
        if not self._states:
            self._states = [self._integrator.steady_state(0, row[0]) for row in voltage_v]
        filtered_v, envelope_v = np.zeros_like(known[0]), np.zeros_like(known[0])
        for i, state in enumerate(self._states):
            counts = self._integrator.integrate(0, *state, known[0, i], known[1, i], filtered_v[i], envelope_v[i])
            self.steps += int(counts[envelope_loop.STEPS] + counts[envelope_loop.REJECTED])
        repeated = self._last.shape[2]
        self._last = known[:, :, -1:].copy()
        return filtered_v[:, repeated:], envelope_v[:, repeated:]


def find_voltage_issues(field: str, voltage_v: Array) -> Iterator[Issue]:
    """Report voltages that are not finite or beyond `MAX_V`, with the first such sample."""
    finite = np.isfinite(voltage_v)
    if (bad := np.flatnonzero(~finite)).size:
        more = f" (and {bad.size - 1} more after it)" if bad.size > 1 else ""
        message = f"{voltage_v[bad[0]]} at sample {bad[0]}{more} is not a finite number; give the true value."
        yield Issue(field, message)
    elif (bad := np.flatnonzero(np.abs(voltage_v) > MAX_V)).size:
        message = f"{voltage_v[bad[0]]:g} V at sample {bad[0]} is no voltage of a board; at most {MAX_V:g} V."
        yield Issue(field, message)


class _Integrator:
    """Boards with their step matrices, and one run of the loop for each."""

    def __init__(self, board: AnalogBoard, step_s: float, tolerance_v: float, fixed: Array) -> None:
        self._board, self._step_s, self._tolerance_v, self._fixed = board, step_s, tolerance_v, fixed.tolist()
        self._state_count, self._rows, *matrices = compute_step_matrices(board, step_s)
        self._steady_state = board.network.steady_state().reshape(-1, self._state_count)
        self._step_columns, self._output_rows, self._amplifier1_row = matrices

    def steady_state(self, i: int, voltage_v: float) -> tuple[Array, Array]:
        """State for a constant input: (envelope, level of the next step, output), and the circuit's states."""
        z = np.zeros(self._state_count + 3)
        z[: self._state_count] = self._steady_state[i] * voltage_v
        z[self._state_count], z[-1] = voltage_v, 1.0
        carried = np.zeros(3)
        carried[envelope_loop.OUTPUT] = envelope_loop.dot(self._output_rows[i].tolist(), 0, z.tolist(), len(z))
        return carried, z

    def integrate(
        self, i: int, carried: Array, z: Array, before: Array, after: Array, filtered_v: Array, envelope_v: Array
    ) -> Array:
        """Integrate board i from the first sample to the last; returns the loop's statistics."""
        statistics, board = np.zeros(3), self._board
        saturation, nvt, series, r, c, gain = self._fixed[i]
        envelope_loop.run(
            self._tolerance_v, self._step_s, self._state_count, self._rows, LEVELS, board.rail_v or 0.0,
            board.rectifier == "precision", (saturation, nvt, series), (r, c), before, after,
            self._step_columns[i], self._output_rows[i], self._amplifier1_row[i], carried, z,
            np.zeros(self._rows), np.zeros(len(z)), np.zeros(4 * LEVELS), filtered_v, envelope_v, statistics,
        )  # fmt: skip
        envelope_v *= gain  # the loop's rectifier and envelope have the gain 1
        return statistics


def _values(board: AnalogBoard) -> list[Any]:
    """Values of the diode and the envelope, which the loop takes, then those that determine the matrices."""
    d = board.diode
    fixed = [d.saturation_a, d.emission * d.thermal_v, d.series_ohm, *board.load, board.envelope_gain]
    return [*fixed, *board.components.values()]
