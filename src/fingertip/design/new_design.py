"""New design files: the main parameters at the top, all others below them as comments with their defaults.

Parameters stand under their dotted names, such as `skin.width_mm = 17`, as in --set and in messages. A line can so be
moved, or its # removed, without regard to tables.
"""

from __future__ import annotations

import contextlib
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from fingertip.catalogues.electronics import SENSORS
from fingertip.catalogues.file_kinds import DESIGN, PARAMS, list_bundled_files
from fingertip.design.files import Parameter, list_parameters, load_tables
from fingertip.design.fit import Fit, fit_design
from fingertip.design.geometry import DesignTables
from fingertip.design.model import Design
from fingertip.design.parameters.declaration import parse_tables, suggest_name
from fingertip.design.parameters.parts import Hand
from fingertip.foundation.errors import DesignError, Issue, TomlFileError, gather
from fingertip.foundation.progress import ShareText
from fingertip.foundation.tables import read_toml

_OPTIONAL = ("length_limit_mm", "tendon_diameter_mm", "pin")


def list_hands() -> dict[str, Path]:
    return {path.stem: path for path in sorted((PARAMS / "hands").glob("*.toml"))}


def find_hand(given: str | Path) -> Path:
    """Find the file of a hand by path or by the name of a bundled one. Raises TomlFileError."""
    hands, path = list_hands(), Path(given)
    if path.name == str(given) and not path.suffix and not path.exists():
        if path.name not in hands:
            remedy = suggest_name(path.name, list(hands))
            raise TomlFileError(Issue(path.name, f"is neither a file nor the name of a bundled hand; {remedy}"))
        path = hands[path.name]
    if message := _find_fault(path, f"the bundled hand {next(iter(hands))}"):
        raise TomlFileError(Issue(str(given), message))
    return path


def _find_fault(path: Path, example: str) -> str:
    """Describe what is wrong with a hand file; nothing if it is complete."""
    if path.is_dir():
        return f"is a folder; give the path of a hand file, such as {example}."
    tables = read_toml(path)
    others, hand = [name for name in tables if name != "hand"], tables.get("hand", {})
    if others:
        return f"holds {others[0]} besides [hand]; a hand file has the table [hand] alone, as {example} has."
    missing = [name for name in Hand.model_fields if name not in hand and name not in _OPTIONAL]
    if missing:
        return f"lacks {', '.join(missing)} in [hand]; measure your hand, or start from {example}."
    return ""


_SENSORS = (*SENSORS, "custom")
_MAIN_PARAMETERS = (
    "sensor.model", "skin.width_mm", "skin.length_mm", "skin.semi_axis_palmar_mm", "skin.semi_axis_dorsal_mm",
    "skin.thickness_palmar_mm", "bone.base_length_mm", "bone.interface", "board.variant",
)  # fmt: skip
"""Parameters that a user changes first. They stand at the top."""

_PLACE = "sensor.distance_from_tip_mm"
_AS_MEASURED = 0.1
"""Millimetres, or degrees, that no joint is measured to."""
_JOINT_PARAMETERS = tuple(f"hand.{name}" for name in Hand.model_fields)
"""Parameters that stand at the top of a design with a clevis: what is measured on the hand."""
PRESETS = ("adult_finger", "adult_thumb", "youth_finger", "youth_thumb", "child_finger", "child_thumb")
"""Bundled designs of anatomical size, each with a clevis."""
_MAX_COLUMN_WIDTH = 40
"""Maximum column in which the comments of a block begin. A longer line shifts its own comment only."""


@dataclass(frozen=True)
class NewDesign:
    """Text of a new design file, and what was fitted for it."""

    text: str
    base: str
    fitted: Mapping[str, tuple[float, float]]
    """Parameter -> value in the base and in the new design."""
    reasons: Mapping[str, str]
    """Fitted parameter of the hand -> what its measured value would break."""
    design: Design


def write_new_design(
    name: str,
    sensor: str | None = None,
    preset: str | None = None,
    hand: str | Path | None = None,
    changes: Sequence[str] = (),
    progress: Callable[[str], None] = lambda message: None,
) -> NewDesign:
    """Write a design file with a bundled design as its base.

    A preset has a joint. With a preset or a hand, lengths that nobody measures are fitted until all rules pass.

    Raises DesignError or TomlFileError.
    """
    refuse_words(name, sensor, preset)
    if preset is None and hand is None:
        fitted = SENSORS.get(sensor or "fsr400", SENSORS["fsr400"])  # a custom sensor begins as an FSR 400
        base, own = fitted.bundled_design, [f"sensor.model={sensor or 'fsr400'}", *fitted.changes, *changes]
        design = Design(**load_tables([list_bundled_files(DESIGN)[base]], own).tables | {"name": name})
        return NewDesign("\n".join([*list_lines(design, base), ""]), base, {}, {}, design)
    return fit_start(start_design(name, sensor, preset, hand, changes), progress)


def refuse_words(name: str, sensor: str | None, preset: str | None) -> None:
    """Refuse a name that no design may have, and an unknown sensor or preset. Raises DesignError."""
    issues: list[Issue] = []
    with gather(issues):
        parse_tables(DesignTables, {"name": name})
    for field, word, known in (("sensor", sensor, _SENSORS), ("preset", preset, PRESETS)):
        if word is not None and word not in known:
            issues.append(Issue(field, f"{word!r} is not known; {suggest_name(word, known)}"))
    if issues:
        raise DesignError(issues)


