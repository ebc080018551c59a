"""Catalogue of silicones for the skin, with the source of every figure.

The catalogue is separate from the formulas, so that a figure can be corrected without touching one. A figure that is
not `verified` was not found in a document of the product or of its kind. Batches differ: the container and the data
sheet of the product you bought are right where they differ from this catalogue.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

SiliconeName = Literal[
    "addition_40a", "condensation_40a", "smooth_sil_940", "mold_star_30", "dragon_skin_30", "elastosil_m4641",
    "sylgard_184", "ecoflex_00_30",
]  # fmt: skip
"""Names of the catalogue, for the parameter silicone.product. A test holds them and `SILICONES` together."""
Cure = Literal["addition", "condensation"]
"""Cure system: addition (platinum) or condensation (tin). Addition cure shrinks least, but uncured resin inhibits it.
Condensation cure is not inhibited."""
RatioBasis = Literal["weight", "volume", "weight or volume"]
"""Basis on which the maker states the mix ratio; "weight or volume" if both are allowed."""

GENERIC: frozenset[SiliconeName] = frozenset(("addition_40a", "condensation_40a"))
"""Names that stand for a kind of silicone, not for a product."""

SOURCES = {
    "article": "Method for Automatic Slippage Detection With Tactile Sensors Embedded in Prosthetic Hands, III.B",
    "common": "commonly stated for silicones of this hardness; no document found",
    "trade": "trade figure for silicones of this hardness; no document found",
    "recalled": "recalled from the maker's data sheet, which could not be read",
    "neat": "D. Neat, Silicone rubber: usual ranges (davidneat.wordpress.com/materials/mouldmaking/silicone-rubber)",
    "troll": "trollfactory.de/lexikon/kondensationsvernetzend",
    "stmpro": "STMPRO X50, a condensation silicone of 30 to 32 Shore A (kb.hairquip.nz/Main/StmproX50)",
    "psi2022": "Mechanical characterization of PDMS with different mixing ratios, Procedia Structural Integrity 2022",
    "wang2014": "J. Appl. Polym. Sci. 2014, 131, 41050: E = 20 MPa divided by the ratio, in compression",
    "johnston2014": "J. Micromech. Microeng. 2014, 24, 035017, abstract: cured at 25 to 200 degrees Celsius",
    "pmc": "PMC11019708, table 2",
    "niml": "niml.org, modulus of Sylgard for various mixing ratios: left to cure for at least two days",
    "dragon_skin_tb": "Smooth-On, Dragon Skin Series bulletin; quoted in via-balaena/CortenForge, cf-cast/src/cure.rs",
    "ecoflex_tb": "Smooth-On, Ecoflex Series bulletin; quoted in via-balaena/CortenForge, cf-cast/src/cure.rs",
    "mold_star_page": "Smooth-On, page of Mold Star 30; quoted by Fab Lab Seoul Innovation, Fab Academy 2018, week 10",
    "mold_star_tb": "Smooth-On, bulletin of Mold Star 15, 16 and 30; quoted in notes on molds in public repositories",
    "smooth_sil_page": "Smooth-On, page of Smooth-Sil 940; quoted in notes on casting in a public repository",
    "design": "the table [silicone] of the design file",
    "": "no document found",
}  # fmt: skip


WANTED_POT_LIFE_MIN = 20.0
"""Pot life that leaves time to stir, degas, load the syringe and fill [min]. An assumption."""
FILLING_SHARE = 0.5
"""Share of the pot life in which the mold must be full: stirring, degassing and loading take the rest."""


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
    name: str
    label: str
    cure: Cure
    components: tuple[str, str]
    ratio_by: RatioBasis
    parts_a: MaterialProperty
    """Parts of the first component in the mix ratio, by what `ratio_by` says."""
    parts_b: MaterialProperty
    viscosity_pa_s: MaterialProperty
    """Viscosity of the mixture at room temperature, right after stirring."""
    density_g_cm3: MaterialProperty
    shore_a: MaterialProperty | None
    """Hardness, Shore A; None if it is stated on another scale."""
    modulus_mpa: MaterialProperty
    """Young's modulus at small strain."""
    shrinkage_percent: MaterialProperty
    pot_life_min: MaterialProperty
    """Pot life at room temperature, from the start of stirring, as the card or the container states it."""
    cure_h: MaterialProperty
    """Time at room temperature until the skin can be demolded."""
    elongation_percent: MaterialProperty
    shore_00: MaterialProperty | None = None
    """Hardness, Shore 00; None if it is stated on another scale."""
    tensile_strength_mpa: MaterialProperty | None = None
    """Tensile strength; None if it is not known."""
    density_a_g_cm3: MaterialProperty | None = None
    """Density of the first component; needed only for a ratio by volume."""
    density_b_g_cm3: MaterialProperty | None = None

    @property
    def planned_pot_life_min(self) -> float:
        """Pot life that checks and casting sheet plan with [min].

        Of a range it is the least, but no less than `WANTED_POT_LIFE_MIN`, which the casting sheet asks for when the
        silicone is bought.
        """
        return min(max(self.pot_life_min.low, WANTED_POT_LIFE_MIN), self.pot_life_min.high)

    @property
    def filling_limit_s(self) -> float:
        """Time that the filling may take [s]: `FILLING_SHARE` of the planned pot life."""
        return FILLING_SHARE * self.planned_pot_life_min * 60.0

    def properties(self) -> dict[str, MaterialProperty]:
        """All known properties by field name, which carries the unit."""
        return {name: value for name, value in vars(self).items() if isinstance(value, MaterialProperty)}


