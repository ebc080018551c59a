"""Motion of a hand: plan of a manipulation with the values that the seed draws, controller, and
motors.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.foundation.numerics import Array
from fingertip.pad.response import Pad
from fingertip.sim.contact.friction import Friction
from fingertip.sim.contact.vibration import smoothstep
from fingertip.sim.runs.scene_and_manipulation_files import GraspedObject, Hand, ManipulationFile
from fingertip.sim.runs.timeline import OPEN_S, TrapezoidalMove, find_trigger_s
from fingertip.sim.signal.grid import BASE_HZ
from fingertip.sim.signal.parameters import ACCELERATION_M_S2

GRAVITY_M_S2 = 9.80665
CLEARANCE_M = 2e-3
"""Distance ahead of the object at which the pin has reached its velocity [m]. Assumption."""
REACH_SPREAD_M = 2e-3
"""Half width of the range around grasp.reach_m from which the seed draws where each finger touches
[m]. Assumption.
"""


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """Moments [s], forces [N] and motion of the pin of one manipulation."""

    scene: ManipulationFile
    friction: Friction
    """Friction as drawn. The hand plans with the nominal friction of the surface."""
    force_n: Array
    reach_m: Array
    """Closing at which each finger touches [m]."""
    goal_m: Array
    """Closing at which each finger presses with its force [m]."""
    closed_s: float
    released_s: float
    """Moment from which only the hand holds the object."""
    knock_s: float
    """Moment at which the pin touches the object. Without a pin, the end of the recording."""
    pin: TrapezoidalMove | None
    duration_s: float

    def planned_m(self, time_s: Array) -> Array:
        """Closing of each finger without control [m], (fingers, times)."""
        fraction: Array = smoothstep((time_s - OPEN_S) / (self.closed_s - OPEN_S))
        return self.goal_m[:, None] * fraction

    def weight_n(self, time_s: Array) -> Array:
        """Weight that the hand carries [N]."""
        scene = self.scene
        begins = self.released_s - scene.grasp.let_go_s
        mass_kg = 0.0 if scene.knock.attached else scene.object.mass_kg

        return mass_kg * GRAVITY_M_S2 * smoothstep((time_s - begins) / scene.grasp.let_go_s)

    def pin_m(self, time_s: Array) -> tuple[Array, Array]:
        """Position [m] and velocity [m/s] of the pin.

        Position 0 is where it touches the object at rest.
        """
        if not self.pin:
            return np.full_like(
                time_s, 0.0 if self.scene.knock.attached else -CLEARANCE_M
            ), np.zeros_like(time_s)

        run_up = self.pin.distance_m - self.scene.knock.stroke_m
        return self.pin.position_m(time_s) - run_up, self.pin.velocity_m_s(time_s)


def thumb_force_n(scene: ManipulationFile, share: float) -> float:
    """Planned force of the thumb at a share of its range [N]: of margins over holding the weight by
    friction on both sides, or of forces where the robot carries the object.
    """
    grasp = scene.grasp
    mu = scene.complete().surface.friction.mu_s
    if scene.knock.attached:
        return grasp.force_n or grasp.min_force_n + (grasp.max_force_n - grasp.min_force_n) * share

    margin = grasp.min_margin + (grasp.max_margin - grasp.min_margin) * share
    return grasp.force_n or max(
        grasp.min_force_n, margin * scene.object.mass_kg * GRAVITY_M_S2 / (2 * mu)
    )


def put_on_object(pad: Pad, target: GraspedObject) -> Pad:
    """Return the pad with the wall of an object that yields, in series, for closing and force.

    Vibration is that of a rigid object: the water behind a wall holds it at the frequencies of slip
    (assumption).
    """
    if not target.stiffness_n_per_m:
        return pad

    hand = pad.backing.stiffness_n_per_m
    series = hand * target.stiffness_n_per_m / (hand + target.stiffness_n_per_m)
    return replace(pad, backing=replace(pad.backing, stiffness_n_per_m=series))


def plan_motion(design: Design, scene: ManipulationFile, pad: Pad, seed: int) -> MotionPlan:
    """Draw the random values of a manipulation and set its moments."""
    rng = random.Random(f"{seed}:grasp")
    target = scene.object
    grasp = scene.grasp
    knock = scene.knock

    # The order of the draws is part of the result: thumb, shares, reaches, friction.
    nominal = scene.complete().surface.friction
    thumb = thumb_force_n(scene, rng.random())
    shares = [1 + grasp.uneven * (2 * rng.random() - 1) for _ in scene.fingers[1:]]
    forces = [thumb, *(thumb * share / sum(shares) for share in shares)]
    reach = np.array([grasp.reach_m + REACH_SPREAD_M * (2 * rng.random() - 1) for _ in forces])
    factor = 1 + target.friction_spread * (2 * rng.random() - 1)
    friction = replace(nominal, mu_s=nominal.mu_s * factor, mu_c=nominal.mu_c * factor)
    grip = put_on_object(pad, target)
    goal = reach + np.array([grip.depth_m(force) for force in forces])

    # The peak of the planned velocity is 1.5 times its mean, which the motors can just follow.
    closed = OPEN_S + max(grasp.close_s, 1.5 * float(goal.max()) / scene.hand.rate_m_s)
    released = closed + grasp.settle_s + grasp.let_go_s
    plan = MotionPlan(
        scene=scene,
        friction=friction,
        force_n=np.array(forces),
        reach_m=reach,
        goal_m=goal,
        closed_s=closed,
        released_s=released,
        knock_s=released,
        pin=None,
        duration_s=released,
    )
    touches = (_find_trigger_s(design, plan, pad) if knock.trigger_v else released) + knock.at_s
    speed = knock.speed_m_s

    if not speed:
        end = touches + grasp.after_s
        return replace(plan, knock_s=end, duration_s=end)

    starts = touches
    run_up = 0.0
    if not knock.attached:
        starts = touches - speed / ACCELERATION_M_S2 - CLEARANCE_M / speed
        run_up = CLEARANCE_M + speed * speed / (2 * ACCELERATION_M_S2)

    pin = TrapezoidalMove.with_speed(starts, run_up + knock.stroke_m, speed)
    return replace(plan, knock_s=touches, pin=pin, duration_s=pin.end_s + grasp.after_s)


def _find_trigger_s(design: Design, plan: MotionPlan, pad: Pad) -> float:
    """Find when the planned closing has lowered the thumb's voltage by the stated drop [s]."""
    scene, hand, count = plan.scene, plan.scene.hand, round(plan.released_s * BASE_HZ)
    motors = Motors(
        hand=hand,
        pad=put_on_object(pad, scene.object),
        fingers=scene.fingers,
        reach_m=plan.reach_m,
        step_s=1 / BASE_HZ,
    )
    period, delay = hand.count_points(BASE_HZ)
    commands = plan.planned_m(np.arange(0, count, period) / BASE_HZ)
    force_n = motors.follow(delay_commands(commands, 0, count, period, delay)).force_n[0]
    time_s = np.arange(1, count + 1) / BASE_HZ

    return find_trigger_s(
        design,
        pad=pad,
        sensing=scene.sensing,
        change_v=scene.knock.trigger_v,
        time_s=time_s,
        force_n=force_n,
    )


