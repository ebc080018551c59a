"""Bands of a parameter: the values with which a design passes every rule while its other parameters stay."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable

from fingertip.design.all_rules import RULES
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, find_unit, format_unit
from fingertip.design.refusal import Search, as_typed, cheapest_first, format_value
from fingertip.design.rules.ruleset import Rule, RuleChecker
from fingertip.foundation.errors import join_words

Band = tuple[float, float]
"""Lowest and highest value of a band; both pass."""
_POINTS = 6
"""Values within a band of the quick rules with which the rules that take long are checked."""


def find_bands(
    tables: DesignTables, name: str, tried: Collection[float] = (), still_wanted: Callable[[], None] = lambda: None
) -> tuple[Band, ...]:
    """Find the bands of a number, in ascending order; none if no value passes.

    A band that is narrower than the grid of a search may be missed, unless it holds the present value or another one
    that is `tried`. `still_wanted` is called before each value, and may raise.
    """
    # Rules that do not read the parameter are checked once, for all of its values.
    checker = RuleChecker(tables, frozenset({name}))
    readers = [rule for rule in RULES if not checker.passes(rule)]
    if checker.violations:
        return ()
    present = tables.value(name)
    grid = {*Search((), ()).list_grid(name, present), present, *tried}
    bands = _narrow(tables, name, grid, [rule for rule in readers if not _takes_long(rule)], still_wanted)
    slow = list(filter(_takes_long, readers))
    if not slow:
        return tuple(bands)
    found: list[Band] = []
    for low, high in bands:
        points = {low, high, *(as_typed(name, low + (high - low) * i / _POINTS) for i in range(1, _POINTS))}
        found += _narrow(
            tables, name, points | {value for value in (present, *tried) if low < value < high}, slow, still_wanted
        )
    return tuple(found)


def describe_bands(name: str, bands: Iterable[Band]) -> str:
    """Write bands as a part of a sentence, such as "16.5 to 22.1 mm"."""
    bounds = find_bounds(PARAMETERS[name])
    said = [
        format_value(name, low)
        if low == high
        else f"{format_value(name, low)} to {format_value(name, high)}"
        if bounds.above is None or low > bounds.above + 1.01e-6 * (bounds.maximum or 1.0)
        else f"above {bounds.above:g}, at most {format_value(name, high)}"
        for low, high in bands
    ]
    return join_words(said, "or") + format_unit(find_unit(PARAMETERS[name]))


def _takes_long(rule: Rule) -> bool:
    return rule.takes_long or any(map(_takes_long, rule.prerequisites))


def _narrow(
    tables: DesignTables, name: str, values: Iterable[float], rules: Iterable[Rule], still_wanted: Callable[[], None]
) -> list[Band]:
    """Find the runs of values that pass some rules, and refine the ends of each towards its neighbours that fail."""
    search, tried, bands = Search(cheapest_first(rules), ()), sorted(values), list[Band]()
    low: float | None = None
    for i, value in enumerate(tried):
        still_wanted()
        passes = search.passes(tables.with_values({name: value}))
        if passes and low is None:
            low = search.refine(tables, name, tried[i - 1], value) if i else value
        elif not passes and low is not None:
            bands.append((low, search.refine(tables, name, value, tried[i - 1])))
            low = None
    return bands if low is None else [*bands, (low, tried[-1])]
