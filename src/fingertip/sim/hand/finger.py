"""One finger of a hand in the loop, from its load to the sampled voltages, chunk by chunk.

The same stages as a scene's (`sim.pipeline`), which runs them over all of its time at once: a chunk begins with the
state in which the one before it ended, so that any chunks give the same bits.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.sim.contact import vibration
from fingertip.sim.contact.pad import DAMPING_RATIO, Pad
from fingertip.sim.contact.surfaces import Surface
from fingertip.sim.electronics import fsr
from fingertip.sim.electronics.anti_alias import Poles
from fingertip.sim.electronics.board_noise import input_noise_v
from fingertip.sim.electronics.converter import noise_v, sampled_v
from fingertip.sim.electronics.sensing import on_sensor_n, voltage_of
from fingertip.sim.scenes.scene_sections import Sensing

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
    """Sensor, bridge and converters of one finger."""

    design: Design
    sensing: Sensing
    stream: Callable[[str], random.Random]
    """Random numbers of this finger for one purpose."""
    _play: Array = field(init=False)
    _voltage_of: Callable[[float], float] = field(init=False)
    _noise: dict[str, random.Random] = field(init=False)
    _poles: tuple[Poles, Poles] = field(init=False)

    def __post_init__(self) -> None:
        self._play = np.zeros(1)
        self._voltage_of = voltage_of(self.design, self.sensing.bridge)
        self._noise = {}
        self._poles = Poles.tactile(self.design), Poles.envelope(self.design)
        if self.sensing.noise:
            self._noise = {what: self.stream(what) for what in ("noise", "board noise", "envelope noise")}

    def bridge_v(self, contact_n: Array, shear_m: Array) -> Array:
        """Voltage of bridge and amplifier at the samples, without noise [V]."""
        shown = fsr.with_hysteresis(on_sensor_n(contact_n, shear_m), self._play)
        return np.array([*map(self._voltage_of, shown.tolist())])

    def tactile_v(self, bridge_v: Array) -> Array:
        """Voltage ahead of the filter board, with the noise of the board's amplifiers [V]."""
        rng = self._noise.get("board noise")
        return bridge_v if rng is None else bridge_v + noise_v(rng, input_noise_v(self.design), len(bridge_v))

    def sampled_v(self, bridge_v: Array) -> Array:
        """What the converter gives of the tactile voltage [V]."""
        return sampled_v(self.design, self._poles[0].process(bridge_v), self._noise.get("noise"))

    def sampled_envelope_v(self, envelope_v: Array) -> Array:
        """What the converter gives of the board's output [V]."""
        return sampled_v(self.design, self._poles[1].process(envelope_v), self._noise.get("envelope noise"))
