"""Front ends of the boards: the article's bridge, and the transimpedance stage of the others.

The article mentions a Wheatstone bridge and an instrumentation amplifier without showing them. The
resistances are selected to reproduce its voltages. The sensor is parallel to the lower resistor of
one arm, and the other arm supplies the reference:

    V = A Vs [1 / (1 + R_top (1 / R_shunt + G)) - R_low / (R_high + R_low)]
    A = 1 + 100 kohm / R_gain

The voltage falls with the force, as in the article. On the boards for 3.3 V the sensor lies between
ground and the inverting input of U2a, which holds it at the bias voltage. Its current flows through
the feedback resistor R30,

    T = V_bias [1 + R30 G / (1 + (R28 + R29) G)]
    V_bias = Vs R32 / (R31 + R32)

so that T rises with the force, from V_bias with an open sensor. The article's bridge with its AD623
has ten to twenty times the noise: it amplifies the 35 nV/sqrt(Hz) of the AD623 by its gain, where
this stage amplifies those of U2a by little more than 1, because the sensor's resistance is large.
"""

from __future__ import annotations

import itertools
import math
import statistics
from dataclasses import dataclass, replace

from fingertip.board.components.selection import neighbouring_values, values_around
from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE
from fingertip.design.parameters.sensor_and_skin import TURN_ON_N

INTERLINK_CURVE = (
    (20.0, 30e3),
    (50.0, 10e3),
    (100.0, 6e3),
    (250.0, 3.5e3),
    (1000.0, 1.25e3),
    (10000.0, 250.0),
)
"""Load [gram force] and resistance [ohm], off Interlink's typical curve (parts differ by 6 %)."""
CURVE_DIAMETER_MM = 5.08
"""Active diameter [mm] for the excitation: that of the article's FSR 400, the smallest."""
NEWTON_PER_GRAM = 9.80665e-3
ARTICLE_POINTS = ((TURN_ON_N, 4.3), (0.8, 4.0), (1.3, 3.85))
"""Force [N] and tactile voltage [V]: light contact at turn-on; then both figures of IV.A."""

POWER_UP_S = 2.0
"""Settling time of a controller's board after power-up [s]: eight time constants."""
MAX_FORCE_N = 20.0
"""Upper end of the sensor's force range (Interlink)."""
MAX_CURRENT_A_PER_CM2 = 1e-3
"""Maximum current through the sensor per active area (Interlink's integration guide)."""
SATURATION = 1.0 / 3.0
"""R_thevenin G at the largest force; smaller values make V more linear, and the signal smaller."""
GAIN_CONSTANT_OHM = 100e3
"""Constant of the amplifier's gain, A = 1 + 100 kohm / R_gain (AD623's data sheet)."""


def sensor_conductance_s(force_n: float) -> float:
    """Return the sensor's conductance [S] at a force [N] (Interlink); 0 below its turn-on."""
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
    sensor_top_ohm: float
    sensor_shunt_ohm: float
    reference_top_ohm: float
    reference_bottom_ohm: float
    gain_ohm: float

    def by_reference(self) -> dict[str, float]:
        return {
            "R10": self.sensor_top_ohm,
            "R11": self.sensor_shunt_ohm,
            "R12": self.reference_top_ohm,
            "R13": self.reference_bottom_ohm,
            "R14": self.gain_ohm,
        }

    @property
    def gain(self) -> float:
        return 1.0 + GAIN_CONSTANT_OHM / self.gain_ohm

    def sensor_v(self, conductance_s: float, supply_v: float) -> float:
        return supply_v / (
            1.0 + self.sensor_top_ohm * (1.0 / self.sensor_shunt_ohm + conductance_s)
        )

    def reference_v(self, supply_v: float) -> float:
        return (
            supply_v
            * self.reference_bottom_ohm
            / (self.reference_top_ohm + self.reference_bottom_ohm)
        )

    def tactile_v(self, conductance_s: float, supply_v: float) -> float:
        """Return the tactile voltage [V] at a conductance [S], with an ideal amplifier output."""
        return self.gain * (self.sensor_v(conductance_s, supply_v) - self.reference_v(supply_v))


def max_current_a(active_diameter_mm: float) -> float:
    """Return the maximum permitted current of a sensor [A], by its active area."""
    return MAX_CURRENT_A_PER_CM2 * math.pi * (active_diameter_mm / 20.0) ** 2


