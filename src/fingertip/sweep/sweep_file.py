"""A sweep file: which parameters vary over what, which outputs are wanted, and of which design. Strict like a design
file; what stands in it once is resolved here, so that the sweep's folder needs no other file."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fingertip.design.issues import issues_from_pydantic, suggest_name
from fingertip.design.load import load_tables
from fingertip.design.model import Design
from fingertip.design.parameters import DesignTables, quantity
from fingertip.errors import DesignError, FingertipError, Issue, SweepError

MAX_POINTS = 100_000_000
"""More rows do not fit what reads them."""


class SweepFile(BaseModel):
    """What a sweep file holds beside its axes."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False, title="fingertip sweep")

    name: str = Field("sweep", pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$", description="Name of the output folder.")
    outputs: list[str] = Field(description="What is computed of each point; [] asks the rules only.")
    sampling: Literal["grid", "latin_hypercube", "sobol"] = Field(
        "grid", description="grid: every combination; the others draw `points` from the whole space."
    )
    points: int = quantity(0, "points", "How many a sampler draws.", minimum=0, maximum=MAX_POINTS)
    seed: int = quantity(0, "", "Of the sampler.", minimum=0, maximum=2**31 - 1)
    tolerance_mm: float = quantity(0.02, "mm", "Most a facet strays from the exact surface.", minimum=0.0005, maximum=1)
    time_limit_s: float = quantity(60.0, "s", "A point that takes longer is given up.", minimum=0.05, maximum=86400)
    trials: int = quantity(
        8, "", "Simulated trials of each point, for the detection's outputs.", minimum=1, maximum=100_000
    )
    first_seed: int = quantity(0, "", "Of the first trial; the others follow.", minimum=0, maximum=2**31 - 1)
    detector: str = Field("fast", description="Which detector the trials are judged by.")
    silicone: str = Field("addition_40a", description="Material card of the skin.")
    print_density_g_cm3: float = quantity(
        1.2, "g/cm3", "Of the printed parts.", minimum=0.1, maximum=20, verified=False
    )
    minimise: list[str] = Field([], description="Outputs of which less is better.")
    maximise: list[str] = Field([], description="Outputs of which more is better.")
    axes: dict[str, Any] = Field(description="Dotted parameter: a list, or low and high, with steps on a grid.")
    design: dict[str, Any] = Field({}, description="Base design: a file beside this one, or its tables.")
    scene: dict[str, Any] | None = Field(None, description="Base scene: a file beside this one, or its tables.")


def read(file: str | Path, changes: Iterable[str] = ()) -> dict[str, Any]:
    """The tables of a sweep file, with the files it names read in and changes made.

    A change of a name of the sweep file (`tolerance_mm=0.05`, `axes.skin.width_mm=[15, 16]`) changes that, `scene.`
    before it the base scene, and any other name the base design (`skin.width_mm=18`).

    Raises
    ------
    SweepError
        With everything that cannot be read.
    """
    of_sweep, of_design, of_scene = _split(changes)
    issues: list[Issue] = []
    try:
        tables = load_tables([file], of_sweep)
    except DesignError as error:
        raise SweepError([Issue(f.field, f.message.replace("a design", "a sweep")) for f in error.issues]) from None
    for name, more in (("design", of_design), ("scene", of_scene)):
        given = tables.get(name, {} if name == "design" else None)
        try:
            tables[name] = _base(Path(file).parent, name, given, more)
        except FingertipError as error:
            issues += error.issues
    if issues:
        raise SweepError(issues)
    return {name: table for name, table in tables.items() if table is not None}


def _base(folder: Path, name: str, given: Any, changes: list[str]) -> dict[str, Any] | None:
    if isinstance(given, str):
        return load_tables([folder / given], changes)
    if given is None and changes:
        raise SweepError(Issue(f"--set scene.{changes[0]}", "changes a base scene; the sweep file names none."))
    if given is not None and not isinstance(given, Mapping):
        raise SweepError(Issue(name, f"{given!r} is refused; give the path of a file, or a table [{name}]."))
    if given is None:
        return None
    return _merged(dict(given), load_tables((), changes))


def _merged(into: dict[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    for key, value in new.items():
        old = into.get(key)
        both = isinstance(old, Mapping) and isinstance(value, Mapping)
        into[key] = _merged(dict(old), value) if both and isinstance(old, Mapping) else value
    return into


def _split(changes: Iterable[str]) -> tuple[list[str], list[str], list[str]]:
    sweep: list[str] = []
    design: list[str] = []
    scene: list[str] = []
    for change in changes:
        name = change.partition("=")[0].strip()
        first, dot, _ = name.partition(".")
        if first in ("design", "scene") and dot:
            (design if first == "design" else scene).append(change.strip().partition(".")[2])
        elif first in SweepFile.model_fields or first not in DesignTables.model_fields:
            sweep.append(change)
        else:
            design.append(change)
    return sweep, design, scene


def validated(tables: Mapping[str, Any]) -> tuple[SweepFile | None, list[Issue]]:
    """The file's own fields, or what is wrong with them."""
    try:
        return SweepFile(**tables), []
    except ValidationError as error:
        return None, [_missing(issue) for issue in issues_from_pydantic(error, SweepFile)]


def _missing(issue: Issue) -> Issue:
    if "Field required" not in issue.message:
        return issue
    remedy = {
        "outputs": 'is missing; name what you want, such as outputs = ["checks_failed"], or [] for the rules only.',
        "axes": "is missing; write [axes] and below it what varies, such as skin.width_mm = [16, 17].",
    }
    return Issue(issue.field, remedy[issue.field])


def to_text(tables: Mapping[str, Any]) -> str:
    """Tables as TOML, one line for each value, in a fixed order: what is compared and stored."""
    lines = [f"{name} = {_value(value)}" for name, value in tables.items() if not isinstance(value, Mapping)]
    for name, table in tables.items():
        if isinstance(table, Mapping):
            lines += ["", f"[{name}]", *_lines(table)]
    return "\n".join(lines) + "\n"


def without_objectives(text: str) -> list[str]:
    """The lines of `to_text` that rows depend on: what is minimised or maximised is only asked of them afterwards."""
    return [line for line in text.splitlines() if not line.startswith(("minimise = ", "maximise = "))]


def _lines(table: Mapping[str, Any], before: str = "") -> Iterator[str]:
    for key, value in table.items():
        if isinstance(value, Mapping) and before == "" and not key.count("."):
            yield from _lines(value, f"{key}.")
        else:
            yield f"{before}{key} = {_value(value)}"


def _value(value: Any) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
        case float() if math.isinf(value):
            return "inf" if value > 0 else "-inf"
        case list() | tuple():
            return "[" + ", ".join(map(_value, value)) + "]"
        case Mapping():
            return "{" + ", ".join(f"{key} = {_value(inner)}" for key, inner in value.items()) + "}"
    return repr(value)


def base_design(tables: Mapping[str, Any]) -> tuple[DesignTables | None, list[Issue]]:
    """The base design within the bounds of its parameters; rules between them are asked of each point."""
    try:
        return DesignTables(**tables), []
    except ValidationError as error:
        return None, [Issue(f"design.{f.field}", f.message) for f in issues_from_pydantic(error, Design)]


def objectives(file: SweepFile) -> Iterator[Issue]:
    """What is wrong with the names of outputs and objectives among themselves."""
    for key in ("minimise", "maximise"):
        for name in dict.fromkeys(getattr(file, key)):
            if name not in file.outputs:
                remedy = suggest_name(name, file.outputs) if file.outputs else "add it to outputs."
                yield Issue(key, f"{name!r} is not among the sweep's outputs; {remedy}")
    for name in dict.fromkeys(file.minimise):
        if name in file.maximise:
            yield Issue("maximise", f"{name!r} is to be minimised too; leave it out of one of them.")


def parsed(text: str) -> dict[str, Any]:
    """Tables from TOML text."""
    return tomllib.loads(text)
