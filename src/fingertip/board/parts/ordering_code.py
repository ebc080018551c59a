"""Part numbers of chip resistors by their makers' published ordering codes.

The resistance is written with its letter R, K or M in the place of the decimal point, and zeros after it are left out:
120 ohm is 120R, 1.24 kohm is 1K24, 10 kohm is 10K (the data sheets in `sources.csv`).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

from fingertip.board.circuit import format_component_value
from fingertip.board.parts.table import ChipResistor, Part, parse_value, read_rows
from fingertip.design.preferred_series import find_preferred_neighbours


@dataclass(frozen=True)
class OrderingCode:
    """Ordering code of a series of resistors."""

    manufacturer: str
    prefix: str
    suffix: str
    tolerance_percent: float
    drift_ppm_per_k: float
    """Temperature coefficient [ppm/K]; infinite where the code states none."""
    power_w: float
    package: str
    min_ohm: float
    max_ohm: float
    series: tuple[str, ...]
    """Series of values that it is made in."""
    source: str

    def is_made(self, ohm: float) -> bool:
        """Return whether a resistance [ohm] is a value of the series, within its range."""
        if not self.min_ohm <= ohm <= self.max_ohm:
            return False
        return any(low == high for low, high in (find_preferred_neighbours(ohm, series) for series in self.series))

    def compose(self, ohm: float) -> ChipResistor:
        """Compose the resistor of this series with a resistance [ohm]."""
        number = f"{self.prefix}{resistance_code(ohm)}{self.suffix}"
        part = Part(self.manufacturer, number, "", self.source)
        return ChipResistor(ohm, self.tolerance_percent, self.drift_ppm_per_k, self.power_w, self.package, part)


@functools.cache
def load_ordering_codes() -> tuple[OrderingCode, ...]:
    """Load the ordering codes. Of several that fit, the first is to be preferred."""
    return tuple(
        OrderingCode(
            row["manufacturer"],
            row["prefix"],
            row["suffix"],
            float(row["tolerance_percent"]),
            float(row["drift_ppm_per_k"] or "inf"),
            float(row["power_w"]),
            row["package"],
            parse_value(row["min_ohm"]),
            parse_value(row["max_ohm"]),
            tuple(row["series"].split()),
            row["source"],
        )
        for row in read_rows("ordering_codes.csv")
    )


def resistance_code(ohm: float) -> str:
    """Write a resistance [ohm] as in an ordering code: 1240 is "1K24", 82 is "82R"."""
    text = format_component_value(ohm)
    digits, letter = (text[:-1], text[-1].upper()) if text[-1] in "kM" else (text, "R")
    whole, _, fraction = digits.partition(".")
    return f"{whole}{letter}{fraction}"
