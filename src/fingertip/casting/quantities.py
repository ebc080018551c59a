"""Quantities of a casting: silicone to pour and to mix, from the volume of the skin."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.skin import cavity, core_within_skin
from fingertip.catalogues.silicones import Silicone
from fingertip.design import Design
from fingertip.design.geometry.mold_layout import POURED

WASTE_FRACTION = 0.25
"""Extra silicone, which stays on cup and stick, as a fraction of what is poured. A project choice."""
MIN_COMPONENT_G = 2.0
"""Least mass of the lighter component, of which half a step of a scale that reads 0.1 g is 2.5 % [g]."""
MIN_MIX_G = 10.0
"""Minimum mass of a mixture [g]. Some 0.5 g stays unstirred on cup and stick, 5 % of this. An assumption."""


@dataclass(frozen=True)
class Batch:
    """Quantities for one mixing cup [g]."""

    in_mold_g: float
    total_g: float
    """Mass to mix: with what stays on cup and stick, and enough to weigh and to stir."""
    a_g: float
    b_g: float


def measure_poured_cm3(design: Design, evaluator: MeshEvaluator) -> float:
    """Measure the silicone to pour, with what overflows, on meshes. Raises GeometryError."""
    room, core = (evaluator.manifold(each(design)) for each in (cavity, core_within_skin))
    return POURED * float(room.volume() - (room ^ core).volume()) / 1000.0


def mass_g(silicone: Silicone, volume_cm3: float) -> float:
    """Mass [g] of a volume [cm3], at the upper end of the density range."""
    return silicone.density_g_cm3.high * volume_cm3


def parts_by_weight(silicone: Silicone) -> tuple[float, float]:
    """Return the mix ratio by weight; one by volume is converted, or taken as it is if no densities are known."""
    a, b = silicone.parts_a.low, silicone.parts_b.low
    densities = silicone.density_a_g_cm3, silicone.density_b_g_cm3
    if silicone.ratio_by != "volume" or None in densities:
        return a, b
    of_a, of_b = ((density.low + density.high) / 2 for density in densities if density)
    return a * of_a, b * of_b


def split_by_mix_ratio(silicone: Silicone, total_g: float) -> tuple[float, float]:
    """Split a total mass [g] into the masses of both components [g]."""
    a, b = parts_by_weight(silicone)
    fraction_b = b / (a + b)
    return total_g * (1.0 - fraction_b), total_g * fraction_b


def compute_batch(silicone: Silicone, volume_cm3: float) -> Batch:
    """Compute what to mix for a volume [cm3]."""
    in_mold_g = mass_g(silicone, volume_cm3)
    to_weigh_g = MIN_COMPONENT_G / min(split_by_mix_ratio(silicone, 1.0))
    total_g = max(in_mold_g * (1.0 + WASTE_FRACTION), MIN_MIX_G, to_weigh_g)
    return Batch(in_mold_g, total_g, *split_by_mix_ratio(silicone, total_g))


@dataclass(frozen=True)
class Mixture:
    """One mixture, as a person weighs it."""

    in_cup_g: float
    a_g: float
    b_g: float
    total_g: float
    components: tuple[str, str]
    density_g_cm3: float
    pot_life_min: float
    cure_h: float


def mix(silicone: Silicone, volume_cm3: float) -> Mixture:
    batch = compute_batch(silicone, volume_cm3)
    a_g, b_g = round(batch.a_g, 1), round(batch.b_g, 1)
    return Mixture(
        round(batch.in_mold_g, 1), a_g, b_g, round(a_g + b_g, 1), silicone.components, silicone.density_g_cm3.high,
        silicone.planned_pot_life_min, silicone.cure_h.high,
    )  # fmt: skip
