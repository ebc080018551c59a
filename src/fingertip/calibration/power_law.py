"""Power law fitted to weighings, with the interval of a force that is read off it.

Model of a conductance G under a force F above the turn-on force F0:

    ln G = intercept + exponent * ln(F - F0) + error

The relative scatter of force-sensing resistors is about the same at all forces, so the logarithms have errors of one
variance: ordinary least squares. The interval of a force inverts the prediction interval of a single reading (inverse
regression; N. R. Draper and H. Smith, Applied Regression Analysis, 3rd ed., section 3.2). It is exact for normal errors
of the logarithm.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from fingertip.calibration.student import t_quantile

CONFIDENCE = 0.95
"""Probability with which an interval holds the true force."""


@dataclass(frozen=True)
class PowerLaw:
    """Fitted curve."""

    turn_on_n: float
    """Force at which the sensor begins to conduct [N], which is not fitted."""
    exponent: float
    conductance_s: float
    """Conductance 1 N above the turn-on [S]."""
    scatter: float
    """Relative standard deviation of a conductance about the curve."""
    count: int
    """Number of weighings."""
    mean_log_force: float
    """Mean of ln(F - F0)."""
    squares: float
    """Sum of squared deviations of ln(F - F0) from their mean."""

    @property
    def coverage_factor(self) -> float:
        """Student's t of the fit's degrees of freedom."""
        return t_quantile(CONFIDENCE, self.count - 2)

    @property
    def exponent_uncertainty(self) -> float:
        """Standard uncertainty of the exponent."""
        return self.scatter / math.sqrt(self.squares)

    def conductance_at(self, force_n: float) -> float:
        """Conductance of the curve [S] at a force above the turn-on [N]."""
        return self.conductance_s * math.pow(force_n - self.turn_on_n, self.exponent)

    def force_at(self, conductance_s: float) -> float:
        """Force of the curve [N] at a conductance [S]."""
        return self.turn_on_n + math.pow(conductance_s / self.conductance_s, 1.0 / self.exponent)

    def interval_n(self, conductance_s: float) -> tuple[float, float]:
        """Interval that holds the true force [N] for one reading of a conductance [S] with 95 % probability.

        The upper end is infinite if the weighings do not even show that the conductance grows.
        """
        b, reach = self.exponent, self.coverage_factor * self.scatter
        centre = math.log(conductance_s / self.conductance_s) / b - self.mean_log_force
        # (b (centre - d))^2 = reach^2 (1 + 1/n + d^2 / squares), solved for d = ln(F - F0) - mean
        lead = b * b - reach * reach / self.squares
        if lead <= 0.0:
            return self.turn_on_n, math.inf
        root = reach * math.sqrt(lead * (1.0 + 1.0 / self.count) + b * b * centre * centre / self.squares)
        low, high = ((b * b * centre + sign * root) / lead + self.mean_log_force for sign in (-1.0, 1.0))
        return self.turn_on_n + math.exp(low), self.turn_on_n + math.exp(high)


def fit_power_law(forces_n: Sequence[float], conductances_s: Sequence[float], turn_on_n: float) -> PowerLaw:
    """Fit a power law to three weighings or more, under at least two forces, all above the turn-on force."""
    x = [math.log(force - turn_on_n) for force in forces_n]
    y = [math.log(conductance) for conductance in conductances_s]
    count = len(x)
    x_mean, y_mean = math.fsum(x) / count, math.fsum(y) / count
    squares = math.fsum((xi - x_mean) ** 2 for xi in x)
    exponent = math.fsum((xi - x_mean) * (yi - y_mean) for xi, yi in zip(x, y, strict=True)) / squares
    residuals = (yi - y_mean - exponent * (xi - x_mean) for xi, yi in zip(x, y, strict=True))
    scatter = math.sqrt(math.fsum(r * r for r in residuals) / (count - 2))
    return PowerLaw(
        turn_on_n, exponent, math.exp(y_mean - exponent * x_mean), scatter, count, x_mean, squares
    )  # fmt: skip
