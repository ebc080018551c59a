"""Front end of the boards on 3.3 V: a transimpedance stage behind a protected cable.

The sensor lies between ground and the inverting input of U2a, which holds it at the bias voltage. Its current flows
through the feedback resistor R30 and lifts the tactile voltage,

    T = V_bias [1 + R30 G / (1 + (R28 + R29) G)],  V_bias = Vs R32 / (R31 + R32)

for a sensor of the conductance G. T rises with the force, from V_bias with an open sensor. All of it scales with the
supply Vs: a converter that takes its reference from the same supply measures the sensor alone.

The article's bridge with its AD623 has ten to twenty times the noise: it amplifies the 35 nV/sqrt(Hz) of the AD623 by
its gain, where this stage amplifies those of U2a by little more than 1, because the sensor's resistance is large.

D6 takes a discharge into the cable, R28 and C26 what D6 leaves of it, and R29 limits the current into the amplifier's
own clamps. A shorted sensor draws Vs / (R28 + R29 + R30). C27 makes the stage stable with the capacitance of a cable
at its input, and ends its band above that of the vibrations. Two poles keep the supply's ripple off the bias.
"""

from __future__ import annotations

SUPPRESSOR_F = 35e-12
"""Capacitance of D6 [F], that of its kind; not measured."""
VALUES = {
    "R28": 100.0, "R29": 220.0, "R30": 15e3, "C26": 100e-12, "C27": 1e-9,
    # The bias: 143 mV of 3.3 V, above what any amplifier's output keeps from the lower rail.
    "R31": 220e3, "R32": 10e3, "C28": 10e-6, "R33": 10e3, "C29": 10e-6,
}  # fmt: skip
"""Value of each component [ohm, F] by its reference. They do not depend on the design: the sensor's curve is one."""
