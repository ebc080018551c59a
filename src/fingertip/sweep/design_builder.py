"""Designs of a sweep's points: the base design with the point's parameters, refused where it breaks a rule.

The bounds of the parameters are checked together with the axes, before any point. If only electronic tables vary, the
rules of the printed parts give the same result at every point as for the base design, and so do the dimensions. Such a
point takes microseconds instead of milliseconds.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.design.model import Design
from fingertip.design.parameters.design_tables import ELECTRONIC_TABLES
from fingertip.design.rules import ELECTRONIC_RULES
from fingertip.design.validation import describe_violations
from fingertip.errors import DesignError
from fingertip.sweep.axes import Value
from fingertip.sweep.plan import SweepPlan


class DesignBuilder:
    """Builds the design of each point of a plan."""

    def __init__(self, plan: SweepPlan) -> None:
        self._names = [axis.name for axis in plan.axes if not axis.name.startswith("scene.")]
        self._only_electronics_vary = all(name.partition(".")[0] in ELECTRONIC_TABLES for name in self._names)
        self._tables = plan.design.model_dump()
        self._base = Design.model_construct(**dict(plan.design))

    def build(self, changes: Mapping[str, Value]) -> Design:
        """Build the design of a point.

        Raises
        ------
        DesignError
            With every rule that the design breaks, without remedies: finding these takes too long for a sweep.
        """
        if not self._only_electronics_vary:
            own_changes = {name: changes[name] for name in self._names}
            return Design.without_remedies(**apply_changes(self._tables, own_changes))
        tables: dict[str, dict[str, Any]] = {}
        for name in self._names:
            table, _, key = name.partition(".")
            tables.setdefault(table, {})[key] = changes[name]
        sections = {name: getattr(self._base, name).model_copy(update=new) for name, new in tables.items()}
        design = self._base.model_copy(update=sections)
        if issues := list(describe_violations(design, ELECTRONIC_RULES)):
            raise DesignError(issues)
        return design


def apply_changes(tables: dict[str, Any], changes: Mapping[str, Value]) -> dict[str, Any]:
    """Copy nested tables with dotted parameters changed; unchanged tables are shared with the original."""
    changed = dict(tables)
    for name, value in changes.items():
        table, _, key = name.rpartition(".")
        if table:
            changed[table] = {**changed[table], key: value}
        else:
            changed[key] = value
    return changed
