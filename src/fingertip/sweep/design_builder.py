"""The designs of a sweep: the base with a point's parameters, refused where it breaks a rule.

Bounds were checked with the axes. Where only the signal's tables vary, the rules that do not read them are as true of
every point as of the base, and so are the lengths: those points take microseconds, not milliseconds.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.design.model import Design
from fingertip.design.rules import RULES
from fingertip.design.rules.ruleset import Rule, broken_rules
from fingertip.errors import DesignError
from fingertip.sweep.axes import Value
from fingertip.sweep.plan import Plan

SIGNAL = frozenset({"board", "detector"})
"""Tables that no part's form depends on. A test holds the rules against what they say they read."""


class Designs:
    """Makes the design of each point of a plan."""

    def __init__(self, plan: Plan) -> None:
        self._names = [axis.name for axis in plan.axes if not axis.name.startswith("scene.")]
        self._quick = all(name.partition(".")[0] in SIGNAL for name in self._names)
        self._tables = plan.design.model_dump()
        if self._quick:
            self._base = Design.model_construct(**dict(plan.design))
            self._rules = signal_rules()

    def design(self, changes: Mapping[str, Value]) -> Design:
        """The design of a point.

        Raises
        ------
        DesignError
            With every rule it breaks.
        """
        if not self._quick:
            return Design(**changed(self._tables, {name: changes[name] for name in self._names}))
        tables: dict[str, dict[str, Any]] = {}
        for name in self._names:
            table, _, key = name.partition(".")
            tables.setdefault(table, {})[key] = changes[name]
        sections = {name: getattr(self._base, name).model_copy(update=new) for name, new in tables.items()}
        design = self._base.model_copy(update=sections)
        if issues := [issue for issue, _ in broken_rules(self._rules, design)]:
            raise DesignError(issues)
        return design


def signal_rules() -> list[Rule]:
    """The rules that read a table of the signal, in their order."""
    return [rule for rule in RULES if any(name.partition(".")[0] in SIGNAL for name in rule.reads)]


def changed(tables: dict[str, Any], changes: Mapping[str, Value]) -> dict[str, Any]:
    """A copy of nested tables with dotted changes; what is not changed is shared."""
    new = dict(tables)
    for name, value in changes.items():
        table, _, key = name.rpartition(".")
        if table:
            new[table] = {**new[table], key: value}
        else:
            new[key] = value
    return new
