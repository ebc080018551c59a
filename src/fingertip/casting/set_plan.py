"""Mixtures of a set: every mold is filled once, all on one day, from as few mixtures as the pot life allows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from fingertip.casting.quantities import Mixture, mix
from fingertip.catalogues.silicones import Silicone
from fingertip.design import Design
from fingertip.foundation.errors import Issue

STIR_MIN, MOLD_MIN = 4.0, 6.0
"""Time to stir a mixture, and to coat one mold, fill it and lower its core [min]. Assumptions: nobody has made one."""
_LONG_LIVED = "smooth_sil_940"


@dataclass(frozen=True)
class Pour:
    finger: str
    design: Design
    poured_cm3: float


@dataclass(frozen=True)
class Cup:
    """Silicone that is mixed at once, and the molds that it fills, in their order."""

    silicone: Silicone
    pours: tuple[Pour, ...]
    batch: Mixture


def plan_cups(pours: Sequence[Pour]) -> Iterator[Cup]:
    """Plan the mixtures of a set, none of which fills many more molds than another of its silicone."""
    silicones: dict[str, list[Pour]] = {}
    for pour in pours:
        silicones.setdefault(repr(pour.design.silicone), []).append(pour)
    for waiting in silicones.values():
        silicone = waiting[0].design.silicone.material
        count = math.ceil(len(waiting) / _count_molds(silicone))
        ends = [round(len(waiting) * number / count) for number in range(count + 1)]
        for start, end in pairwise(ends):
            taken = tuple(waiting[start:end])
            yield Cup(silicone, taken, mix(silicone, sum(pour.poured_cm3 for pour in taken)))


def find_short_pot_lives(designs: Iterable[Design]) -> Iterator[Issue]:
    """Report the silicones that thicken before they have filled one mold."""
    for design in designs:
        silicone = design.silicone.material
        if _count_molds(silicone) < 1:
            told = f"{silicone.name} thickens after {silicone.planned_pot_life_min:g} min, and to fill the mold of "
            told += (
                f"{design.name} takes {STIR_MIN + MOLD_MIN:g} min; it passes with --set silicone.product={_LONG_LIVED}."
            )
            yield Issue("silicone.product", told)


def _count_molds(silicone: Silicone) -> int:
    return max(0, math.floor((silicone.planned_pot_life_min - STIR_MIN) / MOLD_MIN))
