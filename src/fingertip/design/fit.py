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

_FOLLOWS = {name: find_follows(info) for name, info in PARAMETERS.items()}
DERIVED: Ranges = {name: ends for name, ends in _FOLLOWS.items() if ends}
"""Parameters that follow from others -> range in which a fit may move them."""
_WISHES: Ranges = {
    "skin.length_mm": (20.0, 44.0),
    "skin.semi_axis_palmar_mm": (4.0, 12.0),
    "skin.thickness_palmar_mm": (2.0, 4.0),
    "skin.width_mm": (12.0, 26.0),
}
"""Wishes that may move in a second round, if the derived parameters alone do not suffice."""
MOVABLE = (*DERIVED, *_WISHES)
_CHECKS = 1500
"""Largest number of single rules that are checked in one round."""
_FEW = 500
"""The same for a refusal, which does not wait."""
_CHECK = 5
"""Number of single rules that a check of all rules counts for."""
_SLOWER = 4
"""A rule counts once more for each so many prerequisites: those with many take long."""
_HALVINGS = 6
"""Halvings of the way to the nearest value with which a rule passes."""
_BACK_HALVINGS = 5
"""Halvings of the way back to the beginning."""
_STRONG_HALVINGS = 2
"""Halvings of the way to a stronger bone."""
_ROUNDS = 3
"""Largest number of times that the loads of a remedy become what its design holds."""
_SHARES = (1.0, 0.5, 0.25)
"""Shares of the way to the end of a parameter's range at which a rule is tried."""
_NEARER = 0.9
"""Part of a lack that may be left after a step towards a repair."""
_OF_MOVES = 0.3
"""Weight of a design's moves, each relative to its range, beside the number of failing rules."""
LEAST_LOADS = {"strength.grip_force_n": 1.0, "strength.knock_speed_m_s": 0.01}
"""Loads that may become lower if they are not given -> least value that may be stated."""


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
    """Judgement of the loads that a design bears."""

    rules: tuple[Rule, ...]
    """Rules on strength that cost little, checked beside those of the design."""
    judge: Callable[[DesignTables], Sequence[BrokenRule]]
    """Function that finds what is too weak in a design that passes all rules."""
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
    """Move the derived parameters that are not `given`, until the parts can be made.

    If they alone do not suffice, wishes that are not given move too. Measurements stay, but for
    those that are `guessed`.

    Raises DesignError, whose remedies lead what is given towards the design `before`. They pass
    when they are typed in.
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

    by_field = {broken.rule.field: broken for broken in weak}

    def settle(values: Mapping[str, Any]) -> dict[str, Any] | None:
        """Add to the values of a remedy the loads that its fit bears; None if no fit follows."""
        for _ in range(_ROUNDS):
            trial = tables.with_values(values)
            fit, weak = find_fit(trial, given, guessed, holds, checks=_FEW, is_remedy=True)
            if fit:
                return dict(values)
            if not weak:
                return None

            for broken in weak:
                by_field.setdefault(broken.rule.field, broken)

            values = {**values, **_find_bounds(weak)}

        return None

    bounds = settle(_find_bounds(weak)) if weak else None
    if bounds:
        issues = []
        for name, bound in bounds.items():
            side = "least" if bound > tables.value(name) else "most"
            text = f"{by_field[name].violation.problem}; at {side} {bound:g}."
            issues.append(Issue(name, text))

        raise DesignError(issues)

    broken = _Search(tables, {}).check({})[1] or weak
    issues = find_remedies(tables, broken, before, [*given], settle=settle)
    raise DesignError([_mark_guess(issue, guessed) for issue in issues])


def _mark_guess(issue: Issue, guessed: Collection[str]) -> Issue:
    if issue.field not in guessed:
        return issue

    return replace(issue, message=f"(guessed) {issue.message}")


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
    """Find a design that passes as `fit_lengths` does.

    Returns the fit; or None, and what is too weak in a design that passes all other rules. With
    `is_early` the search gives up after so many checks, and does not go on to move wishes. A fit
    that only proves a remedy names no moves, and its values may move further than they need.
    """
    derived = dict(DERIVED)
    for name in guessed:
        value = tables.value(name)
        if value:
            derived[name] = (0.8 * value, 1.2 * value)

    rounds: list[Ranges] = [derived]
    if not _WISHES.keys() <= set(given):
        rounds.append({**derived, **_WISHES})

    weak: Sequence[BrokenRule] = ()
    for ranges in rounds:
        free = _list_free(tables, ranges, given)
        search = _Search(tables, free)
        values = search.find_passing({}, progress, checks)

        if values is None:
            if is_early and search.count >= checks:
                break

            continue

        values = search.move_back(values)
        if holds and holds.judge(tables.with_values(values)):
            search = _Search(tables, free, holds)
            nearer = search.find_passing(values, progress, checks)
            strong = None
            if nearer is not None:
                values = search.move_back(nearer)
                strong = search.strengthen(values, is_least=not is_remedy)

            if strong is None:
                too_weak = holds.judge(tables.with_values(values))
                weak = [broken for broken in too_weak if broken.rule.field not in free] or too_weak
                if (_WISHES.keys() - {*given}) & {broken.rule.field for broken in too_weak}:
                    continue

                break

            values = strong

        return Fit(tables.with_values(values), ()) if is_remedy else search.describe(values), ()

    return None, weak


def _list_free(tables: DesignTables, ranges: Ranges, given: Collection[str]) -> Ranges:
    """List the ranges of what is not given, each with the present value inside."""
    free = {}
    for name, (low, high) in ranges.items():
        if name not in given:
            present = tables.value(name)
            free[name] = (min(low, present), max(high, present))

    return free


def _find_bounds(weak: Sequence[BrokenRule]) -> dict[str, float]:
    """Find the values with which a design that is too weak bears its loads, rounded inwards."""
    bounds = {}
    for broken in weak:
        low, high = broken.violation.passing[0]
        is_least = high == math.inf
        bounds[broken.rule.field] = round_digits(low if is_least else high, 3, up=is_least)

    return bounds


def list_moved(tables: DesignTables, given: Collection[str]) -> tuple[str, ...] | None:
    """List the parameters that an early `find_fit` moves; None if it finds no fit."""
    fit, _ = find_fit(tables, given, checks=_FEW, is_early=True)
    return tuple(move.name for move in fit.moves) if fit else None


class _Search:
    """Search for values of free parameters with which a design passes."""

    def __init__(self, tables: DesignTables, free: Ranges, holds: Holds | None = None) -> None:
        self._tables = tables
        self._free = free
        self._holds = holds
        self._strength_rules = holds.rules if holds else ()
        self._rules = (*cheapest_first(PART_RULES), *self._strength_rules)
        self._checked: dict[_Key, tuple[float, tuple[BrokenRule, ...]]] = {}
        self.count = 0
        """Number of single rules that were checked."""

    def check(self, values: Values) -> tuple[float, tuple[BrokenRule, ...]]:
        """Check all rules, and return a score and the rules that are broken.

        The score is the number of rules that do not pass, and how far the broken ones are from it.
        """
        key = _make_key(values)
        if key not in self._checked:
            self.count += _CHECK
            checker = RuleChecker(self._tables.with_values(values))
            broken = tuple(checker.find_broken(self._rules))
            failing = len(broken)
            # Rules that a broken one hides count too. With wishes free, a search that counts them
            # finds fewer designs.
            if not self._free.keys() & _WISHES.keys():
                failing = sum(not checker.passes(rule) for rule in self._rules)

            self._checked[key] = failing + sum(map(_measure_lack, broken)), broken

        return self._checked[key]

    def passes(self, values: Values) -> bool:
        """Tell whether a design passes; this is quicker than its score if it does not."""
        return next(find_violations(self._rules, self._tables.with_values(values)), None) is None

    def find_passing(
        self, begin: Values, progress: Progress, checks: int = _CHECKS
    ) -> dict[str, float] | None:
        """Find values that pass: always repair the most promising design, at its first broken rule.

        Returns None if none was found within so many checks.
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
                if _make_key(trial) in self._checked:
                    continue

                score = self.check(trial)[0]
                cost = score + _OF_MOVES * self._measure_moves(trial)
                heapq.heappush(queue, (score > 0.0, cost, next(order), trial))

        return None

    def _list_repairs(self, values: Values, broken: BrokenRule) -> Iterator[dict[str, float]]:
        """Yield values of free parameters with which a rule passes, or is nearer to passing.

        Each parameter is moved alone, and then all that help together.
        """
        name = broken.rule.field
        if broken.rule in self._strength_rules and name in self._free:
            bound = _find_bounds([broken])[name]
            if self._free[name][0] <= bound <= self._free[name][1]:
                yield {name: bound}
                return

        tables = self._tables.with_values(values)
        helpful = dict[str, float]()
        for name in sorted(broken.own_reads & self._free.keys()):
            yield from self._move(name, values, broken, helpful)

        failing = {name: tables.value(name) for name in helpful}
        if len(helpful) > 1 and self._lack_of(broken.rule, {**values, **helpful}) == 0.0:
            yield self._approach(failing, helpful, values, broken.rule)

    def _move(
        self, name: str, values: Values, broken: BrokenRule, helpful: dict[str, float]
    ) -> Iterator[dict[str, float]]:
        """Yield values of one parameter that bring a rule nearer to passing.

        The best of them is stored in `helpful`.
        """
        lack = _measure_lack(broken)
        least = lack
        begin = self._tables.value(name)
        present = self._tables.with_values(values).value(name)

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
        """Move passing values towards failing ones by bisection.

        One rule must pass with them and the rest of the values, or all rules.
        """
        for _ in range(halvings):
            middle = _find_middle(failing, passing)
            if middle in (failing, passing):
                break

            trial = {**rest, **middle}
            is_passing = self._lack_of(rule, trial) == 0.0 if rule else self.passes(trial)
            if is_passing:
                passing = middle
            else:
                failing = middle

        return dict(passing)

    def _measure_moves(self, values: Values) -> float:
        """Add up how far parameters have moved, each relative to its range."""
        moves = 0.0
        for name, value in values.items():
            low, high = self._free[name]
            moves += abs(value - float(self._tables.value(name))) / (high - low)

        return moves

    def move_back(self, values: Values) -> dict[str, float]:
        """Move each value back towards where it began, as far as the design passes."""
        values = dict(values)
        changed = True

        while changed:
            changed = False
            for name in sorted(values):
                rest = _leave_out(values, name)
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
        """Make a design that passes all rules strong enough; None if no value suffices.

        With `is_least`, nothing moves more than it needs.
        """
        if self._holds is None or not self._holds.judge(self._tables.with_values(values)):
            return dict(values)

        strong = dict(values)
        tables = self._tables.with_values(values)
        for name, factor in self._holds.stronger.items():
            is_used = name in self._free and ("post" not in name or tables.bone.interface == "post")
            for share in _SHARES if is_used else ():
                low, high = self._free[name]
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
            middle = _find_middle(failing, moved)
            if self._is_held({**values, **middle}):
                moved = middle
            else:
                failing = middle

        moved = {**values, **moved}
        for name in sorted(moved):
            fewer = _leave_out(moved, name)
            moved = fewer if self._is_held(fewer) else moved

        return moved

    def _is_held(self, values: Values) -> bool:
        """Tell whether a design passes all rules and bears its loads."""
        assert self._holds
        return self.passes(values) and not self._holds.judge(self._tables.with_values(values))

    def describe(self, values: Values) -> Fit:
        """Return the fit with its moves, each with the rule that its former value would break."""
        moves = []
        for name, value in sorted(values.items()):
            begin = self._tables.value(name)
            if value != begin:
                moves.append(Move(name, begin, value, self._explain({**values, name: begin})))

        return Fit(self._tables.with_values(values), tuple(moves))

    def _explain(self, values: Values) -> str:
        """Describe the first rule that a design breaks, or the first load that it does not bear."""
        broken: Sequence[BrokenRule] = self.check(values)[1]
        if not broken and self._holds:
            broken = self._holds.judge(self._tables.with_values(values))

        return f"{broken[0].rule.field}: {broken[0].violation.problem}" if broken else ""


_Key = tuple[tuple[str, float], ...]


def _make_key(values: Values) -> _Key:
    return tuple(sorted(values.items()))


def _leave_out(values: Values, name: str) -> dict[str, float]:
    return {kept: value for kept, value in values.items() if kept != name}


def _find_middle(failing: Values, passing: Values) -> dict[str, float]:
    return {name: _round(name, (failing[name] + value) / 2) for name, value in passing.items()}


def _measure_lack(broken: BrokenRule) -> float:
    """Return how far a design is from passing a rule, from 0 to 1.

    It is measured by the rule's field where the rule names values that pass.
    """
    ends = filter(math.isfinite, itertools.chain.from_iterable(broken.violation.passing))
    distances = [abs(float(broken.design.value(broken.rule.field)) - end) for end in ends]
    if not distances:
        lack = broken.violation.lack
        return lack / (1.0 + lack) if math.isfinite(lack) else 1.0

    present = float(broken.design.value(broken.rule.field))
    relative = min(distances) / max(1.0, abs(present))
    return relative / (1.0 + relative)


def _round(name: str, value: float) -> float:
    return round(value, 2 if find_unit(PARAMETERS[name]) else 3)
