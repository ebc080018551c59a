"""The bridge and its amplifier: from the sensor's conductance to the tactile voltage, and their values.

The article names a Wheatstone bridge and an instrumentation amplifier and shows neither; these are fitted to its
voltages. The sensor lies parallel to the lower resistor of one arm, the other arm holds the reference:

    V = V0 + A (Vs - V0) [1 / (1 + R_top (1 / R_shunt + G)) - R_low / (R_high + R_low)],  A = 1 + 100 kohm / R_gain

with V0 = 0 on a split supply. On a single one V0 is its middle: the amplifier's insides (AD623) must stay above its
lower rail, and with inputs a few tenths of a volt above ground they would carry 1.5 V at most, not the article's 4.3 V.

All of it scales with the supply Vs, so a converter that takes its reference from the same supply sees the sensor alone.
Voltage falls with force, as in the article.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from fingertip.board.values.preferred import neighbours, spread

INTERLINK_CURVE = ((20.0, 30e3), (50.0, 10e3), (100.0, 6e3), (250.0, 3.5e3), (1000.0, 1.25e3), (10000.0, 250.0))
"""Load [gram force] and resistance [ohm], read off Interlink's typical curve (part to part 6 % at best)."""
CURVE_DIAMETER_MM = 5.08
"""Active area the excitation is made for: the article's FSR 400, the smallest of the catalogue."""
NEWTON_PER_GRAM = 9.80665e-3
ARTICLE_POINTS = ((0.2, 4.3), (0.8, 4.0), (1.3, 3.85))
"""Force [N] and voltage [V]: light contact at the sensor's turn-on, then the two figures of the article's IV.A."""

MAX_FORCE_N = 20.0
"""Upper end of the sensor's range (Interlink)."""
MAX_CURRENT_A_PER_CM2 = 1e-3
"""Most current through the sensor, by its active area (Interlink's integration guide)."""
SATURATION = 1.0 / 3.0
"""R_thevenin G at the upper end: the smaller, the straighter V over G, and the smaller the signal."""
CABLE_F = 100e-9
"""Across the sensor: with the bridge's 230 ohm, a pole at 7 kHz against what the cable picks up."""
GAIN_CONSTANT_OHM = 100e3
"""A = 1 + 100 kohm / R_gain (AD623's data sheet)."""


def sensor_conductance_s(force_n: float) -> float:
    """Conductance [S] of the sensor at a force [N], by Interlink's curve, straight lines on logarithmic axes.

    Below the turn-on at 0.2 N (20 gram) the sensor is open: 0.
    """
    load = force_n / NEWTON_PER_GRAM
    # The article's turn-on of 0.2 N is 20.4 gram, the curve's first point 20.
    if load < INTERLINK_CURVE[0][0]:
        return 0.0
    pairs = list(itertools.pairwise(INTERLINK_CURVE))
    (x0, r0), (x1, r1) = next((pair for pair in pairs if load <= pair[1][0]), pairs[-1])
    slope = math.log(r0 / r1) / math.log(x1 / x0)
    return math.pow(load / x0, slope) / r0


@dataclass(frozen=True)
class Bridge:
    """Resistances [ohm] of the bridge and its amplifier."""

    top_ohm: float
    """From the supply to the sensor."""
    shunt_ohm: float
    """Parallel to the sensor."""
    high_ohm: float
    """From the supply to the reference."""
    low_ohm: float
    """From the reference to ground."""
    gain_ohm: float
    """Sets the amplifier's gain."""
    zero_share: float = 0.0
    """To what the bridge's lower ends and the amplifier's output return, as a share of the supply: 0 is ground."""

    @property
    def gain(self) -> float:
        """The amplifier's gain A."""
        return 1.0 + GAIN_CONSTANT_OHM / self.gain_ohm

    def sensor_v(self, conductance_s: float, supply_v: float) -> float:
        """Voltage [V] against ground at a sensor of this conductance [S]."""
        zero_v = self.zero_share * supply_v
        return zero_v + (supply_v - zero_v) / (1.0 + self.top_ohm * (1.0 / self.shunt_ohm + conductance_s))

    def reference_v(self, supply_v: float) -> float:
        """Voltage [V] against ground of the other arm."""
        zero_v = self.zero_share * supply_v
        return zero_v + (supply_v - zero_v) * self.low_ohm / (self.high_ohm + self.low_ohm)

    def tactile_v(self, conductance_s: float, supply_v: float) -> float:
        """The amplifier's output [V] for a sensor of this conductance [S]; 0 is an open one. Not limited to rails."""
        difference_v = self.sensor_v(conductance_s, supply_v) - self.reference_v(supply_v)
        return self.zero_share * supply_v + self.gain * difference_v

    def sensor_current_a(self, conductance_s: float, supply_v: float) -> float:
        """Current [A] through the sensor."""
        return conductance_s * (self.sensor_v(conductance_s, supply_v) - self.zero_share * supply_v)


