"""Base class of scene and manipulation files: strict tables, all issues reported at once, and a table of parameters."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fingertip.catalogues.file_kinds import FileKind
from fingertip.design.files import format_parameter_table, format_value, load_tables
from fingertip.design.parameters import ParameterTable
from fingertip.design.parameters.declaration import issues_from_pydantic, suggest_name
from fingertip.foundation.errors import FingertipError, Issue, TraceError


class SimulationFile(BaseModel):
    """Frozen file of tables that refuses unknown names, values out of bounds and broken rules between parameters.

    Raises TraceError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)
    file_kind: ClassVar[FileKind]
    """Kind of TOML file that is read."""
    known_outputs: ClassVar[tuple[str, ...]]
    """Names that `outputs` may contain."""

    scene: str = Field("scene", pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$", description="Name of the scene.")
    outputs: list[str] = Field(["voltage_v", "force_n", "slip"], description="Columns to record beside the time.")

    def __init__(self, /, **tables: Any) -> None:
        try:
            super().__init__(**tables)
        except ValidationError as error:
            issues = issues_from_pydantic(error, type(self))
            raise TraceError([*issues, *self._rule_issues_beside(tables, issues)]) from None
        if issues := [issue for issue, _ in self.find_rule_issues()]:
            raise TraceError(issues)

    def find_rule_issues(self) -> Iterator[tuple[Issue, set[str]]]:
        """Yield each broken rule between parameters, with the names of the parameters it reads."""
        yield from find_output_issues(self.outputs, self.known_outputs)

    @property
    def name(self) -> str:
        """Name of the scene, which the file calls ``scene``."""
        return self.scene

    @classmethod
    def load(cls, *files: str | Path, changes: Iterable[str] = ()) -> Self:
        """Read a file or a bundled one: defaults first, then each file, then changes such as ``"tap.force_n=5"``.

        Raises TraceError.
        """
        try:
            tables = load_tables(files, changes, cls.file_kind).tables
        except FingertipError as error:
            raise TraceError(error.issues) from None
        return cls(**tables)

    def list_parameters(self) -> Iterator[dict[str, Any]]:
        """Yield name, value, default, unit, bounds and description of every parameter, in the order of the file."""
        schema = type(self).model_json_schema()
        for name in type(self).model_fields:
            value = getattr(self, name)
            if isinstance(value, ParameterTable):
                table = schema["$defs"][type(value).__name__]["properties"]
                for key, field in table.items():
                    yield _describe(f"{name}.{key}", getattr(value, key), field, self.known_outputs)
            else:
                yield _describe(name, value, schema["properties"][name], self.known_outputs)

    def format_parameters(self) -> list[str]:
        """Return the parameters as lines of a table with a header."""
        columns = ("name", "value", "unit", "bounds", "description")
        rows = [tuple(format_value(p[column]) for column in columns) for p in self.list_parameters()]
        return format_parameter_table(rows).splitlines()

    @classmethod
    def _rule_issues_beside(cls, tables: Mapping[str, Any], issues: Iterable[Issue]) -> list[Issue]:
        """Broken rules among the parameters that are in bounds, so that one run reports everything that is wrong."""
        faulty = {issue.field for issue in issues}
        fields: dict[str, Any] = {}
        for name, info in cls.model_fields.items():
            value, default = tables.get(name), info.default
            if isinstance(default, ParameterTable):
                known = type(default).model_fields
                table = value if isinstance(value, Mapping) else {}
                valid = {k: v for k, v in table.items() if k in known and f"{name}.{k}" not in faulty}
                fields[name] = default.model_copy(update=valid)
            else:
                fields[name] = default if value is None or any(f.startswith(name) for f in faulty) else value
        return [issue for issue, reads in cls.model_construct(**fields).find_rule_issues() if not reads & faulty]


def find_output_issues(outputs: Sequence[str], known: Sequence[str]) -> Iterator[tuple[Issue, set[str]]]:
    """Yield the issues of a list of outputs."""
    if not outputs:
        yield Issue("outputs", f"is empty; name at least one of {', '.join(known)}."), {"outputs"}
    for name in dict.fromkeys(outputs):
        if name not in known:
            yield Issue("outputs", f"{name!r} is not an output; {suggest_name(name, known)}"), {"outputs"}
        elif outputs.count(name) > 1:
            yield Issue("outputs", f"{name!r} is named {outputs.count(name)} times; name it once."), {"outputs"}


def _describe(name: str, value: Any, field: dict[str, Any], outputs: Sequence[str]) -> dict[str, Any]:
    low = f">= {field['minimum']:g}" if "minimum" in field else ""
    low = f"> {field['exclusiveMinimum']:g}" if "exclusiveMinimum" in field else low
    high = f"<= {field['maximum']:g}" if "maximum" in field else ""
    bounds = " | ".join(field["enum"]) if "enum" in field else ", ".join(part for part in (low, high) if part)
    if name == "outputs":
        bounds = " | ".join(outputs)
    return {
        "name": name,
        "value": value,
        "default": field.get("default"),
        "unit": field.get("unit", ""),
        "bounds": bounds,
        "description": field.get("description", ""),
    }
