"""Sweep file: which parameters vary over which values, which outputs are computed, and for which
base design.

A sweep file is as strict as a design file. The files that it names are read in here, so that the
folder of a sweep needs no other file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fingertip.catalogues.electronics import split_finger
from fingertip.catalogues.file_kinds import DESIGN, SCENE, SET, SWEEP, find_file, identify_kind
from fingertip.design.design_file import load_tables, merge, resolve_names
from fingertip.design.finger_set import SetFile, read_set
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import quantity
from fingertip.design.parameters.declaration import issues_from_pydantic, parse_tables, suggest_name
from fingertip.design.proportions import fill_in
from fingertip.foundation.errors import (
    FingertipError,
    Issue,
    SweepError,
    gather,
    quote_value,
    raise_issues,
)
from fingertip.foundation.input_files import is_safe_name

if TYPE_CHECKING:
    from tomlkit.items import Item

MAX_POINTS = 100_000_000
"""Maximum number of points. The report cannot read more rows."""
MAX_SAMPLED_VALUES = 20_000_000
"""Maximum number of values, points times axes, that a sampler draws.
They are held in memory, several times.
"""


class SweepFile(BaseModel):
    """Contents of a sweep file."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        title="fingertip sweep",
    )

    name: str = Field(
        "sweep",
        pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$",
        description="Name of the output folder.",
    )
    outputs: list[str] = Field(
        description="Outputs computed for each point; [] checks only the design rules."
    )
    sampling: Literal["grid", "latin_hypercube", "sobol"] = Field(
        "grid",
        description="grid: every combination of the axes; the others sample `points` points.",
    )
    points: int = quantity(0, "points", (0, MAX_POINTS), "Number of points that a sampler draws.")
    seed: int = quantity(0, "", (0, 2**31 - 1), "Random seed of the sampler.")
    fit: bool = Field(
        False,
        description="Whether what follows from the axes moves at each point until the design can "
        "be made.",
    )
    tolerance_mm: float = quantity(
        0.02, "mm", (0.0005, 1), "Maximum distance between a mesh and the exact surface."
    )
    time_limit_s: float = quantity(
        60.0, "s", (0.05, 86400), "Time limit of a point; a point that takes longer is given up."
    )
    trials: int = quantity(
        8, "", (1, 100_000), "Number of simulated trials per point, for the detection outputs."
    )
    first_seed: int = quantity(
        0, "", (0, 2**31 - 1), "Random seed of the first trial; the others count up from it."
    )
    detector: str = Field("fast", description="Detector that is run on the trials.")
    print_density_g_cm3: float = quantity(
        1.2, "g/cm3", (0.1, 20), "Density of the printed parts. (unverified)"
    )
    minimise: list[str] = Field([], description="Outputs to minimise.")
    maximise: list[str] = Field([], description="Outputs to maximise.")
    axes: dict[str, Any] = Field(
        description="Dotted parameter: a list of values, or low and high, on a grid with steps."
    )
    design: dict[str, Any] = Field(
        {},
        description="Base design or set of fingers: a file beside this one, a bundled name, or "
        "the tables of a design.",
    )
    scene: dict[str, Any] | None = Field(
        None, description="Base scene: a file beside this one, a bundled name, or its tables."
    )


