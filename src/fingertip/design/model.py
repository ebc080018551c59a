"""A design: all parameters of one fingertip, its board and its detector, validated as a whole and frozen."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from pydantic import ValidationError

from fingertip.design.issues import issues_from_pydantic
from fingertip.design.parameters import DesignTables
from fingertip.design.rules import RULES
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.validation import describe_violations, explain_invalid, explain_violations
from fingertip.errors import DesignError


class Design(DesignTables):
    """One fingertip. Its construction checks every bound and every rule, and reports all issues at once.

    Raises
    ------
    DesignError
        With one message for each unknown name, each parameter out of bounds and each field that a broken rule blames.
        `fingertip.design.rules.remedies` states what the remedies in the messages promise.
    """

    def __init__(self, /, **tables: Any) -> None:
        self._validate(tables)

    @classmethod
    def load(cls, *files: str | Path, changes: Iterable[str] = ()) -> Self:
        """Read a design: the defaults, then each file, then changes such as "mold.draft_deg=2"; later values win.

        Raises
        ------
        DesignError
            If a file cannot be read, is not valid TOML or is of another kind, or if the design is refused.
        """
        from fingertip.design.load import load_tables

        loaded = load_tables(files, changes)
        return cls.from_tables(loaded.tables, loaded.before, loaded.changed)

    @classmethod
    def from_tables(
        cls, tables: Mapping[str, Any], before: Mapping[str, Any] | None = None, changed: Sequence[str] = ()
    ) -> Self:
        """Make a design of tables that were changed. If it is refused, the cause is sought among the changes.

        Parameters
        ----------
        tables
            Contents of a design file, with the changes.
        before
            Contents without the changes; the defaults if None.
        changed
            Names of the changed parameters, such as "skin.width_mm".

        Raises
        ------
        DesignError
            If the design is refused.
        """
        design = cls.__new__(cls)
        design._validate(tables, before, changed)
        return design

    @classmethod
    def without_remedies(cls, **tables: Any) -> Design:
        """Make a design as the constructor does, but refuse it faster: the messages contain no remedies.

        A sweep refuses thousands of designs, and needs to know only why.

        Raises
        ------
        DesignError
            If the design is refused.
        """
        try:
            valid = DesignTables(**tables)
        except ValidationError as error:
            raise DesignError(issues_from_pydantic(error, cls)) from None
        if issues := list(describe_violations(valid)):
            raise DesignError(issues)
        return cls.model_construct(None, **{name: getattr(valid, name) for name in cls.model_fields})

    def _validate(
        self, tables: Mapping[str, Any], before: Mapping[str, Any] | None = None, changed: Sequence[str] = ()
    ) -> None:
        """Fill in the tables, or raise `DesignError`."""
        try:
            super().__init__(**tables)
        except ValidationError as error:
            raise DesignError(explain_invalid(tables, error, changed)) from None
        if broken := list(find_violations(RULES, self)):
            raise DesignError(explain_violations(self, broken, before, changed))
