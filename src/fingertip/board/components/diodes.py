"""Model of the rectifier's diodes. SPICE deck, simulation and bring-up read these figures."""

from __future__ import annotations

SATURATION_A, EMISSION, SERIES_OHM = 2.52e-9, 1.752, 0.568
"""1N4148: saturation current [A], emission coefficient and series resistance [ohm] of a common SPICE model. It drops
0.62 V at 1 mA; not measured."""
THERMAL_V = 0.025864951
"""Thermal voltage k T / q at SPICE's 27 degrees Celsius [V]."""
