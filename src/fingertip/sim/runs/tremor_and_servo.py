"""Force changes of the hand that holds: tremor, voluntary changes, and the steps of a servo.

None of them is slip.

Physiological tremor lies between 8 and 12 Hz (J. H. McAuley, C. D. Marsden, Brain 123(8), 2000),
and force under voluntary control varies below 4 Hz, with a standard deviation in proportion to the
force (K. E. Jones, A. F. Hamilton, D. M. Wolpert, J. Neurophysiol. 88(3), 2002). The levels for a
stump or a prosthetic hand are assumptions.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import numpy as np

from fingertip.design.parameters import ParameterTable, quantity
from fingertip.foundation.numerics import Array
from fingertip.sim.contact.surfaces import SurfaceProfile, sum_waves
from fingertip.sim.contact.vibration import smoothstep
from fingertip.sim.signal.parameters import assumption

_SINES = 8
"""Number of sines that make up a band of frequencies."""
_PEAK = math.sqrt(2 * _SINES)
"""Largest value of such a sum of RMS value 1."""
_SPACING_S = 2e-3
"""Distance of the points between which tremor is a cubic: it errs by 1e-6 of its amplitude at 12
Hz.
"""
_TREMOR_WIDTH = 0.2
_VOLUNTARY_WIDTH = 0.6
"""Half widths of the bands around the stated frequencies."""


class Tremor(ParameterTable):
    """Unsteady force of a living hand, relative to the force it holds; 0 means none."""

    share: float = quantity(
        0.0, "", (0, 0.1), "RMS physiological tremor; 0.01 to 0.03 in able hands. (unverified)"
    )
    frequency_hz: float = quantity(
        10.0, "Hz", (3, 14), "Middle of its band of 20 % to either side: 8 to 12 Hz."
    )
    voluntary_share: float = quantity(
        0.0, "", (0, 0.2), "RMS voluntary change; 0.02 to 0.1. (unverified)"
    )
    voluntary_hz: float = assumption(
        1.2, "Hz", (0.3, 4), "Middle of its band of 60 % to either side."
    )


class Servo(ParameterTable):
    """Steps of a servo that hunts between two positions while it holds; 0 N means none."""

    step_n: float = quantity(0.0, "N", (0, 1), "Height of a step of this finger's force.")
    rise_s: float = assumption(0.01, "s", (0.003, 0.1), "Duration of a step: 3 to 30 ms.")
    interval_s: float = assumption(
        0.3, "s", (0.05, 10), "Time from one step to the next, up and down in turn."
    )
    at_s: float = assumption(
        0.5, "s", (0, 600), "Time of the first step, after the holding force is reached."
    )


@dataclass(frozen=True, eq=False)
class HandMotion:
    """Factor by which the force of a hand differs from the planned one, over time."""

    unsteady: SurfaceProfile
    servo: Servo
    step: float
    """Height of a servo's step, relative to the holding force."""
    held_s: float

    @classmethod
    def draw(
        cls,
        tremor: Tremor,
        servo: Servo,
        rng: random.Random,
        force_n: float,
        held_s: float,
        duration_s: float,
    ) -> HandMotion | None:
        """Draw the frequencies and phases of a tremor; None if the hand is steady."""
        if not (tremor.share or tremor.voluntary_share or servo.step_n):
            return None

        waves = [
            (
                share * math.sqrt(2 / _SINES),
                2 * math.pi * middle_hz * (1 + width * (2 * rng.random() - 1)),
                phase,
            )
            for share, middle_hz, width in (
                (tremor.share, tremor.frequency_hz, _TREMOR_WIDTH),
                (tremor.voluntary_share, tremor.voluntary_hz, _VOLUNTARY_WIDTH),
            )
            for phase in (2 * math.pi * rng.random() for _ in range(_SINES))
        ]
        points = sum_waves(waves, _SPACING_S, math.ceil(duration_s / _SPACING_S) + 2)
        return cls(SurfaceProfile(0.0, *points, _SPACING_S), servo, servo.step_n / force_n, held_s)

    def factor(self, time_s: Array) -> Array:
        factor = 1.0 + self.unsteady.height_m(time_s)
        if self.step:
            since = np.maximum(time_s - self.held_s - self.servo.at_s, 0.0)
            number = np.floor(since / self.servo.interval_s)
            risen = smoothstep((since - number * self.servo.interval_s) / self.servo.rise_s)
            factor += self.step * np.where(number % 2 == 0, risen, 1 - risen)

        return np.maximum(factor, 0.0)


def largest_factor(tremor: Tremor, servo: Servo, force_n: float) -> float:
    """Largest factor that can occur."""
    return 1 + _PEAK * (tremor.share + tremor.voluntary_share) + servo.step_n / force_n
