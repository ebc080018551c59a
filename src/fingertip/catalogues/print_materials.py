"""Catalogue of materials for printed parts, read from `print_materials.csv` with the source of every figure.

Strength falls with temperature, moisture, age and a poor post-cure: no figure here includes that.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from fingertip.foundation.tables import load_table, read_rows

Process = Literal["sla", "fdm", "powder"]


@dataclass(frozen=True)
class PrintMaterial:
    name: str
    label: str
    process: Process
    """Printer that it is for: resin, filament or powder bed."""
    strength_mpa: float
    """Tensile strength across the layers [MPa], as a bone prints; the lower end where the source gives a range."""
    modulus_mpa: float
    density_g_cm3: float
    """Density of a print without hollows; no document of a product was found for any."""
    source: str
    verified: tuple[str, ...]
    """Names of the figures that the source confirms."""


PRINT_MATERIALS = {
    material.name: material
    for material in load_table(PrintMaterial, read_rows(Path(__file__).with_name("print_materials.csv")))
}
