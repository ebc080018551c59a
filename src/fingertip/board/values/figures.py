"""The filter's figures for any eight component values, as arrays: what tolerances and sensitivities are made of.

Unlike the formulas of `filters`, C1, C2 and C3 may differ here, as bought capacitors do.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fingertip.design.filter_components import Components

Array = NDArray[np.float64]

NAMES = ("R1", "R2", "R3", "R4", "R5", "C1", "C2", "C3")
"""Order of the values in every array here."""
FIGURES = ("cutoff_hz", "section_quality", "passband_gain", "first_pole_hz", "section_hz")

_HALVINGS = 60


def nominal(c: Components) -> Array:
    """The fitted values [ohm, F] in the order of `NAMES`."""
    return np.array([c.r1_ohm, c.r2_ohm, c.r3_ohm, c.r4_ohm, c.r5_ohm, c.c_f, c.c_f, c.c_f])


def figures(values: Array) -> dict[str, Array]:
    """`FIGURES` of values in rows of eight.

    The second-order section with unequal capacitors: f0 = 1 / (2 pi sqrt(R2 R3 C2 C3)) and
    Q = sqrt(R3 / R2) sqrt(C2 C3) / (C2 + C3), which are eqs. (10, corrected) and (8) for C2 = C3.
    """
    R1, R2, R3, R4, R5, C1, C2, C3 = np.moveaxis(values, -1, 0)
    f1 = 1.0 / (2.0 * np.pi * R1 * C1)
    f0 = 1.0 / (2.0 * np.pi * np.sqrt(R2 * R3 * C2 * C3))
    Q = np.sqrt(R3 / R2) * np.sqrt(C2 * C3) / (C2 + C3)
    return {
        "cutoff_hz": _cutoff_hz(f1, f0, Q),
        "section_quality": Q,
        "passband_gain": 1.0 + R5 / R4,
        "first_pole_hz": f1,
        "section_hz": f0,
    }


def _cutoff_hz(f1: Array, f0: Array, Q: Array) -> Array:
    """Where (1 + r v)(1 + (1/Q^2 - 2) v + v^2) = 2, v = (f0 / f)^2: see `filters.overall_cutoff_hz`.

    By bisection of the only root; a Q above 1.5 may have several, and this filter's is about 1.
    """
    r, beta = (f1 / f0) ** 2, 1.0 / Q**2 - 2.0
    low = np.zeros_like(r)
    high = 4.0 + 2.0 / r  # there the loss is above 2 whatever beta, which is above -2
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        below = (1.0 + r * middle) * (1.0 + beta * middle + middle * middle) < 2.0
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    result: Array = f0 / np.sqrt(high)
    return result


@dataclass(frozen=True)
class Spread:
    """What a figure comes to over many boards."""

    nominal: float
    mean: float
    deviation: float
    """Standard deviation."""
    low_95: float
    high_95: float
    """Between these lie 95 % of the boards."""
    worst_low: float
    worst_high: float
    """With every part at the end of its tolerance that is worst."""


def monte_carlo(
    c: Components, resistor_percent: float, capacitor_percent: float, boards: int = 10_000, seed: int = 1
) -> dict[str, Spread]:
    """Figure -> spread over boards whose parts lie anywhere within their tolerance, evenly, each for itself.

    Parameters
    ----------
    c
        The fitted values.
    resistor_percent, capacitor_percent
        Tolerances.
    boards
        How many.
    seed
        The same seed gives the same boards.
    """
    tolerance = np.array([resistor_percent] * 5 + [capacitor_percent] * 3) / 100.0
    base = nominal(c)
    rng = np.random.default_rng(seed)
    drawn = figures(base * (1.0 + tolerance * rng.uniform(-1.0, 1.0, (boards, len(base)))))
    corners = figures(base * (1.0 + tolerance * np.array(list(product((-1.0, 1.0), repeat=len(base))))))
    exact = figures(base)
    result = {}
    for name in FIGURES:
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


def sensitivities(c: Components) -> dict[str, dict[str, float]]:
    """Figure -> part -> percent that the figure moves for one percent of the part (d ln figure / d ln part)."""
    step = 1e-4
    base = nominal(c)
    up, down = (figures(base * (1.0 + sign * step * np.eye(len(base)))) for sign in (1.0, -1.0))
    width = np.log((1.0 + step) / (1.0 - step))
    return {
        figure: {
            name: round(float(np.log(up[figure][i] / down[figure][i]) / width), 6) + 0.0 for i, name in enumerate(NAMES)
        }
        for figure in FIGURES
    }
