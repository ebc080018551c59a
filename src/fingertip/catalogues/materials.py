"""Catalogues of silicones for the skin and of materials for printed parts, with the source of every
figure.

They are read from `silicones.toml` and `print_materials.csv`. The strength of a print falls with
temperature, moisture, age and a poor post-cure: no figure here includes that.
"""

from __future__ import annotations

import functools
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Self, cast

from fingertip.foundation.tables import load_table, read_rows

Cure = Literal["addition", "condensation"]
"""Cure system: addition (platinum) or condensation (tin). Addition cure shrinks least, but uncured
resin inhibits it. Condensation cure is not inhibited.
"""
RatioBasis = Literal["weight", "volume", "weight or volume"]
"""Basis on which the maker states the mix ratio; "weight or volume" if both are allowed."""

GENERIC = frozenset(("addition_40a", "condensation_40a"))
"""Names that stand for a kind of silicone, not for a product."""

WANTED_POT_LIFE_MIN = 20.0
"""Pot life that leaves time to stir, coat, pour and lower the core [min]. An assumption."""


@dataclass(frozen=True)
class MaterialProperty:
    """Range of a material property; a single value where both ends are equal."""

    low: float
    high: float
    source: str
    """Key of a source of the catalogue."""
    verified: bool = True

    @property
    def middle(self) -> float:
        return (self.low + self.high) / 2

    @classmethod
    def from_table(
        cls,
        *,
        value: float | None = None,
        low: float | None = None,
        high: float | None = None,
        source: str = "",
        verified: bool = True,
    ) -> Self:
        """Return the property that a table of `silicones.toml` states, by value or by range.

        Raises ValueError if it states both, or neither.
        """
        if value is not None and low is None and high is None:
            return cls(float(value), float(value), source, verified)
        if value is None and low is not None and high is not None:
            return cls(float(low), float(high), source, verified)

        raise ValueError("a property has a value, or a low and a high end")


@dataclass(frozen=True)
class Silicone:
    """Silicone for the skin: a product, or a kind of products such as `addition_40a`."""

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
    modulus_mpa: MaterialProperty
    """Young's modulus at small strain."""
    shrinkage_percent: MaterialProperty
    pot_life_min: MaterialProperty
    """Pot life at room temperature, from the start of stirring, as the container states it."""
    cure_h: MaterialProperty
    """Time at room temperature until the skin can be demolded."""
    elongation_percent: MaterialProperty
    shore_a: MaterialProperty | None = None
    """Hardness, Shore A; None if it is stated on another scale."""
    shore_00: MaterialProperty | None = None
    tensile_strength_mpa: MaterialProperty | None = None
    density_a_g_cm3: MaterialProperty | None = None
    """Density of the first component; needed only for a ratio by volume."""
    density_b_g_cm3: MaterialProperty | None = None

    @property
    def planned_pot_life_min(self) -> float:
        """Pot life that the casting sheet plans with [min].

        It is the least of a range, or `WANTED_POT_LIFE_MIN` where the range reaches that far.
        """
        return min(max(self.pot_life_min.low, WANTED_POT_LIFE_MIN), self.pot_life_min.high)

    def properties(self) -> dict[str, MaterialProperty]:
        """All known properties by field name, which carries the unit."""
        return {
            name: value for name, value in vars(self).items() if isinstance(value, MaterialProperty)
        }


@functools.cache
def _load() -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name("silicones.toml").read_text(encoding="utf-8"))


def load_sources() -> dict[str, str]:
    """Load the sources of the figures: key -> title."""
    return cast(dict[str, str], _load()["sources"])


@functools.cache
def load_silicones() -> dict[str, Silicone]:
    """Load the catalogue: name -> silicone, in the order of the file."""
    rows = []
    for name, table in _load()["silicones"].items():
        properties = {
            field: MaterialProperty.from_table(**cell)
            for field, cell in table.items()
            if isinstance(cell, dict)
        }
        rows.append({"name": name, **table, **properties})

    return {silicone.name: silicone for silicone in load_table(Silicone, rows)}


def find_example(silicone: Silicone) -> Silicone | None:
    """Find the product that comes nearest in hardness to a kind of silicone.

    It cures by the same system and leaves `WANTED_POT_LIFE_MIN`. Returns None for a product, and
    for a kind without such a product.
    """
    if silicone.name not in GENERIC or silicone.shore_a is None:
        return None

    shore_a = silicone.shore_a.low
    by_distance = {
        (abs(product.shore_a.low - shore_a), name): product
        for name, product in load_silicones().items()
        if name not in GENERIC
        and product.cure == silicone.cure
        and product.shore_a
        and product.pot_life_min.low >= WANTED_POT_LIFE_MIN
    }
    return by_distance[min(by_distance)] if by_distance else None


Process = Literal["sla", "fdm", "powder"]


@dataclass(frozen=True)
class PrintMaterial:
    """Material of the printed parts."""

    name: str
    product: str
    """Name to buy it by."""
    remark: str
    """Note on how it is printed; empty for a material of one's own."""
    process: Process
    """Printer that it is for: resin, filament or powder bed."""
    strength_mpa: float
    """Tensile strength across the layers of a bone [MPa], the lower end of a range."""
    modulus_mpa: float
    density_g_cm3: float
    """Density of a print without hollows; no document of a product was found for any."""
    source: str
    verified: tuple[str, ...]
    """Names of the figures that the source confirms."""

    @property
    def label(self) -> str:
        return f"{self.product} ({self.remark})" if self.remark else self.product


PRINT_MATERIALS = {
    material.name: material
    for material in load_table(
        PrintMaterial, read_rows(Path(__file__).with_name("print_materials.csv"))
    )
}
