"""Amplifiers of the board as its circuit names them, and data-sheet values of the bridge's AD623.

The operational amplifiers and their figures are in `fingertip.amplifiers`; no other module repeats these values.
"""

from __future__ import annotations

from fingertip.amplifiers import CATALOGUE

BOLTZMANN_J_PER_K = 1.380649e-23
TEMPERATURE_K = 300.15
"""Temperature: 27 degrees Celsius, as in SPICE."""

AMPLIFIERS = {amplifier.symbol: amplifier for amplifier in CATALOGUE.values()}
"""Amplifiers of the catalogue by the name of their symbol, by which circuits know them."""

AD623_NOISE_V = 35e-9
"""Noise density at the input [V/sqrt(Hz)]."""
AD623_OUTPUT_NOISE_V = 50e-9
"""Noise density at the output in addition to the input's, for a gain of 1 [V/sqrt(Hz)]."""
AD623_OFFSET_V = 200e-6
"""Typical input offset voltage [V]."""
AD623_BANDWIDTH_HZ = 800e3
"""Bandwidth for a gain of 1 [Hz]. It falls with the gain; the data sheet has 10 kHz for 100, slightly above that."""
AD623_SUPPLY_A, COMPARATOR_SUPPLY_A = 375e-6, 60e-6
"""Typical supply currents of AD623 and LMV331 [A] (recalled, unverified)."""

GAIN_RESISTOR = "R14"
"""Resistor between the gain pins of the bridge's amplifier."""

LOW_NOISE_NAME, LOW_NOISE_V = "INA821", 7e-9
"""Instrumentation amplifier with a lower noise density [V/sqrt(Hz)], for comparison.

It has another footprint and pinout, and another gain equation, so that it requires another R14.
"""
