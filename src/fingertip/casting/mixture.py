"""Silicone to pour and to mix, with what stays on cup and stick."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.catalogues.materials import Silicone
from fingertip.design import Design
from fingertip.design.geometry.casting_layout import POURED
from fingertip.models.making import making_of
from fingertip.models.mold import cavity

WASTE_FRACTION = 0.25
"""Extra silicone, which stays on cup and stick, as a fraction of what is poured.
A project choice.
"""
MIN_COMPONENT_G = 2.0
"""Least mass of the lighter component [g]: half a step of a scale of 0.1 g is 2.5 % of it."""
MIN_MIX_G = 10.0
"""Minimum mass of a mixture [g].
Some 0.5 g stays unstirred on cup and stick, 5 % of this. An assumption.
"""


@dataclass(frozen=True)
class Mixture:
    """Quantities for one mixing cup, and what limits its use."""

    in_cup_g: float
    a_g: float
    b_g: float
    total_g: float
    """Mass to mix: with what stays on cup and stick, and enough to weigh and to stir."""
    components: tuple[str, str]
    density_g_cm3: float
    """Upper end of its range."""
    pot_life_min: float
    cure_h: float


def measure_poured_cm3(design: Design, evaluator: MeshEvaluator) -> float:
    """Measure the silicone to pour, with what overflows, on meshes. Raises GeometryError."""
    room = evaluator.manifold(cavity(design))
    core = evaluator.manifold(making_of(design).in_cup(design))
    return POURED * float(room.volume() - (room ^ core).volume()) / 1000.0


def parts_by_weight(silicone: Silicone) -> tuple[float, float]:
    """Return the parts of both components in the mix ratio by weight.

    A ratio by volume is converted, or taken for one by weight if no densities are known.
    """
    a = silicone.parts_a.low
    b = silicone.parts_b.low
    density_a = silicone.density_a_g_cm3
    density_b = silicone.density_b_g_cm3
    if silicone.ratio_by != "volume" or density_a is None or density_b is None:
        return a, b

    return a * density_a.middle, b * density_b.middle


def split_by_mix_ratio(silicone: Silicone, total_g: float) -> tuple[float, float]:
    """Split a total mass [g] into the masses of both components [g]."""
    a, b = parts_by_weight(silicone)
    fraction_b = b / (a + b)
    return total_g * (1.0 - fraction_b), total_g * fraction_b


def compute_batch(silicone: Silicone, volume_cm3: float) -> Mixture:
    """Compute what to mix for a volume [cm3]."""
    in_cup_g = silicone.density_g_cm3.high * volume_cm3
    to_weigh_g = MIN_COMPONENT_G / min(split_by_mix_ratio(silicone, 1.0))
    total_g = max(in_cup_g * (1.0 + WASTE_FRACTION), MIN_MIX_G, to_weigh_g)
    a_g, b_g = split_by_mix_ratio(silicone, total_g)

    return Mixture(
        in_cup_g=in_cup_g,
        a_g=a_g,
        b_g=b_g,
        total_g=total_g,
        components=silicone.components,
        density_g_cm3=silicone.density_g_cm3.high,
        pot_life_min=silicone.planned_pot_life_min,
        cure_h=silicone.cure_h.high,
    )


def mix(silicone: Silicone, volume_cm3: float) -> Mixture:
    """Compute what to mix for a volume [cm3], rounded to the 0.1 g that a scale reads."""
    exact = compute_batch(silicone, volume_cm3)
    a_g = round(exact.a_g, 1)
    b_g = round(exact.b_g, 1)

    return replace(
        exact,
        in_cup_g=round(exact.in_cup_g, 1),
        a_g=a_g,
        b_g=b_g,
        total_g=round(a_g + b_g, 1),
    )
