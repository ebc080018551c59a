"""All rules of a design, and the search for values of a parameter with which they pass.

A rule checks parameters that are each within their own bounds. The parameters that it reads are
recorded, not declared: if one of them is not valid by itself, the rule is skipped. So one mistake
gives one message, and all other rules are still checked. The values of a parameter with which a
design passes every rule while its other parameters stay are its bands.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fingertip.design import interfaces
from fingertip.design.geometry import DesignTables
from fingertip.design.interfaces import adapter, clevis_rules, flange, post_and_socket
from fingertip.design.parameters import ELECTRONIC_TABLES, PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, find_unit, format_unit
from fingertip.design.rules import amplifiers, board, bone, encapsulation, skin
from fingertip.design.rules.ruleset import Rule, RuleChecker, find_violations
from fingertip.foundation.errors import join_words
from fingertip.foundation.numerics import bisect

PART_RULES = (
    *skin.RULES,
    *bone.WALL_RULES,
    *interfaces.LENGTH_RULES,
    *clevis_rules.LENGTH_RULES,
    *bone.RULES,
    *post_and_socket.RULES,
    *flange.RULES,
    *clevis_rules.RULES,
    *adapter.RULES,
    *bone.MOLD_RULES,
    *encapsulation.RULES,
)
"""Rules of the printed parts and the skin. They read no electronic table."""
ELECTRONIC_RULES = (
    *board.CHANNEL_RULES,
    *board.RULES,
    *amplifiers.SUPPLY_RULES,
    *amplifiers.RULES,
    *board.SIGNAL_RULES,
    *skin.FORCE_CURVE_RULES,
)
"""Rules of the board and of slip detection. They read only the electronic tables."""
RULES = (*PART_RULES, *ELECTRONIC_RULES)

SMALLEST = 1e-300
"""Absolute value below which a number has no digits that count."""
_GRID_INTERVALS = 48
"""Intervals of the grid between a parameter's bounds."""
_HALVINGS = 9
"""Halvings of the interval between a failing and a passing value."""
_SHORT_DIGITS = (2, 3)
"""Significant digits of the short numbers that are tried in the last interval."""
_DIGITS = (3, 4, 5)
"""Significant digits to which a value that was found is rounded, if it passes then."""
Band = tuple[float, float]
"""Lowest and highest value of a band; both pass."""


@dataclass(frozen=True)
class Search:
    """Search for values near a design that pass all rules; each was checked."""

    rules: tuple[Rule, ...]
    """Rules to pass, the cheapest first."""
    suspects: tuple[Rule, ...]
    """Rules that are checked first, because they are likely to fail."""
    invalid: frozenset[str] = frozenset()
    """Parameters whose own values are not valid."""
    before: DesignTables | None = None
    """Design whose values are tried too."""

    def passes(self, tables: DesignTables) -> bool:
        """Tell whether a design passes all rules."""
        violations = find_violations((*self.suspects, *self.rules), tables, self.invalid)
        return next(violations, None) is None

    def nearest(self, tables: DesignTables, name: str) -> Any:
        """Find the passing value of a number that is nearest to its present one; None without one.

        The value is the nearest one on a grid between the parameter's bounds, which bisection then
        refines. A range of passing values that is narrower than the grid may be missed.
        """
        if not is_number(name) or name in self.invalid:
            return None

        present = tables.value(name)
        failing = {False: present, True: present}  # below and above the present value
        for value in self.list_grid(name, present):
            if self.passes(tables.with_values({name: value})):
                return self.refine(tables, name, failing[value > present], value)

            failing[value > present] = value

        return None

    def refine(
        self,
        tables: DesignTables,
        name: str,
        failing: float,
        passing: float,
    ) -> Any:
        """Move a passing value of a parameter towards a failing one by bisection, and round it."""

        def passes(value: float) -> bool:
            return self.passes(tables.with_values({name: value}))

        def between(share: float) -> float:
            """Return the value at a share of the way to passing, on a log scale if it is long."""
            if min(failing, passing) > 0.0 and max(failing, passing) > 4.0 * min(failing, passing):
                log = (1.0 - share) * math.log(failing) + share * math.log(passing)
                return as_typed(name, math.exp(log))

            return as_typed(name, failing + share * (passing - failing))

        below, share = bisect(
            lambda share: not passes(between(share)), 0.0, 1.0, halvings=_HALVINGS
        )
        best = passing if share == 1.0 else between(share)
        last_failing = between(below)

        # A bound is often a short number, which then lies between the last failing and the last
        # passing value.
        for digits in _SHORT_DIGITS:
            short = as_typed(name, round_digits(best, digits, up=best < failing))
            is_between = min(last_failing, best) <= short <= max(last_failing, best)
            if is_between and find_bounds(PARAMETERS[name]).contain(short) and passes(short):
                return short

        for digits in _DIGITS:
            rounded = as_typed(name, round_digits(best, digits, up=best > failing))
            if find_bounds(PARAMETERS[name]).contain(rounded) and passes(rounded):
                return rounded

        return best

    def list_grid(self, name: str, present: float) -> Sequence[float]:
        """List values between the parameter's bounds, the nearest to the present one first."""
        bounds = find_bounds(PARAMETERS[name])
        high = bounds.maximum if bounds.maximum is not None else 2.0 * abs(present) + 1.0
        low = bounds.minimum if bounds.minimum is not None else (bounds.above or 0.0) + 1e-6 * high
        is_wide = low > 0.0 and high / low > 300.0
        shares = [i / _GRID_INTERVALS for i in range(_GRID_INTERVALS)]
        values = [
            low * (high / low) ** share if is_wide else low + (high - low) * share
            for share in shares
        ]
        values += [high, PARAMETERS[name].default]
        if self.before is not None:
            values.append(self.before.value(name))

        inside = {as_typed(name, value) for value in values if bounds.contain(value)} - {present}

        def distance(value: float) -> float:
            return (
                abs(math.log(value / present))
                if is_wide and present > 0.0
                else abs(value - present)
            )

        return sorted(inside, key=lambda value: (distance(value), value))


