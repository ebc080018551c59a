"""What the filter passes as built: its largest gain and where it has lost 3 dB, from the circuit with all its parts.

The formulas of `filters` know neither C14, which takes a little gain at the lower end, nor C20, which ends the passband
above the vibrations, nor the amplifier's own end. Here the whole transfer function is looked at.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from fingertip.board.values.built import FirstStage, network
from fingertip.board.values.filters import Response, decibel, response
from fingertip.design.filter_components import Components

_PER_DECADE = 12
_BELOW = 3.0
"""Where the search begins, in cutoffs below the formulas'."""
_HALVINGS = 50


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
        return abs(network(math.exp(x), c, gain_bandwidth_hz, extra))

    first = math.log(min(formulas.cutoff_hz, formulas.section_hz) / _BELOW)
    last = math.log(10.0 * max(formulas.amplifier_bandwidth_hz, formulas.cutoff_hz))
    count = math.ceil((last - first) / math.log(10.0) * _PER_DECADE)
    step = (last - first) / count
    grid = [gain(first + i * step) for i in range(count + 1)]
    at = max(range(len(grid)), key=grid.__getitem__)
    peak = first + at * step
    low, high = peak - step, peak + step
    for _ in range(_HALVINGS):  # by thirds: around the largest of the grid it has one maximum
        a, b = low + (high - low) / 3.0, high - (high - low) / 3.0
        low, high = (a, high) if gain(a) < gain(b) else (low, b)
    peak = 0.5 * (low + high)
    most = gain(peak)
    level = most / math.sqrt(2.0)

    def crossing(inside: float, outward: float) -> float:
        while gain(inside + outward) >= level:
            inside += outward
        outside = inside + outward
        for _ in range(_HALVINGS):
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if gain(middle) >= level else (inside, middle)
        return math.exp(inside)

    return Passband(most, crossing(peak, -step), crossing(peak, step))


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
