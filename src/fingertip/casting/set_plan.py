"""Casting plan of a set: rounds, in each of which every mold is filled once, and the cups that fill them.

What one cup holds must be in the molds before the silicone thickens, so a round takes as many cups as the pot life asks
for. Molds are filled one after the other, each with its own syringe: a manifold would feed the mold that resists least
first, and no prediction says that the others then fill.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, groupby
from typing import Any

from fingertip.casting.quantities import Batch, compute_batch
from fingertip.catalogues.silicones import Silicone
from fingertip.design import Design
from fingertip.foundation.errors import DesignError, Issue

CHANGE_S = 180.0
"""Time to prop up a filled mold, load the next syringe and take the next mold [s]. An assumption."""
PATCH_CM3 = 0.5
"""Silicone that patches the hole of a screw, with what stays in a small syringe [cm3]. An assumption."""


@dataclass(frozen=True)
class Mold:
    """Mold of a form: what it casts, and the figures of the casting sheet for one casting."""

    design: Design
    fingers: tuple[str, ...]
    volume_cm3: float
    load_cm3: float
    """Silicone in the syringe."""
    fill_s: float
    """Time to fill it, as the thumb pushes."""

    @classmethod
    def of_sheet(cls, design: Design, fingers: tuple[str, ...], casting: Mapping[str, Any]) -> Mold:
        filling = casting["filling"]
        fill_s = max(float(filling["fill_s"]), float(filling["push_s"]))
        return cls(design, fingers, casting["volumes_cm3"]["total"], filling["load_cm3"], fill_s)

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
    patched: tuple[str, ...]
    """Fingers of rounds before whose holes it patches after the castings."""
    batch: Batch

    @property
    def full_s(self) -> tuple[float, ...]:
        """Times from the first push to the end of each filling."""
        ends = accumulate(casting.mold.fill_s + CHANGE_S for casting in self.castings)
        return tuple(end - CHANGE_S for end in ends)

    @property
    def silicone(self) -> Silicone:
        return self.castings[0].mold.silicone


@dataclass(frozen=True)
class CastingPlan:
    rounds: tuple[tuple[Cup, ...], ...]
    tests: tuple[tuple[Silicone, Batch], ...]
    """Mixtures for the test of the cure, one of each product."""
    patches: tuple[tuple[Silicone, Batch, tuple[str, ...]], ...]
    """Mixtures for the patches that no later cup of their product fills, with their fingers."""
    cure_h: float
    """Hours in which silicone cures: the test, each round, and the last patches."""

    @property
    def cups(self) -> tuple[Cup, ...]:
        return tuple(cup for cups in self.rounds for cup in cups)

    @property
    def mixtures(self) -> tuple[tuple[Silicone, Batch], ...]:
        cups = ((cup.silicone, cup.batch) for cup in self.cups)
        return (*self.tests, *cups, *((silicone, batch) for silicone, batch, _ in self.patches))


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
    rounds, unpatched = list[tuple[Cup, ...]](), dict[str, list[str]]()
    for i in range(max(len(mold.fingers) for mold in molds)):
        castings = [Casting(mold.fingers[i], mold) for mold in molds if i < len(mold.fingers)]
        rounds.append(tuple(_fill_cups(castings, unpatched)))
        for casting in castings:
            if casting.mold.design.dimensions.chaplet:
                unpatched.setdefault(casting.mold.silicone.name, []).append(casting.finger)
    silicones = {mold.silicone.name: mold.silicone for mold in molds}
    patches = tuple(
        (silicones[name], compute_batch(silicones[name], PATCH_CM3 * len(fingers)), tuple(fingers))
        for name, fingers in unpatched.items()
    )
    waits = [tuple(silicones.values()), *(tuple(cup.silicone for cup in cups) for cups in rounds)]
    waits.append(tuple(silicone for silicone, _, _ in patches))
    return CastingPlan(
        tuple(rounds),
        tuple((silicone, compute_batch(silicone, 0.0)) for silicone in silicones.values()),
        patches,
        sum(max((silicone.cure_h.high for silicone in each), default=0.0) for each in waits),
    )


def _fill_cups(castings: Sequence[Casting], unpatched: dict[str, list[str]]) -> Iterator[Cup]:
    """Fill the molds of a round from as few cups as their silicones and pot lives allow, the slowest mold first.

    The first cup of a silicone also patches the fingers that wait for it, which are taken out of `unpatched`.
    """
    by_silicone = sorted(castings, key=lambda casting: (casting.mold.silicone.name, -casting.mold.fill_s))
    for name, group in groupby(by_silicone, key=lambda casting: casting.mold.silicone.name):
        waiting = list(group)
        while waiting:
            silicone, taken, elapsed_s = waiting[0].mold.silicone, list[Casting](), -CHANGE_S
            while waiting and elapsed_s + CHANGE_S + waiting[0].mold.fill_s <= silicone.filling_limit_s:
                elapsed_s += CHANGE_S + waiting[0].mold.fill_s
                taken.append(waiting.pop(0))
            patched = tuple(unpatched.pop(name, ()))
            patch_cm3 = PATCH_CM3 * len(patched)
            volume_cm3 = sum(casting.mold.volume_cm3 for casting in taken) + patch_cm3
            loaded_cm3 = sum(casting.mold.load_cm3 for casting in taken) + patch_cm3
            yield Cup(tuple(taken), patched, compute_batch(silicone, max(volume_cm3, loaded_cm3)))
