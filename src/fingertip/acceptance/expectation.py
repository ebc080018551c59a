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
_GRAVITY = 9.81


@dataclass(frozen=True)
class WeightReading:
    """Expected reading of a weight on the pad."""

    mass_g: float
    sensor_ohm: float
    tactile_v: float
    limits_v: tuple[float, float]
    """Lowest and highest voltage of a good finger."""


def expect_open_v(design: Design) -> float:
    """Expect the tactile voltage of an untouched finger [V]."""
    return Bridge.of_board(design).response.open_v


def expect_readings(design: Design) -> tuple[WeightReading, ...]:
    """Expect the readings of `WEIGHTS_G`, with limits that cover sensors within `SPREAD` of the data sheet."""
    bridge = Bridge.of_board(design)
    # A board on a single supply gives no voltage below its ground.
    lowest_v = 0.0 if signal_ground_ratio(design.board.supply) else -math.inf
    readings = []
    for mass in WEIGHTS_G:
        conductance = bridge.curve.conductance_s(mass / 1000.0 * _GRAVITY)
        low, high = (
            max(lowest_v, bridge.response.tactile_v(conductance * factor)) for factor in (SPREAD, 1.0 / SPREAD)
        )
        readings.append(WeightReading(mass, 1.0 / conductance, bridge.response.tactile_v(conductance), (low, high)))
    return tuple(readings)