# Controller of a hand in closed loop: what it observes, and the commands it returns.


@dataclass(frozen=True, eq=False)
class Observation:
    """Values that a controller receives at the end of each control period.

    It sees nothing of the ground truth.

    Fingers are in the order of `ManipulationFile.fingers`, the thumb first.
    """

    time_s: float
    """Present time [s]. The first observation is at time 0 and holds one sample."""
    voltage_v: Array
    """Voltages sampled by the ADC since the previous observation, up to now [V], (fingers,
    samples).
    """
    closing_m: Array
    """Present closing of each finger [m], (fingers,), as the encoder of its motor shows it."""
    planned_m: Array
    """Closing of each finger that a hand without control would command now [m], (fingers,): the
    hand closes, and keeps its grip. A controller that returns this changes nothing; one that adds
    0.001 closes by 1 mm more.
    """
    envelope_v: Array | None = None
    """Sampled outputs of the filter boards [V], shaped like `voltage_v`. None unless ``envelope_v``
    is among the outputs of the scene.
    """
    filtered_v: Array | None = None
    """Sampled filtered signals [V], shaped like `voltage_v`. None unless ``sampled_filtered_v`` is
    among the outputs of the scene.
    """


def delay_commands(
    commands: Array,
    start: int,
    end: int,
    period: int,
    delay: int,
) -> Array:
    """Command in force before each point after `start`.

    Command i is given at i * period and takes `delay` points.
    """
    latest = (np.arange(start, end) - delay) // period
    return np.where(latest >= 0, commands[:, np.maximum(latest, 0)], 0.0)


