"""What a rule between parameters is, how rules are listed, and which of them a design breaks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from fingertip.design.parameters import DesignTables
from fingertip.errors import Issue

Check = Callable[[DesignTables], str | None]


@dataclass(frozen=True)
class Rule:
    """A check on a design: the field it blames, the fields it reads, the sentence it finds (None: passed)."""

    field: str
    reads: frozenset[str]
    check: Check


class Ruleset:
    """The rules of one module, in the order they are written there."""

    def __init__(self) -> None:
        self._rules: list[Rule] = []

    def rule(self, field: str, *reads: str) -> Callable[[Check], Check]:
        """Enlist the decorated check; it blames `field` and reads that and `reads`."""

        def enlist(check: Check) -> Check:
            self._rules.append(Rule(field, frozenset((field, *reads)), check))
            return check

        return enlist

    def __iter__(self) -> Iterator[Rule]:
        return iter(self._rules)


def broken_rules(rules: Iterable[Rule], design: DesignTables) -> Iterator[tuple[Issue, frozenset[str]]]:
    """Each broken rule's issue and the fields the rule reads; the first to break for a field speaks."""
    blamed: set[str] = set()
    for rule in rules:
        if rule.field not in blamed and (sentence := rule.check(design)):
            blamed.add(rule.field)
            yield Issue(rule.field, sentence), rule.reads


def rounded_down(value: float) -> str:
    """A positive `value` rounded down to four digits: a printed bound must pass when it is typed back in."""
    return _rounded(value, math.floor)


def rounded_up(value: float) -> str:
    """A positive `value` rounded up to four digits."""
    return _rounded(value, math.ceil)


def _rounded(value: float, towards: Callable[[float], int]) -> str:
    step = 10.0 ** (math.floor(math.log10(value)) - 3)
    # A value that has four digits already must not lose one to the division's last bit.
    return f"{towards(round(value / step, 6)) * step:.4g}"


SLACK = 1e-6
"""Bounds computed from other lengths carry rounding errors; a bound typed back in must not fail by one."""


def floor2(value: float) -> str:
    """A length rounded down to two decimals."""
    return f"{math.floor(value * 100 + 1e-9) / 100:g}"


def ceil2(value: float) -> str:
    """A length rounded up to two decimals."""
    return f"{math.ceil(value * 100 - 1e-9) / 100:g}"
