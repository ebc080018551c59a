"""Design: all parameters of one fingertip, its board and its detector, validated and frozen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from pydantic import PrivateAttr, ValidationError

from fingertip.design.design_file import Changes, list_parameters, load_tables, merge
from fingertip.design.fit import list_moved
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import parse_tables
from fingertip.design.refusal import describe_violations, explain_invalid, find_remedies, read_valid
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import RULES
from fingertip.foundation.display import html_table, to_dataframe
from fingertip.foundation.errors import DesignError, checked, raise_issues

if TYPE_CHECKING:
    import pandas

    from fingertip.design.fit import Move

MAX_SHOWN = 4
"""Largest number of parameters in the short form of a design."""


@dataclass(frozen=True)
class History:
    """Origin of the values of a design; it plays no part when designs are compared."""

    provisional: tuple[str, ...] = field(default=(), compare=False)
    moves: tuple[Move, ...] = field(default=(), compare=False)


class Design(DesignTables):
    """One fingertip.

    Its construction checks every bound and every rule, and reports all issues at once.

    Raises
    ------
    DesignError
        With one message for each unknown name, each parameter out of bounds and each field that a
        broken rule blames. `fingertip.design.remedies` states what the remedies in the messages
        promise.
    """

    _history: History = PrivateAttr(default_factory=History)

    def __init__(self, /, **tables: Any) -> None:
        self._validate(tables)

    @classmethod
    @checked
    def load(cls, *files: str | Path, changes: Changes = ()) -> Self:
        """Read a design: the defaults, then each file, then changes; later values win.

        A change is a text such as "skin.width_mm=18"; a mapping such as {"skin.width_mm": 18} holds
        several, each once.

        Raises
        ------
        DesignError
            If a file cannot be read, is not valid TOML or is of another kind, or if the design is
            refused.
        """
        loaded = load_tables(files, changes)
        return cls.from_tables(loaded.tables, loaded.before, loaded.changed, loaded.provisional)

    @classmethod
    def from_tables(
        cls,
        tables: Mapping[str, Any],
        before: Mapping[str, Any] | None = None,
        changed: Sequence[str] = (),
        provisional: Sequence[str] = (),
        moves: Sequence[Move] = (),
    ) -> Self:
        """Make a design of tables that were changed.

        `before` holds the tables without the changes, the defaults if None, and `changed` the names
        of what changed, such as "skin.width_mm". If the design is refused, the cause is sought
        among these. `moves` are those of the fit that made the tables. Raises DesignError.
        """
        design = cls.__new__(cls)
        design._validate(tables, before, changed)
        guessed = tuple(name for name in provisional if name not in changed)
        design._history = History(guessed, tuple(moves))

        return design

    @checked
    def replace(self, changes: Changes) -> Self:
        """Return the design with changes as those of `load`, checked as a whole.

        >>> Design().replace({"skin.width_mm": 18}).skin.width_mm
        18.0

        Raises
        ------
        DesignError
            If a change is not valid, or the design with all of them is refused.
        """
        loaded = load_tables((), changes)
        tables = self.model_dump()
        merge(tables, loaded.tables)

        return self.from_tables(tables, self.model_dump(), loaded.changed, self.provisional)

    @property
    def moves(self) -> tuple[Move, ...]:
        """Parameters that a fit moved, each with `name`, `before`, `after` and `reason`."""
        return self._history.moves

    @property
    def provisional(self) -> tuple[str, ...]:
        """Guessed sizes of the hand, and loads that `fingertip new` lowered, as the file marks."""
        return self._history.provisional

    @classmethod
    def without_remedies(cls, /, **tables: Any) -> Design:
        """Make a design as the constructor does, but refuse it faster, without remedies.

        A sweep refuses thousands of designs, and needs only the reasons. Raises DesignError.
        """
        design = cls.model_construct(None, **dict(parse_tables(DesignTables, tables)))
        raise_issues(DesignError, describe_violations(design))
        return design

    def changes(self) -> dict[str, Any]:
        """Return the parameters that differ from the default design, by dotted name."""
        values = {path: self.value(path) for path in PARAMETERS if path != "name"}
        return {path: value for path, value in values.items() if value != PARAMETERS[path].default}

    def __repr__(self) -> str:
        changed = [f"{path}={value!r}" for path, value in self.changes().items()]
        more = f", {len(changed) - MAX_SHOWN} more" if len(changed) > MAX_SHOWN else ""
        return f"Design({', '.join([repr(self.name), *changed[:MAX_SHOWN]])}{more})"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """Table of the parameters that differ from the default design, for Jupyter."""
        changed = self.changes()
        parameters = [parameter for parameter in list_parameters() if parameter.path in changed]
        rows = [
            (
                parameter.path,
                changed[parameter.path],
                parameter.default,
                parameter.unit,
                parameter.description,
            )
            for parameter in parameters
        ]
        count = f"{len(rows) or 'no'} parameter{' differs' if len(rows) == 1 else 's differ'}"
        caption = f"Design {self.name}: {count} from the default design"

        return html_table(caption, ("parameter", "value", "default", "unit", "meaning"), rows)

    def to_dataframe(self) -> pandas.DataFrame:
        """Return every parameter with value, default, unit, bounds, kind and description as a data
        frame.

        Raises
        ------
        MissingLibraryError
            If pandas is not installed.
        """
        parameters = list(list_parameters())
        columns = {
            "name": [parameter.path for parameter in parameters],
            "value": [self.value(parameter.path) for parameter in parameters],
        }
        for key in ("default", "unit", "bounds", "kind", "description"):
            columns[key] = [getattr(parameter, key) for parameter in parameters]

        return to_dataframe(columns, "Design.to_dataframe")

    def _validate(
        self,
        tables: Mapping[str, Any],
        before: Mapping[str, Any] | None = None,
        changed: Sequence[str] = (),
    ) -> None:
        try:
            super().__init__(**tables)
        except ValidationError as error:
            raise DesignError(explain_invalid(tables, error, changed)) from None

        broken = list(find_violations(RULES, self))
        if broken:
            raise DesignError(
                find_remedies(self, broken, read_valid(before), changed, fit=list_moved)
            )
