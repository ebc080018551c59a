"""Material data of 40 Shore A silicones, each value with its source.

Catalogue data stands apart from code, so that a value can be corrected without touching a formula. A value that is not
`verified` was not found in a document of the product or of its kind: read the data sheet of the product you bought.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from fingertip.design.issues import suggest_name
from fingertip.errors import DesignError, Issue

SOURCES = {
    "article": "Method for Automatic Slippage Detection With Tactile Sensors Embedded in Prosthetic Hands, III.B",
    "common": "commonly stated for silicones of this hardness; no document found",
    "neat": "D. Neat, Silicone rubber: usual ranges (davidneat.wordpress.com/materials/mouldmaking/silicone-rubber)",
    "troll": "trollfactory.de/lexikon/kondensationsvernetzend",
    "stmpro": "STMPRO X50, a condensation silicone of 30 to 32 Shore A (kb.hairquip.nz/Main/StmproX50)",
    "psi2022": "Mechanical characterization of PDMS with different mixing ratios, Procedia Structural Integrity 2022",
    "wang2014": "J. Appl. Polym. Sci. 2014, 131, 41050: E = 20 MPa divided by the ratio, in compression",
    "pmc": "PMC11019708, table 2",
    "niml": "niml.org, modulus of Sylgard for various mixing ratios: left to cure for at least two days",
    "": "no document found",
}


@dataclass(frozen=True)
class MaterialProperty:
    """Range of a material property; a single value where both ends are equal."""

    low: float
    high: float
    source: str
    """Key of `SOURCES`."""
    verified: bool = True

    def __str__(self) -> str:
        value = f"{self.low:g}" if self.low == self.high else f"{self.low:g} to {self.high:g}"
        return value if self.verified else f"{value} (unverified)"


@dataclass(frozen=True)
class Silicone:
    """Two-part silicone rubber. Its components, named in `component_names`, are mixed by weight."""

    name: str
    label: str
    cure: Literal["addition", "condensation"]
    """Cure system: addition (platinum) or condensation (tin).

    Addition cure shrinks least, but uncured resin inhibits it. Condensation cure is not inhibited.
    """
    shore_a: MaterialProperty
    modulus_mpa: MaterialProperty
    """Young's modulus at small strain."""
    density_g_cm3: MaterialProperty
    parts_a: MaterialProperty
    parts_b: MaterialProperty
    shrinkage_percent: MaterialProperty
    """Linear shrinkage."""
    pot_life_min: MaterialProperty
    """Working time at room temperature, from the start of stirring."""
    cure_h: MaterialProperty
    """Time at room temperature until the skin can be demolded."""
    elongation_percent: MaterialProperty
    """Elongation at break."""

    @property
    def component_names(self) -> tuple[str, str]:
        """Names of the larger and the smaller component, as on their containers."""
        return ("part A", "part B") if self.cure == "addition" else ("base", "catalyst")

    def properties(self) -> dict[str, MaterialProperty]:
        """All properties by field name, which carries the unit."""
        return {name: value for name, value in vars(self).items() if isinstance(value, MaterialProperty)}


def _unverified(low: float, high: float, source: str = "") -> MaterialProperty:
    return MaterialProperty(low, high, source, verified=False)


def _single(value: float, source: str) -> MaterialProperty:
    return MaterialProperty(value, value, source)


MATERIALS: dict[str, Silicone] = {
    silicone.name: silicone
    for silicone in (
        Silicone(
            "addition_40a", "addition-cure (platinum) silicone, 40 Shore A", "addition",
            shore_a=_single(40.0, "article"),
            modulus_mpa=_unverified(0.7, 2.0, "common"),  # upper end: Ruess, lg E = 0.0235 S - 0.6403
            density_g_cm3=_unverified(1.08, 1.08, "common"),
            parts_a=_unverified(10.0, 10.0, "common"),
            parts_b=_unverified(1.0, 1.0, "common"),
            shrinkage_percent=_unverified(0.2, 0.2, "common"),
            pot_life_min=MaterialProperty(5.0, 40.0, "neat"),
            cure_h=MaterialProperty(2.0, 24.0, "neat"),
            elongation_percent=_unverified(250.0, 400.0),
        ),
        Silicone(
            "condensation_40a", "condensation-cure (tin) silicone, 40 Shore A", "condensation",
            shore_a=_single(40.0, "article"),
            modulus_mpa=_unverified(0.7, 2.0, "common"),
            density_g_cm3=MaterialProperty(1.07, 1.09, "stmpro"),
            parts_a=_unverified(10.0, 10.0, "common"),
            parts_b=_unverified(1.0, 1.0, "common"),
            shrinkage_percent=MaterialProperty(0.8, 1.2, "troll"),
            pot_life_min=MaterialProperty(5.0, 40.0, "neat"),
            cure_h=MaterialProperty(2.0, 24.0, "neat"),
            elongation_percent=_unverified(250.0, 400.0),
        ),
        Silicone(
            "sylgard_184", "Sylgard 184", "addition",
            shore_a=MaterialProperty(40.7, 42.7, "psi2022"),
            modulus_mpa=_single(2.0, "wang2014"),
            density_g_cm3=_unverified(1.03, 1.03),
            parts_a=_single(10.0, "psi2022"),
            parts_b=_single(1.0, "psi2022"),
            shrinkage_percent=_unverified(0.2, 0.2, "common"),
            pot_life_min=_unverified(90.0, 90.0),
            cure_h=_single(48.0, "niml"),
            elongation_percent=_single(140.0, "pmc"),
        ),
    )
}  # fmt: skip


def find_silicone(name: str) -> Silicone:
    """The silicone of this name.

    Raises
    ------
    DesignError
        If there is no silicone of this name.
    """
    if name not in MATERIALS:
        raise DesignError(Issue("--material", f"there is no {name!r}; {suggest_name(name, tuple(MATERIALS))}"))
    return MATERIALS[name]
