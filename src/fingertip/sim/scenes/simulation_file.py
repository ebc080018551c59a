"""What every scene file has in common: all issues at once, rules between parameters among them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fingertip.design.issues import issues_from_pydantic, suggest_name
from fingertip.design.load import load_tables
from fingertip.design.parameters import ParameterTable
from fingertip.errors import FingertipError, Issue, TraceError


class StrictFile(BaseModel):
    """A frozen file of tables; an unknown name, a value out of bounds or a broken rule is refused.

    Raises
    ------
    TraceError
        With one sentence for each issue.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)
    known_outputs: ClassVar[tuple[str, ...]]

    scene: str = Field("scene", pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$", description="Name of the scene.")
    outputs: list[str] = Field(["voltage_v", "force_n", "slip"], description="Columns wanted beside the time.")

    def __init__(self, **tables: Any) -> None:
        try:
            super().__init__(**tables)
        except ValidationError as error:
            issues = issues_from_pydantic(error, type(self))
            raise TraceError([*issues, *self._broken_beside(tables, issues)]) from None
        if issues := [issue for issue, _ in self.broken()]:
            raise TraceError(issues)

    def broken(self) -> Iterator[tuple[Issue, set[str]]]:
        """Rules between parameters that do not hold, and the parameters each reads."""
        yield from outputs_broken(self.outputs, self.known_outputs)

    @classmethod
    def load(cls, *files: str | Path, changes: Iterable[str] = ()) -> Self:
        """Read a scene: defaults, then each file, then changes such as ``"tap.force_n=5"``.

        Raises
        ------
        TraceError
            If a file is missing or no valid TOML, or the scene it gives is refused.
        """
        try:
            tables = load_tables(files, changes)
        except FingertipError as error:
            raise TraceError(error.issues) from None
        return cls(**tables)

    @classmethod
    def _broken_beside(cls, tables: Mapping[str, Any], issues: Iterable[Issue]) -> list[Issue]:
        """Broken rules among the parameters that are in bounds, so that one run tells everything that is wrong."""
        faulty = {issue.field for issue in issues}
        fields: dict[str, Any] = {}
        for name, info in cls.model_fields.items():
            given, default = tables.get(name), info.default
            if isinstance(default, ParameterTable):
                known = type(default).model_fields
                table = given if isinstance(given, Mapping) else {}
                kept = {k: v for k, v in table.items() if k in known and f"{name}.{k}" not in faulty}
                fields[name] = default.model_copy(update=kept)
            else:
                fields[name] = default if given is None or any(f.startswith(name) for f in faulty) else given
        return [issue for issue, reads in cls.model_construct(**fields).broken() if not reads & faulty]


def outputs_broken(outputs: Sequence[str], known: Sequence[str]) -> Iterator[tuple[Issue, set[str]]]:
    """Faults of a list of outputs."""
    if not outputs:
        yield Issue("outputs", f"is empty; name at least one of {', '.join(known)}."), {"outputs"}
    for name in dict.fromkeys(outputs):
        if name not in known:
            yield Issue("outputs", f"{name!r} is no output; {suggest_name(name, known)}"), {"outputs"}
        elif outputs.count(name) > 1:
            yield Issue("outputs", f"{name!r} is named {outputs.count(name)} times; name it once."), {"outputs"}
