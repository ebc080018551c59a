"""Margins of a design: how near its checks and its rules are to their limits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from fingertip.cad.verification.check import Check
from fingertip.design import Design
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, find_unit
from fingertip.design.rules.ruleset import SLACK, BrokenRule, RuleChecker
from fingertip.design.search import RULES
from fingertip.foundation.validation import Comparison, Relation

_TRIED: tuple[tuple[float, Relation], ...] = ((0.7, "at least"), (1.3, "at most"))
"""Shares of a value at which its rules are asked for their limits: what passes there too is not
near.
"""
_CHOSEN = 1e-4
"""Margin below which a value stands at a limit of a rule because it was chosen there [%]."""


def list_margins(design: Design, checks: Iterable[Check]) -> list[Comparison]:
    """List the checks and the rules of a design that compare a number with a limit, the nearest to
    it first.
    """
    limits = (limit for limit in _list_limits(design) if abs(limit.margin_percent) > _CHOSEN)
    compared = (
        comparison for comparison in (*checks, *limits) if comparison.margin_percent < math.inf
    )
    return sorted(compared, key=lambda comparison: comparison.margin_percent)


def _list_limits(design: Design) -> Iterator[Comparison]:
    """List the limits that rules set to a length or the like while all others stay, as far as they
    are near it.
    """
    fields = dict.fromkeys(
        rule.field for rule in RULES if isinstance(design.value(rule.field), float)
    )
    for field in fields:
        for share, relation in _TRIED:
            for broken in _try_share(design, field, share):
                yield from _limits_at(design, broken, relation)


def _try_share(design: Design, field: str, share: float) -> Iterator[BrokenRule]:
    """Find the rules of a field that break at a share of its value, or at the bound before it."""
    value = share * design.value(field)
    bounds = find_bounds(PARAMETERS[field])
    if bounds.contain(value):
        tried = design.with_values({field: value})
    else:
        tried = design.with_values({field: bounds.minimum if share < 1.0 else bounds.maximum})

    return RuleChecker(tried).find_broken(rule for rule in RULES if rule.field == field)


def _limits_at(design: Design, broken: BrokenRule, relation: Relation) -> Iterator[Comparison]:
    """List the ends, on the side of the broken rule, of the intervals in which a value passes."""
    field = broken.rule.field
    value = design.value(field)
    rule_name = broken.rule.check.__name__.replace("_", " ")
    for low, high in broken.violation.passing:
        if low - SLACK <= value <= high + SLACK:
            yield Comparison(
                name=f"{field}: {rule_name}",
                value=value,
                limit=low if relation == "at least" else high,
                unit=find_unit(PARAMETERS[field]),
                relation=relation,
            )
