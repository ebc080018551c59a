"""Margins of a design: how near its checks and its rules are to their limits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from fingertip.cad.verification.check import Check
from fingertip.design import Design
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, find_unit
from fingertip.design.rules.ruleset import SLACK, RuleChecker
from fingertip.design.search import RULES
from fingertip.foundation.validation import Comparison, Relation

_TRIED: tuple[tuple[float, Relation], ...] = ((0.7, "at least"), (1.3, "at most"))
"""Shares of a value at which its rules are asked for their limits: what passes there too is not near."""

_CHOSEN = 1e-4
"""Margin below which a value stands at a limit of a rule because it was chosen there [%]."""


def list_margins(design: Design, checks: Iterable[Check]) -> list[Comparison]:
    """List the checks and the rules of a design that compare a number with a limit, the nearest to it first."""
    limits = (one for one in _list_limits(design) if abs(one.margin_percent) > _CHOSEN)
    compared = (one for one in (*checks, *limits) if one.margin_percent < math.inf)
    return sorted(compared, key=lambda one: one.margin_percent)


def _list_limits(design: Design) -> Iterator[Comparison]:
    """List the limits that rules set to a length or the like while all others stay, as far as they are near it."""
    for name in dict.fromkeys(rule.field for rule in RULES if isinstance(design.value(rule.field), float)):
        value, unit, bounds = design.value(name), find_unit(PARAMETERS[name]), find_bounds(PARAMETERS[name])
        for share, relation in _TRIED:
            tried = design.with_values({name: share * value})
            if not bounds.contain(share * value):
                tried = design.with_values({name: bounds.minimum if share < 1.0 else bounds.maximum})
            for broken in RuleChecker(tried).find_broken(rule for rule in RULES if rule.field == name):
                label = f"{name}: {broken.rule.check.__name__.replace('_', ' ')}"
                for low, high in broken.violation.passing:
                    if low - SLACK <= value <= high + SLACK:
                        yield Comparison(label, value, low if share < 1.0 else high, unit, relation)
