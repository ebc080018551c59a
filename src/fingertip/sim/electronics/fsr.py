"""From the force on the sensor to a voltage: force-sensing resistor, bridge and amplifier."""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.board.values.bridge import ARTICLE_POINTS, sensor_conductance_s
from fingertip.jit import CompiledLoop

HYSTERESIS = 0.10
"""Most by which the force reads high after a higher one, of its value (article, III.B: at most 10 %)."""
TURN_ON_WIDTH_N = 0.1
"""Half width of the turn-on around its force [N]: the traces short one after the other as the pad's patch of contact
grows, not all at once. Assumption; that contacts show nothing above 30 Hz (article, III.A) rules out a sharp one."""
_PLAY_SHARE = 0.2
# Share of the force that goes through the play. A play alone would swallow every vibration smaller than
# itself, and the article's vibrations do get through. Assumption.


@dataclass(frozen=True)
class Curve:
    """Voltage over force: ``open_v - scale (F - turn_on)^exponent``, begun as `turned_on` has it.

    The bridge is not drawn in the article. Over the article's range this is a power law of the conductance, shown by a
    circuit whose voltage falls in proportion to it.
    """

    turn_on_n: float
    open_v: float
    scale: float
    exponent: float

    def voltage_v(self, force_n: float) -> float:
        """Voltage [V] at a force [N] that only ever grew."""
        return self.open_v - self.scale * turned_on(force_n - self.turn_on_n, self.exponent)


@dataclass(frozen=True)
class Conductance:
    """Conductance over force: ``scale (F - turn_on)^exponent`` [S], begun as `turned_on` has it."""

    turn_on_n: float
    scale: float
    exponent: float

    def siemens(self, force_n: float) -> float:
        """Conductance [S] at a force [N] that only ever grew."""
        return self.scale * turned_on(force_n - self.turn_on_n, self.exponent)


def turned_on(excess_n: float, exponent: float) -> float:
    """``excess^exponent`` beyond the turn-on's width, 0 below it, and a cubic that starts as a parabola between.

    Value and slope are continuous. What the exponent is does not matter to how gently it starts: a parabola of the
    force, raised to an exponent of 0.5, would be a corner.
    """
    w = TURN_ON_WIDTH_N
    if excess_n >= w:
        return math.pow(excess_n, exponent)
    if excess_n <= -w:
        return 0.0
    t = (excess_n + w) / (2 * w)
    return math.pow(w, exponent) * t * t * (3 - 2 * exponent + (2 * exponent - 2) * t)


def fit(points: tuple[tuple[float, float], ...] = ARTICLE_POINTS) -> Curve:
    """The curve that is open below the first point's force, and goes through the two others.

    The article's give an exponent of 0.669; Interlink's curve (50 g: 10 kohm, 1 kg: 1.25 kohm), which took
    no part, 0.694.
    """
    (f0, v0), (f1, v1), (f2, v2) = points
    exponent = math.log((v0 - v2) / (v0 - v1)) / math.log((f2 - f0) / (f1 - f0))
    return Curve(f0, v0, (v0 - v1) / (f1 - f0) ** exponent, exponent)


def fit_conductance() -> Conductance:
    """Interlink's curve at the article's two forces, from the turn-on at which the board's own curve begins."""
    (f0, _), (f1, _), (f2, _) = ARTICLE_POINTS
    g1, g2 = sensor_conductance_s(f1), sensor_conductance_s(f2)
    exponent = math.log(g2 / g1) / math.log((f2 - f0) / (f1 - f0))
    return Conductance(f0, g1 / (f1 - f0) ** exponent, exponent)


def with_hysteresis(force_n: Array, state: Array | None = None) -> Array:
    """Force as the sensor shows it [N]: growing it shows the force itself, falling up to `HYSTERESIS` more.

    A play operator on the force's ratio, p in [F, F (1 + H/s)], mixed in with the share s. `state` of shape (1,), at
    first 0, carries p from chunk to chunk.
    """
    shown = np.zeros(len(force_n))
    _play(1 + HYSTERESIS / _PLAY_SHARE, force_n, np.zeros(1) if state is None else state, shown)
    return shown


def _play_loop(
    room: float, forces: Sequence[float], state: MutableSequence[float], shown: MutableSequence[float]
) -> None:
    p = state[0]
    for i in range(len(forces)):
        force = forces[i]
        p = min(max(p, force), force * room)
        shown[i] = force + _PLAY_SHARE * (p - force)
    state[0] = p


_play = CompiledLoop(_play_loop, outputs=2, samples="forces", plain_us=0.4)
