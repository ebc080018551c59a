"""Catalogue of force-sensing resistors (FSR), with the source of every dimension.

The catalogue is separate from the geometry, so that a value can be corrected without changing a solid.

Sources: [G] Interlink Electronics, FSR Integration Guide; [D] Interlink's one-page data sheet of the model. Dimensions
listed in `unverified` were not found in an Interlink document, or differ between its editions. Measure your own sensor
before you print.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

SensorName = Literal["fsr400", "fsr400_short", "fsr402", "fsr402_short"]
"""Names of the catalogue, for the parameter sensor.model. A test holds them and `CATALOGUE` together."""
MIN_FOLD_RADIUS_MM = 2.5
"""Least radius at which Interlink allows the film to bend, at rest [mm]."""
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


CATALOGUE: dict[str, ForceSensor] = {
    sensor.model: sensor
    for sensor in (
        ForceSensor("fsr400", "FSR 400", 5.08, 7.62, 0.30, 38.0, 6.4, 2.54, "[D] FSR 400", ("tail_width_mm",)),
        ForceSensor(
            "fsr400_short", "FSR 400 short tail", 5.08, 7.62, 0.30, 20.0, 6.4, 2.54, "[D] FSR 400 Short",
            ("tail_width_mm",), changes=("bone.base_length_mm=13",),  # a longer one would only weaken the bone
        ),
        ForceSensor(
            "fsr402", "FSR 402", 12.7, 18.28, 0.46, 56.0, 7.6, 2.54, "[D] FSR 402",
            ("tail_width_mm", "active_diameter_mm"),  # a newer data sheet states 14.68 mm for the active diameter
            "fsr402", ("bone.base_length_mm=37",),  # its tail of 56 mm runs on through a longer base
        ),
        ForceSensor(
            "fsr402_short", "FSR 402 short tail", 12.7, 18.28, 0.46, 25.0, 7.6, 2.54, "[D] FSR 402 Short",
            ("tail_width_mm", "active_diameter_mm"), "fsr402",
        ),
    )
}  # fmt: skip
