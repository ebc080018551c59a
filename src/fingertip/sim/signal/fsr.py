"""Tactile sensor: from the force on the pad to the voltage of force-sensing resistor, bridge and amplifier."""

from __future__ import annotations

import math
from collections.abc import Callable, MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.board import board_values
from fingertip.board.components.bridge import ARTICLE_POINTS, sensor_conductance_s
from fingertip.design import Design
from fingertip.jit import CompiledLoop

LOAD_SHIFT_PER_M = (1 - 0.035 / 0.32) / 6e-3
"""Fraction of the force that the sensor loses per metre by which the pad is sheared towards the base [1/m].

Source: a linear finite-element trial of such a finger, in which a pad load that moved by 6 mm towards the base left
0.035 of it on the active area instead of 0.32. That the article's slide shears the pad towards the base is an
assumption.
"""
HYSTERESIS = 0.10
"""Largest relative error by which the force reads high after a higher one (article, III.B: at most 10 %)."""
TURN_ON_WIDTH_N = 0.1
"""Half width of the turn-on around its force [N]: the traces short one after the other as the pad's contact patch
grows. Assumption; that contacts show nothing above 30 Hz (article, III.A) rules out a sharp turn-on."""
_PLAY_FRACTION = 0.2
"""Fraction of the force that goes through the play operator. Assumption.

A play operator alone would pass no vibration smaller than itself, and the article's vibrations do pass."""


@dataclass(frozen=True)
class VoltageCurve:
    """Voltage over force: ``open_v - scale (F - turn_on)^exponent``, with the turn-on of `turn_on_power`.

    The article does not show its bridge circuit. Over the article's range the curve is a power law of the conductance,
    measured by a circuit whose voltage falls in proportion to the conductance.
    """

    turn_on_n: float
    open_v: float
    scale: float
    exponent: float

    def voltage_v(self, force_n: float) -> float:
        """Voltage [V] at a force [N] that never decreased."""
        return self.open_v - self.scale * turn_on_power(force_n - self.turn_on_n, self.exponent)


@dataclass(frozen=True)
class ConductanceCurve:
    """Conductance over force: ``scale (F - turn_on)^exponent`` [S], with the turn-on of `turn_on_power`."""

    turn_on_n: float
    scale: float
    exponent: float

    def conductance_s(self, force_n: float) -> float:
        """Conductance [S] at a force [N] that never decreased."""
        return self.scale * turn_on_power(force_n - self.turn_on_n, self.exponent)


def turn_on_power(excess_n: float, exponent: float) -> float:
    """Power ``excess^exponent`` beyond the turn-on's width, 0 below it, and a cubic that starts as a parabola between.

    Value and slope are continuous. The start is equally gentle for every exponent: a parabola of the force, raised to
    an exponent of 0.5, would have a corner.
    """
    w = TURN_ON_WIDTH_N
    if excess_n >= w:
        return math.pow(excess_n, exponent)
    if excess_n <= -w:
        return 0.0
    t = (excess_n + w) / (2 * w)
    return math.pow(w, exponent) * t * t * (3 - 2 * exponent + (2 * exponent - 2) * t)


def fit_voltage_curve(points: tuple[tuple[float, float], ...] = ARTICLE_POINTS) -> VoltageCurve:
    """Fit the curve that turns on at the first point's force and passes through the two others.

    The article's points give an exponent of 0.669. Interlink's curve (50 g: 10 kohm, 1 kg: 1.25 kohm), which is not
    used in the fit, gives 0.694.
    """
    (f0, v0), (f1, v1), (f2, v2) = points
    exponent = math.log((v0 - v2) / (v0 - v1)) / math.log((f2 - f0) / (f1 - f0))
    return VoltageCurve(f0, v0, (v0 - v1) / (f1 - f0) ** exponent, exponent)


def fit_conductance_curve() -> ConductanceCurve:
    """Fit Interlink's curve at the article's two forces, with the turn-on at which the board's own curve begins."""
    (f0, _), (f1, _), (f2, _) = ARTICLE_POINTS
    g1, g2 = sensor_conductance_s(f1), sensor_conductance_s(f2)
    exponent = math.log(g2 / g1) / math.log((f2 - f0) / (f1 - f0))
    return ConductanceCurve(f0, g1 / (f1 - f0) ** exponent, exponent)


def compute_sensor_force_n(contact_n: Array, shear_m: Array) -> Array:
    """Compute the force on the sensor [N] from the contact's force [N] and the shear of the pad [m]."""
    return contact_n * np.clip(1 - LOAD_SHIFT_PER_M * shear_m, 0.0, None)


def apply_hysteresis(force_n: Array, state: Array | None = None) -> Array:
    """Apply the sensor's hysteresis: a growing force reads true [N], a falling one up to `HYSTERESIS` too high.

    A play operator acts on the force's ratio, p in [F, F (1 + H/s)], and is mixed in with the fraction s.

    Parameters
    ----------
    force_n
        Force on the sensor [N].
    state
        Play p of shape (1,), at first 0, carried from chunk to chunk.
    """
    indicated = np.zeros(len(force_n))
    _play(1 + HYSTERESIS / _PLAY_FRACTION, force_n, np.zeros(1) if state is None else state, indicated)
    return indicated


def _play_loop(
    play_ratio: float, forces: Sequence[float], state: MutableSequence[float], indicated: MutableSequence[float]
) -> None:
    """Apply the play operator, mixed in with its fraction."""
    p = state[0]
    for i in range(len(forces)):
        force = forces[i]
        p = min(max(p, force), force * play_ratio)
        indicated[i] = force + _PLAY_FRACTION * (p - force)
    state[0] = p


_play = CompiledLoop(_play_loop, outputs=2, samples="forces", plain_us=0.5)


def select_voltage_function(design: Design, bridge: str) -> Callable[[float], float]:
    """Select the voltage [V] over the sensor's indicated force [N].

    Parameters
    ----------
    design
        Its board.
    bridge
        "board" for the design's bridge, or "article" for a curve through the article's points.
    """
    if bridge == "article":
        return fit_voltage_curve().voltage_v
    response, curve = board_values(design).tactile_response, fit_conductance_curve()
    return lambda force_n: response.tactile_v(curve.conductance_s(force_n))
