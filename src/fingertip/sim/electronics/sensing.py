"""From the force on the pad to the voltage ahead of the converter: what reaches the sensor, and what its bridge makes
of it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fingertip.arrays import Array
from fingertip.board import board_values
from fingertip.design import Design
from fingertip.sim.electronics import fsr

LOAD_SHIFT_PER_M = (1 - 0.035 / 0.32) / 6e-3
"""Share of the force the sensor loses per metre by which the pad is sheared towards the base [1/m].

From a linear finite-element trial of such a finger: a pad load moved by 6 mm towards the base left 0.035 of
it on the active area instead of 0.32. That the article's slide shears the pad towards the base is an
assumption.
"""


def on_sensor_n(contact_n: Array, shear_m: Array) -> Array:
    """Force that counts for the sensor [N], from the contact's and the way by which the pad is sheared [m]."""
    return contact_n * np.clip(1 - LOAD_SHIFT_PER_M * shear_m, 0.0, None)


def voltage_of(design: Design, bridge: str) -> Callable[[float], float]:
    """Voltage [V] over the force the sensor shows [N]: of the design's bridge, or through the article's points.

    Parameters
    ----------
    design
        Its board.
    bridge
        "board" or "article".
    """
    if bridge == "article":
        return fsr.fit().voltage_v
    values, supply = board_values(design).bridge, design.board.supply_v
    conductance = fsr.fit_conductance()
    return lambda force_n: values.tactile_v(conductance.siemens(force_n), supply)
