"""Touches of the finger, and how far down each drives the filtered signal: results of simulations, stored as data.

This package does not import the simulation. `tests/board/test_touches.py` simulates each touch again.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SimulatedTouch:
    """Touch of the finger and the lowest filtered voltage that it causes on the default board, by simulation.

    The amplifiers are ideal, so the voltage is that which would be reached if nothing limited it.
    """

    force_n: float
    rise_s: float
    """Time in which the force rises."""
    min_filtered_v: float


SLOW_PRESS = SimulatedTouch(1.5, 0.2, -0.1)
FAST_PRESSES = SimulatedTouch(1.5, 0.04, -2.1), SimulatedTouch(1.5, 0.025, -4.2)
"""Presses that reach the TL082's typical limit, and exceed it."""
KNOCK = SimulatedTouch(0.2, 0.004, -2.6)
"""Tap on an object that is held with 1 N."""


def describe_touches() -> str:
    """Describe which touches drive the filtered signal below the TL082's input range."""
    limit, beyond = FAST_PRESSES
    return (
        f"in simulations of the article's board a press to {limit.force_n:g} N takes the filtered signal to "
        f"{limit.min_filtered_v:.1f} V if the force rises within {1e3 * limit.rise_s:g} ms and to "
        f"{beyond.min_filtered_v:.1f} V within {1e3 * beyond.rise_s:g} ms, but only to "
        f"{SLOW_PRESS.min_filtered_v:.1f} V within {1e3 * SLOW_PRESS.rise_s:g} ms; a knock of {KNOCK.force_n:g} N "
        f"within {1e3 * KNOCK.rise_s:g} ms on a held object takes it to {KNOCK.min_filtered_v:.1f} V"
    )
