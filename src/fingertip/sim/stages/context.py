"""Context of one run of a scene: the inputs that every stage may read, and nothing that a stage computes."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.sim.contact.pad import DAMPING_RATIO, Pad
from fingertip.sim.contact.surfaces import SURFACES, Surface
from fingertip.sim.contact.tangential import Mount
from fingertip.sim.scene.scene_file import SceneFile
from fingertip.sim.scene.timeline import Timeline, build_timeline

MAX_STEP_S = 1.25e-4
"""Maximum step of the grid on which contacts are integrated [s]. Velocities are then within 1e-5 m/s of the limit for
vanishing steps, and the position of a grasped object within 5 um. Tests check both."""


@dataclass(frozen=True)
class SceneContext:
    """Design, scene and seed of one run, and everything that follows from them before a stage runs."""

    design: Design
    scene: SceneFile
    seed: int

    def random_stream(self, purpose: str) -> random.Random:
        """Random numbers for one purpose, so that setting the force changes neither the surface nor the noise."""
        return random.Random(f"{self.seed}:{purpose}")

    @cached_property
    def force_n(self) -> float:
        """Holding force on this finger, drawn by the seed [N]."""
        hold = self.scene.hold
        force = hold.min_force_n + (hold.max_force_n - hold.min_force_n) * self.random_stream("force").random()
        return force * hold.share if hold.mode == "grasp" else force

    @cached_property
    def pad(self) -> Pad:
        """Pad of the finger."""
        return Pad.from_design(self.design, self.scene.contact.resonance_hz)

    @cached_property
    def surface(self) -> Surface:
        """Surface that the pad touches."""
        return SURFACES[self.scene.contact.surface]

    @cached_property
    def timeline(self) -> Timeline:
        """Moments of the scene's events."""
        return build_timeline(self.scene, self.pad, self.force_n)

    @property
    def substeps(self) -> int:
        """Number of grid steps per sample."""
        return math.ceil(1 / (self.design.detector.sample_rate_hz * MAX_STEP_S) - 1e-9)

    @property
    def step_s(self) -> float:
        """Step of the grid [s]."""
        return 1 / (self.design.detector.sample_rate_hz * self.substeps)

    @cached_property
    def time_s(self) -> Array:
        """Times of the grid points [s]."""
        count = math.ceil(self.timeline.duration_s * self.design.detector.sample_rate_hz) * self.substeps + 1
        return np.arange(count, dtype=np.float64) * self.step_s

    @property
    def samples(self) -> slice:
        """Slice that selects the samples among the grid points."""
        return slice(None, None, self.substeps)

    @cached_property
    def mount(self) -> Mount:
        """Tangential mount of the pad."""
        k = self.pad.tangential_stiffness_n_per_m(self.force_n)
        return Mount(self.pad.mass_kg, k, 2 * DAMPING_RATIO * math.sqrt(k * self.pad.mass_kg))
