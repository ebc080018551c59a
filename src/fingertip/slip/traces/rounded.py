"""Times written with too few decimals: several samples share each, though they were taken evenly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_REPEATS = 0.05
"""Least share of steps that repeat the time before; fewer are single issues, told one by one."""
_STRAY = 1.5
"""Most by which a stamp may be off even times, in steps of the rounding: rounding itself moves it by less than one."""
SURE = 0.005
"""Rates that the rounding leaves open by more are not worth telling."""


@dataclass(frozen=True)
class Rounded:
    """Even times that were rounded."""

    repeats: int
    """Samples that have the time of the one before them."""
    first: int
    """The first of those, counted from 0."""
    step_s: float
    """What the times were rounded to."""
    rate_hz: float | None
    """Their mean rate, in as few digits as the rounding leaves open; None if it leaves too much open."""


def rounded(time_s: NDArray[np.float64]) -> Rounded | None:
    """What finite times were rounded to; None if they do not look like even ones that were rounded."""
    steps = np.diff(time_s)
    places = np.flatnonzero(steps == 0.0)
    if len(places) < max(1.0, _REPEATS * len(steps)) or (steps < 0.0).any() or not steps.any():
        return None
    step_s, lasts_s = float(steps[steps > 0.0].min()), float(time_s[-1] - time_s[0])
    even = time_s[0] + lasts_s * np.arange(len(time_s)) / len(steps)
    if np.abs(time_s - even).max() > _STRAY * step_s:
        return None
    return Rounded(len(places), int(places[0]) + 1, step_s, _shortest(len(steps) / lasts_s, step_s / lasts_s))


def _shortest(rate_hz: float, doubt: float) -> float | None:
    """A rate [Hz] in the fewest digits within its doubt, a share of it."""
    if doubt > SURE:
        return None
    return next(
        (short for n in range(1, 6) if abs((short := float(f"{rate_hz:.{n}g}")) / rate_hz - 1) <= doubt), rate_hz
    )
