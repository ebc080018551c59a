"""Laminar resistance of the ducts between syringe and cavity.

The resistance is dp / (mu Q) [1/mm3]: pressure drop of unit flow at unit viscosity. Entrance losses are left out: the
Reynolds number of silicone in a mold is far below 1.

References: F. M. White, Viscous Fluid Flow, 3rd ed., eqs. 3-38 (round) and 3-48 (rectangle); H. Bruus, Theoretical
Microfluidics, section 3.4. The cone is locally a round duct (lubrication approximation), good for slopes below 0.2.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

_TERMS = 12
"""Terms of the rectangle's series, whose terms fall with the fifth power of odd numbers."""


class Duct(Protocol):
    """Duct that fills from its inlet."""

    @property
    def volume_mm3(self) -> float:
        """Volume."""
        ...

    @property
    def resistance(self) -> float:
        """Resistance of the full duct [1/mm3]."""
        ...

    @property
    def resistance_integral(self) -> float:
        """Integral of the duct's resistance over the volume that has entered it, until it is full [1]."""
        ...


@dataclass(frozen=True)
class RoundDuct:
    """Duct of circular section."""

    diameter_mm: float
    length_mm: float

    @property
    def volume_mm3(self) -> float:
        """Volume."""
        return math.pi / 4.0 * self.diameter_mm**2 * self.length_mm

    @property
    def resistance(self) -> float:
        """Resistance, 128 L / (pi d^4) [1/mm3] (Hagen-Poiseuille)."""
        return 128.0 * self.length_mm / (math.pi * self.diameter_mm**4)

    @property
    def resistance_integral(self) -> float:
        """Integral of the resistance while the duct fills [1]: it grows linearly."""
        return 0.5 * self.resistance * self.volume_mm3


@dataclass(frozen=True)
class ConicalDuct:
    """Duct of circular section whose diameter changes linearly from inlet to outlet."""

    inlet_diameter_mm: float
    outlet_diameter_mm: float
    length_mm: float

    @property
    def volume_mm3(self) -> float:
        """Volume."""
        a, b = self.inlet_diameter_mm, self.outlet_diameter_mm
        return math.pi / 12.0 * (a * a + a * b + b * b) * self.length_mm

    @property
    def resistance(self) -> float:
        """Resistance [1/mm3]: the integral of 128 / (pi d^4) along the cone."""
        a, b = self.inlet_diameter_mm, self.outlet_diameter_mm
        return 128.0 * self.length_mm * (a * a + a * b + b * b) / (3.0 * math.pi * a**3 * b**3)

    @property
    def resistance_integral(self) -> float:
        """Integral of the resistance while the cone fills [1].

        With q = ln(b / a): 32 L^2 / (3 a^2) ((e^3q - 1) / 3 - q) / (e^q - 1)^2, where the last factor tends to 3/2.
        """
        a, q = self.inlet_diameter_mm, math.log(self.outlet_diameter_mm / self.inlet_diameter_mm)
        factor = 1.5 if abs(q) < 1e-5 else (math.expm1(3.0 * q) / 3.0 - q) / math.expm1(q) ** 2
        return 32.0 * self.length_mm**2 / (3.0 * a * a) * factor


@dataclass(frozen=True)
class RectangularDuct:
    """Duct of rectangular section."""

    width_mm: float
    height_mm: float
    length_mm: float

    @property
    def volume_mm3(self) -> float:
        """Volume."""
        return self.width_mm * self.height_mm * self.length_mm

    @property
    def resistance(self) -> float:
        """Resistance [1/mm3]: 12 L / (w h^3), divided by the series for walls at a finite distance."""
        w, h = max(self.width_mm, self.height_mm), min(self.width_mm, self.height_mm)
        series = sum(math.tanh(n * math.pi * w / (2.0 * h)) / n**5 for n in range(1, 2 * _TERMS, 2))
        return 12.0 * self.length_mm / (w * h**3 * (1.0 - 192.0 * h / (math.pi**5 * w) * series))

    @property
    def resistance_integral(self) -> float:
        """Integral of the resistance while the duct fills [1]: it grows linearly."""
        return 0.5 * self.resistance * self.volume_mm3


def fill_in_series(ducts: Iterable[Duct]) -> tuple[float, float, float]:
    """Fill ducts one after the other.

    Returns
    -------
    tuple
        Their resistance [1/mm3], their volume [mm3], and the integral of the growing resistance over volume [1].
    """
    resistance = volume = integral = 0.0
    for duct in ducts:
        integral += resistance * duct.volume_mm3 + duct.resistance_integral
        resistance += duct.resistance
        volume += duct.volume_mm3
    return resistance, volume, integral
