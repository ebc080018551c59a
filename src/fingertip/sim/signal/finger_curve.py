"""Curve of a finger on its board: the force that a tactile voltage means, and the travel that a
force needs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.pad.response import Pad
from fingertip.sim.signal.bridge import Bridge, reads_whole_finger

MIN_PRESENT_N = 0.1
"""Smallest present force that the force ratio is applied to [N]: with a smaller one a finger would
hardly close.
"""
_TABLE_N = np.concatenate((np.linspace(0.0, 0.5, 41), np.geomspace(0.5, 20.0, 88)[1:])).round(9)
"""Forces of a curve [N], rounded, since processors differ in the last bit of a power.

Lines between them are within 0.5 % of the force above 0.3 N, where the sensor is on."""


@dataclass(frozen=True, eq=False)
class FingerCurve:
    """Knowledge of a hand about a finger."""

    volts: Array
    """Ascending tactile voltages [V]."""
    forces_n: Array
    pad: Pad

    @classmethod
    def from_design(cls, design: Design) -> FingerCurve:
        """Take both from a design. The hand knows what part of a grip's force its sensors feel."""
        pad = Pad.from_design(design)
        sensed_n = pad.sensed_n(_TABLE_N, None, reads_whole_finger(design, "board"))
        volts = Bridge.of_board(design).voltage_v(sensed_n)
        order = np.argsort(volts)

        return cls(volts[order], _TABLE_N[order], pad)

    def force_n(self, voltage_v: float) -> float:
        return float(np.interp(voltage_v, self.volts, self.forces_n))

    def further_m(self, force_n: float, ratio: float, max_force_n: float) -> float:
        """Closing that increases a force by a ratio, but not beyond a limit [m]. It never opens."""
        present_n = max(force_n, MIN_PRESENT_N)
        target_n = min(present_n * ratio, max_force_n)
        return max(self.pad.depth_m(target_n) - self.pad.depth_m(present_n), 0.0)
