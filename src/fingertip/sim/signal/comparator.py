"""Digital slip output of variant `comparator`: the envelope's mean against a threshold with hysteresis, in hardware.

The mean is one pole behind the envelope, ``tau m' = v - m``. Between samples the envelope is the cubic through its
values and slopes at both ends, for which m has a closed form. The moment at which m crosses a threshold is therefore
found by bisection to machine precision, not just at the next sample. The pin is an open collector: low while the board
indicates slip.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.board import board_values
from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.jit import CompiledLoop
from fingertip.foundation.numerics import Array
from fingertip.foundation.validation import find_column_issues, find_not_positive, raise_issues
from fingertip.sim.signal.analog_circuit import AnalogBoard

PIN_LOW_V = 0.0
"""Voltage of the pin while it indicates slip [V]: an open collector's 0.05 V at 1 mA are neglected."""
_PARTS = 4
"""Number of parts of a sampling interval in each of which one crossing is looked for."""


@dataclass(frozen=True)
class Comparator:
    """Time constant and thresholds, relative to the signal ground. Raises TraceError."""

    averaging_tau_s: float
    """Time constant of the mean [s]."""
    on_v: float
    """Mean above which the pin goes ON [V]."""
    off_v: float
    """Mean below which the pin goes OFF [V]."""
    high_v: float = 5.0
    """Voltage of the pin while it is OFF [V]."""

    def __post_init__(self) -> None:
        issues = find_not_positive("comparator.averaging_tau_s", self.averaging_tau_s, "s", "0.015")
        if not self.off_v < self.on_v:
            message = f"{self.off_v:g} V is not below on_v, so the output would oscillate; choose less than"
            issues.append(Issue("comparator.off_v", f"{message} {self.on_v:g} V."))
        raise_issues(issues)

    @classmethod
    def from_design(cls, design: Design) -> Comparator:
        """Comparator with the components that are fitted and the trimmer in its middle. Raises TraceError."""
        values = board_values(design)
        if values.comparator_levels is None:
            raise TraceError(Issue("outputs", describe_missing_comparator(design)))
        levels = values.comparator_levels
        return cls(levels.averaging_tau_s, levels.on_v, levels.off_v, design.board.supply_v)


@dataclass(frozen=True, eq=False)
class ComparatorSignals:
    """Signals of the comparator for one envelope."""

    mean_v: Array
    """Mean at the samples [V]."""
    on: NDArray[np.bool_]
    """Output at the samples."""
    edges_s: Array
    """Moments at which the output changes [s]; the first edge is to ON unless the output begins ON."""


def describe_missing_comparator(design: Design) -> str:
    """Error message for a board without comparator."""
    return (
        f"'slip_pin_v' exists on boards of variant comparator only, and this design's variant is "
        f"{design.board.variant}; use --set board.variant=comparator."
    )


class ComparatorStream:
    """Comparator behind one board's outputs, chunk by chunk. The mean begins in its steady state. Raises TraceError."""

    def __init__(self, comparator: Comparator, board: AnalogBoard, step_s: float) -> None:
        raise_issues(_find_issues(board, step_s))
        self._comparator, self._board, self._step_s = comparator, board, step_s
        self._state = np.zeros(0)
        self._last = np.zeros((2, 0))
        self._points = 0

    def process(self, filtered_v: Array, envelope_v: Array) -> ComparatorSignals:
        """Follow the comparator over the next outputs of the board [V]. Raises TraceError."""
        raise_issues(find_column_issues(filtered_v=filtered_v, envelope_v=envelope_v))
        levels, board = self._comparator, self._board
        slope = (board.envelope_gain * np.maximum(filtered_v, 0.0) - envelope_v) / np.asarray(board.envelope_decay_s)
        if not len(self._state):
            self._state = np.array([envelope_v[0], 1.0 if envelope_v[0] > levels.on_v else 0.0])
        known = np.concatenate((self._last, [envelope_v, slope]), axis=1)
        repeated, count = self._last.shape[1], known.shape[1]
        self._last = known[:, -1:].copy()
        mean, on, found = np.zeros(count), np.zeros(count), np.zeros(1)
        edges = np.zeros(_PARTS * count)  # room for a crossing in every part of every interval
        _compare(
            levels.averaging_tau_s, levels.on_v, levels.off_v, self._step_s, known[0], known[1],
            self._state, mean, on, edges, found,
        )  # fmt: skip
        begin_s = max(self._points - 1, 0) * self._step_s
        self._points += len(envelope_v)
        return ComparatorSignals(mean[repeated:], on[repeated:] > 0.0, begin_s + edges[: int(found[0])])


