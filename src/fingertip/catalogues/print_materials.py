"""Catalogue of materials for printed parts, with the source of every figure.

The catalogue is separate from the formulas, so that a figure can be corrected without touching one. Figures that are
not `verified` were not found in a document of the product or of its kind. Strength falls with temperature, moisture,
age and a poor post-cure: no figure here includes that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Process = Literal["sla", "fdm", "powder"]


@dataclass(frozen=True)
class PrintMaterial:
    name: str
    label: str
    process: Process
    """Printer that it is for: resin, filament or powder bed."""
    strength_mpa: float
    """Tensile strength within a layer [MPa]; the lower end where the source gives a range."""
    across_mpa: float
    modulus_mpa: float
    density_g_cm3: float
    """Density of a print without hollows; no document of a product was found for any."""
    source: str
    verified: tuple[str, ...] = ()
    """Names of the figures that the source confirms."""

    def strength_along_finger(self, print_direction: Literal["lying", "upright"]) -> float:
        """Return the tensile strength along a bone that lies or stands while it prints [MPa]."""
        return self.across_mpa if print_direction == "upright" else self.strength_mpa


PRINT_MATERIALS: dict[str, PrintMaterial] = {
    material.name: material
    for material in (
        PrintMaterial(
            "surgical_guide", "Formlabs Surgical Guide resin (SLA)", "sla", 73.0, 73.0, 2900.0, 1.2,
            "manufacturer's figures in PMC10406103, table 2; as strong across the layers: assumed for SLA",
            ("strength_mpa", "modulus_mpa"),
        ),
        PrintMaterial(
            "clear", "Formlabs Clear resin V4 (SLA)", "sla", 65.0, 65.0, 2800.0, 1.18,
            "no document found; as strong across the layers: assumed for SLA",
        ),
        PrintMaterial(
            "durable", "Formlabs Durable resin (SLA)", "sla", 31.8, 31.8, 1260.0, 1.16,
            "Formlabs, Material properties of FLDUCL01, 2017, post-cured; as strong across the layers: assumed for SLA",
            ("strength_mpa", "modulus_mpa"),
        ),
        PrintMaterial(
            "petg", "PETG (FDM, solid)", "fdm", 44.0, 25.0, 2000.0, 1.27,
            "additive.tools/materials/petg: 44 to 56 MPa within a layer, 25 to 38 MPa across",
            ("strength_mpa", "across_mpa", "modulus_mpa"),
        ),
        PrintMaterial(
            "pa12", "nylon 12 (powder bed)", "powder", 43.0, 36.0, 1387.0, 1.01,
            "3D Systems' figures in PMC10406103, table 2; across the layers: assumed",
            ("strength_mpa", "modulus_mpa"),
        ),
    )
}  # fmt: skip
