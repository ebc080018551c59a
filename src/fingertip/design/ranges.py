"""Ranges of single parameters: from where to where one may change while all others stay."""

from __future__ import annotations

from functools import lru_cache

from fingertip.design.geometry import DesignTables
from fingertip.design.rules.ruleset import Rule, RuleChecker, find_violations, record_reads
from fingertip.design.search import RULES
from fingertip.foundation.numerics import bisect

_HALVINGS = 12


def find_range(design: DesignTables, path: str, ends: tuple[float, float]) -> tuple[float, float]:
    """Find the least and the largest number within bounds with which a design passes all rules."""
    low, high = (_find_last(design, path, end) for end in ends)
    return low, high


def _find_last(design: DesignTables, path: str, end: float) -> float:
    """Find the last number on the way to an end of its bounds that passes all rules, to 0.001."""
    value = design.value(path)

    def at(share: float) -> float:
        return float(round(value + share * (end - value), 3))

    if passes(design, path, at(0.999)) and passes(design, path, end):
        return end

    share, _ = bisect(lambda share: passes(design, path, at(share)), 0.0, 1.0, halvings=_HALVINGS)
    return at(share)


def passes(design: DesignTables, path: str, value: float) -> bool:
    """Return whether a design that passes all rules does so with another value of one parameter."""
    rules = _rules_by_parameter(design).get(path, ())
    return not any(find_violations(rules, design.with_values({path: value})))


@lru_cache(8)
def _rules_by_parameter(design: DesignTables) -> dict[str, list[Rule]]:
    """Find the rules that read each parameter: a change of it alone cannot break the others."""
    found: dict[str, list[Rule]] = {}
    for rule in RULES:
        tables, reads = record_reads(design)
        RuleChecker(tables).passes(rule)
        for path in reads:
            found.setdefault(path, []).append(rule)

    return found
