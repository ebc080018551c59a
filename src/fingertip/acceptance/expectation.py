"""Expected readings of a finger: resistance and tactile voltage under weights."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.casting.hardware import WEIGHTS_G
from fingertip.design import Design
from fingertip.design.signal_ground import signal_ground_ratio
from fingertip.sim.signal.bridge import Bridge

SPREAD = 4.0
"""Factor by which the conductance of a good sensor may differ from the data sheet's curve, up or down.

Single force-sensing resistors differ by a factor of two to eight at the same force, and a skin spreads the load.
"""
_RATIO_SPREAD = 1.3
"""Factor by which the exponent of single sensors and the place of the disc change the ratio. An assumption."""
_GRAVITY = 9.81


@dataclass(frozen=True)
class WeightReading:
    """Expected reading of a weight on the pad."""

    mass_g: float
    sensor_ohm: float
    tactile_v: float
    limits_v: tuple[float, float]
    """Lowest and highest voltage of a good finger."""
    spread: float
    """Factor by which the conductance may differ from the expected one within these limits."""


@dataclass(frozen=True)
class DropRatio:
    """Drop of the tactile voltage below that of the untouched finger: the heaviest weight's over the lightest's."""

    expected: float
    limits: tuple[float, float]


def expect_open_v(design: Design) -> float:
    """Expect the tactile voltage of an untouched finger [V]."""
    return Bridge.of_board(design).response.open_v


def expect_readings(design: Design) -> tuple[WeightReading, ...]:
    """Expect the readings of `WEIGHTS_G`, with limits that cover sensors within `find_spread` of the curve."""
    bridge = Bridge.of_board(design)
    # A board on a single supply gives no voltage below its ground.
    lowest_v = 0.0 if signal_ground_ratio(design.board.supply) else -math.inf
    readings = []
    for mass in WEIGHTS_G:
        force_n = mass / 1000.0 * _GRAVITY
        conductance, spread = bridge.curve.conductance_s(force_n), find_spread(design, force_n)
        low, high = (
            max(lowest_v, bridge.response.tactile_v(conductance * factor)) for factor in (spread, 1.0 / spread)
        )
        expected = bridge.response.tactile_v(conductance)
        readings.append(WeightReading(mass, 1.0 / conductance, expected, (low, high), spread))
    return tuple(readings)


def find_spread(design: Design, force_n: float) -> float:
    """Find the factor by which the conductance of a good sensor may differ from the curve of the design at a force.

    A calibrated curve is as uncertain as its calibration, in the range of its forces. Beyond it, and without a
    calibration, the factor is that of single sensors.
    """
    curve = design.force_curve
    if curve.curve == "calibrated" and curve.min_force_n <= force_n <= curve.max_force_n:
        return min(curve.interval_factor, SPREAD)
    return SPREAD


def expect_drop_ratio(design: Design) -> DropRatio:
    """Expect the ratio of the drops under the heaviest and the lightest weight.

    Sensors that differ by a factor at every force have nearly the same ratio, so its limits are much closer than those
    of the voltages. They cover the same factors for both weights, and `_RATIO_SPREAD` besides.
    """
    open_v = expect_open_v(design)
    light, *_, heavy = expect_readings(design)
    drops = [
        (open_v - of_light, open_v - of_heavy)
        for of_light, of_heavy in (
            (light.tactile_v, heavy.tactile_v), *zip(light.limits_v, heavy.limits_v, strict=True)
        )
    ]  # fmt: skip
    expected, *others = (of_heavy / of_light for of_light, of_heavy in drops)
    return DropRatio(expected, (min(expected, *others) / _RATIO_SPREAD, max(expected, *others) * _RATIO_SPREAD))