def is_number(name: str) -> bool:
    return PARAMETERS[name].annotation in (float, int)


def as_typed(name: str, value: float) -> float:
    """Return a value as the type of its parameter: some are whole numbers."""
    return round(value) if PARAMETERS[name].annotation is int else value


def round_inwards(name: str, value: float, up: bool) -> float:
    """Round a bound inwards: to four digits in electronic tables, else to two decimals."""
    if PARAMETERS[name].annotation is int:
        return math.ceil(value - 1e-9) if up else math.floor(value + 1e-9)
    if _is_electronic(name):
        return round_digits(value, 4, up)

    return (math.ceil(value * 100 - 1e-9) if up else math.floor(value * 100 + 1e-9)) / 100


def round_digits(value: float, digits: int, up: bool) -> float:
    """Round a number up or down to so many significant digits."""
    if value == 0.0 or math.isinf(value):
        return value
    if abs(value) < SMALLEST:  # has no more digits to round
        return 0.0 if up == (value < 0.0) else math.copysign(SMALLEST, value)

    step = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)
    # A value that has so few digits already must not lose one to the division's last bit.
    count = round(value / step, 6)
    return float(f"{(math.ceil(count) if up else math.floor(count)) * step:.{digits}g}")


def format_value(name: str, value: Any) -> str:
    """Write a value so that it is the same number when it is typed in."""
    if not isinstance(value, float):
        return str(value)

    text = f"{value:.4g}" if _is_electronic(name) else f"{value:g}"
    return text if float(text) == value else repr(value)


def join_assignments(values: Mapping[str, Any]) -> str:
    """Write values as they are typed after --set, such as "skin.width_mm=18 and bone.wall_mm=1"."""
    return join_words(f"{name}={format_value(name, value)}" for name, value in values.items())


def cheapest_first(rules: Iterable[Rule]) -> tuple[Rule, ...]:
    """Order rules by their cost: those that measure the silicone have most prerequisites."""
    return tuple(sorted(rules, key=lambda rule: len(rule.prerequisites)))


def _is_electronic(name: str) -> bool:
    return name.partition(".")[0] in ELECTRONIC_TABLES


def find_bands(
    tables: DesignTables,
    name: str,
    tried: Collection[float] = (),
    still_wanted: Callable[[], None] = lambda: None,
) -> tuple[Band, ...]:
    """Find the bands of a number, in ascending order; none if no value passes.

    A band that is narrower than the grid of a search may be missed, unless it holds the present
    value or one of those `tried`. `still_wanted` is called before each value, and may raise.
    """
    # Rules that do not read the parameter are checked once, for all of its values.
    checker = RuleChecker(tables, frozenset({name}))
    readers = [rule for rule in RULES if not checker.passes(rule)]
    if checker.violations:
        return ()

    present = tables.value(name)
    search = Search(cheapest_first(readers), ())
    values = sorted({*search.list_grid(name, present), present, *tried})
    bands = list[Band]()
    low = None

    for i, value in enumerate(values):
        still_wanted()
        passes = search.passes(tables.with_values({name: value}))
        if passes and low is None:
            low = search.refine(tables, name, values[i - 1], value) if i else value
        elif not passes and low is not None:
            bands.append((low, search.refine(tables, name, value, values[i - 1])))
            low = None

    return tuple(bands) if low is None else (*bands, (low, values[-1]))


def describe_bands(name: str, bands: Iterable[Band]) -> str:
    """Write bands as a part of a sentence, such as "16.5 to 22.1 mm"."""
    texts = [_describe_band(name, low, high) for low, high in bands]
    return join_words(texts, "or") + format_unit(find_unit(PARAMETERS[name]))


def _describe_band(name: str, low: float, high: float) -> str:
    if low == high:
        return format_value(name, low)

    # The grid begins just above a bound that a value must exceed.
    bounds = find_bounds(PARAMETERS[name])
    if bounds.above is not None and low <= bounds.above + 1.01e-6 * (bounds.maximum or 1.0):
        return f"above {bounds.above:g}, at most {format_value(name, high)}"

    return f"{format_value(name, low)} to {format_value(name, high)}"
