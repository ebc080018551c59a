"""What the robot does: the article's sliding-finger trial (section III.C, figures 8 and 9) as motion over
time.

Approach and contact, one second's wait, 4 cm of sliding with a trapezoidal velocity profile, one second's
wait, lift by 5 cm in 2 s. Only sums, products and square roots are used, so that every processor gives the
same bits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SLIDE_M = 0.04
LIFT_M = 0.05
LIFT_S = 2.0
WAIT_S = 1.0
ACCELERATION_M_S2 = 1.0
"""Of every ramp. Assumption: the article only says that 4 cm at 4 cm/s took about one second; this gives
1.04 s."""
APPROACH_M = 0.01
"""Free way before the touch. Assumption: half of the article's 2 cm, the rest of which presses the finger
on."""
AFTER_S = 0.2
"""Recorded after the lift. Assumption."""


@dataclass(frozen=True)
class Ramp:
    """A move from rest to rest: acceleration, cruise, deceleration (a triangle if the way is too short to
    cruise)."""

    start_s: float
    distance_m: float
    acceleration_m_s2: float
    peak_m_s: float

    @classmethod
    def at(cls, start_s: float, distance_m: float, speed_m_s: float) -> Ramp:
        """Cruise at `speed_m_s` where the way allows."""
        a = ACCELERATION_M_S2
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


@dataclass(frozen=True)
class Scene:
    """One sliding-finger trial as the robot moves."""

    approach: Ramp
    slide: Ramp
    lift: Ramp
    duration_s: float

    def depth_m(self, time_s: Array) -> Array:
        """How far the hand is pressed beyond the first touch [m]; negative while the finger is clear."""
        return self.approach.position_m(time_s) - APPROACH_M - self.lift.position_m(time_s)


def sliding_finger(speed_m_s: float, depth_m: float) -> Scene:
    """Plan a trial.

    Parameters
    ----------
    speed_m_s
        Peak sliding velocity [m/s]; the article's are 0.04, 0.06 and 0.08.
    depth_m
        How far the hand is pressed on beyond the first touch [m].
    """
    # Down as fast as up (assumption; the article gives the lift's time only).
    approach = Ramp.at(0.0, APPROACH_M + depth_m, Ramp.within(0.0, LIFT_M, LIFT_S).peak_m_s)
    slide = Ramp.at(approach.end_s + WAIT_S, SLIDE_M, speed_m_s)
    lift = Ramp.within(slide.end_s + WAIT_S, LIFT_M, LIFT_S)
    return Scene(approach, slide, lift, lift.end_s + AFTER_S)