class Controller(Protocol):
    """Object that closes the loop."""

    def step(self, observation: Observation) -> Array:
        """Return the commanded closing of each finger [m], (fingers,), valid until the next
        command.
        """
        ...


# Motors of the hand: from commands to the closing of each finger and the force with which it
# presses.
#
# A command is the closing of a finger [m], counted from the open hand. It reaches the motors after
# a delay. The motors follow with a first-order lag and a maximum velocity. Ring and little finger
# share one motor (article, III.C): the larger command moves both. A finger that closes beyond the
# touch deflects its pad and the hand behind it (`fingertip.pad.response`), and its force F
# satisfies
#
#     closing - reach -+ q = F / k + c F^(2/3)
#
# The object moves by q between thumb and fingers until both sides press with the same force. Its
# mass in that direction is neglected, because tendon drives damp any oscillation there
# (assumption).

SHARED_MOTOR = ("ring", "little")
POSITION_TOLERANCE_M = 1e-9
"""Distance from its command at which a motor stops [m]."""


@dataclass(frozen=True, eq=False)
class MotorMotion:
    closing_m: Array
    force_n: Array
    """Force with which the finger presses [N]."""
    vibration_n: Array
    """Force with which the motor shakes its finger [N]."""
    jump_n: Array
    """Jump of this force right after the previous point, where a new command changes the velocity
    [N].
    """


class Motors:
    """Closing of the fingers, which touch at `reach_m` [m], and the forces they press with, chunk
    by chunk.
    """

    def __init__(
        self,
        hand: Hand,
        pad: Pad,
        fingers: tuple[str, ...],
        reach_m: Array,
        step_s: float,
    ) -> None:
        self._hand = hand
        self._pad = pad
        self._fingers = fingers
        self._reach_m = reach_m
        self._step_s = step_s
        # Of each finger: closing [m]; phase [rad] and force [N] of its motor's vibration; cube root
        # of its force [N^(1/3)], the start of Newton's method.
        self._closing_m, self._phase, self._shaking, self._root = (
            np.zeros(len(fingers)) for _ in range(4)
        )
        self._moved = np.ones(1)  # 1 if a finger has moved since the forces were balanced

    def follow(self, command_m: Array) -> MotorMotion:
        hand = self._hand
        pad = self._pad
        fingers = self._fingers
        reach_m = self._reach_m
        stall_m = reach_m + pad.depth_m(hand.max_force_n)  # while the other side stands still
        goal = np.clip(command_m, 0.0, stall_m[:, None])

        if all(name in fingers for name in SHARED_MOTOR):
            both = [fingers.index(name) for name in SHARED_MOTOR]
            goal[both] = goal[both].max(axis=0)

        count, length = goal.shape
        closing, force, vibration, jump = (np.zeros(count * length) for _ in range(4))
        _follow(
            (hand.lag_s, hand.rate_m_s, 2 * math.pi * hand.motor_hz, hand.motor_n),
            self._step_s,
            (pad.backing.stiffness_n_per_m, pad.hertz_m_per_n23),
            count,
            length,
            reach_m,
            goal.ravel(),
            self._closing_m,
            self._phase,
            self._shaking,
            self._moved,
            self._root,
            closing,
            force,
            vibration,
            jump,
        )
        return MotorMotion(*(row.reshape(goal.shape) for row in (closing, force, vibration, jump)))


def solve_force_root(depth: float, k: float, c: float, start: float) -> float:
    """Solve ``n^3 / k + c n^2 = depth`` for n >= 0 with Newton's method, which converges from
    above.
    """
    if depth <= 0.0:
        return 0.0

    n = start if start > 0.0 else math.sqrt(depth / c)
    for _ in range(60):
        step = (n * n * (n / k + c) - depth) / (n * (3 * n / k + 2 * c))
        n -= step
        if abs(step) <= 1e-14 * n:
            break

    return n


