"""Fit of a design: parameters that follow from others are moved until every rule passes.

What is given stays, and so do measurements. Wall thicknesses, the place of the sensor, the collar
and the like move within sensible ranges. The search knows which parameters a broken rule reads: it
moves each of them to the nearest value with which that rule passes, and goes on with the most
promising design that it has found. Each value then moves back towards where it began, as far as the
rules allow. The same input gives the same design.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_follows, find_unit
from fingertip.design.refusal import find_remedies
from fingertip.design.rules.ruleset import BrokenRule, Rule, RuleChecker, find_violations
from fingertip.design.search import PART_RULES, cheapest_first, round_digits
from fingertip.foundation.errors import DesignError, Issue

Progress = Callable[[float], None]
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
"""Wishes of a file that may move in a second round, if the derived parameters alone do
not suffice.
"""
MOVABLE = (*DERIVED, *_WISHES)
_CHECKS = 1500
_FEW = 500
_CHECK = 5
_SLOWER = 4
"""Largest number of single rules that are checked in one round, for a refusal a few, the number
that a check of all counts for, and the number of prerequisites for which a rule counts once more:
those with many take long.
"""
_HALVINGS = 6
_BACK_HALVINGS = 5
_STRONG_HALVINGS = 2
"""Halvings of the way to the nearest value with which a rule passes,
back to the beginning, and to a stronger bone.
"""
_ROUNDS = 3
"""Largest number of times that the loads of a remedy become what its design holds."""
_SHARES = (1.0, 0.5, 0.25)
"""Shares of the way to the end of a parameter's range at which a rule is tried."""
_NEARER = 0.9
"""Part of a lack that may be left after a step towards a repair."""
_OF_MOVES = 0.3
"""Weight of the moves of a design, each relative to its range,
beside the number of rules that do not pass.
"""
LEAST_LOADS = {"strength.grip_force_n": 1.0, "strength.knock_speed_m_s": 0.01}
"""Loads that may become lower if they are not given, with the least that may be stated."""


@dataclass(frozen=True)
class Move:
    """Parameter that a fit has moved."""

    name: str
    before: Any
    after: Any
    reason: str
    """Rule that the former value would break, as a part of a sentence."""


@dataclass(frozen=True)
class Fit:
    """Design that passes, and what was moved for it."""

    tables: DesignTables
    moves: tuple[Move, ...]


@dataclass(frozen=True)
class Holds:
    """Judgement of what a design holds."""

    rules: tuple[Rule, ...]
    """Rules that cost little, checked beside those of the design."""
    judge: Callable[[DesignTables], Sequence[BrokenRule]]
    """Finds what is too weak in a design that passes all rules."""
    stronger: Mapping[str, float]
    """Factors on parameters that make it stronger."""


def fit_lengths(
    tables: DesignTables,
    given: Collection[str] = (),
    before: DesignTables | None = None,
    *,
    holds: Holds | None = None,
    progress: Progress = lambda share: None,
    guessed: Collection[str] = (),
) -> Fit:
    """Move the derived parameters of a design, but for those that are given, until its parts can be
    made.

    If they alone do not suffice, wishes that are not given move too. Measurements stay, but for
    those that are guessed.

    Raises DesignError. Its remedies lead what is given towards the design `before`. Typed in, they
    pass.
    """
    fit, weak = find_fit(
        tables,
        given=given,
        guessed=guessed,
        holds=holds,
        progress=progress,
    )
    if fit:
        return fit

    named = {broken.rule.field: broken for broken in weak}

    def settle(values: Mapping[str, Any]) -> dict[str, Any] | None:
        """Add the loads that a fit holds with the values of a remedy; None if no fit follows.

        Parts follow loads.
        """
        for _ in range(_ROUNDS):
            trial = tables.with_values(values)
            found, weak = find_fit(trial, given, guessed, holds, checks=_FEW, is_remedy=True)
            if found:
                return dict(values)

            named.update(
                {broken.rule.field: broken for broken in weak if broken.rule.field not in named}
            )
            values = {**values, **_find_bounds(weak)}
            if not weak:
                break

        return None

    if weak and (values := settle(_find_bounds(weak))):
        sides = {
            name: "least" if bound > tables.value(name) else "most"
            for name, bound in values.items()
        }
        texts = {
            name: f"{named[name].violation.problem}; at {sides[name]} {values[name]:g}."
            for name in values
        }
        raise DesignError([Issue(name, text) for name, text in texts.items()])

    broken = _Search(tables, {}).check({})[1] or weak
    issues = find_remedies(tables, broken, before, [*given], settle=settle)
    raise DesignError(
        [
            replace(one, message="(guessed) " * (one.field in guessed) + one.message)
            for one in issues
        ]
    )


