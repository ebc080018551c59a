"""One finger of a hand, from its load to the sampled voltages, computed chunk by chunk.

The computations are those of a scene (`fingertip.sim.stages`), which runs each of them over its whole duration at once.
Here a chunk starts with the state in which the previous one ended, so that the cuts between chunks change no bit.
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
from fingertip.sim.signal.converter import AntiAliasFilter, draw_noise_v, sample_v
from fingertip.sim.signal.board_noise import compute_input_noise_v
from fingertip.sim.signal.board_output import sample_envelope_v
from fingertip.sim.signal.fsr import apply_hysteresis, compute_sensor_force_n, select_voltage_function
from fingertip.sim.scene.scene_file import Sensing

PROFILE_MARGIN_M = 2e-3
"""Length of the surface profile before the point of first touch [m], because objects are also pushed back a little."""


@dataclass
class VibratingPad:
    """Normal vibration of the pad: surface profile and other forces through the resonance of the contact."""

    pad: Pad
    held_n: float
    """Holding force for which the resonance is computed [N]."""
    step_s: float
    """Step of the grid [s]."""
    surface: Surface
    length_m: float
    """Distance that the object can slide [m]."""
    rng: random.Random
    """Source of the surface profile."""
    _profile: Array = field(init=False)
    _hand_state: Array = field(init=False)
    _resonance_state: Array = field(init=False)

    def __post_init__(self) -> None:
        surface, length = self.surface, PROFILE_MARGIN_M + self.length_m
        self._profile = vibration.generate_profile(self.rng, surface.roughness_um, surface.cutoff_wavelength_m, length)
        self._hand_state = vibration.interpolate_height_m(self._profile, np.array([PROFILE_MARGIN_M]))
        self._resonance_state = np.zeros(3)

    def contact_n(self, load_n: Array, path_m: Array, push_n: Array) -> Array:
        """Contact force on the grid [N].

        Parameters
        ----------
        load_n
            Quasi-static load [N].
        path_m
            Position of the pad along the surface [m].
        push_n
            Other forces that drive the vibration [N].
        """
        height = vibration.interpolate_height_m(self._profile, PROFILE_MARGIN_M + path_m)
        deflection = vibration.compute_pad_deflection_m(height, self.step_s, self.pad.hand_hz, self._hand_state)
        touching = load_n > 0.0
        drive = load_n + self.pad.normal_stiffness_n_per_m(1.0) * np.cbrt(load_n) * deflection
        drive += np.where(touching, push_n, 0.0)
        frequency = self.pad.resonance_hz(self.held_n)
        return vibration.apply_resonance(drive, touching, self.step_s, frequency, DAMPING_RATIO, self._resonance_state)


@dataclass
class FingerSensor:
    """Sensor, bridge and ADC channels of one finger."""

    design: Design
    sensing: Sensing
    """Parameters of the conversion."""
    random_stream: Callable[[str], random.Random]
    """Function from a purpose to random numbers of this finger."""
    _hysteresis_state: Array = field(init=False)
    _voltage_function: Callable[[float], float] = field(init=False)
    _noise: dict[str, random.Random] = field(init=False)
    _tactile_filter: AntiAliasFilter = field(init=False)
    _envelope_filter: AntiAliasFilter = field(init=False)

    def __post_init__(self) -> None:
        self._hysteresis_state = np.zeros(1)
        self._voltage_function = select_voltage_function(self.design, self.sensing.bridge)
        self._noise = {}
        self._tactile_filter = AntiAliasFilter.for_tactile(self.design)
        self._envelope_filter = AntiAliasFilter.for_envelope(self.design)
        if self.sensing.noise:
            purposes = ("noise", "board noise", "envelope noise")
            self._noise = {purpose: self.random_stream(purpose) for purpose in purposes}

    def bridge_v(self, contact_n: Array, shear_m: Array) -> Array:
        """Voltage of bridge and amplifier at the samples, without noise [V]."""
        sensor_n = apply_hysteresis(compute_sensor_force_n(contact_n, shear_m), self._hysteresis_state)
        return np.array([*map(self._voltage_function, sensor_n.tolist())])

    def tactile_v(self, bridge_v: Array) -> Array:
        """Voltage ahead of the filter board, with the noise of the board's amplifiers [V]."""
        rng = self._noise.get("board noise")
        return (
            bridge_v if rng is None else bridge_v + draw_noise_v(rng, compute_input_noise_v(self.design), len(bridge_v))
        )

    def sampled_v(self, bridge_v: Array) -> Array:
        """Tactile voltage as sampled by the ADC [V]."""
        return sample_v(self.design, self._tactile_filter.process(bridge_v), self._noise.get("noise"))

    def sampled_envelope_v(self, envelope_v: Array) -> Array:
        """Envelope output of the board as sampled by the ADC [V]."""
        return sample_envelope_v(self.design, envelope_v, self._noise.get("envelope noise"), self._envelope_filter)