def _unverified(low: float, high: float, source: str = "") -> MaterialProperty:
    return MaterialProperty(low, high, source, verified=False)


def _single(value: float, source: str) -> MaterialProperty:
    return MaterialProperty(value, value, source)


# Bulletins state the stress at 100 % strain. It is the low end of a modulus here; the high end is Young's modulus of a
# neo-Hookean rubber, which is 12/7 of it. A shrinkage stated as less than 0.1 % is the range 0 to 0.1 %.
SILICONES: dict[str, Silicone] = {
    silicone.name: silicone
    for silicone in (
        Silicone(
            "addition_40a", "addition-cure (platinum) silicone, 40 Shore A", "addition", ("part A", "part B"), "weight",
            parts_a=_unverified(10.0, 10.0, "common"),
            parts_b=_unverified(1.0, 1.0, "common"),
            viscosity_pa_s=_unverified(20.0, 35.0, "trade"),
            density_g_cm3=_unverified(1.08, 1.08, "common"),
            shore_a=_single(40.0, "article"),
            modulus_mpa=_unverified(0.7, 2.0, "common"),  # upper end: Ruess, lg E = 0.0235 S - 0.6403
            shrinkage_percent=_unverified(0.2, 0.2, "common"),
            pot_life_min=MaterialProperty(5.0, 40.0, "neat"),
            cure_h=MaterialProperty(2.0, 24.0, "neat"),
            elongation_percent=_unverified(250.0, 400.0),
        ),
        Silicone(
            "condensation_40a", "condensation-cure (tin) silicone, 40 Shore A", "condensation", ("base", "catalyst"),
            "weight",
            parts_a=_unverified(10.0, 10.0, "common"),
            parts_b=_unverified(1.0, 1.0, "common"),
            viscosity_pa_s=_unverified(20.0, 35.0, "trade"),
            density_g_cm3=MaterialProperty(1.07, 1.09, "stmpro"),
            shore_a=_single(40.0, "article"),
            modulus_mpa=_unverified(0.7, 2.0, "common"),
            shrinkage_percent=MaterialProperty(0.8, 1.2, "troll"),
            pot_life_min=MaterialProperty(5.0, 40.0, "neat"),
            cure_h=MaterialProperty(2.0, 24.0, "neat"),
            elongation_percent=_unverified(250.0, 400.0),
        ),
        Silicone(
            "smooth_sil_940", "Smooth-On Smooth-Sil 940", "addition", ("part A", "part B"), "weight",
            parts_a=_single(10.0, "smooth_sil_page"),
            parts_b=_single(1.0, "smooth_sil_page"),
            viscosity_pa_s=_unverified(35.0, 35.0, "recalled"),
            density_g_cm3=_unverified(1.18, 1.18, "recalled"),
            shore_a=_single(40.0, "smooth_sil_page"),
            modulus_mpa=_unverified(1.38, 2.36, "recalled"),
            shrinkage_percent=_unverified(0.0, 0.1, "recalled"),
            pot_life_min=_unverified(30.0, 30.0, "recalled"),
            cure_h=_unverified(24.0, 24.0, "recalled"),
            elongation_percent=_unverified(300.0, 300.0, "recalled"),
            tensile_strength_mpa=_unverified(4.1, 4.1, "recalled"),
        ),
        Silicone(
            "mold_star_30", "Smooth-On Mold Star 30", "addition", ("part A", "part B"), "volume",
            parts_a=_single(1.0, "mold_star_page"),
            parts_b=_single(1.0, "mold_star_page"),
            viscosity_pa_s=_unverified(12.5, 12.5, "recalled"),
            density_g_cm3=_unverified(1.12, 1.12, "recalled"),
            shore_a=_unverified(30.0, 30.0, "recalled"),
            modulus_mpa=_unverified(0.66, 1.13, "recalled"),
            shrinkage_percent=MaterialProperty(0.0, 0.1, "mold_star_tb"),
            pot_life_min=_single(45.0, "mold_star_page"),
            cure_h=_single(6.0, "mold_star_page"),
            elongation_percent=_unverified(339.0, 339.0, "recalled"),
            tensile_strength_mpa=_unverified(2.9, 2.9, "recalled"),
        ),
        Silicone(
            "dragon_skin_30", "Smooth-On Dragon Skin 30", "addition", ("part A", "part B"), "weight or volume",
            parts_a=_single(1.0, "dragon_skin_tb"),
            parts_b=_single(1.0, "dragon_skin_tb"),
            viscosity_pa_s=_single(20.0, "dragon_skin_tb"),
            density_g_cm3=_single(1.08, "dragon_skin_tb"),
            shore_a=_single(30.0, "dragon_skin_tb"),
            modulus_mpa=MaterialProperty(0.59, 1.02, "dragon_skin_tb"),
            shrinkage_percent=MaterialProperty(0.0, 0.1, "dragon_skin_tb"),
            pot_life_min=_single(45.0, "dragon_skin_tb"),
            cure_h=_single(16.0, "dragon_skin_tb"),
            elongation_percent=_single(364.0, "dragon_skin_tb"),
            tensile_strength_mpa=_single(3.45, "dragon_skin_tb"),
        ),
        Silicone(
            "elastosil_m4641", "Wacker Elastosil M 4641", "addition", ("component A", "component B"), "weight",
            parts_a=_unverified(10.0, 10.0, "recalled"),
            parts_b=_unverified(1.0, 1.0, "recalled"),
            viscosity_pa_s=_unverified(20.0, 35.0, "trade"),
            density_g_cm3=_unverified(1.07, 1.1, "recalled"),
            shore_a=_unverified(43.0, 43.0, "recalled"),
            modulus_mpa=_unverified(0.7, 2.0, "common"),
            shrinkage_percent=_unverified(0.0, 0.1, "recalled"),
            pot_life_min=_unverified(60.0, 90.0, "recalled"),
            cure_h=_unverified(12.0, 24.0, "recalled"),
            elongation_percent=_unverified(250.0, 400.0, "common"),
        ),
        Silicone(
            "sylgard_184", "Dow Sylgard 184", "addition", ("base", "curing agent"), "weight",
            parts_a=_single(10.0, "psi2022"),
            parts_b=_single(1.0, "psi2022"),
            viscosity_pa_s=_unverified(3.5, 4.0, "recalled"),
            density_g_cm3=_unverified(1.03, 1.03, "recalled"),
            shore_a=MaterialProperty(40.7, 42.7, "psi2022"),
            modulus_mpa=_single(2.0, "wang2014"),
            shrinkage_percent=_unverified(0.2, 0.2, "common"),
            pot_life_min=_unverified(90.0, 90.0, "recalled"),
            cure_h=_single(48.0, "niml"),
            elongation_percent=_single(140.0, "pmc"),
            tensile_strength_mpa=MaterialProperty(3.51, 7.65, "johnston2014"),
        ),
        Silicone(
            "ecoflex_00_30", "Smooth-On Ecoflex 00-30", "addition", ("part A", "part B"), "weight or volume",
            parts_a=_single(1.0, "ecoflex_tb"),
            parts_b=_single(1.0, "ecoflex_tb"),
            viscosity_pa_s=_single(3.0, "ecoflex_tb"),
            density_g_cm3=_single(1.07, "ecoflex_tb"),
            shore_a=None,
            modulus_mpa=MaterialProperty(0.069, 0.118, "ecoflex_tb"),
            shrinkage_percent=MaterialProperty(0.0, 0.1, "ecoflex_tb"),
            pot_life_min=_single(45.0, "ecoflex_tb"),
            cure_h=_single(4.0, "ecoflex_tb"),
            elongation_percent=_single(900.0, "ecoflex_tb"),
            shore_00=_single(30.0, "ecoflex_tb"),
            tensile_strength_mpa=_single(1.38, "ecoflex_tb"),
        ),
    )
}  # fmt: skip


def find_example(silicone: Silicone) -> dict[str, str] | None:
    """Find the product of the catalogue that comes nearest in hardness to a kind of silicone; None for a product.

    It has the same cure system and lasts as long as asked for. There is none for a kind that no product belongs to.
    """
    if silicone.name not in GENERIC or silicone.shore_a is None:
        return None
    wanted = silicone.shore_a.low
    found = [
        (abs(product.shore_a.low - wanted), name)
        for name, product in SILICONES.items()
        if name not in GENERIC and product.cure == silicone.cure and product.shore_a
        and product.pot_life_min.low >= WANTED_POT_LIFE_MIN
    ]  # fmt: skip
    return {"name": min(found)[1], "label": SILICONES[min(found)[1]].label} if found else None
