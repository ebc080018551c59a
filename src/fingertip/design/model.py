"""A design: all parameters of one fingertip, its board and its detector, validated as a whole and frozen."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fingertip.design.geometry.dimensions import Dimensions, compute_dimensions
from fingertip.design.issues import issues_from_pydantic
from fingertip.design.parameters import DesignTables, ParameterTable
from fingertip.design.rules import find_broken_rules
from fingertip.errors import DesignError, Issue


class Design(DesignTables):
    """One fingertip. Constructing it checks every bound and every rule, and raises all issues at once.

    Raises
    ------
    DesignError
        With one sentence for each parameter out of bounds, unknown name or broken rule.
    """

    def __init__(self, **tables: Any) -> None:
        try:
            super().__init__(**tables)
        except ValidationError as error:
            issues = issues_from_pydantic(error, type(self))
            raise DesignError([*issues, *_rules_beside(tables, issues)]) from None
        if issues := [issue for issue, _ in find_broken_rules(self)]:
            raise DesignError(issues)

    @classmethod
    def load(cls, *files: str | Path, changes: Iterable[str] = ()) -> Design:
        """Read a design: defaults, then each file, then changes such as ``"mold.draft_deg=2"``, the later winning.

        Raises
        ------
        DesignError
            If a file is missing or no valid TOML, or the design it gives is refused.
        """
        from fingertip.design.load import load_tables

        return cls(**load_tables(files, changes))

    @cached_property
    def dimensions(self) -> Dimensions:
        """Lengths that follow from the parameters."""
        return compute_dimensions(self)


def _rules_beside(tables: Mapping[str, Any], issues: Iterable[Issue]) -> list[Issue]:
    """Broken rules among the parameters that are in bounds, so that one run tells everything that is wrong."""
    faulty = {issue.field for issue in issues}
    fields: dict[str, Any] = {}
    for name, info in DesignTables.model_fields.items():
        table, default = tables.get(name), info.default
        if isinstance(default, ParameterTable):
            given = table if isinstance(table, Mapping) else {}
            known = type(default).model_fields
            kept = {k: v for k, v in given.items() if k in known and f"{name}.{k}" not in faulty}
            fields[name] = default.model_copy(update=kept)
        else:
            fields[name] = default
    return [issue for issue, reads in find_broken_rules(DesignTables.model_construct(**fields)) if not reads & faulty]
