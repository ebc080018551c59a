"""Expected readings of a finger: resistance and tactile voltage under weights, and the wires it needs."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design import Design
from fingertip.sim.signal.bridge import Bridge

WEIGHTS_G = (100.0, 500.0)
"""Weights laid on the pad."""
SPREAD = 4.0
"""Factor by which the conductance of a good sensor may differ from the data sheet's curve, up or down.

Single force-sensing resistors differ by a factor of two to eight at the same force, and a skin spreads the load.
"""
_GRAVITY = 9.81
_SLACK_MM = 10.0
"""Slack of the wires besides what a joint takes up [mm]. An assumption."""
_AWG_36_MM = 0.127
"""Diameter of AWG 36, from which all others follow [mm] (ASTM B258)."""


@dataclass(frozen=True)
class WeightReading:
    """Expected reading of a weight on the pad."""

    mass_g: float
    sensor_ohm: float
    tactile_v: float
    limits_v: tuple[float, float]
    """Lowest and highest voltage of a good finger."""


@dataclass(frozen=True)
class Wires:
    """Wires of a sensor."""

    max_diameter_mm: float
    """Largest diameter of one wire over its insulation."""
    conductor_awg: int
    """Thickest usual conductor that leaves half of the diameter to the insulation."""
    slack_mm: float
    """Length of the loop between the finger and the first place at which the wires are fixed."""


def expect_open_v(design: Design) -> float:
    """Expect the tactile voltage of an untouched finger [V]."""
    return Bridge.of_board(design).response.open_v


def expect_readings(design: Design) -> tuple[WeightReading, ...]:
    """Expect the readings of `WEIGHTS_G`, with limits that cover sensors within `SPREAD` of the data sheet."""
    bridge = Bridge.of_board(design)
    readings = []
    for mass in WEIGHTS_G:
        conductance = bridge.curve.conductance_s(mass / 1000.0 * _GRAVITY)
        low, high = (bridge.response.tactile_v(conductance * factor) for factor in (SPREAD, 1.0 / SPREAD))
        readings.append(WeightReading(mass, 1.0 / conductance, bridge.response.tactile_v(conductance), (low, high)))
    return tuple(readings)


def size_wires(design: Design) -> Wires:
    """Size the wires: they fit through channel or fold, and cross the joint in a loop that stays loose.

    The gauge number of a diameter d is 36 - 39 log(d / 0.127 mm) / log 92 (ASTM B258).
    """
    dims, joint = design.dimensions, design.dimensions.joint
    # Two equal circles side by side span the channel.
    diameter = design.sensor.wire_diameter_mm if dims.fold else design.bone.channel_diameter_mm / 2
    gauge = math.ceil(36.0 - 39.0 * math.log(diameter / 2 / _AWG_36_MM) / math.log(92.0))
    bend = math.radians(design.hand.travel_deg) * (dims.bone_outline.section.dorsal - joint.axis_y) if joint else 0.0
    return Wires(diameter, gauge, bend + _SLACK_MM)
