"""Fit of a design: parameters that follow from others are moved until every rule passes.

What is given stays, and so do measurements. Wall thicknesses, the place of the sensor, the collar and the like move
within sensible ranges. A seeded random search lowers the number of broken rules to zero: it moves a
value to where a broken rule says that it passes, or a few values at random. Each value then moves back towards where it
began, as far as the rules allow. The same input gives the same design.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_follows
from fingertip.design.refusal import find_remedies
from fingertip.design.rules.ruleset import BrokenRule, RuleChecker
from fingertip.design.search import PART_RULES, cheapest_first
from fingertip.foundation.errors import DesignError
from fingertip.foundation.numerics import bisect

Values = Mapping[str, float]
Ranges = Mapping[str, tuple[float, float]]

DERIVED: Ranges = {name: ends for name, info in PARAMETERS.items() if (ends := find_follows(info))}
"""Parameters that follow from others, with the range in which a fit may move each."""
_WISHES: Ranges = {
    "skin.length_mm": (20.0, 44.0),
    "skin.semi_axis_palmar_mm": (4.0, 12.0),
    "skin.thickness_palmar_mm": (2.0, 4.0),
    "skin.width_mm": (12.0, 26.0),
}
"""Wishes of a file that may move in a second round, if the derived parameters alone do not suffice."""
MOVABLE = (*DERIVED, *_WISHES)
_STEPS = 1200
"""Largest number of designs that one search tries."""


@dataclass(frozen=True)
class _Round:
    """Searches of one kind, each from the beginning with another seed."""

    searches: int
    repairs: float
    """Share of the steps that repair one rule instead of changing values at random."""
    patience: int
    """Number of designs without improvement after which a search ends."""
    choice: int
    """Number of designs that pass after which the round ends. The one that changes least is chosen."""


_ROUNDS = (_Round(6, 0.8, 60, choice=6), _Round(5, 0.5, 350, choice=1))
"""Rounds of the fit. A later one begins if none of the searches before found a design that passes."""
_BACK_STEPS = 8
"""Halvings by which a value moves back towards where it began."""


@dataclass(frozen=True)
class Move:
    """Parameter that a fit has moved."""

    name: str
    before: Any
    after: Any
    reason: str
    """What the former value would break, as a part of a sentence."""


@dataclass(frozen=True)
class Fit:
    """Design that passes, and what was moved for it."""

    tables: DesignTables
    moves: tuple[Move, ...]


Holds = Callable[[DesignTables], Sequence[BrokenRule]]
"""Judges a design that passes all rules: what is too weak, with the values that may hold; nothing if it holds."""


class _Judge:
    """Checks a design with other free lengths, and scores each set of them once."""

    def __init__(self, tables: DesignTables) -> None:
        self._tables, self._rules = tables, cheapest_first(PART_RULES)
        self._scores: dict[tuple[float, ...], float] = {}

    def score(self, values: Values, limit: float = math.inf) -> tuple[float, list[BrokenRule]]:
        """Return the score of a design and what it breaks, as far as the score stays within a limit.

        Each broken rule adds one, and more if it is far from repaired.
        """
        key, found, score = tuple(values.values()), list[BrokenRule](), 0.0
        if self._scores.get(key, 0.0) > limit:
            return self._scores[key], found
        for broken in RuleChecker(self._tables.with_values(values)).find_broken(self._rules):
            found.append(broken)
            score += 1.0 + _find_distance(broken)
            if score > limit:
                break
        self._scores[key] = score
        return score, found

    def passes(self, values: Values) -> bool:
        return self.score(values, 0.0)[0] == 0.0

    def explain(self, values: Values) -> str:
        found = self.score(values)[1]
        return f"{found[0].rule.field} {found[0].violation.problem}" if found else ""


def fit_design(
    tables: DesignTables,
    given: Collection[str] = (),
    before: DesignTables | None = None,
    *,
    holds: Holds | None = None,
    progress: Callable[[float], None] = lambda share: None,
) -> Fit:
    """Move the derived parameters of a design, but for those that are given, until its parts can be made.

    If they alone do not suffice, wishes that are not given move too. Measurements stay.

    Raises DesignError. Its remedies lead what is given towards the design `before`. Typed in, they pass.
    """
    begin = {name: float(tables.value(name)) for name in (*DERIVED, *_WISHES) if name not in given}
    judge = _Judge(tables)
    for ranges in (DERIVED, {**DERIVED, **_WISHES}):
        free = {name: (min(low, begin[name]), max(high, begin[name])) for name, (low, high) in ranges.items()
                if name in begin}  # fmt: skip
        values = _find_passing(free, {name: begin[name] for name in free}, judge, progress)
        if values is not None:
            break
    else:
        raise DesignError(find_remedies(tables, judge.score({})[1], before, [*given]))
    for _ in range(2):
        for name in free:
            values[name] = _move_back(name, begin[name], values, judge.passes)
    moves = (
        Move(name, begin[name], values[name], judge.explain({**values, name: begin[name]}))
        for name in free
        if values[name] != begin[name]
    )
    return Fit(tables.with_values(values), tuple(moves))


def _find_passing(
    free: Ranges, begin: Values, judge: _Judge, progress: Callable[[float], None]
) -> dict[str, float] | None:
    """Find free lengths that pass, of several the nearest to those at the beginning; None if no search finds any."""
    for number, kind in enumerate(_ROUNDS):
        reached: list[tuple[float, dict[str, float]]] = []
        for seed in range(kind.searches):
            progress((number + seed / kind.searches) / len(_ROUNDS))
            reached.append(_search(kind, seed, free, begin, judge))
            if sum(score == 0.0 for score, _ in reached) == kind.choice:
                break
        nearest, values = min(reached, key=lambda found: (found[0], _measure_change(free, begin, found[1])))
        if nearest == 0.0:
            return values
        # All searches end at a rule of the same fixed size: longer ones do not repair it either.
        blamed = ({broken.rule.field for broken in judge.score(found)[1]} - set(free) for _, found in reached)
        if set.intersection(*blamed):
            break
    return None


def _search(kind: _Round, seed: int, free: Ranges, begin: Values, judge: _Judge) -> tuple[float, dict[str, float]]:
    rng, values = random.Random(seed), dict(begin)
    best, found = judge.score(values)
    improved = 0
    for step in range(_STEPS):
        if best == 0.0 or step - improved > kind.patience:
            break
        repair = _list_repairs(found, free, values) if rng.random() < kind.repairs else []
        trial = {**values, **(rng.choice(repair) if repair else _change_at_random(rng, free, values))}
        score, found_now = judge.score(trial, best)
        if score <= best:
            improved = step if score < best else improved
            best, values, found = score, trial, found_now
    return best, values


def _measure_change(free: Ranges, begin: Values, values: Values) -> float:
    """Add up the changes of all values, each relative to its range."""
    return sum(abs(values[name] - begin[name]) / (high - low) for name, (low, high) in free.items())


def _change_at_random(rng: random.Random, free: Ranges, values: Values) -> dict[str, float]:
    """Change one to three values at random, mostly a little."""
    changed = {}
    for name in rng.sample(sorted(free), rng.randint(1, 3)):
        low, high = free[name]
        moved = values[name] + rng.gauss(0.0, 0.2) * (high - low) * rng.random()
        changed[name] = round(min(max(moved, low), high), 2)
    return changed


def _list_repairs(found: Sequence[BrokenRule], free: Ranges, values: Values) -> list[dict[str, float]]:
    """List the nearest value of each blamed field with which its rule says it passes, where the field is free."""
    repairs = []
    for rule in found:
        name = rule.rule.field
        if name in free:
            low, high = free[name]
            for start, end in rule.violation.passing:
                inside = math.ceil(100 * max(start, low) - 1e-6) / 100, math.floor(100 * min(end, high) + 1e-6) / 100
                if inside[0] <= inside[1]:
                    repairs.append({name: min(max(values[name], inside[0]), inside[1])})
    return repairs


def _find_distance(rule: BrokenRule) -> float:
    """Return how far a design is from passing a rule: below 0.9 if its field alone can repair it, else 1."""
    ends = [end for interval in rule.violation.passing for end in interval if math.isfinite(end)]
    present = float(rule.design.value(rule.rule.field)) if ends else 0.0
    return min((0.9, *(abs(present - end) / max(1.0, abs(present)) for end in ends))) if ends else 1.0


def _move_back(name: str, begin: float, values: Values, passes: Callable[[Values], bool]) -> float:
    """Move one value towards where it began, as far as the design passes; rounded to hundredths."""
    here = values[name]
    if here == begin or passes({**values, name: begin}):
        return begin

    def between(share: float) -> float:
        return round(here + share * (begin - here), 2)

    return between(bisect(lambda share: passes({**values, name: between(share)}), 0.0, 1.0, halvings=_BACK_STEPS)[0])
