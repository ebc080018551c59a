"""Effect of component tolerances on the filter: Monte Carlo spread, worst case and sensitivities.

C1, C2 and C3 may differ, as purchased capacitors do. Gain, cutoff, poles and quality factor come from the transfer
function of the circuit, evaluated for thousands of boards at once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from fingertip.arrays import Array
from fingertip.board.analysis.response import FilterModel, find_passband, find_passbands, search_band_hz
from fingertip.board.circuit import Circuit
from fingertip.board.network import Value

COMPONENTS = ("R1", "R2", "R3", "R4", "R5", "C1", "C2", "C3", "C14", "C20")
"""Components of the filter that have a tolerance. Variant article has neither C14 nor C20."""
CUTOFF_CAPACITORS = ("C1", "C2", "C3")
"""Capacitors that set the cutoff."""
ARTICLE_CAPACITOR_PERCENT = 5.0
"""Tolerance [%] of the article's capacitors, with which others are compared."""
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

    def deviate(self, deviations: Array) -> dict[str, Value]:
        """Values of the network for relative deviations of the components, (..., components)."""
        values = dict(self.values)
        for name, ratio in zip(self.names, np.moveaxis(1.0 + deviations, -1, 0), strict=True):
            # A network's quantity is the conductance of a resistor.
            values[name] = self.values[name] / ratio if name.startswith("R") else self.values[name] * ratio
        return values

    def quantities(self, deviations: Array) -> dict[str, Array]:
        """Compute `QUANTITIES` for relative deviations of the components, (..., components)."""
        values = self.deviate(deviations)
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
    board: TolerancedFilter, tolerances: Mapping[str, float], boards: int = 10_000, seed: int = 1
) -> dict[str, Spread]:
    """Compute the spread of each quantity over boards with independent, uniformly distributed component values.

    Parameters
    ----------
    board
        Filter with its nominal values. The bandwidth of its amplifiers is assumed to be exact.
    tolerances
        Tolerance [%] of each component by its name.
    boards
        Number of boards.
    seed
        Seed of the random numbers; the same seed gives the same boards.
    """
    limits, count = _limits(board, tolerances), len(board.names)
    drawn = board.quantities(draw_deviations(board, tolerances, boards, seed))
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


def draw_deviations(board: TolerancedFilter, tolerances: Mapping[str, float], boards: int, seed: int) -> Array:
    """Draw relative deviations, (boards, components), independent and uniform within these tolerances [%]."""
    uniform = np.random.default_rng(seed).uniform(-1.0, 1.0, (boards, len(board.names)))
    deviations: Array = _limits(board, tolerances) * uniform
    return deviations


def _limits(board: TolerancedFilter, tolerances: Mapping[str, float]) -> Array:
    """Largest relative deviation of each component."""
    return np.array([tolerances[name] / 100.0 for name in board.names])


def component_tolerances(circuit: Circuit) -> dict[str, float]:
    """Tolerance [%] of each of `COMPONENTS` that a circuit has, as its parts are bought."""
    requirements = {component.reference: component.requirement for component in circuit.components}
    return {name: found.tolerance_percent for name in COMPONENTS if (found := requirements.get(name))}


def state_capacitors(tolerances: Mapping[str, float], percent: float) -> dict[str, float]:
    """Tolerances [%] with another one for C1 to C3, which set the cutoff."""
    return {name: percent if name in CUTOFF_CAPACITORS else own for name, own in tolerances.items()}


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
