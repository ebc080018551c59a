"""The board in the time domain: sampled voltage in, filtered and enveloped voltage out, for one board or thousands.

Between samples the input is linear, which the linear stages follow exactly (`sim.linear`); the diode is solved with
error control (`sim.envelope_loop`). A jump is given as two values at one sample.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.electronics import envelope_loop
from fingertip.sim.electronics.board_matrices import matrices
from fingertip.sim.electronics.circuit import Analog
from fingertip.sim.electronics.envelope_loop import LEVELS
from fingertip.sim.validation import columns, positive, refuse

_CHUNK = 256  # boards whose matrices are held at a time: 4 MB


@dataclass(frozen=True)
class Response:
    """Voltages at the samples [V], along a first axis of boards if there are many; and what it took."""

    filtered_v: Array
    """Output of the second stage, ahead of the diode."""
    envelope_v: Array
    steps: int
    rejected: int
    implicit: int
    """Steps in which the diode conducted; the others are closed forms."""


def respond(
    board: Analog, step_s: float, voltage_v: Array, tolerance_v: float = 1e-4, after_v: Array | None = None
) -> Response:
    """What the board makes of a voltage, starting settled on its first sample.

    Parameters
    ----------
    board
        One board, or many: any of its values may be an array.
    step_s
        Time between samples [s].
    voltage_v
        Voltage at the samples [V].
    tolerance_v
        Error of one step of the envelope [V].
    after_v
        Voltage right after each sample [V], where the input jumps there.

    Raises
    ------
    TraceError
        If the step or the tolerance is not above 0, or a sample is not finite (the first such is named).
    """
    single = all(np.ndim(value) == 0 for value in _values(board))
    parts = list(respond_in_parts(board, step_s, voltage_v, tolerance_v, after_v))
    filtered = np.concatenate([part.filtered_v for part in parts])
    enveloped = np.concatenate([part.envelope_v for part in parts])
    if single:
        filtered, enveloped = filtered[0], enveloped[0]
    return Response(
        filtered,
        enveloped,
        sum(part.steps for part in parts),
        sum(part.rejected for part in parts),
        sum(part.implicit for part in parts),
    )


def respond_in_parts(
    board: Analog, step_s: float, voltage_v: Array, tolerance_v: float = 1e-4, after_v: Array | None = None
) -> Iterator[Response]:
    """The same for more boards than memory holds: 256 of them at a time."""
    after = voltage_v if after_v is None else after_v
    refuse(
        [
            *positive("step_s", step_s, "s", "0.0005"),
            *positive("tolerance_v", tolerance_v, "V", "1e-4"),
            *columns(voltage_v=voltage_v, after_v=after),
        ]
    )
    table = np.stack(np.broadcast_arrays(*map(np.atleast_1d, _values(board))), axis=1).astype(np.float64)
    for start in range(0, len(table), _CHUNK):
        part = table[start : start + _CHUNK]
        chunk = board.changed(**{name: part[:, 5 + i] for i, name in enumerate(board.value_names)})
        made = _Made(chunk, step_s, tolerance_v, part[:, :5])
        filtered, enveloped = np.zeros((len(part), len(voltage_v))), np.zeros((len(part), len(voltage_v)))
        counts = np.zeros(3)
        for i in range(len(part)):
            counts += made.follow(i, *made.start(voltage_v[0]), voltage_v, after, filtered[i], enveloped[i])
        yield Response(filtered, enveloped, *(int(count) for count in counts))


class Stream:
    """Some boards of one kind on voltages that come in chunks; any chunks give the bits of `respond`.

    Parameters
    ----------
    board
        What all of them are; plain values.
    step_s
        Time between samples [s].
    count
        How many boards.
    tolerance_v
        As in `respond`.

    Raises
    ------
    TraceError
        If the step or the tolerance is not above 0.
    """

    def __init__(self, board: Analog, step_s: float, count: int = 1, tolerance_v: float = 1e-4) -> None:
        refuse([*positive("step_s", step_s, "s", "0.0005"), *positive("tolerance_v", tolerance_v, "V", "1e-4")])
        fixed = np.array([[float(value) for value in _values(board)[:5]]])
        self._made, self._count = _Made(board, step_s, tolerance_v, fixed), count
        self._states: list[tuple[Array, Array]] = []
        self._last = np.zeros((count, 0))

    def process(self, voltage_v: Array) -> tuple[Array, Array]:
        """Filtered and enveloped voltages [V] at the next samples, (boards, samples) like the voltages [V].

        Raises
        ------
        TraceError
            If a sample is not finite.
        """
        refuse(issue for i, row in enumerate(voltage_v) for issue in columns(**{f"voltage_v of board {i}": row}))
        known = np.concatenate((self._last, voltage_v), axis=1)
        if not self._states:
            self._states = [self._made.start(row[0]) for row in voltage_v]
        filtered, enveloped = np.zeros_like(known), np.zeros_like(known)
        for i, state in enumerate(self._states):
            self._made.follow(0, *state, known[i], known[i], filtered[i], enveloped[i])
        seen = self._last.shape[1]
        self._last = known[:, -1:]
        return filtered[:, seen:], enveloped[:, seen:]


class _Made:
    """Boards with their matrices, and one run of the loop."""

    def __init__(self, board: Analog, step_s: float, tolerance_v: float, fixed: Array) -> None:
        self._board, self._step_s, self._tolerance_v, self._fixed = board, step_s, tolerance_v, fixed.tolist()
        self._n, self._steps, self._rows, self._out, self._first = matrices(board, step_s)

    def start(self, voltage_v: float) -> tuple[Array, Array]:
        """What is carried from sample to sample, settled: envelope and step size, and the states."""
        z = np.zeros(self._out.shape[-1])
        z[0] = voltage_v
        return np.zeros(2), z

    def follow(
        self, i: int, carried: Array, z: Array, before: Array, after: Array, filtered: Array, enveloped: Array
    ) -> Array:
        """Board i from the first sample to the last; returns what it took."""
        count, board = np.zeros(3), self._board
        saturation, nvt, series, r, c = self._fixed[i]
        envelope_loop.run(
            self._tolerance_v, self._step_s, self._n, len(z), LEVELS, board.rail_v or 0.0,
            board.rectifier == "precision", (saturation, nvt, series), (r, c), before, after,
            self._steps[i], self._rows[i], self._out[i], self._first[i],
            carried, z, np.zeros(len(z)), np.zeros(LEVELS), filtered, enveloped, count,
        )  # fmt: skip
        return count


def _values(board: Analog) -> list[Any]:
    d = board.diode
    fixed = [d.saturation_a, d.emission * d.thermal_v, d.series_ohm, board.r_lp_ohm, board.c_lp_f]
    return fixed + [getattr(board, name) for name in board.value_names]