def read_sweep_file(file: str | Path, changes: Iterable[str] = ()) -> dict[str, Any]:
    """Read the tables of a sweep file and of the files that it names, with changes applied.

    Raises SweepError.
    """
    sweep_changes, design_changes, scene_changes = _sort_changes(changes)
    try:
        path = find_file(file, SWEEP)
        loaded = load_tables([path], sweep_changes, SWEEP)
    except FingertipError as error:
        raise SweepError(error.issues) from None

    tables = loaded.tables
    is_bundled = path != Path(file)
    issues = list(_find_changed_axes(tables.get("axes"), design_changes, scene_changes))

    for name, base_changes in (("design", design_changes), ("scene", scene_changes)):
        entry = tables.get(name, {} if name == "design" else None)
        is_typed = name in loaded.changed
        folder = Path() if is_bundled and is_typed else path.parent

        with gather(issues):
            tables[name] = _load_base(
                folder,
                name=name,
                entry=entry,
                changes=base_changes,
                is_typed=is_typed,
            )
            if name == "design" and "fingers" in tables[name] and not isinstance(entry, str):
                message = "is a table of a set; write it in a file of its own, and name that."
                raise SweepError(Issue("design.fingers", message))

    raise_issues(SweepError, issues)
    return {name: table for name, table in tables.items() if table is not None}


def parse_sweep_file(tables: Mapping[str, Any]) -> tuple[SweepFile | None, list[Issue]]:
    try:
        return SweepFile(**tables), []
    except ValidationError as error:
        return None, [_explain(issue) for issue in issues_from_pydantic(error, SweepFile)]


def parse_base_designs(tables: Mapping[str, Any]) -> tuple[dict[str, DesignTables], list[Issue]]:
    """Validate the base design, as "" -> design, or each finger -> design of a set.

    Points check the rules.
    """
    designs = dict[str, DesignTables]()
    issues = list[Issue]()

    if "fingers" in tables:
        with gather(issues, "design."):
            parse_tables(SetFile, tables)

        if issues:
            return {}, issues

    for finger, own in tables.get("fingers", {"": tables}).items():
        with gather(issues, f"design.fingers.{finger}." if finger else "design."):
            designs[finger] = parse_tables(DesignTables, own)

    return designs, issues


def check_objectives(file: SweepFile) -> Iterator[Issue]:
    """Return the issues of objectives that are not outputs, or are listed on both sides."""
    for key in ("minimise", "maximise"):
        for name in dict.fromkeys(getattr(file, key)):
            if name not in file.outputs:
                remedy = suggest_name(name, file.outputs) if file.outputs else "add it to outputs."
                yield Issue(key, f"{name!r} is not among the sweep's outputs; {remedy}")

    for name in dict.fromkeys(file.minimise):
        if name in file.maximise:
            yield Issue(
                "maximise", f"{name!r} is listed under minimise too; leave it out of one of them."
            )


def to_canonical_text(tables: Mapping[str, Any]) -> str:
    """Write tables as TOML with one line per value in a fixed order: the text that is stored and
    compared.
    """
    import tomlkit  # noqa: PLC0415

    document = tomlkit.document()

    for name, value in tables.items():
        if not isinstance(value, Mapping):
            document.add(name, _to_inline_item(value))

    for name, value in tables.items():
        if isinstance(value, Mapping):
            table = tomlkit.table()
            for keys, inner in _list_lines(value):
                table.add(tomlkit.key(keys), _to_inline_item(inner))

            document.add(name, table)

    return tomlkit.dumps(document)