def max_current_a(active_diameter_mm: float) -> float:
    """Most current [A] through a sensor, by its active area."""
    return MAX_CURRENT_A_PER_CM2 * math.pi * (active_diameter_mm / 20.0) ** 2


def fit_bridge(supply_v: float, series: str, active_diameter_mm: float, zero_share: float = 0.0) -> Bridge:
    """Preferred values that meet the article's three voltages best, with the sensor's current within its limit.

    The sensor's arm comes from the limit: the greatest excitation allowed at `MAX_FORCE_N`. Gain and reference are
    then searched among all pairs of one decade for the least sum of squared errors at `ARTICLE_POINTS`.

    Parameters
    ----------
    supply_v
        Positive supply [V].
    series
        "E12", "E24" or "E96".
    active_diameter_mm
        Of the sensor.
    zero_share
        As `Bridge.zero_share`.
    """
    max_g = sensor_conductance_s(MAX_FORCE_N)
    # The same curve is used for every sensor, so a larger one gains nothing from a larger limit.
    limit_a = max_current_a(min(active_diameter_mm, CURVE_DIAMETER_MM))
    thevenin_ohm = SATURATION / max_g
    thevenin_v = limit_a / max_g * (1.0 + SATURATION)
    zero_v = zero_share * supply_v
    excitation_v = supply_v - zero_v
    top_ohm = max(neighbours(thevenin_ohm * excitation_v / thevenin_v, series))
    shunt_ohm = min(neighbours(thevenin_ohm * excitation_v / (excitation_v - thevenin_v), series))
    arm = Bridge(top_ohm, shunt_ohm, top_ohm, shunt_ohm, GAIN_CONSTANT_OHM, zero_share)
    points = [(arm.sensor_v(sensor_conductance_s(f), supply_v) - zero_v, v - zero_v) for f, v in ARTICLE_POINTS]

    # A straight line through the points, V = A x - A reference, says where to look.
    gain = _slope(points)
    offset_v = sum(gain * x - v for x, v in points) / len(points)
    candidates = (
        Bridge(top_ohm, shunt_ohm, high_ohm, low_ohm, gain_ohm, zero_share)
        for gain_ohm in neighbours(GAIN_CONSTANT_OHM / (gain - 1.0), series)
        for high_ohm in spread(top_ohm, series)
        for low_ohm in neighbours(high_ohm * offset_v / (gain * excitation_v - offset_v), series)
    )
    return min(candidates, key=lambda bridge: (article_error_v(bridge, supply_v), bridge.high_ohm))


def article_error_v(bridge: Bridge, supply_v: float) -> float:
    """Root mean square [V] of what a bridge misses the article's voltages by."""
    errors = (bridge.tactile_v(sensor_conductance_s(f), supply_v) - v for f, v in ARTICLE_POINTS)
    return math.sqrt(sum(e * e for e in errors) / len(ARTICLE_POINTS))


def _slope(points: list[tuple[float, float]]) -> float:
    """Of the least-squares line through (x, y)."""
    x0, y0 = (sum(p[i] for p in points) / len(points) for i in (0, 1))
    return sum((x - x0) * (y - y0) for x, y in points) / sum((x - x0) ** 2 for x, _ in points)
