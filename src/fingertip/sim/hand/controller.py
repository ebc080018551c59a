"""Controller of a hand in closed loop: what it observes, and the commands it returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from fingertip.arrays import Array


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
