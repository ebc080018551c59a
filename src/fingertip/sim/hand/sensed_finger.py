"""One finger of a hand in the loop, from its load to the sampled voltage, chunk by chunk.

The same stages as a scene's (`sim.pipeline`), which runs them over all of its time at once: a chunk begins with the
state in which the one before it ended, so that any chunks give the same bits.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.sim.contact import vibration
from fingertip.sim.contact.pad import DAMPING_RATIO, Pad
from fingertip.sim.contact.surfaces import Surface
from fingertip.sim.electronics import fsr
from fingertip.sim.electronics.sensing import on_sensor_n, voltage_of

Array = NDArray[np.float64]

BEFORE_M = 2e-3
"""Profile ahead of the place at which the finger touches first: objects are also pushed back a little."""


@dataclass
class Shaken:
    """The pad's normal vibration: the surface's profile and whatever else shakes it, through its resonance."""

    pad: Pad
    held_n: float
    """Force for which its resonance is taken."""
    step_s: float
    surface: Surface
    length_m: float
    rng: random.Random
    _profile: Array = field(init=False)
    _hand: Array = field(init=False)
    _swing: Array = field(init=False)

    def __post_init__(self) -> None:
        s = self.surface
        self._profile = vibration.profile(self.rng, s.roughness_um, s.cutoff_wavelength_m, BEFORE_M + self.length_m)
        self._hand = vibration.height_m(self._profile, np.array([BEFORE_M]))
        self._swing = np.zeros(3)

    def contact_n(self, load_n: Array, way_m: Array, push_n: Array) -> Array:
        """Contact force [N] on the grid, from the quasi-static load, the way over the surface, and other pushes."""
        height = vibration.height_m(self._profile, BEFORE_M + way_m)
        felt = vibration.left_by_hand(height, self.step_s, self.pad.hand_hz, self._hand)
        touching = load_n > 0.0
        drive = load_n + self.pad.normal_stiffness_n_per_m(1.0) * np.cbrt(load_n) * felt
        drive += np.where(touching, push_n, 0.0)
        frequency = self.pad.resonance_hz(self.held_n)
        return vibration.resonate(drive, touching, self.step_s, frequency, DAMPING_RATIO, self._swing)


@dataclass
class Sensed:
    """Sensor, bridge and converter of one finger."""

    design: Design
    bridge: str
    rng: random.Random
    _play: Array = field(init=False)
    _voltage_of: Callable[[float], float] = field(init=False)

    def __post_init__(self) -> None:
        self._play = np.zeros(1)
        self._voltage_of = voltage_of(self.design, self.bridge)

    def tactile_v(self, contact_n: Array, shear_m: Array) -> Array:
        """Voltage ahead of converter and filter board [V] at the samples."""
        shown = fsr.with_hysteresis(on_sensor_n(contact_n, shear_m), self._play)
        noise = self.design.detector.noise_v
        return np.array([self._voltage_of(f) + self.rng.gauss(0.0, noise) for f in shown.tolist()])

    def sampled_v(self, tactile_v: Array) -> Array:
        """What the converter gives [V]."""
        d = self.design.detector
        return fsr.quantise(tactile_v, d.adc_bits, d.adc_range_v)
