"""The ON/OFF pin of variant `comparator`: the envelope's mean against a threshold with hysteresis, in hardware.

The mean is one pole behind the envelope, ``tau m' = v - m``. Between samples the envelope is the cubic through its
values and slopes at both ends, for which m has a closed form; so the moment at which it crosses a threshold is found to
the last digit, and not at the next sample. The pin is an open collector: low while the board says slip.
"""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.board import board_values
from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.jit import CompiledLoop
from fingertip.sim.electronics.circuit import Analog
from fingertip.sim.validation import columns, positive, refuse

LOW_V = 0.0
"""Of the pin while it says slip: an open collector's 0.05 V at 1 mA are neglected."""
_MAX_EDGES = 100_000


@dataclass(frozen=True)
class Comparator:
    """Mean and thresholds, above the level at which the signals rest.

    Raises
    ------
    TraceError
        If the mean's time constant is not above 0, or slip would end at a higher mean than it is said at.
    """

    mean_s: float
    """Time constant of the mean [s]."""
    on_v: float
    """Mean at which slip is said [V]."""
    off_v: float
    """And at which it ends."""
    high_v: float = 5.0
    """Of the pin while it says nothing [V]."""

    def __post_init__(self) -> None:
        issues = positive("comparator.mean_s", self.mean_s, "s", "0.015")
        if not self.off_v < self.on_v:
            sentence = f"{self.off_v:g} V is not below on_v; below {self.on_v:g} V, or its output would ring."
            issues.append(Issue("comparator.off_v", sentence))
        refuse(issues)

    @classmethod
    def of(cls, design: Design) -> Comparator:
        """As fitted, the trimmer in its middle.

        Raises
        ------
        TraceError
            If the design's board has none.
        """
        values = board_values(design)
        if values.decision is None:
            raise TraceError(Issue("outputs", missing(design)))
        decision = values.decision
        return cls(decision.mean_s, decision.on_v, decision.off_v, design.board.supply_v)


@dataclass(frozen=True, eq=False)
class Decided:
    """What the comparator makes of an envelope."""

    mean_v: Array
    """At the samples [V]."""
    on: NDArray[np.bool_]
    """At the samples."""
    edges_s: Array
    """When the output changes, from the first sample on; the first edge is to ON unless it begins ON."""


def missing(design: Design) -> str:
    """The sentence for a board without comparator."""
    return (
        f"'slip_pin_v' is given by boards of variant comparator only, this design's is {design.board.variant}; use "
        "--set board.variant=comparator."
    )


def decide(comparator: Comparator, board: Analog, step_s: float, filtered_v: Array, envelope_v: Array) -> Decided:
    """Follow one board's outputs, as `analog.respond` gives them; the mean begins settled.

    Raises
    ------
    TraceError
        If the board has no precision rectifier, whose envelope's slope is known at every sample, or its outputs are not
        finite.
    """
    issues = list(columns(filtered_v=filtered_v, envelope_v=envelope_v))
    if board.rectifier != "precision":
        issues.append(Issue("board.rectifier", f"{board.rectifier!r} has no comparator behind it; use 'precision'."))
    refuse([*issues, *positive("step_s", step_s, "s", "0.0005")])
    slope = (np.maximum(filtered_v, 0.0) - envelope_v) / (np.asarray(board.r_lp_ohm) * np.asarray(board.c_lp_f))
    mean, on, edges, count = np.zeros(len(envelope_v)), np.zeros(len(envelope_v)), np.zeros(_MAX_EDGES), np.zeros(1)
    _follow(comparator.mean_s, comparator.on_v, comparator.off_v, step_s, envelope_v, slope, mean, on, edges, count)
    return Decided(mean, on > 0.0, edges[: int(count[0])])


def pin_v(design: Design, step_s: float, filtered_v: Array, envelope_v: Array) -> Array:
    """Voltage of the design's ON/OFF pin at the samples [V]."""
    comparator = Comparator.of(design)
    found = decide(comparator, Analog.of(design), step_s, filtered_v, envelope_v)
    return np.where(found.on, LOW_V, comparator.high_v)


def mean_at(tau: float, s: float, m: float, v: float, d: float, a: float, b: float) -> float:
    """m(s) for ``tau m' = v + d s + a s^2 + b s^3 - m``, m(0) = m."""
    start = v - tau * (d - tau * (2 * a - tau * 6 * b))
    now = v + s * (d + s * (a + s * b)) - tau * (d + s * (2 * a + s * 3 * b) - tau * (2 * a + s * 6 * b - tau * 6 * b))
    return now + (m - start) * math.exp(-s / tau)


def _loop(
    tau: float,
    on_at: float,
    off_at: float,
    H: float,
    level: Sequence[float],
    slope: Sequence[float],
    mean: MutableSequence[float],
    on_out: MutableSequence[float],
    edges: MutableSequence[float],
    count: MutableSequence[float],
) -> None:
    m = level[0]
    on = 1.0 if m > on_at else 0.0
    found = 0
    mean[0], on_out[0] = m, on
    for i in range(len(level) - 1):
        v, d = level[i], slope[i]
        rise = (level[i + 1] - v) / H
        a, b = (3 * rise - 2 * d - slope[i + 1]) / H, (d + slope[i + 1] - 2 * rise) / (H * H)
        before = 0.0
        for quarter in range(1, 5):
            s = 0.25 * quarter * H
            value = mean_at(tau, s, m, v, d, a, b)
            at = off_at if on > 0.0 else on_at
            if (value < at) if on > 0.0 else (value > at):
                low, high = before, s
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    value = mean_at(tau, middle, m, v, d, a, b)
                    if (value < at) if on > 0.0 else (value > at):
                        high = middle
                    else:
                        low = middle
                on = 1.0 - on
                if found < len(edges):
                    edges[found] = i * H + high
                    found += 1
            before = s
        m = mean_at(tau, H, m, v, d, a, b)
        mean[i + 1] = m
        on_out[i + 1] = on
    count[0] = found


_follow = CompiledLoop(_loop, mean_at, outputs=4, samples="level", plain_us=4.0)
"""Fills the mean, ON or OFF, the moments of change, and how many there are."""
