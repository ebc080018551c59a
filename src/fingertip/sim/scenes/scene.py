"""What the robot does: moves with a trapezoidal velocity profile, and the article's figures for them (section III.C,
figures 8 and 9). `fingertip.sim.scenes.timeline` puts them together.

Only sums, products and square roots are used, so that every processor gives the
same bits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array

SLIDE_M = 0.04
LIFT_M = 0.05
LIFT_S = 2.0
ACCELERATION_M_S2 = 1.0
"""Of every ramp. Assumption: the article only says that 4 cm at 4 cm/s took about one second; this gives
1.04 s."""
APPROACH_M = 0.01
"""Free way before the touch. Assumption: half of the article's 2 cm, the rest of which presses the finger
on."""


@dataclass(frozen=True)
class Ramp:
    """A move from rest to rest: acceleration, cruise, deceleration (a triangle if the way is too short to
    cruise)."""

    start_s: float
    distance_m: float
    acceleration_m_s2: float
    peak_m_s: float

    @classmethod
    def at(cls, start_s: float, distance_m: float, speed_m_s: float, acceleration_m_s2: float | None = None) -> Ramp:
        """Cruise at `speed_m_s` where the way allows."""
        a = ACCELERATION_M_S2 if acceleration_m_s2 is None else acceleration_m_s2
        return cls(start_s, distance_m, a, min(speed_m_s, math.sqrt(a * distance_m)))

    @classmethod
    def within(cls, start_s: float, distance_m: float, duration_s: float) -> Ramp:
        """Be there after `duration_s` [s], which must be at least ``2 sqrt(distance / acceleration)``."""
        a, T = ACCELERATION_M_S2, duration_s
        return cls(start_s, distance_m, a, (a * T - math.sqrt(a * a * T * T - 4 * a * distance_m)) / 2)

    @property
    def _ramp_s(self) -> float:
        return self.peak_m_s / self.acceleration_m_s2

    @property
    def _cruise_s(self) -> float:
        return max(0.0, self.distance_m / self.peak_m_s - self._ramp_s)

    @property
    def end_s(self) -> float:
        """When it rests again [s]."""
        return self.start_s + 2 * self._ramp_s + self._cruise_s

    def velocity_m_s(self, time_s: Array) -> Array:
        """Velocity [m/s]."""
        a = self.acceleration_m_s2
        rising, falling = a * (time_s - self.start_s), a * (self.end_s - time_s)
        return np.clip(np.minimum(rising, falling), 0.0, self.peak_m_s)

    def position_m(self, time_s: Array) -> Array:
        """Way since the start [m]."""
        a, v, ramp, cruise = self.acceleration_m_s2, self.peak_m_s, self._ramp_s, self._cruise_s
        t = time_s - self.start_s
        up = np.clip(t, 0.0, ramp)
        even = np.clip(t - ramp, 0.0, cruise)
        down = np.clip(t - ramp - cruise, 0.0, ramp)
        return a * up * up / 2 + v * even + (v * down - a * down * down / 2)
