"""Material cards of Shore 40A silicones, the source of every figure beside it.

Catalogue data stands apart from code, so that a figure can be corrected without touching a formula. A figure that is
not `verified` was not found in a document of the product or of its kind: read the data sheet of what you bought.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from fingertip.design.issues import suggest_name
from fingertip.errors import DesignError, Issue

SOURCES = {
    "article": "Method for Automatic Slippage Detection With Tactile Sensors Embedded in Prosthetic Hands, III.B",
    "common": "commonly stated for silicones of this hardness; no document found",
    "ruess": "Ruess' relation lg E = 0.0235 S - 0.6403 (josephborrello.com/shore-a-to-modulus)",
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
    """A figure of a material as a range; one value where both ends are equal."""

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
    """One two-part silicone rubber. Parts A and B are mixed by weight."""

    name: str
    label: str
    cure: Literal["addition", "condensation"]
    """Addition (platinum) shrinks least and is inhibited by uncured resin; condensation (tin) is not."""
    shore_a: MaterialProperty
    modulus_mpa: MaterialProperty
    """Young's modulus at small strain."""
    density_g_cm3: MaterialProperty
    parts_a: MaterialProperty
    parts_b: MaterialProperty
    shrinkage_percent: MaterialProperty
    """Linear."""
    pot_life_min: MaterialProperty
    """At room temperature, from the first stirring."""
    cure_h: MaterialProperty
    """At room temperature, until it can be taken out of the mold."""
    elongation_percent: MaterialProperty
    """At break."""

    def figures(self) -> dict[str, MaterialProperty]:
        """Every figure by its field's name, which carries the unit."""
        return {name: value for name, value in vars(self).items() if isinstance(value, MaterialProperty)}


def _unverified(low: float, high: float, source: str = "") -> MaterialProperty:
    return MaterialProperty(low, high, source, verified=False)


def _one(value: float, source: str) -> MaterialProperty:
    return MaterialProperty(value, value, source)


MATERIALS: dict[str, Silicone] = {
    card.name: card
    for card in (
        Silicone(
            "addition_40a", "addition-cure (platinum) silicone, 40 Shore A", "addition",
            shore_a=_one(40.0, "article"),
            modulus_mpa=_unverified(0.7, 2.0, "common"),  # the upper end is Ruess' 1.99 MPa at 40 Shore A
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
            shore_a=_one(40.0, "article"),
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
            modulus_mpa=_one(2.0, "wang2014"),
            density_g_cm3=_unverified(1.03, 1.03),
            parts_a=_one(10.0, "psi2022"),
            parts_b=_one(1.0, "psi2022"),
            shrinkage_percent=_unverified(0.2, 0.2, "common"),
            pot_life_min=_unverified(90.0, 90.0),
            cure_h=_one(48.0, "niml"),
            elongation_percent=_one(140.0, "pmc"),
        ),
    )
}  # fmt: skip


def silicone(name: str) -> Silicone:
    """The material card of this name.

    Raises
    ------
    DesignError
        If there is none.
    """
    if name not in MATERIALS:
        raise DesignError(Issue("--material", f"there is no {name!r}; {suggest_name(name, tuple(MATERIALS))}"))
    return MATERIALS[name]


def modulus_from_hardness_mpa(shore_a: float) -> float:
    """Young's modulus [MPa] by Ruess' relation, lg E = 0.0235 S - 0.6403, for 30 to 60 Shore A."""
    return float(10.0 ** (0.0235 * shore_a - 0.6403))
