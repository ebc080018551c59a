"""Casting plan of a set: rounds, in each of which every mold is filled once, and the cups that fill them.

What one cup holds must be in the molds before the silicone thickens, so a round takes as many cups as the pot life asks
for. Molds are filled one after the other, each with its own syringe: a manifold would feed the mold that resists least
first, and no prediction says that the others then fill.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from fingertip.casting.quantities import Batch, compute_batch
from fingertip.catalogues.silicones import Silicone
from fingertip.design import Design
from fingertip.foundation.errors import DesignError, Issue

CHANGE_S = 120.0
"""Time to take the next mold and load its syringe [s]. An assumption."""


@dataclass(frozen=True)
class Mold:
    """Mold of a form: what it casts, and the figures of the casting sheet for one casting."""

    design: Design
    fingers: tuple[str, ...]
    volume_cm3: float
    load_cm3: float
    """Silicone in the syringe; 0 for a mold that gravity fills."""
    fill_s: float
    """Time to fill it: as the thumb pushes, or as the silicone flows by itself."""

    @classmethod
    def of_sheet(cls, design: Design, fingers: tuple[str, ...], casting: Mapping[str, Any]) -> Mold:
        """Take the figures from the data of a casting sheet."""
        filling = casting["filling"]
        pushed = filling["push_s"] if filling["syringe"] else 0.0
        fill_s = max(float(filling["fill_s"]), float(pushed))
        return cls(design, fingers, casting["volumes_cm3"]["total"], filling["load_cm3"] or 0.0, fill_s)

    @property
    def silicone(self) -> Silicone:
        return self.design.silicone.material


@dataclass(frozen=True)
class Casting:
    finger: str
    mold: Mold


@dataclass(frozen=True)
class Cup:
    """Silicone that is mixed at once, and the castings that it fills, in their order."""

    castings: tuple[Casting, ...]
    batch: Batch
    fill_s: float
    """Time from the first filling to the end of the last one."""

    @property
    def silicone(self) -> Silicone:
        return self.castings[0].mold.silicone


@dataclass(frozen=True)
class CastingPlan:
    rounds: tuple[tuple[Cup, ...], ...]
    tests: tuple[tuple[Silicone, Batch], ...]
    """Mixtures for the test of the cure, one of each product."""
    patches: tuple[tuple[Silicone, Batch], ...]
    """Mixtures for the patches that no later cup of their product can fill."""
    cure_h: float
    """Hours in which silicone cures: the test, each round, and the last patches."""

    @property
    def cups(self) -> tuple[Cup, ...]:
        return tuple(cup for cups in self.rounds for cup in cups)

    @property
    def mixtures(self) -> tuple[tuple[Silicone, Batch], ...]:
        """All mixtures in their order."""
        return (*self.tests, *((cup.silicone, cup.batch) for cup in self.cups), *self.patches)


def plan_castings(molds: Sequence[Mold]) -> CastingPlan:
    """Plan the castings of a set. Raises DesignError if a silicone thickens before it has filled one mold."""
    issues = [
        Issue(
            "silicone.product",
            f"{mold.silicone.name} must fill the mold of {mold.design.name} within {mold.silicone.filling_limit_s:.0f} "
            f"s, which takes {mold.fill_s:.0f} s; choose one with a longer pot life.",
        )
        for mold in molds
        if mold.fill_s > mold.silicone.filling_limit_s
    ]
    if issues:
        raise DesignError(issues)
    count = max(len(mold.fingers) for mold in molds)
    rounds = tuple(
        tuple(_fill_cups([Casting(mold.fingers[i], mold) for mold in molds if i < len(mold.fingers)]))
        for i in range(count)
    )
    silicones = {mold.silicone.name: mold.silicone for mold in molds}
    patched = {mold.silicone.name: mold.silicone for mold in molds if mold.design.dimensions.chaplet}
    waits = [silicones, *({cup.silicone.name: cup.silicone for cup in cups} for cups in rounds), patched]
    smallest = {name: (silicone, compute_batch(silicone, 0.0)) for name, silicone in silicones.items()}
    return CastingPlan(
        rounds,
        tuple(smallest.values()),
        tuple(smallest[name] for name in patched),
        sum(max((silicone.cure_h.high for silicone in each.values()), default=0.0) for each in waits),
    )


def _fill_cups(castings: Sequence[Casting]) -> Iterator[Cup]:
    """Fill the molds of a round from as few cups as their silicones and pot lives allow, the slowest mold first."""
    by_silicone = sorted(castings, key=lambda casting: (casting.mold.silicone.name, -casting.mold.fill_s))
    for _, group in groupby(by_silicone, key=lambda casting: casting.mold.silicone.name):
        waiting = list(group)
        while waiting:
            silicone, taken, elapsed_s = waiting[0].mold.silicone, list[Casting](), -CHANGE_S
            while waiting and elapsed_s + CHANGE_S + waiting[0].mold.fill_s <= silicone.filling_limit_s:
                elapsed_s += CHANGE_S + waiting[0].mold.fill_s
                taken.append(waiting.pop(0))
            volume, load = (
                sum(getattr(casting.mold, name) for casting in taken) for name in ("volume_cm3", "load_cm3")
            )
            yield Cup(tuple(taken), compute_batch(silicone, volume, load), elapsed_s)
