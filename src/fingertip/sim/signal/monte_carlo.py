"""Monte Carlo samples of the board: components within their tolerances, for thousands of boards at once."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import Issue, TraceError
from fingertip.sim.signal.analog_circuit import AnalogBoard

RESISTOR_TOLERANCE = 0.01
"""Relative tolerance of the resistors."""
CAPACITOR_TOLERANCE = 0.05
"""Relative tolerance of the capacitors."""
SATURATION_FACTOR = 2.0
"""Range of the diodes' saturation current: from the nominal value divided by this to the value times it. Assumption."""


def draw_boards(board: AnalogBoard, count: int, seed: int = 0) -> AnalogBoard:
    """Draw boards whose components are uniformly distributed within their tolerances and independent.

    Raises TraceError.
    """
    if count < 1:
        raise TraceError(Issue("count", f"{count} is too few; give at least 1 board."))
    rng = random.Random(f"{seed}:boards")
    nominal = board.components
    drawn = np.array([[2 * rng.random() - 1 for _ in range(len(nominal) + 1)] for _ in range(count)])
    values: dict[str, NDArray[np.float64]] = {
        name: value * (1 + (RESISTOR_TOLERANCE if name.startswith("R") else CAPACITOR_TOLERANCE) * drawn[:, i])
        for i, (name, value) in enumerate(nominal.items())
    }
    factors = np.array([SATURATION_FACTOR**x for x in drawn[:, -1].tolist()])
    saturation = np.asarray(board.diode.saturation_a) * factors
    return replace(board.with_components(**values), diode=replace(board.diode, saturation_a=saturation))
