"""Boards as they are bought: every part within its tolerance, thousands of them at once."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fingertip.errors import Issue, TraceError
from fingertip.sim.electronics.circuit import Analog

RESISTORS = 0.01
"""Tolerance of the resistors, as a share."""
CAPACITORS = 0.05
"""Tolerance of the capacitors, as a share."""
SATURATION = 2.0
"""Saturation current of diodes: from the fitted one divided by this to that times it. Assumption."""


def spread(board: Analog, count: int, seed: int = 0) -> Analog:
    """Boards whose parts lie evenly within their tolerances, each part by itself.

    Parameters
    ----------
    board
        The one they are meant to be.
    count
        How many.
    seed
        The same seed gives the same boards; the first ones are the same for every count.

    Raises
    ------
    TraceError
        If the count is not above 0.
    """
    if count < 1:
        raise TraceError(Issue("count", f"{count} boards are none; give at least 1."))
    rng = random.Random(f"{seed}:boards")
    names = board.value_names
    drawn = np.array([[2 * rng.random() - 1 for _ in range(len(names) + 1)] for _ in range(count)])
    values: dict[str, NDArray[np.float64]] = {
        name: getattr(board, name) * (1 + (RESISTORS if name.endswith("_ohm") else CAPACITORS) * drawn[:, i])
        for i, name in enumerate(names)
    }
    saturation = np.asarray(board.diode.saturation_a) * np.array([SATURATION**x for x in drawn[:, -1].tolist()])
    return board.changed(diode=replace(board.diode, saturation_a=saturation), **values)
