"""Rules between parameters: what a rule is, how rules are listed, and how a design is checked."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

from pydantic import BaseModel, create_model

from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS, ParameterTable
from fingertip.design.parameters.declaration import find_unit, format_unit

Model = TypeVar("Model", bound=BaseModel)

SLACK = 1e-6
"""Slack of the rules for lengths [mm].

A bound that is computed from other lengths carries rounding errors, and a design at the bound must
not fail because of them.
"""

Interval = tuple[float, float]
"""Closed interval of values of a field; an open end is infinite."""


def at_least(minimum: float) -> tuple[Interval, ...]:
    """Return the intervals of a violation that values from a minimum on would repair."""
    return ((minimum, math.inf),)


def at_most(maximum: float) -> tuple[Interval, ...]:
    """Return the intervals of a violation that values up to a maximum would repair."""
    return ((-math.inf, maximum),)


@dataclass(frozen=True)
class Violation:
    """Problem that a rule finds with a design."""

    problem: str
    """Value of the blamed field and what is wrong with it, without a final full stop."""
    passing: tuple[Interval, ...] = ()
    """Values of the blamed field that pass this rule if all other parameters stay; empty if the
    rule cannot tell. They may lie outside the field's own bounds, or break another rule.
    `fingertip.design.remedies` recommends none of them unchecked.
    """
    note: str = ""
    """Condition under which the bounds hold, such as "with this r5_ohm"."""
    alternatives: Mapping[str, Any] = field(default_factory=dict)
    """Values of other fields, each of which may pass instead."""
    lack: float = math.inf
    """Length by which a design misses the rule [mm], for one that names no values which pass."""


RuleFunction = Callable[[DesignTables], Violation | None]
"""Function that checks a design, and returns None if it passes."""
Condition = Callable[[DesignTables], object] | None
"""Function that tells whether a rule applies to a design; None for a rule that applies to all."""


@dataclass(frozen=True, eq=False)
class Rule:
    """Rule between parameters."""

    field: str
    """Parameter that it blames."""
    check: RuleFunction
    prerequisites: tuple[Rule, ...] = ()
    """Rules that must pass before this one is checked."""


class Limit(NamedTuple):
    """Limit of the blamed field in a design, and what a value beyond it does."""

    value: float
    problem: str
    """Rest of the sentence after the field's value and its unit, without a final full stop."""
    note: str = ""
    """Condition of the bounds, as in `Violation`."""
    alternatives: Mapping[str, Any] = MappingProxyType({})
    """Values of other fields, as in `Violation`."""


LimitFunction = Callable[[DesignTables], Limit | None]
"""Function that computes the limit of a field in a design; None where there is none."""
AddRule = Callable[[RuleFunction], Rule]
AddLimit = Callable[[LimitFunction], Rule]


class Ruleset(list[Rule]):
    """Rules of one subject, in the order in which they are written.

    All of them apply only to designs for which `when` is true.
    """

    def __init__(self, when: Condition = None) -> None:
        super().__init__()
        self._when = when

    def rule(self, field: str, *prerequisites: Rule, when: Condition = None) -> AddRule:
        """Add the decorated function as a rule that blames `field`.

        It is checked only if its prerequisites pass.
        """

        def add(check: RuleFunction) -> Rule:
            conditions = [condition for condition in (self._when, when) if condition]

            @functools.wraps(check)
            def check_if_it_applies(design: DesignTables) -> Violation | None:
                return check(design) if all(condition(design) for condition in conditions) else None

            self.append(Rule(field, check_if_it_applies if conditions else check, prerequisites))
            return self[-1]

        return add

    def at_most(
        self, field: str, *prerequisites: Rule, when: Condition = None, slack: float = SLACK
    ) -> AddLimit:
        """Add the decorated function as a rule: it returns the largest value of `field`."""
        return self._bound(
            field,
            prerequisites=prerequisites,
            when=when,
            passes=lambda value, limit: value <= limit + slack,
            passing=at_most,
        )

    def at_least(
        self, field: str, *prerequisites: Rule, when: Condition = None, slack: float = SLACK
    ) -> AddLimit:
        """Add the decorated function as a rule: it returns the least value of `field`."""
        return self._bound(
            field,
            prerequisites=prerequisites,
            when=when,
            passes=lambda value, limit: value >= limit - slack,
            passing=at_least,
        )

    def _bound(
        self,
        field: str,
        prerequisites: tuple[Rule, ...],
        when: Condition,
        passes: Callable[[float, float], bool],
        passing: Callable[[float], tuple[Interval, ...]],
    ) -> AddLimit:
        unit = format_unit(find_unit(PARAMETERS[field]))

        def add(find_limit: LimitFunction) -> Rule:
            @functools.wraps(find_limit)
            def check(design: DesignTables) -> Violation | None:
                limit = find_limit(design)
                if limit is None:
                    return None

                value = design.value(field)
                if passes(value, limit.value):
                    return None

                text = f"{value:g}{unit} {limit.problem}"
                return Violation(text, passing(limit.value), limit.note, limit.alternatives)

            return self.rule(field, *prerequisites, when=when)(check)

        return add