def find_fit(
    tables: DesignTables,
    given: Collection[str] = (),
    guessed: Collection[str] = (),
    holds: Holds | None = None,
    progress: Progress = lambda share: None,
    checks: int = _CHECKS,
    is_early: bool = False,
    is_remedy: bool = False,
) -> tuple[Fit | None, Sequence[BrokenRule]]:
    """Find a design that passes as `fit_lengths` does; or else what is too weak in one that passes
    all rules.

    A search that gives up early moves no wish in place of what a whole one would have found. A fit
    that only proves a remedy names no moves, and its values may move further than they need.
    """
    derived = {
        **DERIVED,
        **{name: (0.8 * value, 1.2 * value) for name in guessed if (value := tables.value(name))},
    }
    weak: Sequence[BrokenRule] = ()

    for ranges in (derived, {**derived, **_WISHES})[: 1 if _WISHES.keys() <= set(given) else 2]:
        free = {
            name: (min(low, present), max(high, present))
            for name, (low, high) in ranges.items()
            if name not in given
            for present in [tables.value(name)]
        }
        search = _Search(tables, free)
        values = search.find_passing({}, progress, checks)

        if values is None:
            if is_early and search.count >= checks:
                break

            continue

        values = search.move_back(values)
        if holds and (found := holds.judge(tables.with_values(values))):
            search = _Search(tables, free, holds)
            nearer = search.find_passing(values, progress, checks)
            values = search.move_back(nearer) if nearer is not None else values
            strong = (
                search.strengthen(values, is_least=not is_remedy) if nearer is not None else None
            )

            if strong is None:
                found = holds.judge(tables.with_values(values))
                weak = [broken for broken in found if broken.rule.field not in free] or found
                if (_WISHES.keys() - {*given}) & {broken.rule.field for broken in found}:
                    continue

                break

            values = strong

        return Fit(tables.with_values(values), ()) if is_remedy else search.describe(values), ()

    return None, weak


def _find_bounds(weak: Sequence[BrokenRule]) -> dict[str, float]:
    """Find the values with which a design that is too weak holds, rounded inwards."""
    ends = ((broken.rule.field, *broken.violation.passing[0]) for broken in weak)
    return {
        name: round_digits(low if high == math.inf else high, 3, up=high == math.inf)
        for name, low, high in ends
    }


def list_moved(tables: DesignTables, given: Collection[str]) -> tuple[str, ...] | None:
    """Fit a design as `find_fit` does, but give up early, as a
    refusal does not wait; name what moved.
    """
    fit, _ = find_fit(tables, given, checks=_FEW, is_early=True)
    return tuple(move.name for move in fit.moves) if fit else None