@dataclass(frozen=True)
class Start:
    """Design with a joint before its fit: a preset with what is given."""

    tables: DesignTables
    base: str
    before: DesignTables
    fixed: tuple[str, ...]
    """Parameters that stay as they are."""
    measured: tuple[str, ...]
    """Parameters of the hand, if one is given."""


def start_design(
    name: str, sensor: str | None, preset: str | None, hand: str | Path | None, changes: Sequence[str]
) -> Start:
    base = preset or "adult_finger"
    files: list[str | Path] = [list_bundled_files(DESIGN)[base], *([find_hand(hand)] if hand is not None else [])]
    loaded = load_tables(files, [*([f"sensor.model={sensor}"] if sensor else []), *changes])
    begun = parse_tables(DesignTables, loaded.tables | {"name": name})
    before = DesignTables(**load_tables(files[:1], []).tables)
    longer_mm = begun.skin.length_mm - before.skin.length_mm
    if longer_mm > 0.0 and _PLACE not in loaded.changed:  # or the collar would touch a plate before the pad
        begun = begun.with_values({_PLACE: round(before.sensor.distance_from_tip_mm + longer_mm, 2)})
    return Start(begun, base, before, loaded.changed, _JOINT_PARAMETERS if hand is not None else ())


def fit_start(start: Start, progress: Callable[[str], None]) -> NewDesign:
    """Fit the lengths that nobody measures, if it can without a move of the sensor. Raises DesignError."""
    was, fit, tables = start.before.value(_PLACE), None, start.tables

    def fit_lengths(*fixed: str) -> Fit:
        return fit_design(
            tables, (*start.fixed, *fixed), start.before,
            progress=lambda share: progress(ShareText("fitting lengths", share)),
        )  # fmt: skip

    with contextlib.suppress(DesignError):
        fit = fit_lengths(_PLACE) if _PLACE not in start.fixed and tables.value(_PLACE) != was else None
    fit = fit or fit_lengths()
    design = Design(**fit.tables.model_dump())
    place, fitted = design.value(_PLACE), {move.name: (move.before, move.after) for move in fit.moves}
    if _PLACE not in start.fixed and place != was:
        fitted[_PLACE] = was, place
    return NewDesign("\n".join([*list_lines(design, start.base), ""]), start.base, fitted, {}, design)


def find_lost_travel(made: NewDesign) -> list[Issue]:
    """Find what the fit has taken from the joint: travel, or distance of the tendon."""
    issues = []
    for name, reason in made.reasons.items():
        before, after = made.fitted[name]
        if after < before - _AS_MEASURED:
            lost = f"{before:g} would become {after:g}: {reason}"
            issues.append(Issue(name, f"{lost}; allow it with --allow-shorter-travel"))
    return issues


def list_lines(design: Design, base: str) -> Iterator[str]:
    parameters = {parameter.path: parameter for parameter in list_parameters()}
    name = parameters.pop("name")
    joint = _JOINT_PARAMETERS if design.dimensions.joint else ()
    main = [parameters.pop(path) for path in (*_MAIN_PARAMETERS, *joint)]
    if design.sensor.model == "custom":
        main[1:1] = [parameters.pop(path) for path in list(parameters) if path.startswith("custom_sensor.")]
    if design.silicone.product == "own":
        main += [parameters.pop(path) for path in list(parameters) if path.startswith("silicone.")]
    changed = [p for p in parameters.values() if design.value(p.path) != p.default]
    yield f"# Design of a fingertip, begun from the bundled design {base}."
    yield "# A comment holds the meaning of a parameter and, in brackets, its unit and bounds."
    yield from ("", *_format_block(design, [name]))
    yield from ("", "# Main parameters.", *_format_block(design, main))
    if changed:
        heading = f"# Other parameters in which the bundled design {base} differs from the defaults."
        yield from ("", heading, *_format_block(design, changed))
    yield ""
    yield "# All other parameters with their defaults. Remove the # in front of a name, then change the value."
    for table, info in Design.model_fields.items():
        rest = [p for p in parameters.values() if p.path.startswith(f"{table}.") and p not in changed]
        if rest:
            heading = f"# {' '.join((inspect.getdoc(info.annotation) or '').split())}"
            yield from ("", heading, *_format_block(design, rest, prefix="#"))


def _format_block(design: Design, parameters: Iterable[Parameter], prefix: str = "") -> Iterator[str]:
    """Format parameters one per line, with their comments in one column."""
    import tomlkit  # noqa: PLC0415

    rows = [(f"{prefix}{p.path} = {tomlkit.item(design.value(p.path)).as_string()}", p) for p in parameters]
    width = max((len(setting) for setting, _ in rows if len(setting) <= _MAX_COLUMN_WIDTH), default=0)
    for setting, parameter in rows:
        limits = ", ".join(text for text in (parameter.unit, parameter.bounds) if text)
        yield f"{setting:{width}}  # {parameter.description}" + (f" [{limits}]" if limits else "")
