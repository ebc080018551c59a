"""Means of a tone: rectifier and envelope detector in time, for many boards at once.

The nets behind FILTERED form a small circuit with two diodes at most, driven by the filter's output. Its linear part
comes from the network. Diodes follow Shockley's equation, and an amplifier's output stays within its swing. Time is
stepped with the second-order backward differentiation formula (C. W. Gear, 1971), whose steps damp what is faster than
they are, such as the amplifiers' own poles. All boards of a batch take each Newton step together.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.board.circuits.network import build_network, list_amplifiers
from fingertip.board.components.front_end import EMISSION, SATURATION_A, SERIES_OHM, THERMAL_V
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.nets import ENVELOPE, FILTERED, RAILS, RECT_OUT
from fingertip.foundation.numerics import Array

Indices = NDArray[np.int_]

_LIMIT_GAIN = 1e3
"""Gain with which an output is held at the end of its swing: the smaller, the softer the limit."""
_NEWTON_STEPS, _TOLERANCE_V = 30, 1e-7
_MAX_STEP_V = 0.5
"""Largest change of a net's voltage in one Newton step."""
PERIODS, STEPS_PER_PERIOD = 16, 48
"""Periods until the envelope has settled, and time steps in each; twice as many of both move the envelope by at most
0.4 %."""


@dataclass(frozen=True)
class Drive:
    """Circuit with the voltage at its filter's output."""

    circuit: Circuit
    filtered_v: float
    """Mean of the filter's output above ground [V]."""
    peak_v: float
    """Peak of the tone at the filter's output [V]; 0 for no tone."""
    given_v: Mapping[str, float]
    """Voltages of the rails and of the signal ground above ground [V]."""


def measure_voltages(
    drives: Sequence[Drive], swing_v: tuple[float, float], gain_bandwidth_hz: float, tone_hz: float
) -> tuple[dict[str, Array], Array]:
    """Step boards through a tone until the envelope has settled.

    Returns the means of envelope and, of a precision rectifier, its output in the last period, by net, and the RMS of
    the envelope's alternating part, for each drive [V].
    """
    batch = _Batch(drives, swing_v, gain_bandwidth_hz)
    steps, h = PERIODS * STEPS_PER_PERIOD, 1.0 / (tone_hz * STEPS_PER_PERIOD)
    level, peak = (np.array([getattr(drive, name) for drive in drives]) for name in ("filtered_v", "peak_v"))
    before = last = batch.rest(level)
    total, squares = np.zeros_like(last), np.zeros_like(last)
    for i in range(1, steps + 1):
        filtered = level + peak * math.sin(2.0 * math.pi * i / STEPS_PER_PERIOD)
        before, last = last, batch.step(before, last, filtered, h)
        if i > steps - STEPS_PER_PERIOD:
            total += last
            squares += last**2
    means = total / STEPS_PER_PERIOD
    ripple = np.sqrt(np.maximum(squares / STEPS_PER_PERIOD - means**2, 0.0))
    named = {net: means[:, batch.nets.index(net)] for net in (ENVELOPE, RECT_OUT) if net in batch.nets}
    return named, ripple[:, batch.nets.index(ENVELOPE)]