@dataclass(frozen=True)
class BrokenRule:
    """Rule that a design breaks."""

    rule: Rule
    violation: Violation
    design: DesignTables

    @cached_property
    def reads(self) -> frozenset[str]:
        """Parameters that decide the violation, those of the prerequisites included."""
        tables, reads = record_reads(self.design)
        RuleChecker(tables).passes(self.rule)
        return frozenset(reads)

    @cached_property
    def own_reads(self) -> frozenset[str]:
        """Parameters that the rule itself reads.

        One of these must change to repair the design: the prerequisites pass.
        """
        tables, reads = record_reads(self.design)
        self.rule.check(tables)
        return frozenset(reads)


class InvalidParameterError(Exception):
    """A rule reads a parameter whose own value is not valid."""


class RuleChecker:
    """Checks rules on one design, each at most once."""

    def __init__(self, design: DesignTables, invalid: frozenset[str] = frozenset()) -> None:
        self._design = design
        self._checked = record_reads(design, invalid)[0] if invalid else design
        self._passed: dict[Rule, bool] = {}
        self.violations: dict[Rule, Violation] = {}
        """Violations found so far."""

    def passes(self, rule: Rule) -> bool:
        """Check a rule after its prerequisites.

        A rule that cannot be checked does not pass, without a violation.
        """
        if rule not in self._passed:
            self._passed[rule] = all(map(self.passes, rule.prerequisites)) and self._check(rule)

        return self._passed[rule]

    def find_broken(self, rules: Iterable[Rule]) -> Iterator[BrokenRule]:
        """Check rules, and yield those that are broken."""
        for rule in rules:
            if not self.passes(rule) and rule in self.violations:
                yield BrokenRule(rule, self.violations[rule], self._design)

    def _check(self, rule: Rule) -> bool:
        try:
            violation = rule.check(self._checked)
        except InvalidParameterError:
            return False

        if violation:
            self.violations[rule] = violation

        return violation is None


def find_violations(
    rules: Iterable[Rule], design: DesignTables, invalid: frozenset[str] = frozenset()
) -> Iterator[BrokenRule]:
    """Check a design, and yield every rule that it breaks, in the order of `rules`.

    Rules that read an `invalid` parameter are skipped.
    """
    return RuleChecker(design, invalid).find_broken(rules)


def record_reads(
    design: DesignTables, invalid: frozenset[str] = frozenset()
) -> tuple[DesignTables, AbstractSet[str]]:
    """Return a copy of a design's tables, and a set to which each parameter is added that is read.

    What is derived, such as `dimensions`, is derived from the copy, so that the parameters behind
    it are added too. Reading a parameter that is `invalid`, itself or with its whole table, raises
    InvalidParameterError.
    """
    reads = set[str]()

    def note(path: str) -> None:
        reads.add(path)
        if not invalid.isdisjoint((path, path.partition(".")[0])):
            raise InvalidParameterError(path)

    fields = {name: getattr(design, name) for name in DesignTables.model_fields}
    for name, value in fields.items():
        if isinstance(value, ParameterTable):
            fields[name] = _derive_noting(type(value), f"{name}.").model_construct(**vars(value))
            vars(fields[name])[_NOTE] = note

    copy = _derive_noting(DesignTables, "").model_construct(**fields)
    vars(copy)[_NOTE] = note
    return copy, reads


_NOTE = "note"
"""Key of the function that tables call with the name of each parameter that is read."""


@functools.cache
def _derive_noting(model: type[Model], prefix: str) -> type[Model]:
    """Derive a class of tables whose parameters are properties that record that they are read."""
    noting = create_model(f"Noting{model.__name__}", __base__=model)
    for path in PARAMETERS.keys() & {f"{prefix}{key}" for key in model.model_fields}:
        setattr(
            noting, path.removeprefix(prefix), property(functools.partial(_note_and_read, path))
        )

    return noting


def _note_and_read(path: str, table: BaseModel) -> Any:
    vars(table)[_NOTE](path)
    return vars(table)[path.rpartition(".")[2]]