class _Search:
    """Search for values of free parameters with which a design passes."""

    def __init__(self, tables: DesignTables, free: Ranges, holds: Holds | None = None) -> None:
        self._tables = tables
        self._free = free
        self._holds = holds
        self._held = holds.rules if holds else ()
        self._rules = (*cheapest_first(PART_RULES), *self._held)
        self._checked: dict[
            tuple[tuple[str, float], ...], tuple[float, tuple[BrokenRule, ...]]
        ] = {}
        self.count = 0

    def check(self, values: Values) -> tuple[float, tuple[BrokenRule, ...]]:
        """Return a score, the number of rules that do not pass and
        how far broken ones are from it, and these.
        """
        key = tuple(sorted(values.items()))
        if key not in self._checked:
            self.count += _CHECK
            checker = RuleChecker(self._tables.with_values(values))
            found = tuple(checker.find_broken(self._rules))
            failing = len(found)
            # Rules that a broken one hides count too. With wishes free, a search that counts them
            # finds fewer designs.
            if not self._free.keys() & _WISHES.keys():
                failing = sum(not checker.passes(rule) for rule in self._rules)

            self._checked[key] = failing + sum(map(_measure_lack, found)), found

        return self._checked[key]

    def passes(self, values: Values) -> bool:
        """Tell whether a design passes; one that does not takes less time than its score."""
        return next(find_violations(self._rules, self._tables.with_values(values)), None) is None

    def find_passing(
        self, begin: Values, progress: Progress, checks: int = _CHECKS
    ) -> dict[str, float] | None:
        """Find values that pass: always repair the most promising design, at its first
        broken rule.
        """
        order = itertools.count()
        queue = [(self.check(begin)[0] > 0.0, 0.0, next(order), dict(begin))]

        while queue and (self.count < checks or not queue[0][0]):
            *_, values = heapq.heappop(queue)
            broken = self.check(values)[1]
            if not broken:
                return values

            progress(self.count / checks)
            for repair in self._list_repairs(values, broken[0]):
                trial = {**values, **repair}
                if tuple(sorted(trial.items())) in self._checked:
                    continue

                score = self.check(trial)[0]
                heapq.heappush(
                    queue,
                    (
                        score > 0.0,
                        score + _OF_MOVES * self._measure_moves(trial),
                        next(order),
                        trial,
                    ),
                )

        return None

    def _list_repairs(self, values: Values, broken: BrokenRule) -> Iterator[dict[str, float]]:
        """List values of free parameters with which a rule passes, or
        is nearer to passing: of each, and of all.
        """
        lack = _measure_lack(broken)
        tables = self._tables.with_values(values)
        helpful = dict[str, float]()

        if broken.rule in self._held and (name := broken.rule.field) in self._free:
            bound = _find_bounds([broken])[name]
            if self._free[name][0] <= bound <= self._free[name][1]:
                yield {name: bound}
                return

        for name in sorted(broken.own_reads & self._free.keys()):
            present = tables.value(name)
            least = lack
            begin = self._tables.value(name)

            for end in self._free[name]:
                if (end - present) * (present - begin) < 0.0:
                    continue  # towards where another repair came from

                for share in _SHARES:
                    value = _round(name, present + share * (end - present))
                    if value == present:
                        break

                    left = self._lack_of(broken.rule, {**values, name: value})
                    if left < least:
                        helpful[name] = value
                        least = left

                    if left == 0.0:
                        yield self._approach({name: present}, {name: value}, values, broken.rule)
                        break

                    if left < _NEARER * lack:
                        yield {name: value}

        failing = {name: tables.value(name) for name in helpful}
        if len(helpful) > 1 and self._lack_of(broken.rule, {**values, **helpful}) == 0.0:
            yield self._approach(failing, helpful, values, broken.rule)

    def _lack_of(self, rule: Rule, values: Values) -> float:
        self.count += 1 + len(rule.prerequisites) // _SLOWER
        design = self._tables.with_values(values)
        checker = RuleChecker(design)
        if checker.passes(rule):
            return 0.0

        violation = checker.violations.get(rule)
        return _measure_lack(BrokenRule(rule, violation, design)) if violation else 1.0

    def _approach(
        self,
        failing: Values,
        passing: Values,
        rest: Values,
        rule: Rule | None = None,
        halvings: int = _HALVINGS,
    ) -> dict[str, float]:
        """Move passing values towards failing ones by bisection;
        one rule must pass beside the rest, or all.
        """
        for _ in range(halvings):
            middle = {
                name: _round(name, (failing[name] + value) / 2) for name, value in passing.items()
            }
            if middle in (failing, passing):
                break

            trial = {**rest, **middle}
            holds = self._lack_of(rule, trial) == 0.0 if rule else self.passes(trial)
            failing, passing = (failing, middle) if holds else (middle, passing)

        return dict(passing)

    def _measure_moves(self, values: Values) -> float:
        return sum(
            abs(value - float(self._tables.value(name)))
            / (self._free[name][1] - self._free[name][0])
            for name, value in values.items()
        )

    def move_back(self, values: Values) -> dict[str, float]:
        """Move each value back towards where it began, as far as the design passes."""
        values = dict(values)
        changed = True

        while changed:
            changed = False
            for name in sorted(values):
                rest = {other: value for other, value in values.items() if other != name}
                if self.passes(rest):
                    values = rest
                    changed = True
                    continue

                begin = {name: self._tables.value(name)}
                nearer = self._approach(begin, {name: values[name]}, rest, halvings=_BACK_HALVINGS)
                if nearer[name] != values[name]:
                    values = {**rest, **nearer}
                    changed = True

        return values

    def strengthen(self, values: Values, is_least: bool) -> dict[str, float] | None:
        """Make a design that passes all rules strong enough, or return
        None; `is_least` moves no more than needed.
        """
        if self._holds is None or not self._holds.judge(self._tables.with_values(values)):
            return dict(values)

        strong = dict(values)
        tables = self._tables.with_values(values)
        for name, factor in self._holds.stronger.items():
            is_used = name in self._free and ("post" not in name or tables.bone.interface == "post")
            for share in _SHARES if is_used else ():
                (low, high) = self._free[name]
                present = tables.value(name)
                end = min(max(present * factor, low), high)
                trial = {**strong, name: _round(name, present + share * (end - present))}

                if self.passes(trial):
                    strong = trial
                    break

        if not self._is_held(strong):
            return None
        if not is_least:
            return strong

        moved = {name: value for name, value in strong.items() if value != tables.value(name)}
        failing = {name: tables.value(name) for name in moved}
        for _ in range(_STRONG_HALVINGS):
            middle = {
                name: _round(name, (failing[name] + value) / 2) for name, value in moved.items()
            }
            failing, moved = (
                (failing, middle) if self._is_held({**values, **middle}) else (middle, moved)
            )

        moved = {**values, **moved}
        for name in sorted(moved):
            fewer = {other: value for other, value in moved.items() if other != name}
            moved = fewer if self._is_held(fewer) else moved

        return moved

    def _is_held(self, values: Values) -> bool:
        assert self._holds
        return self.passes(values) and not self._holds.judge(self._tables.with_values(values))

    def describe(self, values: Values) -> Fit:
        moves = []
        for name, value in sorted(values.items()):
            begin = self._tables.value(name)
            if value != begin:
                moves.append(Move(name, begin, value, self._explain({**values, name: begin})))

        return Fit(self._tables.with_values(values), tuple(moves))

    def _explain(self, values: Values) -> str:
        found = self.check(values)[1] or (
            self._holds.judge(self._tables.with_values(values)) if self._holds else ()
        )
        return next((f"{one.rule.field}: {one.violation.problem}" for one in found), "")


def _measure_lack(broken: BrokenRule) -> float:
    """Return how far a design is from passing a rule, below 1: by its
    field, where the rule names values that pass.
    """
    ends = [end for interval in broken.violation.passing for end in interval if math.isfinite(end)]
    if not ends:
        return (
            broken.violation.lack / (1.0 + broken.violation.lack)
            if math.isfinite(broken.violation.lack)
            else 1.0
        )

    present = float(broken.design.value(broken.rule.field))
    lack: float = min(abs(present - end) for end in ends) / max(1.0, abs(present))
    return lack / (1.0 + lack)


def _round(name: str, value: float) -> float:
    return round(value, 2 if find_unit(PARAMETERS[name]) else 3)
