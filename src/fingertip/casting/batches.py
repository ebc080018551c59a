"""How much to mix: grams of A and B for a volume, with what stays in the cup."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.casting.materials import Silicone

WASTE_FRACTION = 0.25
"""This much more is mixed than goes into the mold: it stays on cup, stirrer and funnel. A choice of this project."""
MIN_PART_G = 1.0
"""The smaller part weighs at least this: a scale that shows 0.1 g then errs by 5% at most, and so does the ratio."""


@dataclass(frozen=True)
class Batch:
    """One mixing cup."""

    in_mold_g: float
    """What fills the mold."""
    total_g: float
    a_g: float
    b_g: float

    @property
    def waste_g(self) -> float:
        """What is left over."""
        return self.total_g - self.in_mold_g


def mass_g(card: Silicone, volume_cm3: float) -> float:
    """Mass [g] of a volume [cm3], at the upper end of the density."""
    return card.density_g_cm3.high * volume_cm3


def split(card: Silicone, total_g: float) -> tuple[float, float]:
    """Grams of A and of B that make `total_g` [g]."""
    share = card.parts_b.low / (card.parts_a.low + card.parts_b.low)
    return total_g * (1.0 - share), total_g * share


def batch(card: Silicone, volume_cm3: float) -> Batch:
    """What to mix to fill a volume [cm3]: with waste, and never less than can be weighed."""
    needed = mass_g(card, volume_cm3)
    a, b = split(card, 1.0)
    total = max(needed * (1.0 + WASTE_FRACTION), MIN_PART_G / min(a, b))
    return Batch(needed, total, *split(card, total))
