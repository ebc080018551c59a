"""Catalogue of force-sensing resistors: what the parts must fit, with the source of every figure.

Catalogue data stands apart from geometry, so that a figure can be corrected without touching a solid.
Sources: [G] Interlink Electronics, FSR Integration Guide; [D] Interlink's one-page data sheet of the model.
Figures in `unverified` were not found in an Interlink document, or its editions contradict each other:
measure your own sensor before you print.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ForceSensor:
    """The outline of one force-sensing resistor, flat, as bought.

    The head is the round end; the tail is the strip that leads from it to the two solder tabs.
    """

    model: str
    label: str
    active_diameter_mm: float
    head_diameter_mm: float
    thickness_mm: float
    length_mm: float
    """From the far edge of the head to the end of the tail [mm]."""
    tail_width_mm: float
    tab_pitch_mm: float
    source: str
    unverified: tuple[str, ...]


CATALOGUE: dict[str, ForceSensor] = {
    sensor.model: sensor
    for sensor in (
        ForceSensor("fsr400", "FSR 400", 5.08, 7.62, 0.30, 38.0, 6.4, 2.54, "[D] FSR 400", ("tail_width_mm",)),
        ForceSensor(
            "fsr400_short", "FSR 400 short tail", 5.08, 7.62, 0.30, 20.0, 6.4, 2.54, "[D] FSR 400 Short",
            ("tail_width_mm",)
        ),
        ForceSensor(
            "fsr402", "FSR 402", 12.7, 18.28, 0.46, 56.0, 7.6, 2.54, "[D] FSR 402",
            ("tail_width_mm", "active_diameter_mm"),  # a newer sheet says 14.68 mm active
        ),
        ForceSensor(
            "fsr402_short", "FSR 402 short tail", 12.7, 18.28, 0.46, 25.0, 7.6, 2.54, "[D] FSR 402 Short",
            ("tail_width_mm", "active_diameter_mm"),
        ),
    )
}  # fmt: skip
