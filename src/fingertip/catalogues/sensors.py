"""Catalogue of force-sensing resistors (FSR), read from `sensors.csv` with the source of every dimension.

Sources: [G] Interlink Electronics, FSR Integration Guide; [D] Interlink's one-page data sheet of the model. Dimensions
listed in `unverified` were not found in an Interlink document, or differ between its editions. Measure your own sensor
before you print.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from fingertip.foundation.tables import load_table, read_rows

PART_TO_PART = (2.0, 8.0)
"""Factors by which the readings of real sensors of one model differ at the same force, from usual to bad. Source: three
sensors under 2.6 N in a divider with a converter of 10 bits gave 341 to 373 counts, and 45 to 54."""

FILM_G_CM3 = 1.4
"""Density of a sensor, taken for that of its polyester films. (unverified)"""


@dataclass(frozen=True)
class ForceSensor:
    """Outline of a flat force-sensing resistor as bought: round head, and tail that leads to the two solder tabs."""

    model: str
    label: str
    active_diameter_mm: float
    head_diameter_mm: float
    thickness_mm: float
    length_mm: float
    """Length from the far edge of the head to the end of the tail [mm]."""
    tail_width_mm: float
    tab_pitch_mm: float
    source: str
    unverified: tuple[str, ...]
    """Names of the dimensions that no Interlink document confirms."""
    bundled_design: str = "fsr400"
    changes: tuple[str, ...] = ()
    """Changes of that design which the sensor needs."""


CATALOGUE = {
    sensor.model: sensor for sensor in load_table(ForceSensor, read_rows(Path(__file__).with_name("sensors.csv")))
}
