"""Effect of component tolerances on the filter: Monte Carlo spread and worst case.

C1, C2 and C3 may differ, as purchased capacitors do. Gain, cutoff, poles and quality factor come
from the transfer function of the circuit, evaluated for thousands of boards at once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from fingertip.board.analysis.response import FilterModel, find_passbands
from fingertip.board.circuits.network import Value
from fingertip.board.parts.circuit import Circuit
from fingertip.design.parameters.board_and_detector import Board
from fingertip.foundation.numerics import Array

COMPONENTS = ("R1", "R2", "R3", "R4", "R5", "C1", "C2", "C3", "C14", "C20")
"""Components of the filter that have a tolerance. Variant article has neither C14 nor C20."""
QUANTITIES = ("cutoff_hz", "section_quality", "passband_gain", "first_pole_hz", "section_hz")
BAND_QUANTILES = (0.025, 0.975)
"""Quantiles between which 95 % of the boards lie."""


@dataclass(frozen=True)
class TolerancedFilter:
    model: FilterModel
    values: Mapping[str, Value]
    """Nominal values of its network."""

    @property
    def names(self) -> tuple[str, ...]:
        """References of its components, in the order of every array of deviations."""
        return tuple(name for name in COMPONENTS if name in self.values)

    def deviate(self, deviations: Array) -> dict[str, Value]:
        """Return the network's values for relative deviations, (..., components)."""
        values = dict(self.values)
        for name, ratio in zip(self.names, np.moveaxis(1.0 + deviations, -1, 0), strict=True):
            # A network's quantity is the conductance of a resistor.
            values[name] = (
                self.values[name] / ratio if name.startswith("R") else self.values[name] * ratio
            )

        return values

    def quantities(self, deviations: Array) -> dict[str, Array]:
        """Compute `QUANTITIES` for relative deviations of the components, (..., components)."""
        values = self.deviate(deviations)
        gain, cutoff_hz = find_passbands(
            self.model.transfer(values), self.model.passband(self.values)
        )
        section_hz, quality = self.model.section(values)
        figures = (cutoff_hz, quality, gain, self.model.first_pole_hz(values), section_hz)

        return dict(zip(QUANTITIES, map(np.asarray, figures), strict=True))


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
    error_95: float
    """Half of the 95 % interval of either end, the wider: that of the number of boards."""
    worst_low: float
    """Minimum over all corners of the tolerances."""
    worst_high: float


def monte_carlo(
    board: TolerancedFilter, tolerances: Mapping[str, float], boards: int = 10_000, seed: int = 1
) -> dict[str, Spread]:
    """Compute the spread of each quantity over boards with uniform tolerances [%]."""
    limits = _limits(board, tolerances)
    count = len(board.names)
    random = board.quantities(draw_deviations(board, tolerances, boards, seed))
    corners = board.quantities(limits * np.array(list(product((-1.0, 1.0), repeat=count))))
    exact = board.quantities(np.zeros(count))
    result = {}

    for name, values in random.items():
        low, high = np.quantile(values, BAND_QUANTILES).tolist()
        worst = corners[name]
        result[name] = Spread(
            nominal=float(exact[name]),
            mean=float(values.mean()),
            deviation=float(values.std(ddof=1)),
            low_95=low,
            high_95=high,
            error_95=max(find_quantile_error(values, quantile) for quantile in BAND_QUANTILES),
            worst_low=float(worst.min()),
            worst_high=float(worst.max()),
        )

    return result


def find_quantile_error(values: Array, quantile: float) -> float:
    """Find half of the 95 % interval of a quantile of independent values.

    Between the order statistics at its ends the quantile lies with 95 %, whatever the distribution:
    the number of values below it is binomial (David, Nagaraja: Order Statistics, section 7.1).
    Infinite where there are too few values to have one beyond each end.
    """
    count = len(values)
    middle = quantile * count
    half = 1.96 * math.sqrt(count * quantile * (1.0 - quantile))
    low = math.floor(middle - half)
    high = math.ceil(middle + half)
    if low < 0 or high >= count:
        return math.inf

    ordered = np.sort(values)
    return float(ordered[high] - ordered[low]) / 2.0


def draw_deviations(
    board: TolerancedFilter, tolerances: Mapping[str, float], boards: int, seed: int
) -> Array:
    """Draw independent uniform deviations within tolerances [%]: ratios, (boards, components)."""
    uniform = np.random.default_rng(seed).uniform(-1.0, 1.0, (boards, len(board.names)))
    deviations: Array = _limits(board, tolerances) * uniform
    return deviations


def _limits(board: TolerancedFilter, tolerances: Mapping[str, float]) -> Array:
    return np.array([tolerances[name] / 100.0 for name in board.names])


def component_tolerances(circuit: Circuit) -> dict[str, float]:
    """Return the tolerance [%] of each of `COMPONENTS` in a circuit, as bought."""
    requirements = {component.reference: component.requirement for component in circuit.components}
    percent = {}
    for name in COMPONENTS:
        requirement = requirements.get(name)
        if requirement:
            percent[name] = requirement.tolerance_percent

    return percent


YIELD_BOARDS = 4000
YIELD_RATIO = 0.1
LEAST_YIELD = 0.99
"""Boards drawn for a yield, deviation within which a board counts, and required share."""


def compute_yields(
    model: FilterModel,
    values: Mapping[str, Value],
    circuit: Circuit,
    board: Board,
    boards: int = YIELD_BOARDS,
) -> dict[str, float]:
    """Compute the share of boards within `YIELD_RATIO` of the design's cutoff, and of its gain."""
    toleranced = TolerancedFilter(model, values)
    deviations = draw_deviations(toleranced, component_tolerances(circuit), boards, seed=1)
    quantities = toleranced.quantities(deviations)
    targets = {"cutoff_hz": board.cutoff_hz, "passband_gain": board.passband_gain}

    return {
        name: float(np.mean(np.abs(quantities[name] / target - 1.0) <= YIELD_RATIO))
        for name, target in targets.items()
    }
