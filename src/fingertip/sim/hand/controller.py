"""What closes the loop of a hand: all that a controller is handed, and what it gives back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from fingertip.arrays import Array


@dataclass(frozen=True, eq=False)
class Seen:
    """What a controller is handed at the end of a period."""

    time_s: float
    """Now; the first time 0, before any sample but the first."""
    voltage_v: Array
    """Samples since the last time, (fingers, samples), as the converters gave them."""
    closing_m: Array
    """Closing of each finger now, as its motor's encoder shows it."""
    planned_m: Array
    """Closing of each finger that a hand without control would be told now: it closes and keeps its grip."""
    envelope_v: Array | None = None
    """Samples of the filter boards' outputs, like those of the voltage; None unless the scene names ``envelope_v``
    among its outputs."""


class Controller(Protocol):
    """What closes the loop."""

    def step(self, seen: Seen) -> Array:
        """The closing [m] each finger is told, (fingers,), in force until the next command."""
        ...


class FixedGrip:
    """No control: the planned closing."""

    def step(self, seen: Seen) -> Array:
        """As planned."""
        return seen.planned_m
