"""Effect of component tolerances on the filter: Monte Carlo spread, worst case and sensitivities.

C1, C2 and C3 may differ, as purchased capacitors do. Gain, cutoff, poles and quality factor come from the transfer
function of the circuit, evaluated for thousands of boards at once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from fingertip.arrays import Array
from fingertip.board.analysis.response import FilterModel, find_passband, find_passbands, search_band_hz
from fingertip.board.components.component_values import ComponentValues
from fingertip.board.components.filter import LARGE_CAPACITOR_PERCENT
from fingertip.board.network import Value
from fingertip.design.filter_components import MAX_1206_F

COMPONENTS = ("R1", "R2", "R3", "R4", "R5", "C1", "C2", "C3", "C14", "C20")
"""Components of the filter that have a tolerance. Variant article has neither C14 nor C20."""
QUANTITIES = ("cutoff_hz", "section_quality", "passband_gain", "first_pole_hz", "section_hz")
"""Quantities of the filter whose tolerance is computed."""


@dataclass(frozen=True)
class TolerancedFilter:
    """Filter whose components deviate from their nominal values."""

    model: FilterModel
    values: Mapping[str, Value]
    """Nominal values of its network."""

    @property
    def names(self) -> tuple[str, ...]:
        """References of its components, in the order of every array of deviations."""
        return tuple(name for name in COMPONENTS if name in self.values)

    def quantities(self, deviations: Array) -> dict[str, Array]:
        """Compute `QUANTITIES` for relative deviations of the components, (..., components)."""
        values = dict(self.values)
        for name, ratio in zip(self.names, np.moveaxis(1.0 + deviations, -1, 0), strict=True):
            # A network's quantity is the conductance of a resistor.
            values[name] = self.values[name] / ratio if name.startswith("R") else self.values[name] * ratio
        nominal = find_passband(self.model.transfer(self.values), search_band_hz(self.model, self.values))
        gain, cutoff_hz = find_passbands(self.model.transfer(values), nominal)
        section_hz, quality = self.model.section(values)
        return {
            "cutoff_hz": cutoff_hz,
            "section_quality": np.asarray(quality),
            "passband_gain": gain,
            "first_pole_hz": np.asarray(self.model.first_pole_hz(values)),
            "section_hz": np.asarray(section_hz),
        }


@dataclass(frozen=True)
class Spread:
    """Distribution of a quantity over many boards."""

    nominal: float
    mean: float
    deviation: float
    """Standard deviation."""
    low_95: float
    """Lower end of the central interval that contains 95 % of the boards."""
    high_95: float
    """Upper end of the central interval that contains 95 % of the boards."""
    worst_low: float
    """Minimum over all corners of the tolerances."""
    worst_high: float
    """Maximum over all corners of the tolerances."""


def monte_carlo(
    board: TolerancedFilter, tolerance: Sequence[float], boards: int = 10_000, seed: int = 1
) -> dict[str, Spread]:
    """Compute the spread of each quantity over boards with independent, uniformly distributed component values.

    Parameters
    ----------
    board
        Filter with its nominal values. The bandwidth of its amplifiers is assumed to be exact.
    tolerance
        Relative tolerance of each component in the order of its names.
    boards
        Number of boards.
    seed
        Seed of the random numbers; the same seed gives the same boards.
    """
    limits, count = np.array(tolerance), len(board.names)
    drawn = board.quantities(limits * np.random.default_rng(seed).uniform(-1.0, 1.0, (boards, count)))
    corners = board.quantities(limits * np.array(list(product((-1.0, 1.0), repeat=count))))
    exact = board.quantities(np.zeros(count))
    result = {}
    for name in QUANTITIES:
        values = drawn[name]
        low, high = np.quantile(values, (0.025, 0.975))
        result[name] = Spread(
            nominal=float(exact[name]),
            mean=float(values.mean()),
            deviation=float(values.std(ddof=1)),
            low_95=float(low),
            high_95=float(high),
            worst_low=float(corners[name].min()),
            worst_high=float(corners[name].max()),
        )
    return result


def component_tolerances(values: ComponentValues) -> list[float]:
    """Relative tolerance of each of `COMPONENTS` that a board has. A C14 too large for it has 20 %."""
    percent, limits = values.tolerance, []
    for name in COMPONENTS:
        if name in values.by_reference:
            is_large = name == "C14" and values.by_reference[name] > MAX_1206_F * (1 + 1e-9)
            capacitor_percent = LARGE_CAPACITOR_PERCENT if is_large else percent.capacitor_percent
            limits.append((percent.resistor_percent if name.startswith("R") else capacitor_percent) / 100.0)
    return limits


def compute_sensitivities(board: TolerancedFilter) -> dict[str, dict[str, float]]:
    """Compute the sensitivity of each quantity to each component: d ln quantity / d ln component.

    It is the change of the quantity in percent for a change of the component by one percent.
    """
    step = 1e-4
    up, down = (board.quantities(sign * step * np.eye(len(board.names))) for sign in (1.0, -1.0))
    width = math.log((1.0 + step) / (1.0 - step))
    return {
        quantity: {
            name: round(float(np.log(up[quantity][i] / down[quantity][i]) / width), 6) + 0.0
            for i, name in enumerate(board.names)
        }
        for quantity in QUANTITIES
    }