def size_bridge(supply_v: float, series: str, active_diameter_mm: float) -> Bridge:
    """Select the preferred values nearest to the article's voltages, within the current limit.

    The limit determines the sensor's arm: the largest excitation permitted at `MAX_FORCE_N`. Gain
    and reference are then searched for the smallest sum of squared errors at `ARTICLE_POINTS`: the
    gain resistors next to the ideal gain, and the references whose upper resistor lies between half
    and twice that of the sensor's arm.
    """
    max_g = sensor_conductance_s(MAX_FORCE_N)
    # The same curve applies to every sensor, so a larger sensor gains nothing from its higher
    # limit.
    limit_a = max_current_a(min(active_diameter_mm, CURVE_DIAMETER_MM))
    thevenin_ohm = SATURATION / max_g
    thevenin_v = limit_a / max_g * (1.0 + SATURATION)
    sensor_top_ohm = max(neighbouring_values(thevenin_ohm * supply_v / thevenin_v, series))
    sensor_shunt_ohm = min(
        neighbouring_values(thevenin_ohm * supply_v / (supply_v - thevenin_v), series)
    )
    arm = Bridge(
        sensor_top_ohm=sensor_top_ohm,
        sensor_shunt_ohm=sensor_shunt_ohm,
        reference_top_ohm=sensor_top_ohm,
        reference_bottom_ohm=sensor_shunt_ohm,
        gain_ohm=GAIN_CONSTANT_OHM,
    )
    points = [
        (arm.sensor_v(sensor_conductance_s(force_n), supply_v), tactile_v)
        for force_n, tactile_v in ARTICLE_POINTS
    ]

    # The least-squares line through the points, V = A x - A reference, gives the ideal gain and
    # reference.
    gain = statistics.linear_regression(*zip(*points, strict=True)).slope
    offset_v = sum(gain * x - v for x, v in points) / len(points)
    candidates = (
        replace(arm, reference_top_ohm=top_ohm, reference_bottom_ohm=bottom_ohm, gain_ohm=gain_ohm)
        for gain_ohm in neighbouring_values(GAIN_CONSTANT_OHM / (gain - 1.0), series)
        for top_ohm in values_around(sensor_top_ohm, series)
        for bottom_ohm in neighbouring_values(
            top_ohm * offset_v / (gain * supply_v - offset_v), series
        )
    )

    return min(
        candidates, key=lambda bridge: (article_error_v(bridge, supply_v), bridge.reference_top_ohm)
    )


def article_error_v(bridge: Bridge, supply_v: float) -> float:
    """Return the RMS error [V] of a bridge's tactile voltage against the article's."""
    errors_v = (
        bridge.tactile_v(sensor_conductance_s(force_n), supply_v) - tactile_v
        for force_n, tactile_v in ARTICLE_POINTS
    )
    return math.sqrt(sum(error_v * error_v for error_v in errors_v) / len(ARTICLE_POINTS))


# Transimpedance stage behind a protected cable.
#
# D6 takes a discharge into the cable, R28 and C26 what D6 leaves of it, and R29 limits the current
# into the amplifier's own clamps. A shorted sensor draws Vs / (R28 + R29 + R30). C27 makes the
# stage stable with the capacitance of a cable at its input, and ends its band above that of the
# vibrations. Two poles keep the supply's ripple off the bias.

SUPPRESSOR_F = 35e-12
"""Capacitance of D6 [F], that of its kind; not measured."""
STAGE_VALUES = {
    "R28": 100.0,
    "R29": 220.0,
    "R30": 15e3,
    "C26": 100e-12,
    "C27": 1e-9,
    # The bias: 143 mV of 3.3 V, above what any amplifier's output keeps from the lower rail.
    "R31": 220e3,
    "R32": 10e3,
    "C28": 10e-6,
    "R33": 10e3,
    "C29": 10e-6,
}
"""Value of each component [ohm, F] by reference; the same in all designs, as the sensor's curve."""


# Amplifiers of the board as its circuit names them, and data-sheet values of the bridge's AD623.
#
# The operational amplifiers and their figures are in `fingertip.catalogues.electronics`; no other
# module repeats these values.

BOLTZMANN_J_PER_K = 1.380649e-23
TEMPERATURE_K = 300.15
"""Temperature: 27 degrees Celsius, as in SPICE."""

AMPLIFIERS = {amplifier.symbol: amplifier for amplifier in AMPLIFIER_CATALOGUE.values()}
"""Amplifiers of the catalogue by the name of their symbol, by which circuits know them."""

AD623_NOISE_V = 35e-9
AD623_OUTPUT_NOISE_V = 50e-9
"""Noise density at the input, and at the output in addition to it, for a gain of 1 [V/sqrt(Hz)]."""
AD623_OFFSET_V = 200e-6
"""Typical input offset voltage [V]."""
AD623_BANDWIDTH_HZ = 800e3
"""Bandwidth for a gain of 1 [Hz]; it falls with the gain, to 10 kHz at 100 (data sheet)."""
AD623_SUPPLY_A = 375e-6
COMPARATOR_SUPPLY_A = 60e-6
"""Typical supply currents of AD623 and LMV331 [A] (recalled, unverified)."""

GAIN_RESISTOR = "R14"
"""Resistor between the gain pins of the bridge's amplifier."""


# Model of the rectifier's diodes. SPICE deck, simulation and bring-up read these figures.

SATURATION_A = 2.52e-9
EMISSION = 1.752
SERIES_OHM = 0.568
"""1N4148: saturation current [A], emission coefficient and series resistance [ohm] of a common
SPICE model. It drops 0.62 V at 1 mA; not measured.
"""
THERMAL_V = 0.025864951
"""Thermal voltage k T / q at SPICE's 27 degrees Celsius [V]."""