def simulate_comparator(
    comparator: Comparator, board: AnalogBoard, step_s: float, filtered_v: Array, envelope_v: Array
) -> ComparatorSignals:
    """Simulate the comparator behind one board's outputs, as `filter_board.simulate_board` gives them.

    Raises TraceError.
    """
    columns = find_column_issues(filtered_v=filtered_v, envelope_v=envelope_v)
    raise_issues([*columns, *_find_issues(board, step_s)])
    return ComparatorStream(comparator, board, step_s).process(filtered_v, envelope_v)


def _find_issues(board: AnalogBoard, step_s: float) -> Iterator[Issue]:
    if board.rectifier != "precision":
        yield Issue("board.rectifier", f"{board.rectifier!r} has no comparator behind it; use 'precision'.")
    yield from find_not_positive("step_s", step_s, "s", "0.0005")


class SlipPin:
    """Voltage of a design's slip pin, chunk by chunk."""

    def __init__(self, design: Design, step_s: float) -> None:
        self._comparator = Comparator.from_design(design)
        self._stream = ComparatorStream(self._comparator, AnalogBoard.from_design(design), step_s)

    def process(self, filtered_v: Array, envelope_v: Array) -> Array:
        """Return the voltage of the pin [V] behind the board's outputs [V]."""
        return np.where(self._stream.process(filtered_v, envelope_v).on, PIN_LOW_V, self._comparator.high_v)


def mean_after(tau: float, s: float, m: float, v: float, d: float, a: float, b: float) -> float:
    """Mean m(s) for ``tau m' = v + d s + a s^2 + b s^3 - m``, m(0) = m."""
    start = v - tau * (d - tau * (2 * a - tau * 6 * b))
    now = v + s * (d + s * (a + s * b)) - tau * (d + s * (2 * a + s * 3 * b) - tau * (2 * a + s * 6 * b - tau * 6 * b))
    return now + (m - start) * math.exp(-s / tau)


def _comparator_loop(
    tau: float,
    on_v: float,
    off_v: float,
    H: float,
    envelope: Sequence[float],
    slope: Sequence[float],
    state: MutableSequence[float],
    mean: MutableSequence[float],
    on_out: MutableSequence[float],
    edges: MutableSequence[float],
    count: MutableSequence[float],
) -> None:
    """Follow the mean, and locate each crossing of a threshold by bisection."""
    m, on = state[0], state[1]  # ON is a float, because the output array takes only floats
    found = 0
    mean[0], on_out[0] = m, on
    for i in range(len(envelope) - 1):
        # Hermite's cubic of the envelope: v + d s + a s^2 + b s^3.
        v, d = envelope[i], slope[i]
        rise = (envelope[i + 1] - v) / H
        a, b = (3 * rise - 2 * d - slope[i + 1]) / H, (d + slope[i + 1] - 2 * rise) / (H * H)
        # Look for a crossing in each part of the interval, so that two crossings in one interval are both found.
        before = 0.0
        for part in range(1, _PARTS + 1):
            s = part / _PARTS * H
            value = mean_after(tau, s, m, v, d, a, b)
            threshold = off_v if on > 0.0 else on_v
            if (value < threshold) if on > 0.0 else (value > threshold):
                low, high = before, s
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    value = mean_after(tau, middle, m, v, d, a, b)
                    if (value < threshold) if on > 0.0 else (value > threshold):
                        high = middle
                    else:
                        low = middle
                on = 1.0 - on
                edges[found] = i * H + high
                found += 1
            before = s
        m = mean_after(tau, H, m, v, d, a, b)
        mean[i + 1] = m
        on_out[i + 1] = on
    state[0], state[1] = m, on
    count[0] = found


_compare = CompiledLoop(_comparator_loop, mean_after, outputs=5, samples="envelope", plain_us=4.0)
"""Carries mean and output to the next chunk.

Fills the mean, ON or OFF, the moments at which the output changes, and their number.
"""