def _load_base(
    folder: Path,
    name: str,
    entry: Any,
    changes: list[str],
    is_typed: bool,
) -> dict[str, Any] | None:
    """Load the base design or the base scene: a file in a folder, a bundled one, or tables within
    the sweep file.

    A path that the user has typed may lead anywhere. A sweep file may come from a stranger, and
    names files beside it.
    """
    if isinstance(entry, str):
        kind = DESIGN if name == "design" else SCENE
        if not (is_typed or is_safe_name(entry)):
            problem = (
                f"{quote_value(entry)} is no name of a file beside the sweep file, or of a "
                f"bundled {kind.name}"
            )
            raise SweepError(
                Issue(name, f"{problem}; put the file there, or add --set {name}=PATH.")
            )

        path = find_file(entry, *((DESIGN, SET) if kind is DESIGN else (kind,)), folder=folder)
        below = folder if not is_typed and path == folder / entry else None
        if kind is DESIGN and identify_kind(path) is SET:
            set_name, side, fingers = read_set(path, changes, lambda loaded: loaded.tables, below)
            return {"name": set_name, "side": side, "fingers": fingers}

        finger = next((change for change in changes if split_finger(change)[0]), None)
        if finger:
            raise SweepError(
                Issue(
                    f"--set {finger}", f"{entry} is no set of fingers; name one, or leave it out."
                )
            )

        return load_tables([path], changes, kind, below).tables

    if entry is None and changes:
        message = "changes a base scene, but the sweep file names none; add --set scene=FILE.toml."
        raise SweepError(Issue(f"--set scene.{changes[0]}", message))

    if entry is None:
        return None

    if not isinstance(entry, Mapping):
        problem = f"{quote_value(entry)} is neither a file nor a table"
        raise SweepError(Issue(name, f"{problem}; give the path of a file, or a table [{name}]."))

    if name == "design":
        resolve_names(entry, folder)

    base = fill_in(entry) if name == "design" and entry else dict(entry)
    merge(
        base,
        load_tables((), changes).tables,
    )
    return base


def _find_changed_axes(
    axes: Any, design_changes: list[str], scene_changes: list[str]
) -> Iterator[Issue]:
    """Find changes of parameters that the sweep varies: the axis would override them at every
    point.
    """
    for change in (*design_changes, *(f"scene.{change}" for change in scene_changes)):
        name, _, value = (text.strip() for text in change.partition("="))
        entry = axes
        for key in name.split("."):
            entry = entry.get(key) if isinstance(entry, Mapping) else None

        if entry is not None:
            problem = f"has no effect, because {name} is an axis of the sweep"
            yield Issue(f"--set {change}", f"{problem}; set axes.{name}=[{value}].")


def _sort_changes(changes: Iterable[str]) -> tuple[list[str], list[str], list[str]]:
    """Sort changes into those of the sweep file, of the base design and of the base scene."""
    sweep = list[str]()
    design = list[str]()
    scene = list[str]()

    for change in changes:
        name = change.partition("=")[0].strip()
        first, dot, _ = name.partition(".")
        if first in ("design", "scene") and dot:
            (design if first == "design" else scene).append(change.strip().partition(".")[2])
        elif first != "fingers" and (
            first in SweepFile.model_fields or first not in DesignTables.model_fields
        ):
            sweep.append(change)
        else:
            design.append(change)

    return sweep, design, scene


def _explain(issue: Issue) -> Issue:
    """Return the issue with a remedy where a field is missing, or where it became a parameter of
    the design.
    """
    if issue.field == "silicone":
        remedy = "write silicone.product under [design], or add --set silicone.product=NAME."
        return Issue(issue.field, f"is a parameter of the design; {remedy}")

    if "Field required" not in issue.message:
        return issue

    remedies = {
        "outputs": 'list outputs, such as outputs = ["checks_failed"], or [] to check only the '
        "rules.",
        "axes": "write [axes] and below it what varies, such as skin.width_mm = [16, 17].",
    }
    return Issue(issue.field, f"is missing; {remedies[issue.field]}")


def _list_lines(table: Mapping[str, Any]) -> Iterator[tuple[list[str], Any]]:
    """Return the values of a table with their keys.

    A table within it becomes dotted keys, one line per value.
    """
    for key, value in table.items():
        if isinstance(value, Mapping) and "." not in key:
            yield from (([key, inner], inner_value) for inner, inner_value in value.items())
        else:
            yield key.split("."), value


def _to_inline_item(value: Any) -> Item:
    import tomlkit  # noqa: PLC0415

    if isinstance(value, Mapping):
        table = tomlkit.inline_table()
        for key, inner in value.items():
            table.add(key, _to_inline_item(inner))

        return table

    if isinstance(value, list | tuple):
        array = tomlkit.array()
        array.extend(map(_to_inline_item, value))
        return array

    item: Item = tomlkit.item(value)
    return item
