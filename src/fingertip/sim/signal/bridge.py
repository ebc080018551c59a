"""Bridge and amplifier: from the force that the sensor shows to the tactile voltage."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.board.analysis.tactile_response import TactileResponse, find_tactile_response
from fingertip.board.components.front_end import ARTICLE_POINTS, sensor_conductance_s
from fingertip.catalogues.electronics import HYSTERESIS as HYSTERESIS
from fingertip.design import Design
from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.foundation.numerics import Array

TURN_ON_WIDTH_N = 0.1
"""Half width of the turn-on around its force [N]: the traces short one after the other as the pad's
contact patch grows. Assumption; that contacts show nothing above 30 Hz (article, III.A) rules out a
sharp turn-on.
"""


@dataclass(frozen=True)
class ConductanceCurve:
    """Conductance over force: ``scale (F - turn_on)^exponent`` [S], with the turn-on of
    `turn_on_power`.
    """

    turn_on_n: float
    scale: float
    exponent: float

    def conductance_s(self, force_n: float) -> float:
        """Conductance [S] at a force [N] that never decreased."""
        return self.scale * turn_on_power(force_n - self.turn_on_n, self.exponent, TURN_ON_WIDTH_N)

    def force_n(self, conductance_s: float) -> float:
        """Force [N] at a conductance [S].

        Where the turn-on rounds the curve, it is the force of the unrounded power.
        """
        return self.turn_on_n + math.pow(max(conductance_s, 0.0) / self.scale, 1.0 / self.exponent)

    @classmethod
    def of_design(cls, design: Design) -> ConductanceCurve:
        """Curve of a design: calibrated, or typical."""
        calibrated = design.force_curve
        if calibrated.curve == "typical":
            return fit_conductance_curve()

        return cls(calibrated.turn_on_n, 1e-6 * calibrated.conductance_us, calibrated.exponent)


@dataclass(frozen=True)
class Bridge:
    """Tactile voltage over force: the sensor's curve, and the response of bridge and amplifier to
    its conductance.
    """

    curve: ConductanceCurve
    response: TactileResponse

    @classmethod
    def select(cls, design: Design, bridge: str) -> Bridge:
        """Bridge that a scene names: the board's or the article's."""
        return cls.of_board(design) if bridge == "board" else cls.of_article()

    @classmethod
    def of_board(cls, design: Design) -> Bridge:
        """Bridge and amplifier of a design, with its calibrated sensor or the data sheet's.

        The resistances are sized for the data sheet's curve in any case: a calibration holds for
        the board on which the sensor was weighed.
        """
        return cls(ConductanceCurve.of_design(design), find_tactile_response(design))

    @classmethod
    def of_article(cls) -> Bridge:
        """Curve through the article's points.

        The article does not show its bridge circuit. Over the article's range the curve is a power
        law of the conductance, measured by a circuit whose voltage falls in proportion to the
        conductance. The exponent is 0.669; Interlink's curve (50 g: 10 kohm, 1 kg: 1.25 kohm),
        which is not used here, gives 0.694.
        """
        (f0, v0), (f1, v1), (f2, v2) = ARTICLE_POINTS
        exponent = math.log((v0 - v2) / (v0 - v1)) / math.log((f2 - f0) / (f1 - f0))
        scale = (v0 - v1) / (f1 - f0) ** exponent

        return cls(ConductanceCurve(f0, scale, exponent), TactileResponse(v0, 1.0, 0.0, 1.0))

    def voltage_v(self, force_n: Array) -> Array:
        """Tactile voltage [V] at the forces that the sensor shows [N]."""
        return self.follow(force_n, np.full(len(force_n), STRAIGHT), np.zeros(1))[0]

    def follow(self, force_n: Array, middle_n: Array, last_v: Array) -> tuple[Array, Array]:
        """Tactile voltage [V], and how far it bends from the straight line in the middle of the
        step before [V].

        The forces [N] are those that the sensor shows at the points and in the middle of the step
        before each.
        """
        curve = self.curve
        response = self.response
        out, bend_v = np.zeros((2, len(force_n)))
        convert(
            (curve.turn_on_n, curve.scale, curve.exponent, TURN_ON_WIDTH_N),
            (response.open_v, response.sensor_v, response.source_ohm, response.transfer_ohm),
            force_n,
            middle_n,
            last_v,
            out,
            bend_v,
        )

        return out, bend_v


def reads_whole_finger(design: Design, bridge: str) -> bool:
    """Return whether the force of a curve is that on the finger: the article's, and one found with
    weights on it.
    """
    return bridge == "article" or design.force_curve.curve == "calibrated"


def turn_on_power(excess_n: float, exponent: float, width_n: float) -> float:
    """Power ``excess^exponent`` beyond the turn-on's width, 0 below it, and a cubic that starts as
    a parabola between.

    Value and slope are continuous. The start is equally gentle for every exponent: a parabola of
    the force, raised to an exponent of 0.5, would have a corner.
    """
    if excess_n >= width_n:
        return math.pow(excess_n, exponent)
    if excess_n <= -width_n:
        return 0.0

    t = (excess_n + width_n) / (2 * width_n)
    return math.pow(width_n, exponent) * t * t * (3 - 2 * exponent + (2 * exponent - 2) * t)


def fit_conductance_curve() -> ConductanceCurve:
    """Fit Interlink's curve at the article's two forces, with the turn-on at which the board's own
    curve begins.
    """
    (f0, _), (f1, _), (f2, _) = ARTICLE_POINTS
    g1 = sensor_conductance_s(f1)
    g2 = sensor_conductance_s(f2)
    exponent = math.log(g2 / g1) / math.log((f2 - f0) / (f1 - f0))

    return ConductanceCurve(f0, g1 / (f1 - f0) ** exponent, exponent)


def _convert_loop(
    curve: Floats,
    response: Floats,
    forces: Floats,
    middles: Floats,
    last: MutableFloats,
    out: MutableFloats,
    bend: MutableFloats,
) -> None:
    turn_on, scale, exponent, width = curve
    open_v, sensor_v, source_ohm, transfer_ohm = response
    # A finger in the air or at rest shows the same force for long.
    force = math.nan
    voltage = 0.0

    for i in range(len(forces)):
        if forces[i] != force:
            force = forces[i]
            g = scale * turn_on_power(force - turn_on, exponent, width)
            voltage = open_v - transfer_ohm * (sensor_v * g / (1.0 + source_ohm * g))

        out[i] = voltage
        bend[i] = 0.0
        if middles[i] >= 0.0:
            g = scale * turn_on_power(middles[i] - turn_on, exponent, width)
            between = open_v - transfer_ohm * (sensor_v * g / (1.0 + source_ohm * g))
            bend[i] = between - 0.5 * ((out[i - 1] if i > 0 else last[0]) + voltage)

    last[0] = voltage if len(forces) else last[0]


convert = CompiledLoop(_convert_loop, turn_on_power, samples="forces", plain_us=0.9)


# Force-sensing resistor: from the force on its active area to the force that it shows.

PLAY_FRACTION = 0.2
"""Fraction of the force through the play operator.
Assumption: the article's small vibrations do pass.
"""
CREEP_FROM_S = 1.0
"""Time under load from which creep is counted in decades [s]: data sheets read the sensor then.
Assumption.
"""
LIGHT_N = 1e-3
"""Force at which time under load counts by half [N]."""
_PLAY, _LOADED, _ONE, _TWO, _THREE = range(5)
"""Indices of the sensor's state: play [N], number of steps since it was loaded, and the last three
forces [N].
"""
NEW = (0.0, 0.0, math.nan, math.nan, math.nan)
"""State of a sensor before its first force."""
STRAIGHT = -1.0
"""Force in the middle of a step that is as good as straight [N]."""
BEND_N = 1e-6
"""Force by which a step must bend to count as two [N]: 0.03 mV of an envelope."""


class ForceSensor:
    """Sensor with hysteresis and creep, chunk by chunk.

    Hysteresis: a growing force reads true, a falling one up to `HYSTERESIS` too high. A play
    operator acts on the force's ratio, p in [F, F (1 + H/s)], and is mixed in with the fraction s.
    Creep: the reading grows by a fixed fraction per decade of time under load.
    """

    def __init__(self, step_s: float, share_per_decade: float = 0.0) -> None:
        self._step_s = step_s
        self._share = share_per_decade
        self._state = np.array(NEW)

    def process(self, sensed_n: Array) -> tuple[Array, Array]:
        """Return the force that the sensor shows [N] at each point, and in the middle of the step
        before it.

        The latter is chosen such that two straight lines enclose the area of the curve, or it is
        `STRAIGHT`.
        """
        shown, middle = np.zeros((2, len(sensed_n)))
        play = 1 + HYSTERESIS / PLAY_FRACTION
        indicate(
            play, self._share, self._step_s / CREEP_FROM_S, sensed_n, self._state, shown, middle
        )

        return shown, middle


def _indicate_loop(
    play_ratio: float,
    creep: float,
    step: float,
    forces: Floats,
    state: MutableFloats,
    shown: MutableFloats,
    middle: MutableFloats,
) -> None:
    p = state[_PLAY]
    loaded = state[_LOADED]
    f1 = state[_ONE]
    f2 = state[_TWO]
    f3 = state[_THREE]

    for i in range(len(forces)):
        force = forces[i]
        is_new = f1 != f1
        if is_new:
            p = f1 = f2 = f3 = force

        start = f1 + PLAY_FRACTION * (p - f1)
        middle[i] = STRAIGHT
        bent = not f3 == f2 == f1 == force

        if bent:
            # Quarters of the step before, where the play turns and catches between points: on the
            # cubic through four points, and on the straight line where a corner bends the curve.
            bend = force - 2 * f1 + f2
            before = f1 - 2 * f2 + f3
            if not abs(before - 1.25 * bend) < abs(bend):
                bend = before = 0.0

            total = 0.0
            for quarter in range(1, 4):
                t = 0.25 * quarter
                q = f1 + t * (force - f1 - 0.5 * (1 - t) * (bend + (1 + t) / 3 * (bend - before)))
                p = min(max(p, q), q * play_ratio)
                total += q + PLAY_FRACTION * (p - q)

        p = min(max(p, force), force * play_ratio)
        value = force + PLAY_FRACTION * (p - force)
        if bent and abs(total - 1.5 * (start + value)) > 2 * BEND_N:
            middle[i] = max(0.5 * total - 0.25 * (start + value), 0.0)

        if creep > 0.0:
            # Time counts as far as the load is above nothing: a whole point from the first on would
            # have order 1.
            if not is_new:
                loaded += 0.5 * (start / (start + LIGHT_N) + value / (value + LIGHT_N))

            loaded = loaded if value > 0.0 else 0.0
            growth = 1 + creep * math.log10(1 + loaded * step)
            value *= growth
            middle[i] *= growth

        shown[i] = value
        f3 = f2
        f2 = f1
        f1 = force

    state[_PLAY] = p
    state[_LOADED] = loaded
    state[_ONE] = f1
    state[_TWO] = f2
    state[_THREE] = f3


indicate = CompiledLoop(_indicate_loop, samples="forces", plain_us=0.7)