class _Batch:
    """Equations F(v) + C v' = 0 of all boards: linear ones, diodes and limits."""

    def __init__(self, drives: Sequence[Drive], swing_v: tuple[float, float], bandwidth_hz: float) -> None:
        first = drives[0].circuit
        diodes = [c.reference for c in first.components if c.symbol.name == "1N4148W"]
        given = (*(name for name in drives[0].given_v if name not in RAILS), FILTERED)
        # What the envelope depends on while all diodes conduct is what it depends on at all.
        conducting = build_network(first, conducting=diodes).drive(*given).restrict(ENVELOPE)
        nets = conducting.nets
        # The equations of these nets; the others are inputs of 0 V.
        networks = [build_network(d.circuit, bandwidth_hz).drive(*given) for d in drives]
        networks = [network.drive(*(name for name in network.nets if name not in nets)) for network in networks]
        size, inputs = len(nets), networks[0].inputs
        G, C = zip(*(network.matrices for network in networks), strict=True)
        self._G, self._C = np.array(G)[:, :, :size], np.array(C)[:, :, :size]
        self._G_in = np.array(G)[:, :, size:]
        self._given = np.array([[d.given_v.get(name, 0.0) for name in inputs] for d in drives])
        self._filtered = inputs.index(FILTERED)
        self.nets = nets
        self._outputs = [nets.index(a.net) for a in list_amplifiers(first) if a.net in nets]
        self._low_v, self._high_v = swing_v
        # Ends of each diode as columns of (nets, inputs); a row of the batch may have them reversed.
        column = {name: i for i, name in enumerate((*nets, *inputs))}
        self._diodes = np.zeros((len(drives), len(diodes), 2), dtype=int)
        self._fitted = np.zeros((len(drives), len(diodes)))
        for i, drive in enumerate(drives):
            for part in drive.circuit.components:
                if part.symbol.name == "1N4148W" and part.reference in diodes:
                    k = diodes.index(part.reference)
                    self._diodes[i, k] = [column[drive.circuit.net_by_pin[part.reference, pin]] for pin in "21"]
                    self._fitted[i, k] = 1.0
        self._size, self._rows = size, np.arange(len(drives))

    def rest(self, level: Array) -> Array:
        """Voltages at rest for a level of the filter's output [V]: a step long enough for all charges to settle."""
        v = np.repeat(level[:, None], self._size, axis=1)
        for h in (1e-3, 1e-1, 1e3):
            v = self.step(v, v, level, h)
        return v

    def step(self, before: Array, last: Array, filtered: Array, h: float) -> Array:
        """Voltages after one more time step [s], from those one and two steps ago [V]."""
        given = self._given.copy()
        given[:, self._filtered] = filtered
        linear = self._G + 1.5 / h * self._C
        fixed = np.einsum("bij,bj->bi", self._G_in, given)
        fixed += np.einsum("bij,bj->bi", self._C, (0.5 * before - 2.0 * last) / h)
        v, active = last.copy(), self._rows
        for _ in range(_NEWTON_STEPS):
            # Boards that have converged stay as they are; a few of them need many more steps than the rest.
            now = v[active]
            residual = np.einsum("bij,bj->bi", linear[active], now) + fixed[active]
            jacobian = linear[active]
            self._add_limits(now, residual, jacobian)
            self._add_diodes(active, now, given[active], residual, jacobian)
            change = np.linalg.solve(jacobian, -residual[:, :, None])[:, :, 0]
            v[active] = now + np.clip(change, -_MAX_STEP_V, _MAX_STEP_V)
            active = active[np.abs(change).max(axis=1) > _TOLERANCE_V]
            if not len(active):
                break
        return v

    def _add_limits(self, v: Array, residual: Array, jacobian: Array) -> None:
        """Hold each amplifier's output within its swing: its input difference no longer moves it."""
        for row in self._outputs:
            excess = np.maximum(v[:, row] - self._high_v, 0.0) + np.minimum(v[:, row] - self._low_v, 0.0)
            residual[:, row] -= _LIMIT_GAIN * excess
            jacobian[:, row, row] -= _LIMIT_GAIN * (excess != 0.0)

    def _add_diodes(self, active: Indices, v: Array, given: Array, residual: Array, jacobian: Array) -> None:
        volts, rows = np.concatenate((v, given), axis=1), np.arange(len(active))
        slope = EMISSION * THERMAL_V
        # Above this voltage the exponential continues as its tangent, so that no Newton step overflows.
        top = slope * math.log(slope / (SATURATION_A * SERIES_OHM))
        for k in range(self._diodes.shape[1]):
            anode, cathode = self._diodes[active, k, 0], self._diodes[active, k, 1]
            fitted = self._fitted[active, k]
            drop = volts[rows, anode] - volts[rows, cathode]
            exponential = SATURATION_A * np.exp(np.minimum(drop, top) / slope)
            conductance = exponential / slope * fitted
            current = (exponential - SATURATION_A) * fitted + conductance * np.maximum(drop - top, 0.0)
            for end, sign in ((anode, 1.0), (cathode, -1.0)):
                own = rows[end < self._size]
                residual[own, end[own]] += sign * current[own]
                for other, factor in ((anode, 1.0), (cathode, -1.0)):
                    both = own[other[own] < self._size]
                    jacobian[both, end[both], other[both]] += sign * factor * conductance[both]
