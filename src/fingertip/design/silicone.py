"""Silicone of a design: from the catalogue, or the user's own from the table [silicone]."""

from __future__ import annotations

from typing import TypeVar

from fingertip.catalogues.sensors import PART_TO_PART
from fingertip.catalogues.silicones import SILICONES, MaterialProperty, Silicone
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import ChosenSilicone
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import DesignError, Issue

OWN = "own"
"""Name that stands for the user's own silicone."""
_COMPONENTS = {"addition": ("part A", "part B"), "condensation": ("base", "catalyst")}
"""Names of the components of a silicone of one's own, by its cure system."""
_Tables = TypeVar("_Tables", bound=DesignTables)


def select_silicone(design: DesignTables) -> Silicone:
    """Return the silicone that a design names in silicone.product."""
    return describe_own(design.silicone) if design.silicone.product == OWN else SILICONES[design.silicone.product]


def replace_silicone(design: _Tables, name: str | None, field: str = "--material") -> _Tables:
    """Return the design with another silicone; the design itself if no name is given. Raises DesignError."""
    if name is None or name == design.silicone.product:
        return design
    if name not in SILICONES and name != OWN:
        raise DesignError(Issue(field, f"there is no {name!r}; {suggest_name(name, (*SILICONES, OWN))}"))
    return design.with_values({"silicone.product": name})


def describe_own(table: ChosenSilicone) -> Silicone:
    """Return the silicone that the user's own figures describe."""

    def stated(value: float) -> MaterialProperty:
        return MaterialProperty(value, value, "design")

    return Silicone(
        OWN,
        table.label,
        table.cure,
        _COMPONENTS[table.cure],
        table.ratio_by,
        parts_a=stated(table.parts_a),
        parts_b=stated(table.parts_b),
        viscosity_pa_s=stated(table.viscosity_pa_s),
        density_g_cm3=stated(table.density_g_cm3),
        shore_a=stated(table.shore_a),
        modulus_mpa=stated(table.modulus_mpa),
        shrinkage_percent=stated(table.shrinkage_percent),
        pot_life_min=stated(table.pot_life_min),
        cure_h=stated(table.cure_h),
        elongation_percent=stated(table.elongation_percent),
    )


# Force curve of a design in words: what a relation between force and voltage assumes of the sensor.


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
