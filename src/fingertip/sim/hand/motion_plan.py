"""A manipulation as planned: what the seed draws, and when everything happens."""

from __future__ import annotations

import random
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.contact.friction import Friction
from fingertip.sim.contact.pad import Pad
from fingertip.sim.contact.surfaces import SURFACES
from fingertip.sim.hand.manipulation_file import ManipulationFile
from fingertip.sim.scenes.scene import ACCELERATION_M_S2, Ramp
from fingertip.sim.scenes.timeline import OPEN_S, rise

GRAVITY_M_S2 = 9.80665
CLEARANCE_M = 2e-3
"""The pin has its velocity this far ahead of the object. Assumption."""
REACH_SPREAD_M = 2e-3
"""The seed draws where each finger touches within this of grasp.reach_m. Assumption."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Moments [s], forces [N] and the pin's motion of one manipulation."""

    scene: ManipulationFile
    friction: Friction
    """As drawn; what the hand reckons with is the surface's own."""
    force_n: Array
    """Of each finger, before anything happens."""
    reach_m: Array
    """Closing at which each finger touches."""
    goal_m: Array
    """Closing at which each finger presses with its force."""
    closed_s: float
    let_go_s: float
    """Nobody but the hand holds the object from here on."""
    knock_s: float
    """The pin touches; after the end, where it does not."""
    pin: Ramp | None
    duration_s: float

    def planned_m(self, time_s: Array) -> Array:
        """Closing of each finger [m] without control, (fingers, times)."""
        share: Array = rise((time_s - OPEN_S) / (self.closed_s - OPEN_S))
        return self.goal_m[:, None] * share

    def weight_n(self, time_s: Array) -> Array:
        """Weight that the hand carries [N]."""
        scene = self.scene
        begins = self.let_go_s - scene.grasp.let_go_s
        return scene.object.mass_kg * GRAVITY_M_S2 * rise((time_s - begins) / scene.grasp.let_go_s)

    def pin_m(self, time_s: Array) -> tuple[Array, Array]:
        """Position [m], from where it touches the object at rest, and velocity [m/s] of the pin."""
        if not self.pin:
            return np.full_like(time_s, -CLEARANCE_M), np.zeros_like(time_s)
        run_up = self.pin.distance_m - self.scene.knock.stroke_m
        return self.pin.position_m(time_s) - run_up, self.pin.velocity_m_s(time_s)


def thumb_n(scene: ManipulationFile, margin: float) -> float:
    """Force of the thumb [N] for a margin over what just holds the weight: thumb and fingers press alike, both rub."""
    grasp, mu = scene.grasp, SURFACES[scene.object.surface].friction.mu_s
    return grasp.force_n or max(grasp.min_force_n, margin * scene.object.mass_kg * GRAVITY_M_S2 / (2 * mu))


def plan(scene: ManipulationFile, pad: Pad, seed: int) -> Plan:
    """Draw what the seed decides, and set the moments."""
    rng = random.Random(f"{seed}:grasp")
    held, grasp, knock = scene.object, scene.grasp, scene.knock
    nominal = SURFACES[held.surface].friction
    margin = grasp.min_margin + (grasp.max_margin - grasp.min_margin) * rng.random()
    thumb = thumb_n(scene, margin)
    shares = [1 + grasp.uneven * (2 * rng.random() - 1) for _ in scene.fingers[1:]]
    forces = [thumb, *(thumb * share / sum(shares) for share in shares)]
    reach = np.array([grasp.reach_m + REACH_SPREAD_M * (2 * rng.random() - 1) for _ in forces])
    factor = 1 + held.friction_spread * (2 * rng.random() - 1)
    friction = Friction(nominal.mu_s * factor, nominal.mu_c * factor)
    goal = reach + np.array([pad.depth_m(force) for force in forces])
    # At its fastest the plan asks for 1.5 times the mean velocity: what the motors can just do.
    closed = OPEN_S + max(grasp.close_s, 1.5 * float(goal.max()) / scene.hand.rate_m_s)
    let_go = closed + grasp.settle_s + grasp.let_go_s
    speed = knock.speed_m_s
    if not speed:
        end = let_go + knock.at_s + grasp.after_s
        return Plan(scene, friction, np.array(forces), reach, goal, closed, let_go, end, None, end)
    run_up = CLEARANCE_M + speed * speed / (2 * ACCELERATION_M_S2)
    touches = let_go + knock.at_s
    starts = touches - speed / ACCELERATION_M_S2 - CLEARANCE_M / speed
    pin = Ramp.at(starts, run_up + knock.stroke_m, speed)
    return Plan(
        scene, friction, np.array(forces), reach, goal, closed, let_go, touches, pin, pin.end_s + grasp.after_s
    )  # fmt: skip