def approach(distance: float, h: float, lag: float, rate: float) -> float:
    """Distance to the command after a step of a first-order lag with limited velocity: exact."""
    size = distance if distance >= 0.0 else -distance
    if size <= POSITION_TOLERANCE_M:
        return distance

    limited = (size - rate * lag) / rate  # time for which the velocity stays at its limit
    if limited >= h:
        size -= rate * h
    elif limited > 0.0:
        size = rate * lag * math.exp(-(h - limited) / lag)
    else:
        size *= math.exp(-h / lag)

    return size if distance >= 0.0 else -size


def speed_share(distance: float, lag: float, rate: float) -> float:
    """Velocity at a distance from the command, as a fraction of the maximum."""
    size = distance if distance >= 0.0 else -distance
    if size <= POSITION_TOLERANCE_M:
        return 0.0

    share = size / (lag * rate)
    return share if share < 1.0 else 1.0


def _motor_loop(
    motor: tuple[float, float, float, float],
    h: float,
    spring: tuple[float, float],
    count: int,
    length: int,
    reach: Floats,
    goal: Floats,
    position: MutableFloats,
    phase: MutableFloats,
    shaking: MutableFloats,
    moved: MutableFloats,
    root: MutableFloats,
    closing: MutableFloats,
    force: MutableFloats,
    vibration: MutableFloats,
    jump: MutableFloats,
) -> None:
    """Advance the motors, and solve the balance of forces between thumb and fingers."""
    lag, rate, w, amplitude = motor
    k, c = spring

    for s in range(length):
        # Motors: a first-order lag towards the command with limited velocity, solved exactly;
        # vibration in proportion to the velocity, which jumps with the command.
        for i in range(count):
            before = goal[i * length + s] - position[i]
            after = approach(before, h, lag, rate)
            if after != before:
                moved[0] = 1.0

            position[i] += before - after
            start = amplitude * speed_share(before, lag, rate) * math.sin(phase[i])
            jump[i * length + s] = start - shaking[i]
            phase[i] = (phase[i] + w * (abs(before - after) / rate)) % (2 * math.pi)
            shaking[i] = amplitude * speed_share(after, lag, rate) * math.sin(phase[i])
            vibration[i * length + s] = shaking[i]
            closing[i * length + s] = position[i]

        if moved[0] > 0.0:
            # Balance of forces: find the thumb's root n, so that all fingers together press with
            # n^3. The larger n, the deeper the thumb's pad is compressed and the less the fingers
            # are. So the difference between their force and n^3 falls with n and has one root. Its
            # upper bound is the force of the fingers on a rigid thumb.
            thumb_travel = position[0] - reach[0]
            low = total = 0.0
            for i in range(1, count):
                root[i] = solve_force_root(position[i] - reach[i] + thumb_travel, k, c, root[i])
                total += root[i] * root[i] * root[i]

            if total <= 0.0:
                n = 0.0
            else:
                high = total ** (1 / 3)
                n = root[0] if 0.0 < root[0] < high else 0.5 * high
                # Newton's method within the bracket [low, high], with bisection where a step leaves
                # it. m is the root of a finger.
                for _ in range(200):
                    thumb_depth = n * n * (n / k + c)
                    total = 0.0
                    slope = 0.0

                    for i in range(1, count):
                        m = solve_force_root(
                            position[i] - reach[i] + thumb_travel - thumb_depth, k, c, root[i]
                        )
                        root[i] = m
                        total += m * m * m
                        if m > 0.0:
                            slope += 3 * m / (3 * m / k + 2 * c)

                    excess = total - n * n * n
                    if excess > 0.0:
                        low = n
                    else:
                        high = n

                    guess = n + excess / (slope * n * (3 * n / k + 2 * c) + 3 * n * n)
                    if not low < guess < high:
                        guess = 0.5 * (low + high)

                    done = abs(guess - n) <= 1e-13 * high
                    n = guess
                    if done:
                        break

            root[0] = n
            moved[0] = 0.0

        for i in range(count):
            force[i * length + s] = root[i] * root[i] * root[i]


_follow = CompiledLoop(
    _motor_loop, solve_force_root, approach, speed_share, samples="force", plain_us=5.0
)
"""Advances closing, phase, vibration and root of each finger, and fills the fields of
`MotorMotion`.
"""
