"""Plan of a manipulation: the values that the seed draws, and the moments of all events."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fingertip.foundation.numerics import Array
from fingertip.sim.contact.friction import Friction
from fingertip.sim.contact.pad import Pad
from fingertip.sim.contact.surface_profile import SURFACES
from fingertip.sim.hand.manipulation_file import ManipulationFile
from fingertip.sim.scene.timeline import ACCELERATION_M_S2, OPEN_S, TrapezoidalMove, smoothstep

GRAVITY_M_S2 = 9.80665
"""Standard acceleration of gravity [m/s2]."""
CLEARANCE_M = 2e-3
"""Distance ahead of the object at which the pin has reached its velocity [m]. Assumption."""
REACH_SPREAD_M = 2e-3
"""Half width of the range around grasp.reach_m from which the seed draws where each finger touches [m]. Assumption."""


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """Moments [s], forces [N] and motion of the pin of one manipulation."""

    scene: ManipulationFile
    friction: Friction
    """Friction as drawn. The hand plans with the nominal friction of the surface."""
    force_n: Array
    """Planned holding force of each finger [N]."""
    reach_m: Array
    """Closing at which each finger touches [m]."""
    goal_m: Array
    """Closing at which each finger presses with its force [m]."""
    closed_s: float
    """Moment at which the hand has closed."""
    released_s: float
    """Moment from which only the hand holds the object."""
    knock_s: float
    """Moment at which the pin touches the object. Without a pin, the end of the recording."""
    pin: TrapezoidalMove | None
    """Motion of the pin, if there is one."""
    duration_s: float
    """End of the recording."""

    def planned_m(self, time_s: Array) -> Array:
        """Closing of each finger without control [m], (fingers, times)."""
        fraction: Array = smoothstep((time_s - OPEN_S) / (self.closed_s - OPEN_S))
        return self.goal_m[:, None] * fraction

    def weight_n(self, time_s: Array) -> Array:
        """Weight that the hand carries [N]."""
        scene = self.scene
        begins = self.released_s - scene.grasp.let_go_s
        return scene.object.mass_kg * GRAVITY_M_S2 * smoothstep((time_s - begins) / scene.grasp.let_go_s)

    def pin_m(self, time_s: Array) -> tuple[Array, Array]:
        """Position [m] and velocity [m/s] of the pin. Position 0 is where it touches the object at rest."""
        if not self.pin:
            return np.full_like(time_s, -CLEARANCE_M), np.zeros_like(time_s)
        run_up = self.pin.distance_m - self.scene.knock.stroke_m
        return self.pin.position_m(time_s) - run_up, self.pin.velocity_m_s(time_s)


def thumb_force_n(scene: ManipulationFile, margin: float) -> float:
    """Force of the thumb for a margin over the force that just holds the weight [N].

    Thumb and opposing fingers press with the same force, and friction acts on both sides.
    """
    grasp, mu = scene.grasp, SURFACES[scene.object.surface].friction.mu_s
    return grasp.force_n or max(grasp.min_force_n, margin * scene.object.mass_kg * GRAVITY_M_S2 / (2 * mu))


def plan_motion(scene: ManipulationFile, pad: Pad, seed: int) -> MotionPlan:
    """Draw the random values of a manipulation and set its moments."""
    rng = random.Random(f"{seed}:grasp")
    target, grasp, knock = scene.object, scene.grasp, scene.knock

    # The order of the draws is part of the result: margin, shares, reaches, friction.
    nominal = SURFACES[target.surface].friction
    margin = grasp.min_margin + (grasp.max_margin - grasp.min_margin) * rng.random()
    thumb = thumb_force_n(scene, margin)
    shares = [1 + grasp.uneven * (2 * rng.random() - 1) for _ in scene.fingers[1:]]
    forces = [thumb, *(thumb * share / sum(shares) for share in shares)]
    reach = np.array([grasp.reach_m + REACH_SPREAD_M * (2 * rng.random() - 1) for _ in forces])
    factor = 1 + target.friction_spread * (2 * rng.random() - 1)
    friction = Friction(nominal.mu_s * factor, nominal.mu_c * factor)
    goal = reach + np.array([pad.depth_m(force) for force in forces])

    # The peak of the planned velocity is 1.5 times its mean, which the motors can just follow.
    closed = OPEN_S + max(grasp.close_s, 1.5 * float(goal.max()) / scene.hand.rate_m_s)
    released = closed + grasp.settle_s + grasp.let_go_s
    speed = knock.speed_m_s
    if not speed:
        end = released + knock.at_s + grasp.after_s
        return MotionPlan(scene, friction, np.array(forces), reach, goal, closed, released, end, None, end)
    run_up = CLEARANCE_M + speed * speed / (2 * ACCELERATION_M_S2)
    touches = released + knock.at_s
    starts = touches - speed / ACCELERATION_M_S2 - CLEARANCE_M / speed
    pin = TrapezoidalMove.with_speed(starts, run_up + knock.stroke_m, speed)
    end = pin.end_s + grasp.after_s
    return MotionPlan(scene, friction, np.array(forces), reach, goal, closed, released, touches, pin, end)


# Controller of a hand in closed loop: what it observes, and the commands it returns.


@dataclass(frozen=True, eq=False)
class Observation:
    """Values that a controller receives at the end of each control period. It sees nothing of the ground truth.

    Fingers are in the order of `ManipulationFile.fingers`, the thumb first.
    """

    time_s: float
    """Present time [s]. The first observation is at time 0 and holds one sample."""
    voltage_v: Array
    """Voltages sampled by the ADC since the previous observation, up to now [V], (fingers, samples)."""
    closing_m: Array
    """Present closing of each finger [m], (fingers,), as the encoder of its motor shows it."""
    planned_m: Array
    """Closing of each finger that a hand without control would command now [m], (fingers,): the hand closes, and keeps
    its grip. A controller that returns this changes nothing; one that adds 0.001 closes by 1 mm more."""
    envelope_v: Array | None = None
    """Sampled outputs of the filter boards [V], shaped like `voltage_v`. None unless ``envelope_v`` is among the
    outputs of the scene."""
    filtered_v: Array | None = None
    """Sampled filtered signals [V], shaped like `voltage_v`. None unless ``sampled_filtered_v`` is
    among the outputs of the scene."""


class Controller(Protocol):
    """Object that closes the loop."""

    def step(self, observation: Observation) -> Array:
        """Return the commanded closing of each finger [m], (fingers,), valid until the next command."""
        ...


class FixedGrip:
    """Controller that does not react: it commands the planned closing."""

    def step(self, observation: Observation) -> Array:
        """Return the planned closing [m]."""
        return observation.planned_m
