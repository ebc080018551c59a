"""One run of a scene: what every stage may read, and nothing that one of them makes."""

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
from fingertip.sim.scenes.scene_file import SceneFile
from fingertip.sim.scenes.timeline import Timeline, plan

LONGEST_STEP_S = 1.25e-4
"""Of the grid on which contacts are integrated: velocities are then within 1e-5 m/s of the limit, and the way of a
grasped object within 5 um (tests hold both)."""


@dataclass(frozen=True)
class Context:
    """One run of a scene: what every stage may read."""

    design: Design
    scene: SceneFile
    seed: int

    def stream(self, what: str) -> random.Random:
        """Random numbers for one purpose: setting the force changes neither the surface nor the noise."""
        return random.Random(f"{self.seed}:{what}")

    @cached_property
    def force_n(self) -> float:
        """Holding force on this finger [N], drawn by the seed."""
        hold = self.scene.hold
        force = hold.min_force_n + (hold.max_force_n - hold.min_force_n) * self.stream("force").random()
        return force * hold.share if hold.mode == "grasp" else force

    @cached_property
    def pad(self) -> Pad:
        """The pad."""
        return Pad.of(self.design, self.scene.contact.resonance_hz)

    @cached_property
    def surface(self) -> Surface:
        """The surface."""
        return SURFACES[self.scene.contact.surface]

    @cached_property
    def timeline(self) -> Timeline:
        """When what happens."""
        return plan(self.scene, self.pad, self.force_n)

    @property
    def substeps(self) -> int:
        """Steps of the grid for each sample."""
        return math.ceil(1 / (self.design.detector.sample_rate_hz * LONGEST_STEP_S) - 1e-9)

    @property
    def step_s(self) -> float:
        """Step of the grid [s]."""
        return 1 / (self.design.detector.sample_rate_hz * self.substeps)

    @cached_property
    def time_s(self) -> Array:
        """The grid [s]."""
        count = math.ceil(self.timeline.duration_s * self.design.detector.sample_rate_hz) * self.substeps + 1
        return np.arange(count, dtype=np.float64) * self.step_s

    @property
    def every(self) -> slice:
        """The samples among the grid's points."""
        return slice(None, None, self.substeps)

    @cached_property
    def mount(self) -> Mount:
        """The pad along the surface."""
        k = self.pad.tangential_stiffness_n_per_m(self.force_n)
        return Mount(self.pad.mass_kg, k, 2 * DAMPING_RATIO * math.sqrt(k * self.pad.mass_kg))
