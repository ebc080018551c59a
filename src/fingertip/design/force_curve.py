"""Force curve of a design in words: what a relation between force and voltage assumes of the sensor."""

from __future__ import annotations

from fingertip.design.parameters import DesignTables
from fingertip.sensors import PART_TO_PART


def describe_force_curve(design: DesignTables) -> str:
    """Describe in a sentence how far the forces of a design can be trusted, for wherever a force is shown."""
    curve = design.force_curve
    if curve.curve == "calibrated":
        return (
            f"forces hold for the calibrated sensor, within a factor of {curve.interval_factor:.3g} (95 %) between "
            f"{curve.min_force_n:g} and {curve.max_force_n:g} N"
        )
    usual, bad = PART_TO_PART
    return (
        f"forces hold for a typical sensor; the readings of real ones differ by a factor of {usual:g} to {bad:g} at "
        "the same force, so calibrate yours: fingertip calibrate sensor"
    )
