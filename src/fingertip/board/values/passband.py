"""What the filter passes as built: its largest gain and where it has lost 3 dB, from the circuit with all its parts.

The formulas of `filters` know neither C14, which takes a little gain at the lower end, nor C20, which ends the passband
above the vibrations, nor the amplifier's own end. Here the whole transfer function is looked at.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from fingertip.board.values.built import FirstStage, network
from fingertip.board.values.filters import Response, decibel, response
from fingertip.design.filter_components import Components

_PER_DECADE = 6
_BELOW = 3.0
"""Where the search begins, in cutoffs below the formulas'."""
_MAX_STEPS = 60
_PEAK = 1e-6
"""How near the peak is looked for, as a share of the frequency: its gain is then within 1e-12."""
_END = 1e-13
"""How near the ends."""


@dataclass(frozen=True)
class Passband:
    """From the tactile voltage to the rectifier."""

    gain: float
    """The largest."""
    low_hz: float
    high_hz: float
    """Between these the gain is within 3.0103 dB of the largest."""


def passband(c: Components, gain_bandwidth_hz: float, extra: FirstStage | None = None) -> Passband:
    """The passband of components as fitted."""
    formulas = response(c, gain_bandwidth_hz)

    def gain(x: float) -> float:
        return math.log(abs(network(math.exp(x), c, gain_bandwidth_hz, extra)))

    first = math.log(min(formulas.cutoff_hz, formulas.section_hz) / _BELOW)
    last = math.log(10.0 * max(formulas.amplifier_bandwidth_hz, formulas.cutoff_hz))
    count = math.ceil((last - first) / math.log(10.0) * _PER_DECADE)
    step = (last - first) / count
    grid = [gain(first + i * step) for i in range(count + 1)]
    at = max(range(1, count), key=grid.__getitem__)
    maximum = _largest(gain, first + at * step, step, (grid[at - 1], grid[at], grid[at + 1]))
    level = maximum - 0.5 * math.log(2.0)

    def crossing(outward: int) -> float:
        i = at
        while grid[i + outward] >= level:
            i += outward
        ends = (first + i * step, first + (i + outward) * step)
        return math.exp(_root(lambda x: gain(x) - level, ends, (grid[i] - level, grid[i + outward] - level)))

    return Passband(math.exp(maximum), crossing(-1), crossing(1))


def _largest(f: Callable[[float], float], x: float, step: float, values: tuple[float, float, float]) -> float:
    """The largest f, which rises to x and falls from it at this step: by parabolas through the three nearest points."""
    (a, b, c), (fa, fb, fc) = (x - step, x, x + step), values
    for _ in range(_MAX_STEPS):
        left, right = (b - a) * (fb - fc), (b - c) * (fb - fa)
        if left == right:
            break
        new = b - 0.5 * ((b - a) * left - (b - c) * right) / (left - right)
        if not a < new < c or abs(new - b) < _PEAK:
            break
        value = f(new)
        if value >= fb:
            (a, fa), (c, fc) = ((b, fb), (c, fc)) if new > b else ((a, fa), (b, fb))
            b, fb = new, value
        elif new > b:
            c, fc = new, value
        else:
            a, fa = new, value
    return fb


def _root(f: Callable[[float], float], ends: tuple[float, float], values: tuple[float, float]) -> float:
    """Where f changes its sign between the ends, at which it is known: by chords, an end that stays weighing half
    (Illinois)."""
    (a, b), (fa, fb) = ends, values
    for _ in range(_MAX_STEPS):
        if fa == fb or abs(b - a) < _END:
            break
        new = b - fb * (b - a) / (fb - fa)
        value = f(new)
        if value * fb < 0.0:
            a, fa = b, fb
        else:
            fa *= 0.5
        b, fb = new, value
        if value == 0.0:
            break
    return b


def built_response(c: Components, gain_bandwidth_hz: float, extra: FirstStage | None = None) -> Response:
    """What components achieve: as `filters.response`, but gain and both ends from the circuit."""
    found = passband(c, gain_bandwidth_hz, extra)
    return replace(
        response(c, gain_bandwidth_hz),
        passband_gain=found.gain,
        passband_gain_db=decibel(found.gain),
        cutoff_hz=found.low_hz,
        upper_cutoff_hz=found.high_hz,
    )
