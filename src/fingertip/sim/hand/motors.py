"""The hand: from commands to how far each finger has closed, and with how much force it then presses.

A command is a finger's closing [m] from the open hand. It reaches the motors after a delay; they follow with a lag of
first order and a greatest velocity. Ring and little finger have one motor (article, III.C): the greater command moves
both. A finger that closes beyond the touch presses by what its pad and the hand behind it yield (`sim.pad`):

    closing - reach -+ q = F / k + c F^(2/3)

The object moves by q between thumb and fingers so that both sides press alike. Its mass in that direction is neglected:
tendon drives damp whatever would swing there (assumption).
"""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass, field

import numpy as np

from fingertip.arrays import Array
from fingertip.jit import CompiledLoop
from fingertip.sim.contact.pad import HAND_N_PER_M, Pad
from fingertip.sim.hand.manipulation_file import Hand

COUPLED = ("ring", "little")
ARRIVED_M = 1e-9
"""A motor this close to its command stands still."""


@dataclass
class Motors:
    """The closing of some fingers, and the forces they press with; carried from chunk to chunk."""

    hand: Hand
    pad: Pad
    fingers: tuple[str, ...]
    reach_m: Array
    """Closing at which each finger touches."""
    step_s: float
    closing_m: Array = field(init=False)
    _phase: Array = field(init=False)
    _root: Array = field(init=False)  # cube roots of the forces [N^(1/3)], where Newton's method starts

    def __post_init__(self) -> None:
        count = len(self.fingers)
        self.closing_m, self._phase, self._root = (np.zeros(count) for _ in range(3))

    @property
    def max_m(self) -> Array:
        """Closing at which a tendon stalls, the other side standing still."""
        return self.reach_m + self.pad.depth_m(self.hand.max_force_n)

    def follow(self, command_m: Array) -> tuple[Array, Array, Array]:
        """Closing [m], force [N] and shaking by the motor [N] of each finger at the next samples.

        Parameters
        ----------
        command_m
            The command that is in force from each sample to the next, (fingers, samples).
        """
        goal = np.clip(command_m, 0.0, self.max_m[:, None])
        if all(name in self.fingers for name in COUPLED):
            both = [self.fingers.index(name) for name in COUPLED]
            goal[both] = goal[both].max(axis=0)
        count, length = goal.shape
        closing, force, shaking = (np.zeros(count * length) for _ in range(3))
        h, hand = self.step_s, self.hand
        _follow(
            (1 - math.exp(-h / hand.lag_s), hand.rate_m_s * h, 2 * math.pi * hand.motor_hz * h, hand.motor_n),
            (HAND_N_PER_M, self.pad.hertz_m_per_n23), count, length, self.reach_m, goal.ravel(),
            self.closing_m, self._phase, self._root, closing, force, shaking,
        )  # fmt: skip
        return closing.reshape(goal.shape), force.reshape(goal.shape), shaking.reshape(goal.shape)


def root_of(depth: float, k: float, c: float, start: float) -> float:
    """The n >= 0 with ``n^3 / k + c n^2 = depth``: Newton's method, from above at the latest after its first step."""
    if depth <= 0.0:
        return 0.0
    n = start if start > 0.0 else math.sqrt(depth / c)
    for _ in range(60):
        step = (n * n * (n / k + c) - depth) / (n * (3 * n / k + 2 * c))
        n -= step
        if abs(step) <= 1e-14 * n:
            break
    return n


def _loop(
    motor: tuple[float, float, float, float],
    spring: tuple[float, float],
    count: int,
    length: int,
    reach: Sequence[float],
    goal: Sequence[float],
    at: MutableSequence[float],
    phase: MutableSequence[float],
    root: MutableSequence[float],
    closing: MutableSequence[float],
    force: MutableSequence[float],
    shaking: MutableSequence[float],
) -> None:
    blend, maximum, turn, shake = motor
    k, c = spring
    moved = True
    for s in range(length):
        for i in range(count):
            step = blend * (goal[i * length + s] - at[i])
            step = maximum if step > maximum else -maximum if step < -maximum else step
            if abs(goal[i * length + s] - at[i]) <= ARRIVED_M:
                step = 0.0
            else:
                moved = True
            at[i] += step
            share = abs(step) / maximum
            phase[i] = (phase[i] + turn * share) % (2 * math.pi)
            shaking[i * length + s] = shake * share * math.sin(phase[i])
            closing[i * length + s] = at[i]
        if moved:
            # The thumb's root n: what the fingers press with, when the object has yielded to it, less n^3, falls in n.
            reserve = at[0] - reach[0]
            low = total = 0.0
            for i in range(1, count):
                root[i] = root_of(at[i] - reach[i] + reserve, k, c, root[i])
                total += root[i] * root[i] * root[i]
            if total <= 0.0:
                n = 0.0
            else:
                high = total ** (1 / 3)
                n = root[0] if 0.0 < root[0] < high else 0.5 * high
                for _ in range(200):
                    yields = n * n * (n / k + c)
                    total = 0.0
                    slope = 0.0
                    for i in range(1, count):
                        m = root_of(at[i] - reach[i] + reserve - yields, k, c, root[i])
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
            moved = False
        for i in range(count):
            force[i * length + s] = root[i] * root[i] * root[i]


_follow = CompiledLoop(_loop, root_of, outputs=6, samples="force", plain_us=8.0)
"""Carries closing, phase and root; fills closing, force and shaking, finger by finger."""
