"""Force on a finger, from the sensor's curve, with its interval.

No verdict on slip depends on it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingertip.catalogues.electronics import HYSTERESIS, PART_TO_PART
from fingertip.design import Design
from fingertip.foundation.numerics import Array

MEAN_S = 0.02
"""Time over which a voltage is averaged for a force [s]."""


@dataclass(frozen=True)
class Force:
    """Force on the finger at one moment, with the interval that holds it."""

    force_n: float
    low_n: float
    high_n: float

    def describe(self) -> str:
        """Describe it for people, such as ``2.1 N (0.9 to 4.8)``."""
        if self.high_n == math.inf:
            return f"{self.low_n:.2g} N or more"

        return f"{self.force_n:.2g} N ({self.low_n:.2g} to {self.high_n:.2g})"

    def as_data(self) -> dict[str, Any]:
        """Force and the ends of its interval for JSON, which knows no infinity."""
        high_n = round(self.high_n, 4) if self.high_n < math.inf else None
        return {
            "force_n": round(self.force_n, 4),
            "force_interval_n": [round(self.low_n, 4), high_n],
        }


@dataclass(frozen=True, eq=False)
class ForceScale:
    """Force at each tactile voltage, by the zero of the board and the sensor's stored curve.

    No rest is taken from a recording, so that a hand may start while something touches it.
    """

    volts: Array
    """Ascending tactile voltages [V]."""
    forces_n: Array
    factor: float
    """Factor within which a force lies."""
    known_n: tuple[float, float]
    """Forces between which the curve is known [N]."""

    @classmethod
    def of(cls, design: Design, volts: Array, forces_n: Array) -> ForceScale:
        """Make the scale of a design's sensor; that of a typical sensor has the wider interval."""
        curve = design.force_curve
        if curve.curve == "calibrated":
            return cls(
                volts, forces_n, curve.interval_factor, (curve.min_force_n, curve.max_force_n)
            )

        return cls(volts, forces_n, PART_TO_PART[1], (curve.turn_on_n, float(forces_n.max())))

    def read(self, voltage_v: float) -> Force:
        """Read a force off the curve.

        Outside of what is known, one end of its interval is 0 or infinite.
        """
        low, middle, high = (float(part[0]) for part in self.read_all(np.array([voltage_v])))
        return Force(middle, low, high)

    def read_all(self, voltage_v: Array) -> tuple[Array, Array, Array]:
        """Lower ends, forces and upper ends of the intervals at voltages [N].

        The lower end counts the hysteresis.
        """
        force_n = np.interp(voltage_v, self.volts, self.forces_n)
        min_n, max_n = self.known_n
        low_n = np.where(
            force_n > min_n, np.minimum(force_n, max_n) / (self.factor * (1 + HYSTERESIS)), 0.0
        )
        high_n = np.where(force_n < max_n, np.maximum(force_n, min_n) * self.factor, np.inf)

        return low_n, force_n, high_n
