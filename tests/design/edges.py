"""Edges of parameters and rules: bounds, covering arrays of them,
and the last value that passes a rule.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, list_choices
from fingertip.design.rules.ruleset import Rule

NUMERIC = [name for name, info in PARAMETERS.items() if info.annotation in (float, int)]
WORDS = {
    name: list_choices(info) or (True, False)
    for name, info in PARAMETERS.items()
    if list_choices(info) or info.annotation is bool
}
DEFAULTS = DesignTables()


def find_ends(name: str) -> tuple[float, float]:
    """Lowest and highest value of a numeric parameter that its own bounds accept."""
    bounds = find_bounds(PARAMETERS[name])
    info = PARAMETERS[name]
    assert bounds.maximum is not None, f"{name} has no upper bound"
    low = bounds.minimum if bounds.minimum is not None else bounds.above
    assert low is not None, f"{name} has no lower bound"
    if bounds.minimum is None:
        low = math.nextafter(low, math.inf)
    return (
        (int(low), int(bounds.maximum))
        if info.annotation is int
        else (float(low), float(bounds.maximum))
    )


def list_levels() -> dict[str, tuple[Any, ...]]:
    """Levels of every parameter in a covering array: its ends and default, or all of its words."""
    levels = {
        name: tuple(dict.fromkeys((*find_ends(name), DEFAULTS.value(name)))) for name in NUMERIC
    }
    return levels | WORDS


def make_covering_array(
    levels: Mapping[str, Sequence[Any]], seed: int = 0
) -> Iterator[dict[str, Any]]:
    """Yield rows in which every pair of levels of two parameters occurs at least once.

    Each row begins with a pair that is still missing; every further parameter takes the level that
    completes most missing pairs with those before it.
    """
    rng = np.random.default_rng(seed)
    names = list(levels)
    counts = [len(levels[name]) for name in names]
    most = max(map(len, levels.values()))
    missing = np.zeros((len(names), len(names), most, most), dtype=bool)
    for a, b in itertools.combinations(range(len(names)), 2):
        missing[a, b, : counts[a], : counts[b]] = missing[b, a, : counts[b], : counts[a]] = True
    while missing.any():
        a, b, i, j = (int(place) for place in np.unravel_index(missing.argmax(), missing.shape))
        chosen = np.full(len(names), -1)
        chosen[a] = i
        chosen[b] = j
        for place in rng.permutation([place for place in range(len(names)) if place not in (a, b)]):
            before = np.flatnonzero(chosen >= 0)
            gains = missing[place, before, : counts[place], chosen[before]].sum(axis=0)
            chosen[place] = rng.choice(np.flatnonzero(gains == gains.max()))
        every = np.arange(len(names))
        missing[every[:, None], every[None, :], chosen[:, None], chosen[None, :]] = False
        yield {name: levels[name][level] for name, level in zip(names, chosen, strict=True)}


def applies(rule: Rule, tables: DesignTables) -> bool:
    """Whether a rule is checked on a design: all of its prerequisites pass."""
    return all(applies(one, tables) and one.check(tables) is None for one in rule.prerequisites)


def find_edge(
    rule: Rule, tables: DesignTables, name: str, broken: float, passing: float
) -> tuple[float, float] | None:
    """Bisect a parameter between values that break and pass a rule, down to neighbouring numbers.

    Returns
    -------
    tuple
        The last value that breaks the rule, and the first one that passes it; None if the
        prerequisites of the rule do not pass between them.
    """
    is_whole = PARAMETERS[name].annotation is int
    for _ in range(2000):
        middle: float = (broken + passing) // 2 if is_whole else (broken + passing) / 2
        if middle in (broken, passing):
            return broken, passing
        design = tables.with_values({name: middle})
        if not applies(rule, design):
            return None
        if rule.check(design) is None:
            passing = middle
        else:
            broken = middle
    raise AssertionError(f"no edge of {rule.field} in {name}")
